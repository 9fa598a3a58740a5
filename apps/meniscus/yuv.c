/* yuv.c: pictures as video stores them. BT.709: Y' = 0.2126 R' + 0.7152 G' + 0.0722 B', Cb = (B' - Y') / 1.8556, Cr = (R' - Y') / 1.5748; Y' takes
 * 16 to 235, Cb and Cr 16 to 240. */
#include "yuv.h"

#include <string.h>

/* The matrix over 255 times 2^16, rounded so that grey has exactly Cb = Cr = 128 and white Y' = 235. */
enum {
    BITS = 16,
    YR = 11966,
    YG = 40254,
    YB = 4064,
    UR = -6596,
    UG = -22189,
    UB = 28785,
    VR = 28784,
    VG = -26145,
    VB = -2639,
};

size_t yuv_bytes(int width, int height)
{
    size_t chroma = ((size_t)width + 1) / 2 * (((size_t)height + 1) / 2);
    return (size_t)width * (size_t)height + 2 * chroma;
}

static const uint8_t *row_of(const struct mns_image *rgb, int y)
{
    size_t stride = rgb->stride ? rgb->stride : 3 * (size_t)rgb->width;
    return (const uint8_t *)rgb->data + (size_t)(y < rgb->height ? y : rgb->height - 1) * stride;
}

static void luma_row(const uint8_t *rgb, int count, int width, uint8_t *out)
{
    for (int x = 0; x < count; x++) {
        int r = rgb[3 * x], g = rgb[3 * x + 1], b = rgb[3 * x + 2];
        out[x] = (uint8_t)((YR * r + YG * g + YB * b + (16 << BITS) + (1 << (BITS - 1))) >> BITS);
    }
    memset(out + count, out[count - 1], (size_t)(width - count));
}

/* Weights 1 2 1 across, 1 1 down, so that sum is 8 times a colour. */
static inline void chroma_sample(const uint8_t *above, const uint8_t *below, int left, int x, int right, uint8_t *u, uint8_t *v)
{
    int sum[3];
    for (int c = 0; c < 3; c++) {
        sum[c] = above[3 * left + c] + 2 * above[3 * x + c] + above[3 * right + c] + below[3 * left + c] + 2 * below[3 * x + c] +
                 below[3 * right + c];
    }
    const int bias = (128 << (BITS + 3)) + (1 << (BITS + 2));
    *u = (uint8_t)((UR * sum[0] + UG * sum[1] + UB * sum[2] + bias) >> (BITS + 3));
    *v = (uint8_t)((VR * sum[0] + VG * sum[1] + VB * sum[2] + bias) >> (BITS + 3));
}

static void chroma_row(const uint8_t *above, const uint8_t *below, int count, int width, uint8_t *u, uint8_t *v)
{
    int inner = (count - 1) / 2; /* [1, inner) has both neighbours */
    for (int i = 1; i < inner; i++) {
        chroma_sample(above, below, 2 * i - 1, 2 * i, 2 * i + 1, &u[i], &v[i]);
    }
    for (int i = 0; i < width; i = i == 0 && inner > 1 ? inner : i + 1) { /* the edges, and what is beyond them */
        int x = 2 * i < count ? 2 * i : count - 1;
        chroma_sample(above, below, x > 0 ? x - 1 : 0, x, x + 1 < count ? x + 1 : x, &u[i], &v[i]);
    }
}

void yuv_from_rgb(const struct mns_image *rgb, int width, int height, uint8_t *planes)
{
    size_t chroma_width = ((size_t)width + 1) / 2, chroma_height = ((size_t)height + 1) / 2;
    uint8_t *u = planes + (size_t)width * (size_t)height, *v = u + chroma_width * chroma_height;
    for (int y = 0; y < height; y++) {
        luma_row(row_of(rgb, y), rgb->width, width, planes + (size_t)y * (size_t)width);
    }
    for (size_t y = 0; y < chroma_height; y++) {
        chroma_row(row_of(rgb, (int)(2 * y)), row_of(rgb, (int)(2 * y + 1)), rgb->width, (int)chroma_width, u + y * chroma_width,
                   v + y * chroma_width);
    }
}
