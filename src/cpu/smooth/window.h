/* window.h: what the filters share that look at a window around each pixel: their lengths in metres and pixels, blocks of pixels, and a pass
 * over the picture. */
#ifndef MNS_CPU_SMOOTH_WINDOW_H
#define MNS_CPU_SMOOTH_WINDOW_H

#include "core/frame.h"
#include "cpu/plane.h"

#include <stdbool.h>

/* The axis along which a line of taps lies, or whose pixels measure a kernel. */
enum { AXIS_X, AXIS_Y };

/* The lengths of a filter, resolved.
 *
 * Narrow range: depth d is positive here where [TY18]'s z is negative, d = -z: nearer is smaller, so the paper's "z_j > z_i + delta" (too
 * near) reads d_j < d_i - delta, its "z_j < z_i - delta" (too far) d_j > d_i + delta, and what is too far counts as d_i + mu. */
struct window_filter {
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
    const struct plane_fit *fit;
    bool at_lens; /* some depth may be less than delta, so that the border's 0 needs telling from a sample in range */
};

/* Farther than any depth that is not empty, with room to add two of them. */
#define RANGE_FIXED 1.0e38f

/* The weight of a sample by its depth, t = (its depth - the pixel's) / delta: a Gaussian with sigma_z = delta / 3, exp(-RANGE_FALL t^2) -
 * RANGE_END, and 0 from |t| = 1 on, so that no sample comes or goes with a step. */
#define RANGE_FALL 4.5f         /* 1 / (2 (1/3)^2) */
#define RANGE_END  0.011108997f /* exp(-RANGE_FALL) */

/* Without the care for NaN that makes fminf and fmaxf calls. */
static inline float lesser(float a, float b) { return a < b ? a : b; }
static inline float greater(float a, float b) { return a > b ? a : b; }

/* [TY18] eq. 5 with a fractional sigma, in pixels along an axis at a depth > 0. Above half of sigma_max it bends, with one tangent,
 * towards sigma_max: s -> sigma_max * (1 - sigma_max / (4 s)). */
static inline float window_sigma(const struct window_filter *filter, int axis, float depth)
{
    float inverse = filter->inverse[axis].slope * depth + filter->inverse[axis].offset;
    float bend = filter->sigma_max * inverse;
    return bend >= 2.0f ? 1.0f / inverse : filter->sigma_max * (1.0f - 0.25f * bend);
}

/* Pixels that the kernel reaches at most, 1 to PLANE_BORDER - 1. */
static inline int window_reach(const struct window_filter *filter, int axis, float depth)
{
    int reach = (int)(filter->cut * window_sigma(filter, axis, depth)) + 1;
    return reach < PLANE_BORDER ? reach : PLANE_BORDER - 1;
}

/* One block of BLOCK_WIDTH x BLOCK_HEIGHT pixels, pixel (x, y) at [y * stride + x]. */
struct depth_block {
    const float *in;
    float *out;
    ptrdiff_t stride;
    struct depth_range range;  /* of in, as in struct depth_plane */
    struct depth_range around; /* no sample that taps of the block meet is outside this; min 0 where they leave the picture */
    int x, y;                  /* its first pixel */
};

/* Filters a block. Pixels that are empty or outside the picture (0) are copied. Returns the range of what was written. axis: of the taps;
 * functions without a line of taps ignore it. Fluid is where 0 < depth < DEPTH_LIMIT. */
typedef struct depth_range window_function(const struct window_filter *filter, const struct depth_block *block, int axis);

/* Where a pass has its taps. */
enum window_shape { WINDOW_LINE_X, WINDOW_LINE_Y, WINDOW_DISC, WINDOW_SQUARE };

struct backend;

/* The filter of a frame's parameters. */
struct window_filter mns_window_resolve(const struct frame *frame);

/* A pass over the picture, from cpu->smoothed to the other plane, which then is cpu->smoothed. kernel filters a block; plain may be used in
 * its place where all depths around a block are within delta of one another, none is empty or outside, and the block's own differ
 * by at most PLAIN_SPREAD of the least, so that sigma hardly changes inside it. The two may be the same. */
void mns_window_pass(struct backend *cpu, const struct window_filter *filter, enum window_shape shape, window_function *kernel,
                     window_function *plain);

#define PLAIN_SPREAD 0.06f

#endif
