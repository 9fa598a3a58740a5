/* gaussian.h: the kernel of the Gaussian filter. */
#ifndef MNS_CPU_SMOOTH_GAUSSIAN_H
#define MNS_CPU_SMOOTH_GAUSSIAN_H

#include "cpu/smooth/window.h"

/* The mean of the fluid taps of a line, however far apart their depths. Empty taps do not count; outside the picture the pair is dropped.
 * Where no tap is empty or outside it is the narrow-range filter's line_plain, which serves here too.
 *
 * Tolerance against plain C, for one pass on equal input: 4e-7 of the depth plus 1e-5 of the range of the taps, by which weights that are
 * stepped from tap to tap may be off. */
struct gaussian_kernels {
    window_function *line;
};

/* Part of a weight that is summed: with it no sum of 2 * PLANE_BORDER depths below DEPTH_LIMIT overflows. A power of two, which changes no digit. */
#define GAUSSIAN_PART 0.0625f

extern const struct gaussian_kernels mns_gaussian_kernels_scalar, mns_gaussian_kernels_sse2, mns_gaussian_kernels_avx2,
    mns_gaussian_kernels_avx512, mns_gaussian_kernels_neon;

#endif
