/* write_png.c: PNG with 8 or 16 bits per channel, marked as sRGB (libspng). */
#include "io/writer.h"

#include "core/message.h"

#include <spng.h>

/* zlib level 1 after the SUB filter: several times faster than the defaults, for files that are a few percent larger. Z_RLE, which looks for
 * runs alone, is faster still, and on our pictures no larger. */
enum { LEVEL = 1, STRATEGY_RLE = 3 };

static mns_result check_png(const char *what, const struct mns_image *image, struct mns_message *message)
{
    if (image->pixel == MNS_PIXEL_F32) {
        return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "%s: a PNG holds 8 or 16 bits per channel, not float32; .npy does", what);
    }
    return MNS_OK;
}

/* What libspng writes to. Its own error after a failed write may be another one than SPNG_IO_ERROR. */
struct stream {
    struct image_sink *sink;
    bool failed;
};

static int put(spng_ctx *png, void *user, void *data, size_t size)
{
    struct stream *stream = user;
    (void)png;
    stream->failed = stream->failed || !stream->sink->put(stream->sink->user, data, size);
    return stream->failed ? SPNG_IO_ERROR : 0;
}

static int set_up(spng_ctx *png, const struct mns_image *image, struct stream *stream)
{
    static const uint8_t color_types[] = {SPNG_COLOR_TYPE_GRAYSCALE, SPNG_COLOR_TYPE_GRAYSCALE_ALPHA, SPNG_COLOR_TYPE_TRUECOLOR,
                                          SPNG_COLOR_TYPE_TRUECOLOR_ALPHA};
    struct spng_ihdr header = {.width = (uint32_t)image->width,
                               .height = (uint32_t)image->height,
                               .bit_depth = image->pixel == MNS_PIXEL_U16 ? 16 : 8,
                               .color_type = color_types[image->channels - 1]};
    int error = spng_set_png_stream(png, put, stream);
    error = error ? error : spng_set_option(png, SPNG_IMG_COMPRESSION_LEVEL, LEVEL);
    error = error ? error : spng_set_option(png, SPNG_IMG_COMPRESSION_STRATEGY, STRATEGY_RLE);
    error = error ? error : spng_set_option(png, SPNG_FILTER_CHOICE, SPNG_FILTER_CHOICE_SUB);
    error = error ? error : spng_set_ihdr(png, &header);
    return error ? error : spng_set_srgb(png, 0); /* 0: perceptual intent */
}

static int encode(spng_ctx *png, const struct mns_image *image, size_t stride)
{
    const uint8_t *row = image->data;
    size_t row_size = mns_image_pixel_size(image) * (size_t)image->width;
    int error = spng_encode_image(png, NULL, 0, SPNG_FMT_PNG, SPNG_ENCODE_PROGRESSIVE | SPNG_ENCODE_FINALIZE);
    for (int y = 0; !error && y < image->height; y++, row += stride) {
        error = spng_encode_row(png, row, row_size);
        if (error == SPNG_EOI) { /* the last row says so */
            error = y == image->height - 1 ? 0 : error;
        }
    }
    return error;
}

static mns_result write_png(const char *what, const struct mns_image *image, size_t stride, struct image_sink *sink,
                            struct mns_message *message)
{
    spng_ctx *png = spng_ctx_new(SPNG_CTX_ENCODER);
    if (!png) {
        return mns_fail(message, MNS_ERR_OUT_OF_MEMORY, "%s: out of memory", what);
    }
    struct stream stream = {.sink = sink};
    int error = set_up(png, image, &stream);
    error = error ? error : encode(png, image, stride);
    spng_ctx_free(png);
    if (stream.failed) {
        return MNS_ERR_IO;
    }
    if (error == SPNG_EMEM) {
        return mns_fail(message, MNS_ERR_OUT_OF_MEMORY, "%s: out of memory", what);
    }
    return error ? mns_fail(message, MNS_ERR_UNSUPPORTED, "%s: cannot be written as PNG: %s", what, spng_strerror(error)) : MNS_OK;
}

const struct mns_writer mns_writer_png = {.name = "png", .check = check_png, .write = write_png};
