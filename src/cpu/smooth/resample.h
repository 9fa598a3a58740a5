/* resample.h: smoothing at half or quarter size ([LGS09] 3.5.1): the way down to texels of 2 or 4 pixels and back, and its kernels.
 *
 * All of it is done in flat depth q, which is linear over the picture where the surface is a plane: 1 / depth, in a parallel view the depth.
 *
 * Down: a texel holds the mean of the nearest surface among its pixels. Back: a pixel that depth_raw has fluid at stands on one surface, and
 * only texels of that surface count: each brings its tangent plane, and those that pass within `edge` of the pixel's own raw depth are averaged
 * with the weights of a quadratic B-spline over 3 x 3 texels. So planes come back as they are also where the surface ends, normals are
 * continuous inside, silhouettes are as sharp as in full size, and no depth is ever a mean of two surfaces. (The paper knows the silhouettes in low
 * resolution alone and has to blur them in the shaded colour.) Where no texel counts the raw depth stays. Texels that the
 * picture's edge cuts hold the mean of what is left of them, up to 1.5 pixels from their middle. */
#ifndef MNS_CPU_SMOOTH_RESAMPLE_H
#define MNS_CPU_SMOOTH_RESAMPLE_H

#include <stdbool.h>
#include <stddef.h>

struct resample {
    int scale; /* pixels per texel along each axis: 2 or 4 */
    bool orthographic;
    float edge;             /* metres: surfaces whose depths differ by more are apart */
    float slant_x, slant_y; /* 1 (parallel: metres): ... times the depth, for the steepest surface from texel to texel */
};

/* Rows of texels: flat depth, 0 where there is no fluid, and its slopes per pixel. Texel 0 at index 0. */
struct texel_row {
    const float *flat, *slope_x, *slope_y;
};

/* Planes have the borders of plane.h; fluid is where 0 < depth < DEPTH_LIMIT. */
struct resample_kernels {
    /* A row of `count` texels from `rows` (1 to scale) rows of `width` pixels. DEPTH_EMPTY where no pixel is fluid. Against plain C: 1e-6 relative, but
     * a pixel within rounding of `edge` may count or not. */
    void (*reduce)(const struct resample *resample, const float *depth, ptrdiff_t stride, int rows, int width, int count, float *out);

    /* Flat depths and slopes of a row of texels. Against plain C: flat 1e-6 relative, slopes 1e-6 of the flat depth; where differences are within rounding of
     * a limit the slope may be another. */
    void (*tangents)(const struct resample *resample, const float *depth, ptrdiff_t stride, int count, float *flat, float *slope_x,
                     float *slope_y);

    /* Row of `count` pixels, of which the first is the first of texel 0; pixel row `row` (0 to scale - 1) of the texels rows[1]. raw: their own depths. Against
     * plain C: 2e-6 relative. */
    void (*interpolate)(const struct resample *resample, const struct texel_row rows[3], int row, const float *raw, int count, float *out);
};

extern const struct resample_kernels mns_resample_kernels_scalar, mns_resample_kernels_sse2, mns_resample_kernels_avx2,
    mns_resample_kernels_avx512, mns_resample_kernels_neon;

/* Place of pixel `index` of its texel, from the texel's middle, in pixels. */
static inline float resample_place(int scale, int index) { return (float)index + 0.5f - 0.5f * (float)scale; }

/* Weights of the texels before, at and after a place: the quadratic B-spline. */
static inline void resample_weights(int scale, float place, float out[3])
{
    float u = place / (float)scale;
    out[0] = 0.5f * (0.5f - u) * (0.5f - u);
    out[1] = 0.75f - u * u;
    out[2] = 0.5f * (0.5f + u) * (0.5f + u);
}

#endif
