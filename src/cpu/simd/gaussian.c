/* gaussian.c: the Gaussian filter over simd.h, with the arithmetic of cpu/scalar/gaussian.c; all lanes go as far as the widest kernel of the
 * block, with weight 0 beyond their own. */
#include "cpu/smooth/gaussian.h"

#include "cpu/simd/window.h"

struct mean {
    vf sum, weights;
};

SIMD void mean_add(struct mean *mean, vf weight, vm counts, vf sample, vf depth)
{
    counts = vm_and(counts, vf_lt(sample, vf_set1(DEPTH_LIMIT)));
    mean->sum = vf_mask_fma(mean->sum, counts, weight, sample - depth);
    mean->weights = vf_mask_add(mean->weights, counts, weight);
}

SIMD vf line_pixels(const struct window_filter *filter, vf depth, const float *at, ptrdiff_t step, ptrdiff_t reach, int axis)
{
    struct gaussian g = gaussian_start(exponent(filter, axis, depth));
    struct mean mean = {vf_zero(), vf_set1(GAUSSIAN_PART * (1.0f - filter->weight_cut))};
    vf part = vf_set1(GAUSSIAN_PART), cut = vf_set1(-GAUSSIAN_PART * filter->weight_cut);
    for (ptrdiff_t tap = step; tap <= reach; tap += step, gaussian_step(&g)) {
        vf a = vf_loadu(at + tap), b = vf_loadu(at - tap), weight = vf_max(vf_fma(g.weight, part, cut), vf_zero());
        vm inside = vm_and(vf_gt(a, vf_zero()), vf_gt(b, vf_zero()));
        mean_add(&mean, weight, inside, a, depth);
        mean_add(&mean, weight, inside, b, depth);
    }
    return vf_fma(mean.sum, vf_rcp(mean.weights), depth);
}

static struct depth_range line(const struct window_filter *filter, const struct depth_block *block, int axis)
{
    struct extent extent = extent_start();
    ptrdiff_t step = axis == AXIS_X ? 1 : block->stride, reach = window_reach(filter, axis, block->range.min) * step;
    for (int y = 0; y < BLOCK_HEIGHT; y++) {
        for (int x = 0; x < BLOCK_WIDTH; x += VLEN) {
            ptrdiff_t at = y * block->stride + x;
            struct pixels pixels = pixels_load(block->in + at, block->range.min);
            vf result = pixels.depth;
            if (vm_any(pixels.fluid)) {
                result = line_pixels(filter, pixels.depth, block->in + at, step, reach, axis);
            }
            pixels_store(&pixels, result, block->out + at, &extent);
        }
    }
    return extent_range(&extent);
}

const struct gaussian_kernels SIMD_NAME(mns_gaussian_kernels) = {.line = line};
