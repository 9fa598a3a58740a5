/* environment_exr.c: pictures of light in OpenEXR files: scan lines with the channels R, G, B, or Y alone. */
#include "scene/environment.h"

#include "core/message.h"

#include <openexr.h>

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double PIXELS_MAX = 1 << 26;

struct exr {
    exr_context_t context;
    exr_attr_box2i_t window;
    int width, height;
    float *pixels; /* [height][width][3] */
};

/* What went wrong is told by result codes; OpenEXRCore would print it. */
static void be_silent(exr_const_context_t context, exr_result_t code, const char *text)
{
    (void)context;
    (void)code;
    (void)text;
}

static exr_result_t open_file(struct exr *exr, const char *path)
{
    exr_context_initializer_t settings = EXR_DEFAULT_CONTEXT_INITIALIZER;
    exr_storage_t storage = EXR_STORAGE_TILED;
    settings.error_handler_fn = be_silent;
    exr_result_t code = exr_start_read(&exr->context, path, &settings);
    code = code == EXR_ERR_SUCCESS ? exr_get_storage(exr->context, 0, &storage) : code;
    code = code == EXR_ERR_SUCCESS && storage != EXR_STORAGE_SCANLINE ? EXR_ERR_SCAN_TILE_MIXEDAPI : code;
    code = code == EXR_ERR_SUCCESS ? exr_get_data_window(exr->context, 0, &exr->window) : code;
    if (code == EXR_ERR_SUCCESS) {
        double width = (double)exr->window.max.x - exr->window.min.x + 1, height = (double)exr->window.max.y - exr->window.min.y + 1;
        bool fits = width >= 1 && height >= 1 && width * height <= PIXELS_MAX;
        exr->width = fits ? (int)width : 0;
        exr->height = fits ? (int)height : 0;
        code = fits ? code : EXR_ERR_INVALID_ATTR;
    }
    return code;
}

/* Where a channel's values go: 0 to 2, or -1: nowhere. */
static int place_of(const char *name)
{
    return !strcmp(name, "R") || !strcmp(name, "Y") ? 0 : !strcmp(name, "G") ? 1 : !strcmp(name, "B") ? 2 : -1;
}

/* Lets the decoder write a block of lines, which begins at row y. Returns how many channels it found. */
static int aim(const struct exr *exr, exr_decode_pipeline_t *decoder, int y)
{
    int found = 0;
    for (int i = 0; i < decoder->channel_count; i++) {
        exr_coding_channel_info_t *channel = &decoder->channels[i];
        int place = place_of(channel->channel_name);
        bool wanted = place >= 0 && channel->width == exr->width;
        channel->decode_to_ptr = wanted ? (uint8_t *)(exr->pixels + 3 * ((size_t)y * (size_t)exr->width) + place) : NULL;
        channel->user_bytes_per_element = sizeof(float);
        channel->user_data_type = EXR_PIXEL_FLOAT;
        channel->user_pixel_stride = 3 * sizeof(float);
        channel->user_line_stride = 3 * (int32_t)sizeof(float) * exr->width;
        found += wanted;
    }
    return found;
}

static exr_result_t read_lines(struct exr *exr, int *channels)
{
    exr_decode_pipeline_t decoder = EXR_DECODE_PIPELINE_INITIALIZER;
    int32_t lines = 1;
    bool begun = false;
    exr_result_t code = exr_get_scanlines_per_chunk(exr->context, 0, &lines);
    for (int y = 0; code == EXR_ERR_SUCCESS && y < exr->height; y += lines) {
        exr_chunk_info_t chunk;
        code = exr_read_scanline_chunk_info(exr->context, 0, exr->window.min.y + y, &chunk);
        if (code == EXR_ERR_SUCCESS) {
            code =
                begun ? exr_decoding_update(exr->context, 0, &chunk, &decoder) : exr_decoding_initialize(exr->context, 0, &chunk, &decoder);
        }
        if (code == EXR_ERR_SUCCESS) {
            *channels = aim(exr, &decoder, y);
            code = begun ? code : exr_decoding_choose_default_routines(exr->context, 0, &decoder);
            begun = true;
        }
        code = code == EXR_ERR_SUCCESS ? exr_decoding_run(exr->context, 0, &decoder) : code;
    }
    exr_decoding_destroy(exr->context, &decoder);
    return code;
}

mns_result mns_light_read_exr(struct mns_image *out, const char *path, struct mns_message *message)
{
    struct exr exr = {.context = NULL};
    int channels = 0;
    *out = (struct mns_image){.data = NULL};
    exr_result_t code = open_file(&exr, path);
    if (code == EXR_ERR_SUCCESS) {
        exr.pixels = calloc(3 * (size_t)exr.width * (size_t)exr.height, sizeof(float));
        code = exr.pixels ? read_lines(&exr, &channels) : EXR_ERR_OUT_OF_MEMORY;
    }
    if (exr.context) {
        exr_finish(&exr.context);
    }
    if (code != EXR_ERR_SUCCESS || channels == 0) {
        free(exr.pixels);
        const char *why = code == EXR_ERR_SUCCESS ? "it has no channels R, G, B or Y" : exr_get_default_error_message(code);
        return mns_fail(message, code == EXR_ERR_FILE_ACCESS ? MNS_ERR_IO : MNS_ERR_BAD_DATA, "%s: cannot be read: %s", path, why);
    }
    for (size_t i = 0; channels == 1 && i < (size_t)exr.width * (size_t)exr.height; i++) {
        exr.pixels[3 * i + 1] = exr.pixels[3 * i + 2] = exr.pixels[3 * i];
    }
    *out = (struct mns_image){.data = exr.pixels, .width = exr.width, .height = exr.height, .channels = 3, .pixel = MNS_PIXEL_F32};
    return MNS_OK;
}
