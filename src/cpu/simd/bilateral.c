/* bilateral.c: the bilateral filter over simd.h. The arithmetic is that of cpu/scalar/bilateral.c, with these differences: samples are taken
 * relative to the pixel's depth in units of delta; the exponential is a polynomial, of less degree where no tap comes near the range's end; all
 * lanes go as far as the widest kernel of the block, with weight 0 beyond their own. */
#include "cpu/smooth/bilateral.h"

#include "cpu/simd/window.h"

/* scaled: depth / delta; sum: deltas from depth. */
struct mean {
    vf depth, scaled, inverse_delta;
    vf sum, weights;
};

SIMD vf mean_sample(const struct mean *mean, vf sample, enum taps taps)
{
    return from_pixel(sample, mean->inverse_delta, mean->scaled, taps);
}

SIMD struct mean mean_start(const struct window_filter *filter, vf depth)
{
    vf inverse = vf_set1(1.0f / filter->delta);
    struct mean mean = {depth, depth * inverse, inverse, vf_zero(), vf_set1((1.0f - filter->weight_cut) * (1.0f - RANGE_END))};
    mean.sum = mean.weights * mean_sample(&mean, depth, TAPS_PLAIN);
    return mean;
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
    vf range_a = range_weight(a * a, taps), range_b = range_weight(b * b, taps);
    mean->sum = vf_fma(vf_fma(range_a, a, range_b * b), weight, mean->sum);
    mean->weights = vf_fma(range_a + range_b, weight, mean->weights);
}

SIMD vf mean_result(const struct window_filter *filter, const struct mean *mean)
{
    vf rest = mean_sample(mean, mean->depth, TAPS_PLAIN); /* what rounding leaves of the pixel's own */
    return vf_fma(vf_fma(mean->sum, vf_rcp(mean->weights), -rest), vf_set1(filter->delta), mean->depth);
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

/* VLEN columns of a block, two rows at once where their state fits the registers: one alone leaves the processor waiting for its results. */
SIMD void line_columns(const struct window_filter *filter, const struct depth_block *block, int x, int axis, int reach,
                       struct extent *extent, enum taps taps)
{
    enum { ROWS = VLEN == 16 ? 2 : 1 };
    ptrdiff_t stride = block->stride, step = axis == AXIS_X ? 1 : stride;
    for (int y = 0; y < BLOCK_HEIGHT; y += ROWS) {
        ptrdiff_t at = y * stride + x, next = at + (ROWS - 1) * stride;
        struct pixels pixels = pixels_load(block->in + at, block->range.min), pixels2 = pixels_load(block->in + next, block->range.min);
        struct line line = line_start(filter, pixels.depth, block->in + at, axis);
        struct line line2 = line_start(filter, pixels2.depth, block->in + next, axis);
        ptrdiff_t end = vm_any(vm_or(pixels.fluid, pixels2.fluid)) ? reach * step : 0;
        for (ptrdiff_t tap = step; tap <= end; tap += step) {
            line_tap(filter, &line, tap, taps);
            if (ROWS == 2) {
                line_tap(filter, &line2, tap, taps);
            }
        }
        pixels_store(&pixels, mean_result(filter, &line.mean), block->out + at, extent);
        if (ROWS == 2) {
            pixels_store(&pixels2, mean_result(filter, &line2.mean), block->out + next, extent);
        }
    }
}

/* What the lines of taps through VLEN columns of a block meet. Along a column taps are compared with pixels of that column only. */
SIMD enum taps line_taps(const struct window_filter *filter, const struct depth_block *block, int x, int axis, int reach)
{
    int beside = axis == AXIS_X ? reach : 0, beyond = axis == AXIS_Y ? reach : 0;
    vf low = vf_set1(DEPTH_EMPTY), high = vf_zero(), own_low = low, own_high = high;
    for (int y = -beyond; y < BLOCK_HEIGHT + beyond; y++) {
        const float *at = block->in + y * block->stride + x, *last = at + beside;
        for (const float *taps = at - beside; taps < last; taps += VLEN) {
            low = vf_min(low, vf_loadu(taps));
            high = vf_max(high, vf_loadu(taps));
        }
        low = vf_min(low, vf_loadu(last));
        high = vf_max(high, vf_loadu(last));
        if (y >= 0 && y < BLOCK_HEIGHT) {
            struct pixels pixels = pixels_load(at, 1);
            own_low = vf_mask_min(own_low, pixels.fluid, pixels.depth);
            own_high = vf_mask_max(own_high, pixels.fluid, pixels.depth);
        }
    }
    float nearest = vf_reduce_min(low);
    if (axis == AXIS_X) {
        low = vf_set1(nearest);
        high = vf_set1(vf_reduce_max(high));
    }
    return taps_within(filter, nearest, vf_reduce_max(vf_max(high - own_low, own_high - low)));
}

static struct depth_range line(const struct window_filter *filter, const struct depth_block *block, int axis)
{
    struct extent extent = extent_start();
    int reach = window_reach(filter, axis, block->range.min);
    for (int x = 0; x < BLOCK_WIDTH; x += VLEN) {
        FOR_TAPS(line_taps(filter, block, x, axis, reach), line_columns, filter, block, x, axis, reach, &extent)
    }
    return extent_range(&extent);
}

SIMD void disc_row(struct mean *mean, const vf *along_x, vf along_y, vf cut, int first, int end, const float *at, ptrdiff_t row,
                   enum taps taps)
{
    for (int x = first; x <= end; x++) {
        mean_add_pair(mean, vf_max(vf_fma(along_x[absolute(x)], along_y, -cut), vf_zero()), at, row + x, taps);
    }
}

/* rows: bounds on the taps in each row from the pixels' own. */
SIMD vf disc_pixels(const struct window_filter *filter, const struct pixels *pixels, const float *at, ptrdiff_t stride,
                    const struct disc_shape *shape, const struct depth_range *rows)
{
    vf along_x[PLANE_BORDER], along_y[PLANE_BORDER], cut = vf_set1(filter->weight_cut);
    gaussian_table(exponent(filter, AXIS_X, pixels->depth), shape->reach[AXIS_X], along_x);
    gaussian_table(exponent(filter, AXIS_Y, pixels->depth), shape->reach[AXIS_Y], along_y);
    struct mean mean = mean_start(filter, pixels->depth);
    struct depth_range own = fluid_range(pixels);
    for (int y = 0; y <= shape->reach[AXIS_Y]; y++) { /* half of the taps; their mirrors are the others */
        int end = shape->end[y];
        FOR_TAPS(row_taps(filter, own, rows[y], rows[-y]), disc_row, &mean, along_x, along_y[y], cut, y ? -end : 1, end, at, y * stride)
    }
    return mean_result(filter, &mean);
}

static struct depth_range disc(const struct window_filter *filter, const struct depth_block *block, int axis)
{
    (void)axis;
    struct extent extent = extent_start();
    ptrdiff_t stride = block->stride;
    struct disc_shape shape;
    disc_shape_of(filter, block->range.min, &shape);
    for (int x = 0; x < BLOCK_WIDTH; x += VLEN) {
        struct depth_range rows[BLOCK_HEIGHT + 2 * PLANE_BORDER];
        disc_rows(block->in + x, stride, shape.reach, rows);
        for (int y = 0; y < BLOCK_HEIGHT; y++) {
            const float *at = block->in + y * stride + x;
            struct pixels pixels = pixels_load(at, block->range.min);
            vf result = pixels.depth;
            if (vm_any(pixels.fluid)) {
                result = disc_pixels(filter, &pixels, at, stride, &shape, rows + shape.reach[AXIS_Y] + y);
            }
            pixels_store(&pixels, result, block->out + y * stride + x, &extent);
        }
    }
    return extent_range(&extent);
}

const struct bilateral_kernels SIMD_NAME(mns_bilateral_kernels) = {.line = line, .line_plain = line, .disc = disc, .disc_plain = disc};
