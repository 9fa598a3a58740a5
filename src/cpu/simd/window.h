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

/* What the taps of a block may be; constants where the functions below are inlined. */
enum taps {
    TAPS_PLAIN,  /* all count */
    TAPS_INSIDE, /* some are too far */
    TAPS_BORDER  /* some are outside the picture */
};

/* exp(-RANGE_FALL s) - RANGE_END for s in [0, 1], within 6e-6 of itself: (1 - s) times the fourth power of a minimax polynomial. */
SIMD vf range_weight(vf s)
{
    vf p = vf_fma(vf_set1(-0.00700921327f), s, vf_set1(0.0388939347f));
    p = vf_fma(p, s, vf_set1(-0.159147192f));
    p = vf_fma(p, s, vf_set1(0.487978373f));
    p = vf_fma(p, s, vf_set1(-0.885077958f));
    p = vf_fma(p, s, vf_set1(0.997209689f));
    p = p * p;
    return p * p * (vf_set1(1.0f) - s);
}

/* A sample's depth relative to the pixel's. What is too far (or NaN) stands at the end of the range, where its weight is 0. */
SIMD vf from_pixel(vf sample, vf depth, vf delta, enum taps taps)
{
    vf from = sample - depth;
    if (taps != TAPS_PLAIN) {
        from = vf_max(vf_min(from, delta), -delta);
    }
    return from;
}

/* Whether a sample and its mirror are in the picture. */
SIMD vm both_inside(vf a, vf b) { return vm_and(vf_gt(a, vf_zero()), vf_gt(b, vf_zero())); }

SIMD vf weight_above_cut(vf weight, const struct window_filter *filter) { return vf_max(weight - vf_set1(filter->weight_cut), vf_zero()); }

/* Pixels that a 2-D kernel reaches along x in the row y pixels from its centre. nearest: the least depth of its block; reach: there, by axis. */
static inline int row_reach(const struct window_filter *filter, const int reach[2], float nearest, int y)
{
    float sigma_x = window_sigma(filter, AXIS_X, nearest), sigma_y = window_sigma(filter, AXIS_Y, nearest), up = (float)y / sigma_y;
    int end = (int)(sigma_x * sqrtf(greater(filter->cut * filter->cut - up * up, 0))) + 1;
    return end < reach[AXIS_X] ? end : reach[AXIS_X];
}

#endif
