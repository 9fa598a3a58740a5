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

/* Pixels on their way along a line of taps. */
struct line {
    const float *at;
    struct mean mean;
    struct gaussian g;
};

SIMD struct line line_start(const struct window_filter *filter, vf depth, const float *at, int axis)
{
    return (struct line){at, mean_start(filter, depth), gaussian_start(exponent(filter, axis, depth))};
}

SIMD void line_tap(const struct window_filter *filter, struct line *line, ptrdiff_t tap, enum taps taps)
{
    mean_add_pair(&line->mean, weight_above_cut(line->g.weight, filter), line->at, tap, taps);
    gaussian_step(&line->g);
}

/* Two rows at once where their state fits the registers: one alone leaves the processor waiting for its results. */
SIMD struct depth_range line_block(const struct window_filter *filter, const struct depth_block *block, int axis, enum taps taps)
{
    enum { ROWS = VLEN == 16 ? 2 : 1 };
    struct extent extent = extent_start();
    ptrdiff_t stride = block->stride, step = axis == AXIS_X ? 1 : stride, reach = window_reach(filter, axis, block->range.min) * step;
    for (int y = 0; y < BLOCK_HEIGHT; y += ROWS) {
        for (int x = 0; x < BLOCK_WIDTH; x += VLEN) {
            ptrdiff_t at = y * stride + x, next = at + (ROWS - 1) * stride;
            struct pixels pixels = pixels_load(block->in + at, block->range.min), pixels2 = pixels_load(block->in + next, block->range.min);
            struct line line = line_start(filter, pixels.depth, block->in + at, axis);
            struct line line2 = line_start(filter, pixels2.depth, block->in + next, axis);
            ptrdiff_t end = vm_any(vm_or(pixels.fluid, pixels2.fluid)) ? reach : 0;
            for (ptrdiff_t tap = step; tap <= end; tap += step) {
                line_tap(filter, &line, tap, taps);
                if (ROWS == 2) {
                    line_tap(filter, &line2, tap, taps);
                }
            }
            pixels_store(&pixels, mean_result(filter, &line.mean), block->out + at, &extent);
            if (ROWS == 2) {
                pixels_store(&pixels2, mean_result(filter, &line2.mean), block->out + next, &extent);
            }
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
