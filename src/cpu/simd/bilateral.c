/* bilateral.c: the bilateral filter over simd.h. The arithmetic is that of cpu/scalar/bilateral.c, with these differences: samples are
 * taken relative to the pixel's depth in units of delta; the exponential is a polynomial; all lanes go as far as the widest kernel of the
 * block, with weight 0 beyond their own. */
#include "cpu/smooth/bilateral.h"

#include "cpu/simd/window.h"

struct mean {
    vf depth, delta, inverse_delta;
    vf sum, weights; /* sum: deltas from depth */
};

SIMD struct mean mean_start(const struct window_filter *filter, vf depth)
{
    return (struct mean){depth, vf_set1(filter->delta), vf_set1(1.0f / filter->delta), vf_zero(), vf_zero()};
}

SIMD vf mean_sample(const struct mean *mean, vf sample, enum taps taps)
{
    return from_pixel(sample, mean->depth, mean->delta, taps) * mean->inverse_delta;
}

/* A sample and its mirror. */
SIMD void mean_add_pair(struct mean *mean, vf weight, const float *at, ptrdiff_t tap, enum taps taps)
{
    vf a = vf_loadu(at + tap), b = vf_loadu(at - tap);
    if (taps == TAPS_BORDER) {
        weight = vf_keep(both_inside(a, b), weight);
    }
    a = mean_sample(mean, a, taps);
    b = mean_sample(mean, b, taps);
    vf range_a = range_weight(a * a), range_b = range_weight(b * b);
    mean->sum = vf_fma(vf_fma(range_a, a, range_b * b), weight, mean->sum);
    mean->weights = vf_fma(range_a + range_b, weight, mean->weights);
}

SIMD vf mean_result(const struct window_filter *filter, const struct mean *mean)
{
    vf own = vf_set1((1.0f - filter->weight_cut) * (1.0f - RANGE_END));
    return vf_fma(mean->sum * vf_set1(filter->delta), vf_rcp(mean->weights + own), mean->depth);
}

SIMD vf line_pixels(const struct window_filter *filter, vf depth, const float *at, ptrdiff_t step, ptrdiff_t reach, int axis,
                    enum taps taps)
{
    struct mean mean = mean_start(filter, depth);
    struct gaussian g = gaussian_start(exponent(filter, axis, depth));
    for (ptrdiff_t tap = step; tap <= reach; tap += step, gaussian_step(&g)) {
        mean_add_pair(&mean, weight_above_cut(g.weight, filter), at, tap, taps);
    }
    return mean_result(filter, &mean);
}

SIMD struct depth_range line_block(const struct window_filter *filter, const struct depth_block *block, int axis, enum taps taps)
{
    struct extent extent = extent_start();
    ptrdiff_t step = axis == AXIS_X ? 1 : block->stride, reach = window_reach(filter, axis, block->range.min) * step;
    for (int y = 0; y < BLOCK_HEIGHT; y++) {
        for (int x = 0; x < BLOCK_WIDTH; x += VLEN) {
            ptrdiff_t at = y * block->stride + x;
            struct pixels pixels = pixels_load(block->in + at, block->range.min);
            vf result = pixels.depth;
            if (vm_any(pixels.fluid)) {
                result = line_pixels(filter, pixels.depth, block->in + at, step, reach, axis, taps);
            }
            pixels_store(&pixels, result, block->out + at, &extent);
        }
    }
    return extent_range(&extent);
}

static struct depth_range line(const struct window_filter *filter, const struct depth_block *block, int axis)
{
    return block->around.min > 0 ? line_block(filter, block, axis, TAPS_INSIDE) : line_block(filter, block, axis, TAPS_BORDER);
}

static struct depth_range line_plain(const struct window_filter *filter, const struct depth_block *block, int axis)
{
    return line_block(filter, block, axis, TAPS_PLAIN);
}

SIMD vf disc_pixels(const struct window_filter *filter, vf depth, const float *at, ptrdiff_t stride, const int reach[2], float nearest,
                    enum taps taps)
{
    vf along_x[PLANE_BORDER], along_y[PLANE_BORDER];
    gaussian_table(exponent(filter, AXIS_X, depth), reach[AXIS_X], along_x);
    gaussian_table(exponent(filter, AXIS_Y, depth), reach[AXIS_Y], along_y);
    struct mean mean = mean_start(filter, depth);
    for (int y = 0; y <= reach[AXIS_Y]; y++) {
        int end = row_reach(filter, reach, nearest, y);
        for (int x = y ? -end : 1; x <= end; x++) { /* half of the taps; their mirrors are the others */
            mean_add_pair(&mean, weight_above_cut(along_x[absolute(x)] * along_y[y], filter), at, y * stride + x, taps);
        }
    }
    return mean_result(filter, &mean);
}

SIMD struct depth_range disc_block(const struct window_filter *filter, const struct depth_block *block, enum taps taps)
{
    struct extent extent = extent_start();
    const int reach[2] = {window_reach(filter, AXIS_X, block->range.min), window_reach(filter, AXIS_Y, block->range.min)};
    for (int y = 0; y < BLOCK_HEIGHT; y++) {
        for (int x = 0; x < BLOCK_WIDTH; x += VLEN) {
            ptrdiff_t at = y * block->stride + x;
            struct pixels pixels = pixels_load(block->in + at, block->range.min);
            vf result = pixels.depth;
            if (vm_any(pixels.fluid)) {
                result = disc_pixels(filter, pixels.depth, block->in + at, block->stride, reach, block->range.min, taps);
            }
            pixels_store(&pixels, result, block->out + at, &extent);
        }
    }
    return extent_range(&extent);
}

static struct depth_range disc(const struct window_filter *filter, const struct depth_block *block, int axis)
{
    (void)axis;
    return block->around.min > 0 ? disc_block(filter, block, TAPS_INSIDE) : disc_block(filter, block, TAPS_BORDER);
}

static struct depth_range disc_plain(const struct window_filter *filter, const struct depth_block *block, int axis)
{
    (void)axis;
    return disc_block(filter, block, TAPS_PLAIN);
}

const struct bilateral_kernels SIMD_NAME(mns_bilateral_kernels) = {
    .line = line, .line_plain = line_plain, .disc = disc, .disc_plain = disc_plain};
