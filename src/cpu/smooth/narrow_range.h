/* narrow_range.h: the kernels of the narrow-range filter, and the filter in metres and pixels. */
#ifndef MNS_CPU_SMOOTH_NARROW_RANGE_H
#define MNS_CPU_SMOOTH_NARROW_RANGE_H

#include "cpu/plane.h"

#include <stdbool.h>

/* The axis along which a line of taps lies, or whose pixels measure a kernel. */
enum { AXIS_X, AXIS_Y };

/* [TY18]'s filter with its lengths resolved. Depth d is positive here where the paper's z is negative, d = -z: nearer is smaller, so
 * the paper's "z_j > z_i + delta" (too near) reads d_j < d_i - delta, its "z_j < z_i - delta" (too far) d_j > d_i + delta, and what is
 * too far counts as d_i + mu. */
struct narrow_range {
    float delta, mu;  /* metres */
    float grow;       /* eq. 8, 9: delta; -RANGE_FIXED without dynamic range, with which the same arithmetic never widens a bound */
    float cut;        /* sigmas */
    float weight_cut; /* exp(-cut^2 / 2), subtracted from every weight so that taps come and go at weight 0 */
    float sigma_max;  /* pixels: with it the kernel just stays inside a plane's border */
    struct {
        float slope, offset; /* 1 / sigma = slope * depth + offset, 1/pixels; one of the two is 0 */
    } inverse[2];            /* by axis */
    float square[3][3];      /* weights of the 5x5 kernel: [|dy|][|dx|] */
    bool bias_correction;    /* eq. 6 in place of eq. 3 */
    bool at_lens;            /* some depth may be less than delta, so that the border's 0 needs telling from a sample in range */
};

/* Farther than any depth that is not empty, with room to add two of them. */
#define RANGE_FIXED 1.0e38f

/* Without the care for NaN that makes fminf and fmaxf calls. */
static inline float lesser(float a, float b) { return a < b ? a : b; }
static inline float greater(float a, float b) { return a > b ? a : b; }

/* [TY18] eq. 5 with a fractional sigma, in pixels along an axis at a depth > 0. Above half of sigma_max it bends, with one tangent,
 * towards sigma_max: s -> sigma_max * (1 - sigma_max / (4 s)). */
static inline float narrow_range_sigma(const struct narrow_range *filter, int axis, float depth)
{
    float inverse = filter->inverse[axis].slope * depth + filter->inverse[axis].offset;
    float bend = filter->sigma_max * inverse;
    return bend >= 2.0f ? 1.0f / inverse : filter->sigma_max * (1.0f - 0.25f * bend);
}

/* Pixels that the kernel reaches at most, 1 to PLANE_BORDER - 1. */
static inline int narrow_range_reach(const struct narrow_range *filter, int axis, float depth)
{
    int reach = (int)(filter->cut * narrow_range_sigma(filter, axis, depth)) + 1;
    return reach < PLANE_BORDER ? reach : PLANE_BORDER - 1;
}

/* One block of BLOCK_WIDTH x BLOCK_HEIGHT pixels, pixel (x, y) at [y * stride + x]. */
struct depth_block {
    const float *in;
    float *out;
    ptrdiff_t stride;
    struct depth_range range;  /* of in, as in struct depth_plane */
    struct depth_range around; /* no sample that taps of the block meet is outside this; min 0 where they leave the picture */
};

/* Filters a block. Pixels that are empty or outside the picture (0) are copied. Returns the range of what was written. axis: of the taps;
 * functions without a line of taps ignore it. Fluid is where 0 < depth < DEPTH_LIMIT; what lies within 1e-6 (depth + mu) of the eye's
 * plane counts as outside for its neighbours.
 *
 * The _plain ones are for blocks whose taps all lie inside the picture, hold fluid, and differ in depth by at most delta: no tap is
 * dropped or clamped, eq. 1 is a Gaussian. The block's own depths differ by at most PLAIN_SPREAD of the least, so that sigma hardly
 * changes inside it.
 *
 * Tolerance against plain C, for one pass on equal input: 4e-7 of the depth (its own rounding) plus 1e-4 of the range of the taps that
 * count (weights are stepped from tap to tap, or expanded about the block's middle sigma). A sample within rounding of a bound may fall
 * on its other side: less than one pixel in 10000. */
typedef struct depth_range narrow_range_function(const struct narrow_range *filter, const struct depth_block *block, int axis);

#define PLAIN_SPREAD 0.06f

struct narrow_range_kernels {
    narrow_range_function *line, *line_plain;     /* 1-D, bounds of its own on each side */
    narrow_range_function *disc, *disc_plain;     /* 2-D, one pair of bounds, ring by ring */
    narrow_range_function *square, *square_plain; /* 5x5 */
};

extern const struct narrow_range_kernels mns_narrow_range_kernels_scalar, mns_narrow_range_kernels_sse2, mns_narrow_range_kernels_avx2,
    mns_narrow_range_kernels_avx512, mns_narrow_range_kernels_neon;

#endif
