/* spline.h: cubic smoothing splines along rows and columns: what they solve, and their kernels.
 *
 * Based on: [Rei67] Reinsch, "Smoothing by Spline Functions", 1967; [WA83] Wecker, Ansley, "The Signal Extraction Approach to Nonlinear Regression
 * and Spline Smoothing", 1983.
 *
 * A line's values v become the u that minimise sum (u_i - v_i)^2 + sum s_i^4 (u_(i-1) - 2 u_i + u_(i+1))^2, where s is sigma in pixels at the pixel's
 * own depth. A wave of k radians per pixel keeps 1 / (1 + (s k)^4) of its height: long waves nearly all, particles nearly nothing. No straight line
 * is changed, however far its end is: where pixels are apart, and at the picture's edge, the second differences that would reach across are left out
 * of the sum (natural ends). In perspective v is R / depth, in which every plane is straight; in a parallel view it is -depth / R.
 *
 * Solved as a random walk of the slope: value and slope are the state, 1 / s^4 is the variance that the slope gains in each pixel, 1 that of a sample. The
 * Kalman filter goes forwards, the fixed-interval smoother of Bryson and Frazier back. The band matrix of the sum has the condition 16 s^4, which
 * float loses from s = 15 on; here every variance is a sum of positive terms, their determinant among them, and s may be anything. The
 * cost of a pixel does not depend on s.
 *
 * The rim of what is nearer is bent: its slope past the last pixel is expected to be SPLINE_BEND * mu / s per pixel away from the eye, with the
 * variance SPLINE_BEND / s^3. That is so wide that it acts as a moment, whatever the surface's own slope: the last pixel comes to lie 0.88 mu
 * farther. */
#ifndef MNS_CPU_SMOOTH_SPLINE_H
#define MNS_CPU_SMOOTH_SPLINE_H

#include "cpu/plane.h"

#include <stdbool.h>

struct spline {
    bool orthographic;
    float radius;   /* R, metres */
    float width[2]; /* s over v, or s, by axis */
    float apart;    /* R: neighbours whose depths differ by more are apart */
    float slant[2]; /* ... but not where a surface is no steeper than shading holds together (SHADE_SLOPE_MAX): over v, or itself */
    float mu;       /* R */
};

/* v of what is no fluid: farther than all fluid (empty), or nearer (outside the picture). Fluid is where |v| < SPLINE_FLUID. */
#define SPLINE_EMPTY   (-1e33f)
#define SPLINE_OUTSIDE 1e33f
#define SPLINE_FLUID   1e32f

/* |v| of fluid is held between these, so that no product of two overflows. */
#define SPLINE_LEAST 1e-20f
#define SPLINE_MOST  1e9f

/* s is at least and at most this, pixels. At the least a pixel keeps what it was. */
#define SPLINE_NARROW 0.01f
#define SPLINE_WIDE   10000.0f

#define SPLINE_BEND 20.0f

/* A hole in the fluid that is this part of s wide in a line, at most, does not part it: else each pixel that opens between particles would
 * leave a streak as long as s. */
#define SPLINE_HOLE 0.4f

/* The slope's variance at a natural end, where it is not known. */
#define SPLINE_NATURAL 1e6f

/* A pixel's result is at most this times its v, and at least v over this: where a spline swings, fluid stays before the eye. */
#define SPLINE_SWING 2.0f

/* Lines lie side by side (lines.h). Tolerance against plain C: 1e-6 of v (its own rounding, gathered over some pixels) plus 1e-5 of the range of v
 * in the line and of what mu is in v (gains from reciprocals of 3e-7). A difference within rounding of the one that sets pixels apart may fall on its other side. */
struct spline_kernels {
    /* Depths to v, count of them, a multiple of 16, in place. */
    void (*enter)(const struct spline *spline, float *values, int count);

    /* LINES lines of count pixels: pixel i of line l at v[i * stride + l], a multiple of 16, 64-byte aligned. Empty pixels between two
     * that belong together get values on the straight line between these. */
    void (*fill)(const struct spline *spline, int axis, float *v, ptrdiff_t stride, int count);

    /* The splines of such lines, in place. before, after: what stands beyond the ends, SPLINE_EMPTY or SPLINE_OUTSIDE. scratch: 3 * count * LINES
     * floats, 64-byte aligned. */
    void (*solve)(const struct spline *spline, int axis, float *v, ptrdiff_t stride, int count, float before, float after, float *scratch);

    /* A block of v to depths, in place; what is no fluid in raw is copied from there. Returns the range. */
    struct depth_range (*leave)(const struct spline *spline, const float *raw, float *v, ptrdiff_t stride);
};

extern const struct spline_kernels mns_spline_kernels_scalar, mns_spline_kernels_sse2, mns_spline_kernels_avx2, mns_spline_kernels_avx512,
    mns_spline_kernels_neon;

#endif
