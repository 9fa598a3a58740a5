/* window.h: what the kernels of window filters in plain C share. */
#ifndef MNS_CPU_SCALAR_WINDOW_H
#define MNS_CPU_SCALAR_WINDOW_H

#include "cpu/smooth/window.h"

#include <math.h>

/* The Gaussian at 1, 2, 3 ... pixels without an exponential each: exp(-a i^2) times exp(-a (2i + 1)) is the next, and that ratio falls
 * by exp(-2a). fall = 1 - exp(-2a) is exact where sigma is large, and so is what is stepped by it. */
struct gaussian {
    float weight, ratio, fall;
};

static inline struct gaussian gaussian_start(float sigma)
{
    float h = -expm1f(-0.5f / (sigma * sigma));
    float fall = h * (2 - h);
    return (struct gaussian){.weight = 1 - h, .ratio = (1 - h) * (1 - fall), .fall = fall};
}

static inline void gaussian_step(struct gaussian *g)
{
    g->weight *= g->ratio;
    g->ratio -= g->ratio * g->fall;
}

/* exp(-i^2 / (2 sigma^2)), i from 0 to reach, along one axis. */
static inline void gaussian_table(const struct window_filter *filter, int axis, float depth, int reach, float table[PLANE_BORDER])
{
    struct gaussian g = gaussian_start(window_sigma(filter, axis, depth));
    table[0] = 1;
    for (int i = 1; i <= reach; i++, gaussian_step(&g)) {
        table[i] = g.weight;
    }
}

typedef float pixel_function(const struct window_filter *filter, const float *in, ptrdiff_t step, int axis);

/* step: from tap to tap, or from row to row. */
static inline struct depth_range each_pixel(const struct window_filter *filter, const struct depth_block *block, ptrdiff_t step, int axis,
                                            pixel_function *pixel)
{
    struct depth_range range = {DEPTH_EMPTY, 0};
    const float *in = block->in;
    float *out = block->out;
    for (int y = 0; y < BLOCK_HEIGHT; y++, in += block->stride, out += block->stride) {
        for (int x = 0; x < BLOCK_WIDTH; x++) {
            bool fluid = in[x] > 0 && in[x] < DEPTH_LIMIT;
            out[x] = fluid ? pixel(filter, in + x, step, axis) : in[x];
            range.min = in[x] > 0 ? lesser(range.min, out[x]) : range.min;
            range.max = greater(range.max, out[x]);
        }
    }
    return range;
}

#endif
