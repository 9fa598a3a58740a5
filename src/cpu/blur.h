/* blur.h: the kernels of stage blur: a Gaussian of its own width at each texel, and the way back to full size. */
#ifndef MNS_CPU_BLUR_H
#define MNS_CPU_BLUR_H

#include <stdbool.h>
#include <stddef.h>

/* The Gaussian's weights are max(exp(-i^2 / 2 sigma^2) - BLUR_FLOOR, 0): they end at 2.5 sigma, where BLUR_FLOOR is reached, and no tap appears
 * or vanishes with a step as sigma grows. exp(-3.125) */
#define BLUR_FLOOR 0.043936934f

/* The widest: 2.5 of these stay within the planes' border of 128. */
#define BLUR_SIGMA_MAX 50.0f

/* One line of texels. Texel i has before + slope * i texels before it and after - slope * i after it, inside the picture; taps are `step` floats
 * apart (1 and slope 1: along the row; the stride and slope 0: along columns). */
struct blur_line {
    const float *in;
    ptrdiff_t step;
    const float *decay; /* exp(-1 / 2 sigma^2) of each texel; negative: nothing shows there */
    float *out;
    int before, after, slope, count;
};

/* How sigma follows from the depth. */
struct blur_sigma {
    float scale; /* sigma in texels times depth (orthographic: sigma) */
    float least; /* texels */
    bool orthographic;
};

/* All rows may be read and written up to count rounded up to 16. */
struct blur_kernels {
    /* decay of a row of texels. depth: their own, DEPTH_EMPTY where there is none, then the nearest of the eight neighbours counts; where all nine
     * are empty the decay is -1. Rows of depth are `stride` apart and have a border of one texel that holds DEPTH_EMPTY. Against plain C: 4e-6. */
    void (*decay)(const struct blur_sigma *sigma, const float *depth, ptrdiff_t stride, int count, float *decay);

    /* The weighted mean over the taps inside the picture; 0 where decay is negative. Against plain C: 1e-5 of the largest tap (weights by
     * recurrence, with fused products). */
    void (*line)(const struct blur_line *line);

    /* Full-size row from texels of `scale` pixels: bilinear, texel t stands at pixel (t + 0.5) * scale - 0.5. top, bottom: rows of texels; pixels x to
     * x + count - 1, x a multiple of scale; texels from x / scale - 1 on are read. Against plain C: 1e-6 of the largest texel. */
    void (*upsample)(const float *top, const float *bottom, float weight_bottom, int scale, int x, int count, float *out);
};

extern const struct blur_kernels mns_blur_kernels_scalar, mns_blur_kernels_sse2, mns_blur_kernels_avx2, mns_blur_kernels_avx512,
    mns_blur_kernels_neon;

/* The two rows of texels about the middle of pixel row y, and the lower one's weight. Rows -1 and beyond the last repeat the edge. */
static inline float blur_rows_of(int y, int scale, int *top)
{
    int shifted = 2 * y + 1 - scale; /* 2 * scale * (row of texels) */
    int row = shifted >= 0 ? shifted / (2 * scale) : -1;
    *top = row;
    return (float)(shifted - 2 * scale * row) / (float)(2 * scale);
}

#endif
