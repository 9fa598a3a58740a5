/* yuv.h: pictures as video stores them: 8-bit Y'CbCr 4:2:0 of BT.709 in the limited range. */
#ifndef MENISCUS_YUV_H
#define MENISCUS_YUV_H

#include <meniscus/common.h>

/* Bytes of the three planes of a width x height picture: Y' [height][width], then Cb and Cr [(height + 1) / 2][(width + 1) / 2]. */
size_t yuv_bytes(int width, int height);

/* Fills the planes from an sRGB picture of 3 channels U8, whose gamma is kept. width, height: of the planes, at least the picture's; what is
 * beyond its edges repeats them. Chroma stands on the left luma column of its two, between the two rows, as H.264 and MPEG-2 have it. */
void yuv_from_rgb(const struct mns_image *rgb, int width, int height, uint8_t *planes);

#endif
