/* outputs.c: where the images of a picture go: their shapes, names and files. */
#include "outputs.h"

#include "exr_file.h"
#include "look.h"
#include "program.h"
#include "whole.h"

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static int check_extension(const char *path)
{
    for (size_t i = 0; mns_image_write_format(i); i++) {
        char extension[16];
        snprintf(extension, sizeof(extension), ".%s", mns_image_write_format(i));
        if (name_has_extension(path, extension)) {
            return STATUS_DONE;
        }
    }
    char list[64] = "";
    for (size_t i = 0; mns_image_write_format(i) && strlen(list) < 32; i++) {
        size_t used = strlen(list);
        snprintf(list + used, sizeof(list) - used, "%s.%s", used ? " and " : "", mns_image_write_format(i));
    }
    return program_usage("%s: this build writes %s pictures, and .mp4, .mkv, .webm and .y4m videos", path, list);
}

static int check_name(const char *path, size_t pictures)
{
    if (pictures > 1 && !pattern_is(path)) {
        return program_usage("%s: %zu frames need a pattern for their numbers, such as out_%%04d%s", path, pictures,
                             strrchr(path, '.') ? strrchr(path, '.') : "");
    }
    return STATUS_DONE;
}

/* An output that would replace its own input is a slip. */
static int check_overwrite(const char *pattern, const struct inputs *inputs)
{
    for (size_t i = 0; i < inputs->count; i++) {
        struct stat in, out;
        char *name = pattern_name(pattern, inputs->list[i].number);
        bool same = name && stat(name, &out) == 0 && stat(inputs->list[i].path, &in) == 0 && S_ISREG(in.st_mode) &&
                    in.st_dev == out.st_dev && in.st_ino == out.st_ino;
        free(name);
        if (same) {
            return program_usage("%s: is an input; choose another name for the output", inputs->list[i].path);
        }
    }
    return STATUS_DONE;
}

/* Told before the frames are read. A folder with a number in its name is left to the writing. */
static int check_place(const char *pattern, const struct inputs *inputs)
{
    const char *slash = strrchr(pattern, '/'), *percent = strchr(pattern, '%');
    if (slash && percent && percent < slash) {
        return STATUS_DONE;
    }
    char *name = pattern_name(pattern, inputs->list[0].number);
    int status = name ? program_check_place(name) : program_fail("%s: out of memory", pattern);
    free(name);
    return status;
}

int outputs_check_place(const char *pattern, const struct inputs *inputs, size_t frames)
{
    int status = check_name(pattern, frames);
    status = status == STATUS_DONE ? check_overwrite(pattern, inputs) : status;
    return status == STATUS_DONE ? check_place(pattern, inputs) : status;
}

static void add(struct outputs *outputs, const struct options *options, enum mns_layer layer, enum output_kind kind, const char *pattern)
{
    struct mns_image image = {.width = options->width, .height = options->height, .channels = mns_layer_channels(layer)};
    bool float_image = kind == OUTPUT_EXR_LAYER || (kind == OUTPUT_FILE && (name_has_extension(pattern, ".npy") || exr_file_is(pattern)));
    bool opaque = options->params.background != MNS_BACKGROUND_TRANSPARENT;
    image.pixel = float_image ? MNS_PIXEL_F32 : MNS_PIXEL_U8;
    if (layer == MNS_LAYER_BEAUTY && !float_image && (opaque || kind == OUTPUT_VIDEO) && kind != OUTPUT_STREAM_RGBA) {
        image.channels = 3;
    }
    outputs->list[outputs->count++] = (struct output){.kind = kind, .pattern = pattern, .layer = layer, .shape = image};
}

static bool is_standard(const char *name) { return name && !strcmp(name, "-"); }

static int plan_stream(struct outputs *outputs, const struct options *options)
{
    const char *format = options->output_format ? options->output_format : "png";
    if (is_standard(options->stats) || is_standard(options->save_look)) {
        return program_usage("-: standard output takes the picture; --stats and --save-look need files");
    }
    if (program_output_is_terminal()) {
        return program_usage("-: a picture is not written to a terminal; redirect standard output");
    }
    enum output_kind kind = !strcmp(format, "y4m") ? OUTPUT_VIDEO : !strcmp(format, "rgba") ? OUTPUT_STREAM_RGBA : OUTPUT_STREAM_PNG;
    int status = kind == OUTPUT_VIDEO ? video_check("-", options, &outputs->encoder) : STATUS_DONE;
    add(outputs, options, MNS_LAYER_BEAUTY, kind, "-");
    return status;
}

static int plan_file(struct outputs *outputs, const struct options *options, const struct inputs *inputs, size_t pictures,
                     enum mns_layer layer, const char *pattern)
{
    int status = check_extension(pattern);
    status = status == STATUS_DONE ? outputs_check_place(pattern, inputs, pictures) : status;
    for (size_t i = 0; status == STATUS_DONE && i < outputs->count; i++) {
        if (!strcmp(outputs->list[i].pattern, pattern)) {
            status = program_usage("%s: is named for two outputs", pattern);
        } else if (outputs->list[i].layer == layer) {
            status = program_usage("layer %s is what -o writes already", mns_layer_name(layer));
        }
    }
    if (status == STATUS_DONE) {
        add(outputs, options, layer, OUTPUT_FILE, pattern);
    }
    return status;
}

/* A layer that goes into the file of the first output. */
static int plan_exr_layer(struct outputs *outputs, const struct options *options, enum mns_layer layer)
{
    if (!options->output || !exr_file_is(options->output)) {
        return program_usage("--layers needs an .exr OUTPUT; --layer NAME=FILE saves a layer by itself");
    }
    if (layer == MNS_LAYER_BEAUTY) {
        return program_usage("layer beauty is what -o writes already");
    }
    add(outputs, options, layer, OUTPUT_EXR_LAYER, options->output);
    return STATUS_DONE;
}

static int plan_video(struct outputs *outputs, const struct options *options, const struct inputs *inputs)
{
    int status = check_overwrite(options->output, inputs);
    status = status == STATUS_DONE ? check_place(options->output, inputs) : status;
    status = status == STATUS_DONE ? video_check(options->output, options, &outputs->encoder) : status;
    add(outputs, options, MNS_LAYER_BEAUTY, OUTPUT_VIDEO, options->output);
    return status;
}

int outputs_plan(struct outputs *outputs, const struct options *options, const struct inputs *inputs, size_t pictures)
{
    *outputs = (struct outputs){.count = 0};
    int status = STATUS_DONE;
    if (!options->output && !options->layer_count) {
        return program_usage("render needs an output: -o OUTPUT or --layer NAME=FILE");
    }
    if (options->output_format && !is_standard(options->output)) {
        return program_usage("--output-format is for standard output: -o -");
    }
    if (is_standard(options->output)) {
        status = plan_stream(outputs, options);
    } else if (options->output && video_is(options->output)) {
        status = plan_video(outputs, options, inputs);
    } else if (options->output) {
        status = plan_file(outputs, options, inputs, pictures, MNS_LAYER_BEAUTY, options->output);
    }
    for (size_t i = 0; status == STATUS_DONE && i < options->layer_count; i++) {
        const struct layer_file *layer = &options->layers[i];
        status = layer->path ? plan_file(outputs, options, inputs, pictures, layer->layer, layer->path)
                             : plan_exr_layer(outputs, options, layer->layer);
    }
    outputs->exr_float = options->exr_float;
    outputs->look = outputs_tell_camera(outputs) ? look_text(&options->params) : NULL;
    return status;
}

int outputs_open(struct outputs *outputs, const struct options *options)
{
    struct mns_message message;
    if (!outputs_in_order(outputs) || outputs->list[0].kind != OUTPUT_VIDEO) {
        return STATUS_DONE;
    }
    outputs->video = video_open(outputs->list[0].pattern, outputs->encoder, options, &message);
    return outputs->video ? STATUS_DONE : program_fail("%s", message.text);
}

int outputs_close(struct outputs *outputs, bool whole)
{
    struct mns_message message = {""};
    bool good = !outputs->video || video_close(outputs->video, whole, &message);
    outputs->video = NULL;
    free(outputs->look);
    outputs->look = NULL;
    if (good && message.text[0]) {
        program_say("%s", message.text);
    }
    return good || !message.text[0] ? STATUS_DONE : program_fail("%s", message.text);
}

bool outputs_in_order(const struct outputs *outputs)
{
    return outputs->count > 0 && outputs->list[0].kind != OUTPUT_FILE; /* a stream or video is the beauty, and so the first */
}

static size_t bytes_of(const struct mns_image *shape)
{
    return (size_t)shape->width * (size_t)shape->height * (size_t)shape->channels * (shape->pixel == MNS_PIXEL_F32 ? 4 : 1);
}

size_t outputs_bytes(const struct outputs *outputs)
{
    size_t bytes = 0;
    for (size_t i = 0; i < outputs->count; i++) {
        bytes += bytes_of(&outputs->list[i].shape);
    }
    return bytes;
}

int outputs_images(const struct outputs *outputs, struct mns_output images[OUTPUT_MAX])
{
    for (size_t i = 0; i < outputs->count; i++) {
        const struct output *output = &outputs->list[i];
        images[i] = (struct mns_output){.layer = output->layer, .image = output->shape};
        images[i].image.data = malloc(bytes_of(&output->shape));
        if (!images[i].image.data) {
            return program_fail("%s: out of memory for %dx%d pixels", output->pattern, output->shape.width, output->shape.height);
        }
    }
    return STATUS_DONE;
}

void outputs_free_images(const struct outputs *outputs, struct mns_output images[OUTPUT_MAX])
{
    for (size_t i = 0; i < outputs->count; i++) {
        free(images[i].image.data);
        images[i].image.data = NULL;
    }
}

bool outputs_exist(const struct outputs *outputs, long long number)
{
    for (size_t i = 0; i < outputs->count; i++) {
        const struct output *output = &outputs->list[i];
        char *name = pattern_name(output->pattern, number);
        bool exists = name && (output->kind == OUTPUT_FILE    ? whole_picture(name, &output->shape)
                               : output->kind == OUTPUT_VIDEO ? whole_file(name)
                                                              : output->kind == OUTPUT_EXR_LAYER);
        free(name);
        if (!exists) {
            return false;
        }
    }
    return true;
}

static bool write_stream(const struct output *output, const struct mns_image *image, struct mns_message *message)
{
    void *data = image->data;
    size_t size = (size_t)image->width * (size_t)image->height * (size_t)image->channels;
    struct mns_message why;
    bool encode = output->kind == OUTPUT_STREAM_PNG;
    if (encode && mns_image_encode("png", image, &data, &size, &why) != MNS_OK) {
        snprintf(message->text, sizeof(message->text), "standard output: %.900s", why.text);
        return false;
    }
    int error = program_output(data, size);
    if (error) {
        snprintf(message->text, sizeof(message->text), "standard output: cannot be written: %s", strerror(error));
    }
    if (encode) {
        mns_memory_free(data);
    }
    return !error;
}

static bool write_file(const struct outputs *outputs, size_t index, const struct mns_output images[OUTPUT_MAX], long long number,
                       const struct mns_camera *camera, struct mns_message *message)
{
    const struct output *output = &outputs->list[index];
    char *name = pattern_name(output->pattern, number);
    if (!name) {
        snprintf(message->text, sizeof(message->text), "%s: out of memory", output->pattern);
        return false;
    }
    bool good = exr_file_is(name) ? exr_file_write(name, outputs, index, images, camera, message)
                                  : mns_image_write(name, &images[index].image, message) == MNS_OK;
    free(name);
    return good;
}

bool outputs_tell_camera(const struct outputs *outputs)
{
    for (size_t i = 0; i < outputs->count; i++) {
        if (outputs->list[i].kind == OUTPUT_FILE && exr_file_is(outputs->list[i].pattern)) {
            return true;
        }
    }
    return false;
}

bool outputs_write(const struct outputs *outputs, const struct mns_output images[OUTPUT_MAX], long long number,
                   const struct mns_camera *camera, struct mns_message *message)
{
    bool good = true;
    for (size_t i = 0; good && i < outputs->count; i++) {
        const struct output *output = &outputs->list[i];
        const struct mns_image *image = &images[i].image;
        good = output->kind == OUTPUT_EXR_LAYER ? true /* written with the first */
               : output->kind == OUTPUT_FILE    ? write_file(outputs, i, images, number, camera, message)
               : output->kind == OUTPUT_VIDEO   ? video_add(outputs->video, image, message)
                                                : write_stream(output, image, message);
    }
    return good;
}
