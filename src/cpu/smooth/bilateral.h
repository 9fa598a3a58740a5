/* bilateral.h: the kernels of the bilateral filter. */
#ifndef MNS_CPU_SMOOTH_BILATERAL_H
#define MNS_CPU_SMOOTH_BILATERAL_H

#include "cpu/smooth/window.h"

/* A tap's weight is that of its place, a Gaussian of sigma pixels, times that of its depth relative to the pixel's, a Gaussian with
 * sigma_z = delta / 3: exp(-RANGE_FALL t^2) - RANGE_END with t = (its depth - the pixel's) / delta, 0 from |t| = 1 on, so that no sample comes
 * or goes with a step. An empty tap is infinitely far; outside the picture the pair is dropped.
 *
 * In the blocks that the _plain ones are for (window.h) every tap counts. Tolerance against plain C, for one pass on equal input: 4e-7 of the
 * depth plus 1e-5 of delta: the range weight of the vector kernels is a polynomial within 6e-6 of itself, which moves a mean by that part
 * of the samples' spread, and weights of places are stepped from tap to tap. */
struct bilateral_kernels {
    window_function *line, *line_plain; /* 1-D */
    window_function *disc, *disc_plain; /* 2-D */
};

#define RANGE_FALL 4.5f         /* 1 / (2 (1/3)^2) */
#define RANGE_END  0.011108997f /* exp(-RANGE_FALL) */

extern const struct bilateral_kernels mns_bilateral_kernels_scalar, mns_bilateral_kernels_sse2, mns_bilateral_kernels_avx2,
    mns_bilateral_kernels_avx512, mns_bilateral_kernels_neon;

#endif
