/* narrow_range.h: the kernels of the narrow-range filter. */
#ifndef MNS_CPU_SMOOTH_NARROW_RANGE_H
#define MNS_CPU_SMOOTH_NARROW_RANGE_H

#include "cpu/smooth/window.h"

/* What lies within 1e-6 (depth + mu) of the eye's plane counts as outside for its neighbours.
 *
 * In the blocks that the _plain ones are for (window.h) no tap is dropped or clamped: eq. 1 is a Gaussian.
 *
 * Tolerance against plain C, for one pass on equal input: 4e-7 of the depth (its own rounding) plus 1e-4 of the range of the taps that
 * count (weights are stepped from tap to tap, or expanded about the block's middle sigma). A sample within rounding of a bound may fall
 * on its other side: less than one pixel in 10000. */
struct narrow_range_kernels {
    window_function *line, *line_plain;     /* 1-D, bounds of its own on each side */
    window_function *disc, *disc_plain;     /* 2-D, one pair of bounds, ring by ring */
    window_function *square, *square_plain; /* 5x5 */
};

extern const struct narrow_range_kernels mns_narrow_range_kernels_scalar, mns_narrow_range_kernels_sse2, mns_narrow_range_kernels_avx2,
    mns_narrow_range_kernels_avx512, mns_narrow_range_kernels_neon;

#endif
