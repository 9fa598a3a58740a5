/* window.h: what the kernels of window filters over simd.h share. */
#ifndef MNS_CPU_SIMD_WINDOW_H
#define MNS_CPU_SIMD_WINDOW_H

#include "cpu/simd.h"
#include "cpu/smooth/window.h"

#include <math.h>

/* VLEN pixels of one row; lanes without fluid run along with some depth. */
struct pixels {
    vf input, depth;
    vm fluid;
};

SIMD struct pixels pixels_load(const float *in, float any_depth)
{
    vf input = vf_load(in);
    vm fluid = vm_and(vf_gt(input, vf_zero()), vf_lt(input, vf_set1(DEPTH_LIMIT)));
    return (struct pixels){input, vf_select(fluid, input, vf_set1(any_depth)), fluid};
}

/* Least and greatest of what was written to a block. */
struct extent {
    vf min, max;
};

SIMD struct extent extent_start(void) { return (struct extent){vf_set1(DEPTH_EMPTY), vf_zero()}; }

SIMD void pixels_store(const struct pixels *pixels, vf result, float *out, struct extent *extent)
{
    result = vf_select(pixels->fluid, result, pixels->input);
    vf_store(out, result);
    extent->min = vf_mask_min(extent->min, vf_gt(pixels->input, vf_zero()), result);
    extent->max = vf_max(extent->max, result);
}

SIMD struct depth_range extent_range(const struct extent *extent)
{
    return (struct depth_range){vf_reduce_min(extent->min), vf_reduce_max(extent->max)};
}

/* 1 / sigma in pixels: 1 / window_sigma. Bounded so that its square is finite. */
SIMD vf inverse_sigma(const struct window_filter *filter, int axis, vf depth)
{
    vf inverse = vf_fma(depth, vf_set1(filter->inverse[axis].slope), vf_set1(filter->inverse[axis].offset));
    vf sigma_max = vf_set1(filter->sigma_max), bend = sigma_max * inverse;
    vf bent = vf_rcp(vf_fnma(sigma_max * bend, vf_set1(0.25f), sigma_max));
    return vf_min(vf_select(vf_lt(bend, vf_set1(2.0f)), bent, inverse), vf_set1(1e18f));
}

/* a in exp(-a i^2). */
SIMD vf exponent(const struct window_filter *filter, int axis, vf depth)
{
    vf inverse = inverse_sigma(filter, axis, depth);
    return inverse * inverse * vf_set1(0.5f);
}

/* The Gaussian at 1, 2, 3 ... pixels, as in plain C. */
struct gaussian {
    vf weight, ratio, fall;
};

SIMD struct gaussian gaussian_start(vf exponent)
{
    vf one = vf_set1(1.0f), h = -vf_expm1(-exponent);
    vf fall = h * (vf_set1(2.0f) - h);
    return (struct gaussian){.weight = one - h, .ratio = (one - h) * (one - fall), .fall = fall};
}

SIMD void gaussian_step(struct gaussian *g)
{
    g->weight = g->weight * g->ratio;
    g->ratio = vf_fnma(g->ratio, g->fall, g->ratio);
}

/* The farthest fluid of a block. */
SIMD float farthest_fluid(const struct depth_block *block)
{
    if (block->range.max < DEPTH_LIMIT) {
        return block->range.max;
    }
    vf farthest = vf_zero();
    for (int i = 0; i < BLOCK_HEIGHT * BLOCK_WIDTH; i += VLEN) {
        vf depth = vf_load(block->in + i / BLOCK_WIDTH * block->stride + i % BLOCK_WIDTH);
        farthest = vf_mask_max(farthest, vf_lt(depth, vf_set1(DEPTH_LIMIT)), depth);
    }
    return vf_reduce_max(farthest);
}

static inline int absolute(int a) { return a < 0 ? -a : a; }

/* exp(-i^2 / (2 sigma^2)), i from 0 to reach. */
SIMD void gaussian_table(vf exponent, int reach, vf table[PLANE_BORDER])
{
    struct gaussian g = gaussian_start(exponent);
    table[0] = vf_set1(1.0f);
    for (int i = 1; i <= reach; i++, gaussian_step(&g)) {
        table[i] = g.weight;
    }
}

static inline int disc_reach(const struct window_filter *filter, float depth)
{
    int x = window_reach(filter, AXIS_X, depth), y = window_reach(filter, AXIS_Y, depth);
    return x > y ? x : y;
}

/* What taps may be; constants where the functions below are inlined. */
enum taps {
    TAPS_CLOSE,  /* all within RANGE_CLOSE of delta */
    TAPS_NEAR,   /* all within RANGE_NEAR of delta */
    TAPS_PLAIN,  /* all count */
    TAPS_INSIDE, /* some are too far */
    TAPS_BORDER, /* some are outside the picture */
    TAPS_NONE    /* all are too far */
};

#define RANGE_CLOSE 0.25f
#define RANGE_NEAR  0.5f

/* exp(-RANGE_FALL s) - RANGE_END for s in [0, 1]: within 6e-6 of itself, (1 - s) times the fourth power of a minimax polynomial; where s ends
 * sooner within 2e-6, a minimax polynomial. */
SIMD vf range_weight(vf s, enum taps taps)
{
    if (taps == TAPS_CLOSE) {
        vf p = vf_fma(vf_set1(-13.1816646f), s, vf_set1(10.0470097f));
        p = vf_fma(p, s, vf_set1(-4.49900551f));
        return vf_fma(p, s, vf_set1(0.988888965f));
    }
    if (taps == TAPS_NEAR) {
        vf p = vf_fma(vf_set1(-8.65853002f), s, vf_set1(15.2982996f));
        p = vf_fma(p, s, vf_set1(-14.9531679f));
        p = vf_fma(p, s, vf_set1(10.1105308f));
        p = vf_fma(p, s, vf_set1(-4.49965962f));
        return vf_fma(p, s, vf_set1(0.988889629f));
    }
    vf p = vf_fma(vf_set1(-0.00700921327f), s, vf_set1(0.0388939347f));
    p = vf_fma(p, s, vf_set1(-0.159147192f));
    p = vf_fma(p, s, vf_set1(0.487978373f));
    p = vf_fma(p, s, vf_set1(-0.885077958f));
    p = vf_fma(p, s, vf_set1(0.997209689f));
    p = p * p;
    return p * p * (vf_set1(1.0f) - s);
}

/* A sample's depth relative to the pixel's, in deltas; scaled: the pixel's own in deltas. What is too far (or NaN) stands at the end of the range,
 * where its weight is 0. */
SIMD vf from_pixel(vf sample, vf inverse_delta, vf scaled, enum taps taps)
{
    vf from = vf_fma(sample, inverse_delta, -scaled);
    if (taps >= TAPS_INSIDE) {
        from = vf_max(vf_min(from, vf_set1(1.0f)), vf_set1(-1.0f));
    }
    return from;
}

/* Whether a sample and its mirror are in the picture. */
SIMD vm both_inside(vf a, vf b) { return vm_and(vf_gt(a, vf_zero()), vf_gt(b, vf_zero())); }

SIMD vf weight_above_cut(vf weight, const struct window_filter *filter) { return vf_max(weight - vf_set1(filter->weight_cut), vf_zero()); }

/* Of taps from nearest on, whose depths are at most `apart` from those of their pixels. */
SIMD enum taps taps_within(const struct window_filter *filter, float nearest, float apart)
{
    float delta = filter->delta;
    if (!(nearest > 0)) {
        return TAPS_BORDER;
    }
    return apart <= RANGE_CLOSE * delta ? TAPS_CLOSE : apart <= RANGE_NEAR * delta ? TAPS_NEAR : apart <= delta ? TAPS_PLAIN : TAPS_INSIDE;
}

/* Of pixels in one range and taps in another. */
SIMD enum taps taps_of(const struct window_filter *filter, struct depth_range pixels, struct depth_range around)
{
    if (around.min - pixels.max >= filter->delta) {
        return TAPS_NONE;
    }
    return taps_within(filter, around.min, greater(around.max - pixels.min, pixels.max - around.min));
}

/* Calls function(..., taps) with taps that are a constant there. */
#define FOR_TAPS(taps, function, ...)                                                                                                      \
    switch (taps) {                                                                                                                        \
    case TAPS_CLOSE: function(__VA_ARGS__, TAPS_CLOSE); break;                                                                             \
    case TAPS_NEAR: function(__VA_ARGS__, TAPS_NEAR); break;                                                                               \
    case TAPS_PLAIN: function(__VA_ARGS__, TAPS_PLAIN); break;                                                                             \
    case TAPS_INSIDE: function(__VA_ARGS__, TAPS_INSIDE); break;                                                                           \
    case TAPS_BORDER: function(__VA_ARGS__, TAPS_BORDER); break;                                                                           \
    case TAPS_NONE: break;                                                                                                                 \
    }

/* Least and greatest fluid of VLEN pixels, of which some have it. */
SIMD struct depth_range fluid_range(const struct pixels *pixels)
{
    vf low = vf_mask_min(vf_set1(DEPTH_EMPTY), pixels->fluid, pixels->depth), high = vf_mask_max(vf_zero(), pixels->fluid, pixels->depth);
    return (struct depth_range){vf_reduce_min(low), vf_reduce_max(high)};
}

/* The shape of a 2-D kernel at the least depth of its block: pixels that it reaches by axis, and along x in the row y pixels from its centre. */
struct disc_shape {
    int reach[2], end[PLANE_BORDER];
};

SIMD void disc_shape_of(const struct window_filter *filter, float nearest, struct disc_shape *out)
{
    float sigma_x = window_sigma(filter, AXIS_X, nearest), per_y = 1.0f / window_sigma(filter, AXIS_Y, nearest);
    out->reach[AXIS_X] = window_reach(filter, AXIS_X, nearest);
    out->reach[AXIS_Y] = window_reach(filter, AXIS_Y, nearest);
    for (int y = 0; y <= out->reach[AXIS_Y]; y++) {
        float up = (float)y * per_y;
        int end = (int)(sigma_x * sqrtf(greater(filter->cut * filter->cut - up * up, 0))) + 1;
        out->end[y] = end < out->reach[AXIS_X] ? end : out->reach[AXIS_X];
    }
}

/* Bounds on each row of taps of VLEN pixels: [row + reach[AXIS_Y]] for rows -reach to BLOCK_HEIGHT - 1 + reach. at: row 0's first pixel. */
SIMD void disc_rows(const float *at, ptrdiff_t stride, const int reach[2], struct depth_range rows[BLOCK_HEIGHT + 2 * PLANE_BORDER])
{
    for (int row = 0; row < BLOCK_HEIGHT + 2 * reach[AXIS_Y]; row++) {
        const float *left = at + (row - reach[AXIS_Y]) * stride - reach[AXIS_X], *last = left + 2 * reach[AXIS_X];
        vf low = vf_loadu(last), high = low;
        for (; left < last; left += VLEN) {
            vf depth = vf_loadu(left);
            low = vf_min(low, depth);
            high = vf_max(high, depth);
        }
        rows[row] = (struct depth_range){vf_reduce_min(low), vf_reduce_max(high)};
    }
}

/* Of two rows of taps together. */
SIMD enum taps row_taps(const struct window_filter *filter, struct depth_range pixels, struct depth_range a, struct depth_range b)
{
    return taps_of(filter, pixels, (struct depth_range){lesser(a.min, b.min), greater(a.max, b.max)});
}

#endif
