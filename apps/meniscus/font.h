/* font.h: text in pictures: a font of strokes, drawn at any size. */
#ifndef MENISCUS_FONT_H
#define MENISCUS_FONT_H

#include <meniscus/common.h>

/* Lays a colour (sRGB codes, 0 to 1) over a pixel, as much of it as cover says; what lies outside the image is left out. F32 images are linear,
 * alpha is straight. */
void font_blend(const struct mns_image *image, int x, int y, const float srgb[3], float cover);

/* Pixels from the text's first stroke to its last, where capitals are `height` pixels high. */
float font_width(const char *text, float height);

/* Draws ASCII text from x on, whose capitals stand from baseline - height to baseline. Other bytes are boxes. Returns false: out of memory. */
int font_draw(const struct mns_image *image, const char *text, float x, float baseline, float height, const float srgb[3]);

#endif
