/* pixels.h: the caller's images: rows, and colours decoded to linear. Encoding is a kernel of stage shade. */
#ifndef MNS_CPU_PIXELS_H
#define MNS_CPU_PIXELS_H

#include <meniscus/common.h>

/* How a colour kernel treats its values. */
enum pixel_meaning {
    PIXEL_COLOR, /* linear light: sRGB in integers */
    PIXEL_CODE   /* a diagram's value, shown as it is */
};

enum { SRGB_STEPS = 1024 };

/* The sRGB curve at SRGB_STEPS + 1 codes from 0 to 1. */
struct srgb_decoder {
    float linear[SRGB_STEPS + 1];
};

/* For 8-bit images the first 256 entries are the codes' own values; for 16-bit ones the table is interpolated, within 4e-7. */
void mns_srgb_decoder_init(struct srgb_decoder *decoder, enum mns_pixel pixel);

/* One row of an image with 3 or 4 channels as linear colours; out: [width][4], the fourth 1. What is not finite becomes 0, what is beyond +-1e15 that. */
void mns_pixels_decode(const struct srgb_decoder *decoder, const struct mns_image *image, int y, float *out);

/* The first byte of row y. */
void *mns_pixels_row(const struct mns_image *image, int y);

/* The pixel at (x, y). */
void *mns_pixels_at(const struct mns_image *image, int x, int y);

#endif
