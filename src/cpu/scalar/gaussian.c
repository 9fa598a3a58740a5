/* gaussian.c: the Gaussian filter in plain C. */
#include "cpu/smooth/gaussian.h"

#include "cpu/scalar/window.h"

static float line_pixel(const struct window_filter *filter, const float *in, ptrdiff_t step, int axis)
{
    float sum = 0, weights = GAUSSIAN_PART * (1 - filter->weight_cut);
    int reach = window_reach(filter, axis, *in);
    struct gaussian g = gaussian_start(window_sigma(filter, axis, *in));
    for (ptrdiff_t i = 1; i <= reach; i++, gaussian_step(&g)) {
        const float pair[2] = {in[i * step], in[-i * step]};
        float weight = pair[0] > 0 && pair[1] > 0 ? GAUSSIAN_PART * greater(g.weight - filter->weight_cut, 0) : 0;
        for (int side = 0; side < 2; side++) {
            if (pair[side] < DEPTH_LIMIT) {
                sum += weight * (pair[side] - *in);
                weights += weight;
            }
        }
    }
    return *in + sum / weights;
}

static struct depth_range line(const struct window_filter *filter, const struct depth_block *block, int axis)
{
    return each_pixel(filter, block, axis == AXIS_X ? 1 : block->stride, axis, line_pixel);
}

const struct gaussian_kernels mns_gaussian_kernels_scalar = {.line = line};
