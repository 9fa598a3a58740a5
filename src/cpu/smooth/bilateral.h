/* bilateral.h: the kernels of the bilateral filter. */
#ifndef MNS_CPU_SMOOTH_BILATERAL_H
#define MNS_CPU_SMOOTH_BILATERAL_H

#include "cpu/smooth/window.h"

/* A tap's weight is that of its place, a Gaussian of sigma pixels, times that of its depth relative to the pixel's, a Gaussian (window.h: RANGE_FALL). An empty tap is infinitely far; outside the picture the pair is dropped.
 *
 * In the blocks that the _plain ones are for (window.h) every tap counts. Tolerance against plain C, for one pass on equal input: 4e-7 of the
 * depth plus 1e-5 of delta: the range weight of the vector kernels is a polynomial within 6e-6 of itself, which moves a mean by that part
 * of the samples' spread, and weights of places are stepped from tap to tap. */
struct bilateral_kernels {
    window_function *line, *line_plain; /* 1-D */
    window_function *disc, *disc_plain; /* 2-D */
};

extern const struct bilateral_kernels mns_bilateral_kernels_scalar, mns_bilateral_kernels_sse2, mns_bilateral_kernels_avx2,
    mns_bilateral_kernels_avx512, mns_bilateral_kernels_neon;

#endif
