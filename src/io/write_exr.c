/* write_exr.c: OpenEXR files through OpenEXRCore: scan lines in zlib blocks of 16, one part, linear colours with premultiplied alpha. The file is put
 * together in memory, since its table of blocks stands in front of them. */
#include "core/message.h"
#include "io/atomic_file.h"
#include "io/writer.h"

#include <math.h>
#include <openexr.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { CHANNELS_MAX = 4, LAYERS_MAX = 64, NAME_MAX_SIZE = 200 };

static const float HALF_MOST = 65504; /* the largest half float; what is brighter would become infinite */

struct memory_file {
    uint8_t *data;
    size_t size, capacity;
    char fault[256]; /* what OpenEXR had to say */
};

static int64_t put_at(exr_const_context_t exr, void *user, const void *data, uint64_t size, uint64_t offset,
                      exr_stream_error_func_ptr_t fail)
{
    struct memory_file *file = user;
    uint64_t end = offset + size;
    if (end < offset || end > SIZE_MAX / 2) {
        return -1;
    }
    if (end > file->capacity) {
        size_t capacity = (size_t)end + file->capacity / 2;
        uint8_t *grown = realloc(file->data, capacity);
        if (!grown) {
            fail(exr, EXR_ERR_OUT_OF_MEMORY, "out of memory");
            return -1;
        }
        memset(grown + file->capacity, 0, capacity - file->capacity);
        file->data = grown;
        file->capacity = capacity;
    }
    memcpy(file->data + offset, data, size);
    file->size = end > file->size ? (size_t)end : file->size;
    return (int64_t)size;
}

static void note_fault(exr_const_context_t exr, exr_result_t code, const char *text)
{
    struct memory_file *file = NULL;
    if (exr && exr_get_user_data(exr, (void **)&file) == EXR_ERR_SUCCESS && file) {
        snprintf(file->fault, sizeof(file->fault), "%s", text ? text : exr_get_default_error_message(code));
    }
}

/* ---- what is written ---- */

/* One channel of the file. */
struct channel {
    char name[NAME_MAX_SIZE];
    const float *in; /* of the block's first pixel, once it was prepared */
    int channels;    /* of the image it is from: floats from one pixel to the next */
    bool half;
};

struct picture {
    const struct mns_exr_layer *layers; /* [layer_count], float32 */
    size_t layer_count;
    int width, height;
    struct channel channels[LAYERS_MAX * CHANNELS_MAX];
    size_t channel_count;
    float *rows[LAYERS_MAX]; /* each layer's rows of a block as the file holds them */
    int block_rows;
};

static size_t layer_stride(const struct mns_image *image)
{
    return image->stride ? image->stride : sizeof(float) * (size_t)image->channels * (size_t)image->width;
}

static bool has_alpha(const struct mns_exr_layer *layer) { return !strcmp(layer->channels, "RGBA"); }

static bool is_half(const struct mns_exr_layer *layer, const struct mns_exr_params *params)
{
    return params->half && (layer->channels[0] == 'R' || layer->channels[0] == 'A');
}

static mns_result name_channels(const char *path, struct picture *picture, const struct mns_exr_params *params, struct mns_message *message)
{
    for (size_t i = 0; i < picture->layer_count; i++) {
        const struct mns_exr_layer *layer = &picture->layers[i];
        for (int c = 0; c < layer->image->channels; c++) {
            struct channel *channel = &picture->channels[picture->channel_count++];
            snprintf(channel->name, sizeof(channel->name), "%s%s%c", layer->name, *layer->name ? "." : "", layer->channels[c]);
            channel->channels = layer->image->channels;
            channel->half = is_half(layer, params);
            channel->in = picture->rows[i] + c;
            for (struct channel *other = picture->channels; other < channel; other++) {
                if (!strcmp(other->name, channel->name)) {
                    return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "%s: two layers have a channel '%s'", path, channel->name);
                }
            }
        }
    }
    return MNS_OK;
}

/* The layer's rows from y on, with premultiplied colours that half floats can hold. */
static void prepare_rows(const struct mns_exr_layer *layer, int y, int count, bool half, float *out)
{
    const struct mns_image *image = layer->image;
    size_t values = (size_t)image->width * (size_t)image->channels;
    for (int r = 0; r < count; r++, out += values) {
        memcpy(out, (const uint8_t *)image->data + (size_t)(y + r) * layer_stride(image), values * sizeof(*out));
        for (size_t i = 0; has_alpha(layer) && i < values; i += 4) {
            for (size_t c = 0; c < 3; c++) {
                out[i + c] *= out[i + 3];
            }
        }
        for (size_t i = 0; half && i < values; i++) {
            out[i] = out[i] > HALF_MOST ? HALF_MOST : out[i] < -HALF_MOST ? -HALF_MOST : out[i];
        }
    }
}

static const struct channel *find_channel(const struct picture *picture, const char *name)
{
    size_t i = 0;
    while (i < picture->channel_count && strcmp(picture->channels[i].name, name) != 0) {
        i++;
    }
    return i < picture->channel_count ? &picture->channels[i] : NULL;
}

/* ---- through OpenEXR ---- */

static exr_result_t add_camera(exr_context_t exr, int part, const struct mns_camera *camera)
{
    exr_attr_m44f_t view, both;
    for (int i = 0; i < 16; i++) { /* EXR multiplies row vectors from the left: the transpose, in rows, which is ours, in columns */
        double sum = 0;
        for (int k = 0; k < 4; k++) {
            sum += camera->projection[k * 4 + i % 4] * camera->view[i / 4 * 4 + k];
        }
        view.m[i] = (float)camera->view[i];
        both.m[i] = (float)sum;
    }
    exr_result_t result = exr_attr_set_m44f(exr, part, "worldToCamera", &view);
    return result == EXR_ERR_SUCCESS ? exr_attr_set_m44f(exr, part, "worldToNDC", &both) : result;
}

static exr_result_t write_header(exr_context_t exr, const struct picture *picture, const struct mns_exr_params *params)
{
    int part = 0;
    exr_result_t result = exr_set_longname_support(exr, 1);
    result = result == EXR_ERR_SUCCESS ? exr_add_part(exr, NULL, EXR_STORAGE_SCANLINE, &part) : result;
    if (result == EXR_ERR_SUCCESS) {
        result = exr_initialize_required_attr_simple(exr, part, picture->width, picture->height, EXR_COMPRESSION_ZIP);
    }
    for (size_t i = 0; result == EXR_ERR_SUCCESS && i < picture->channel_count; i++) {
        const struct channel *channel = &picture->channels[i];
        result =
            exr_add_channel(exr, part, channel->name, channel->half ? EXR_PIXEL_HALF : EXR_PIXEL_FLOAT, EXR_PERCEPTUALLY_LOGARITHMIC, 1, 1);
    }
    if (result == EXR_ERR_SUCCESS && params->camera) {
        result = add_camera(exr, part, params->camera);
    }
    for (size_t i = 0; result == EXR_ERR_SUCCESS && i < params->note_count; i++) {
        result = exr_attr_set_string(exr, part, params->notes[i].name, params->notes[i].text);
    }
    return result == EXR_ERR_SUCCESS ? exr_write_header(exr) : result;
}

/* Tells the encoder where the values of its channels are. */
static void point_channels(exr_encode_pipeline_t *encoder, const struct picture *picture)
{
    for (int c = 0; c < encoder->channel_count; c++) {
        exr_coding_channel_info_t *info = &encoder->channels[c];
        const struct channel *channel = find_channel(picture, info->channel_name);
        info->encode_from_ptr = (const uint8_t *)(const void *)channel->in;
        info->user_bytes_per_element = sizeof(float);
        info->user_data_type = EXR_PIXEL_FLOAT;
        info->user_pixel_stride = (int32_t)sizeof(float) * channel->channels;
        info->user_line_stride = info->user_pixel_stride * picture->width;
    }
}

static exr_result_t write_blocks(exr_context_t exr, struct picture *picture, const struct mns_exr_params *params)
{
    exr_encode_pipeline_t encoder = EXR_ENCODE_PIPELINE_INITIALIZER;
    exr_result_t result = EXR_ERR_SUCCESS;
    for (int y = 0; result == EXR_ERR_SUCCESS && y < picture->height; y += picture->block_rows) {
        exr_chunk_info_t block;
        int count = picture->height - y < picture->block_rows ? picture->height - y : picture->block_rows;
        for (size_t i = 0; i < picture->layer_count; i++) {
            prepare_rows(&picture->layers[i], y, count, is_half(&picture->layers[i], params), picture->rows[i]);
        }
        result = exr_write_scanline_chunk_info(exr, 0, y, &block);
        if (result == EXR_ERR_SUCCESS) {
            result = y == 0 ? exr_encoding_initialize(exr, 0, &block, &encoder) : exr_encoding_update(exr, 0, &block, &encoder);
        }
        if (result == EXR_ERR_SUCCESS) {
            point_channels(&encoder, picture);
            result = y == 0 ? exr_encoding_choose_default_routines(exr, 0, &encoder) : EXR_ERR_SUCCESS;
        }
        result = result == EXR_ERR_SUCCESS ? exr_encoding_run(exr, 0, &encoder) : result;
    }
    exr_encoding_destroy(exr, &encoder);
    return result;
}

/* The whole file, in memory. */
static exr_result_t encode(const char *path, struct picture *picture, const struct mns_exr_params *params, struct memory_file *file)
{
    exr_context_initializer_t setup = EXR_DEFAULT_CONTEXT_INITIALIZER;
    exr_context_t exr = NULL;
    setup.user_data = file;
    setup.write_fn = put_at;
    setup.error_handler_fn = note_fault;
    exr_result_t result = exr_start_write(&exr, path, EXR_WRITE_FILE_DIRECTLY, &setup);
    result = result == EXR_ERR_SUCCESS ? write_header(exr, picture, params) : result;
    result = result == EXR_ERR_SUCCESS ? write_blocks(exr, picture, params) : result;
    exr_result_t finished = exr ? exr_finish(&exr) : EXR_ERR_SUCCESS; /* writes the table of blocks */
    return result == EXR_ERR_SUCCESS ? finished : result;
}

static mns_result make(const char *path, struct picture *picture, const struct mns_exr_params *params, struct memory_file *file,
                       struct mns_message *message)
{
    picture->width = picture->layers[0].image->width;
    picture->height = picture->layers[0].image->height;
    picture->block_rows = 16; /* of EXR_COMPRESSION_ZIP */
    mns_result result = MNS_OK;
    for (size_t i = 0; result == MNS_OK && i < picture->layer_count; i++) {
        size_t values = (size_t)picture->width * (size_t)picture->layers[i].image->channels;
        picture->rows[i] = malloc(values * (size_t)picture->block_rows * sizeof(float));
        result = picture->rows[i] ? MNS_OK : mns_fail(message, MNS_ERR_OUT_OF_MEMORY, "%s: out of memory", path);
    }
    result = result == MNS_OK ? name_channels(path, picture, params, message) : result;
    if (result == MNS_OK && encode(path, picture, params, file) != EXR_ERR_SUCCESS) {
        result = mns_fail(message, MNS_ERR_IO, "%s: OpenEXR cannot make it: %s", path, file->fault[0] ? file->fault : "no reason given");
    }
    for (size_t i = 0; i < picture->layer_count; i++) {
        free(picture->rows[i]);
    }
    return result;
}

/* ---- entry ---- */

static mns_result check_layer(const char *path, const struct mns_exr_layer *layer, const struct mns_image *first,
                              struct mns_message *message)
{
    const struct mns_image *image = layer->image;
    if (!layer->name || !layer->channels || !image) {
        return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "%s: a layer has no name, no channels or no image", path);
    }
    mns_result result = mns_image_check(path, image, message);
    if (result != MNS_OK) {
        return result;
    }
    if (image->pixel != MNS_PIXEL_F32 || strlen(layer->channels) != (size_t)image->channels || strlen(layer->name) + 4 > NAME_MAX_SIZE) {
        return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "%s: layer '%.60s' must be float32, with a letter for each of its %d channels",
                        path, layer->name, image->channels);
    }
    if (image->width != first->width || image->height != first->height) {
        return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "%s: layer '%.60s' is %dx%d, the first one %dx%d", path, layer->name,
                        image->width, image->height, first->width, first->height);
    }
    return MNS_OK;
}

mns_result mns_exr_write(const char *path, const struct mns_exr_layer *layers, size_t layer_count, const struct mns_exr_params *params,
                         struct mns_message *message)
{
    struct mns_exr_params known;
    struct memory_file file = {0};
    struct atomic_file *out;
    if (!path || !layers || layer_count < 1 || layer_count > LAYERS_MAX) {
        return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "mns_exr_write: a path and 1 to %d layers are wanted", (int)LAYERS_MAX);
    }
    mns_exr_params_init(&known);
    if (params) {
        memcpy(&known, params, params->struct_size < sizeof(known) ? params->struct_size : sizeof(known));
    }
    for (size_t i = 0; i < layer_count; i++) {
        mns_result result = check_layer(path, &layers[i], layers[0].image, message);
        if (result != MNS_OK) {
            return result;
        }
    }
    struct picture *picture = calloc(1, sizeof(*picture));
    if (!picture) {
        return mns_fail(message, MNS_ERR_OUT_OF_MEMORY, "%s: out of memory", path);
    }
    picture->layers = layers;
    picture->layer_count = layer_count;
    mns_result result = make(path, picture, &known, &file, message);
    result = result == MNS_OK ? mns_atomic_begin(&out, path, message) : result;
    if (result == MNS_OK) {
        mns_atomic_write(out, file.data, file.size);
        result = mns_atomic_commit(out, message);
    }
    free(file.data);
    free(picture);
    return result;
}

static mns_result check_exr(const char *what, const struct mns_image *image, struct mns_message *message)
{
    if (image->pixel != MNS_PIXEL_F32) {
        return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "%s: an .exr image holds float32; .png holds 8 and 16 bits", what);
    }
    return MNS_OK;
}

static mns_result write_exr(const char *what, const struct mns_image *image, size_t stride, struct image_sink *sink,
                            struct mns_message *message)
{
    static const char *const channels[] = {"Y", "YA", "RGB", "RGBA"};
    const struct mns_image copy = {image->data, stride, image->width, image->height, image->channels, image->pixel};
    const struct mns_exr_layer layer = {"", channels[image->channels - 1], &copy};
    struct mns_exr_params params;
    struct memory_file file = {0};
    struct picture *picture = calloc(1, sizeof(*picture));
    if (!picture) {
        return mns_fail(message, MNS_ERR_OUT_OF_MEMORY, "%s: out of memory", what);
    }
    mns_exr_params_init(&params);
    picture->layers = &layer;
    picture->layer_count = 1;
    mns_result result = make(what, picture, &params, &file, message);
    if (result == MNS_OK && !sink->put(sink->user, file.data, file.size)) {
        result = MNS_ERR_IO;
    }
    free(file.data);
    free(picture);
    return result;
}

const struct mns_writer mns_writer_exr = {.name = "exr", .check = check_exr, .write = write_exr};
