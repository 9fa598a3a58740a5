/* pixels.c: rows of the caller's images, and the sRGB curve. */
#include "cpu/pixels.h"

#include <math.h>

static const size_t channel_size[] = {[MNS_PIXEL_F32] = 4, [MNS_PIXEL_U8] = 1, [MNS_PIXEL_U16] = 2};

void *mns_pixels_row(const struct mns_image *image, int y)
{
    size_t stride = image->stride ? image->stride : (size_t)image->width * (size_t)image->channels * channel_size[image->pixel];
    return (char *)image->data + stride * (size_t)y;
}

static float linear_from_srgb(double code) { return (float)(code <= 0.04045 ? code / 12.92 : pow((code + 0.055) / 1.055, 2.4)); }

void mns_srgb_decoder_init(struct srgb_decoder *decoder, enum mns_pixel pixel)
{
    int steps = pixel == MNS_PIXEL_U8 ? 255 : pixel == MNS_PIXEL_U16 ? SRGB_STEPS : -1;
    for (int i = 0; i <= steps; i++) {
        decoder->linear[i] = linear_from_srgb((double)i / steps);
    }
}

/* What is not finite counts as 0. Colours are still multiplied, by 2^20 at the highest exposure, and must not become infinite then. */
static float decode_float(float value)
{
    static const float COLOR_MAX = 1e15f;
    return isfinite(value) ? fmaxf(fminf(value, COLOR_MAX), -COLOR_MAX) : 0;
}

static float decode_16(const struct srgb_decoder *decoder, uint16_t code)
{
    float at = (float)code * ((float)SRGB_STEPS / 65535);
    int i = (int)at < SRGB_STEPS ? (int)at : SRGB_STEPS - 1;
    return decoder->linear[i] + (at - (float)i) * (decoder->linear[i + 1] - decoder->linear[i]);
}

void mns_pixels_decode(const struct srgb_decoder *decoder, const struct mns_image *image, int y, float *out)
{
    const void *row = mns_pixels_row(image, y);
    for (int x = 0; x < image->width; x++) {
        for (int c = 0; c < 3; c++) {
            size_t at = (size_t)x * (size_t)image->channels + (size_t)c;
            switch (image->pixel) {
            case MNS_PIXEL_U8: out[4 * x + c] = decoder->linear[((const uint8_t *)row)[at]]; break;
            case MNS_PIXEL_U16: out[4 * x + c] = decode_16(decoder, ((const uint16_t *)row)[at]); break;
            case MNS_PIXEL_F32: out[4 * x + c] = decode_float(((const float *)row)[at]); break;
            }
        }
        out[4 * x + 3] = 1;
    }
}

void *mns_pixels_at(const struct mns_image *image, int x, int y)
{
    size_t size = image->pixel == MNS_PIXEL_F32 ? 4 : image->pixel == MNS_PIXEL_U16 ? 2 : 1;
    return (char *)mns_pixels_row(image, y) + size * (size_t)image->channels * (size_t)x;
}
