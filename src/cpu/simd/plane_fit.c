/* plane_fit.c: the plane-fit filter over simd.h. The arithmetic is that of cpu/scalar/plane_fit.c, with these differences: the exponential is a
 * polynomial, of less degree in rows where no tap comes near the range's end; taps are added with their mirrors; all lanes go as far as the widest
 * kernel of the block, with weight 0 beyond their own. */
#include "cpu/smooth/plane_fit.h"

#include "cpu/simd/window.h"

/* Sums over the taps, as in plain C, depth in deltas. row: what the taps of one row add to y, per pixel that it is away; x: minus what they add to x. */
struct sums {
    vf weights, depth, x, y, row;
    vf normal[3];
};

/* What does not change from tap to tap. scaled: depth / delta. */
struct centre {
    vf depth, scaled, inverse_delta;
    const float *at, *normal[3]; /* the first pixel and its normal */
};

SIMD struct centre centre_of(const struct window_filter *filter, const struct depth_block *block, vf depth, int column, int row)
{
    ptrdiff_t at = (block->y + row) * block->stride + block->x + column;
    struct centre centre = {.depth = depth, .inverse_delta = vf_set1(1.0f / filter->delta)};
    centre.scaled = depth * centre.inverse_delta;
    centre.at = block->in + row * block->stride + column;
    for (int c = 0; c < 3; c++) {
        centre.normal[c] = filter->fit->normal[c] + at;
    }
    return centre;
}

/* What rounding leaves of the pixel's own depth, relative to itself, where samples are taken so. */
SIMD vf centre_rest(const struct centre *centre) { return from_pixel(centre->depth, centre->inverse_delta, centre->scaled, TAPS_PLAIN); }

SIMD struct sums sums_start(const struct window_filter *filter, const struct centre *centre)
{
    vf own = vf_set1((1.0f - filter->weight_cut) * (1.0f - RANGE_END));
    struct sums sums = {own, own * centre_rest(centre), vf_zero(), vf_zero(), vf_zero(), {vf_zero(), vf_zero(), vf_zero()}};
    for (int c = 0; c < 3; c++) {
        sums.normal[c] = vf_load(centre->normal[c]) * own;
    }
    return sums;
}

/* A tap, `tap` floats on, and its mirror. */
SIMD void sums_add(struct sums *sums, const struct centre *centre, vf weight, ptrdiff_t tap, bool orthographic, enum taps taps)
{
    vf a = vf_loadu(centre->at + tap), b = vf_loadu(centre->at - tap);
    if (taps == TAPS_BORDER) {
        weight = vf_keep(both_inside(a, b), weight);
    }
    vf from_a = from_pixel(a, centre->inverse_delta, centre->scaled, taps);
    vf from_b = from_pixel(b, centre->inverse_delta, centre->scaled, taps);
    vf weight_a = weight * range_weight(from_a * from_a, taps), weight_b = weight * range_weight(from_b * from_b, taps);
    sums->weights = sums->weights + (weight_a + weight_b);
    sums->depth = vf_fma(from_b, weight_b, vf_fma(from_a, weight_a, sums->depth));
    for (int c = 0; c < 3; c++) {
        const float *normal = centre->normal[c];
        sums->normal[c] = vf_fma(vf_loadu(normal - tap), weight_b, vf_fma(vf_loadu(normal + tap), weight_a, sums->normal[c]));
    }
    sums->row = vf_either(orthographic, sums->row + (weight_a - weight_b), vf_fnma(b, weight_b, vf_fma(a, weight_a, sums->row)));
    sums->x = sums->x + sums->row;
}

/* Row y of taps, from `first` to `end` pixels to the right, and the mirrors. Each tap is in sums->x once for itself and each tap that follows. */
SIMD void sums_add_row(struct sums *sums, const struct centre *centre, const vf *along_x, vf along_y, vf cut, int first, int end,
                       ptrdiff_t row, bool orthographic, enum taps taps)
{
    for (int x = first; x <= end; x++) {
        vf weight = vf_max(vf_fma(along_x[absolute(x)], along_y, -cut), vf_zero());
        sums_add(sums, centre, weight, row + x, orthographic, taps);
    }
    sums->x = vf_fnma(vf_set1((float)(end + 1)), sums->row, sums->x);
}

SIMD vf meet(const struct window_filter *filter, const struct sums *sums, const struct centre *centre, int x, int y)
{
    const struct plane_fit *fit = filter->fit;
    const vf *n = sums->normal;
    vf inverse = vf_rcp(sums->weights), delta = vf_set1(filter->delta), ray_x = vf_zero(), ray_y = vf_zero();
    vf mean = vf_fma(vf_fma(sums->depth, inverse, -centre_rest(centre)), delta, centre->depth);
    if (!fit->orthographic) {
        ray_x = (vf_iota() + vf_set1((float)x + 0.5f - fit->cx)) * vf_set1(fit->step_x);
        ray_y = vf_set1(((float)y + 0.5f - fit->cy) * fit->step_y);
    }
    vf facing = vf_fma(n[0], ray_x, vf_fma(n[1], ray_y, n[2]));
    vf lean = vf_fnma(n[0] * vf_set1(fit->step_x), sums->x, n[1] * vf_set1(fit->step_y) * sums->y);
    vf square = vf_fma(n[0], n[0], vf_fma(n[1], n[1], n[2] * n[2]));
    vf ray = vf_fma(ray_x, ray_x, vf_fma(ray_y, ray_y, vf_set1(1.0f)));
    vm meets = vf_gt(facing * facing, square * ray * vf_set1(PLANE_FIT_GRAZING * PLANE_FIT_GRAZING));
    vf met = vf_fma(lean * inverse, vf_rcp(facing), mean);
    met = vf_max(vf_min(met, mean + delta), vf_max(mean - delta, mean * vf_set1(0.5f)));
    return vf_select(meets, met, mean);
}

/* rows: bounds on the taps in each row from the pixels' own. */
SIMD vf disc_pixels(const struct window_filter *filter, const struct depth_block *block, const struct pixels *pixels, int column, int row,
                    const struct disc_shape *shape, const struct depth_range *rows, bool orthographic)
{
    vf along_x[PLANE_BORDER], along_y[PLANE_BORDER], cut = vf_set1(filter->weight_cut);
    gaussian_table(exponent(filter, AXIS_X, pixels->depth), shape->reach[AXIS_X], along_x);
    gaussian_table(exponent(filter, AXIS_Y, pixels->depth), shape->reach[AXIS_Y], along_y);
    struct centre centre = centre_of(filter, block, pixels->depth, column, row);
    struct sums sums = sums_start(filter, &centre);
    struct depth_range own = fluid_range(pixels);
    for (int y = 0; y <= shape->reach[AXIS_Y]; y++) { /* half of the taps; their mirrors are the others */
        int end = shape->end[y];
        FOR_TAPS(row_taps(filter, own, rows[y], rows[-y]), sums_add_row, &sums, &centre, along_x, along_y[y], cut, y ? -end : 1, end,
                 y * block->stride, orthographic)
        sums.y = vf_fma(vf_set1((float)y), sums.row, sums.y);
        sums.row = vf_zero();
    }
    return meet(filter, &sums, &centre, block->x + column, block->y + row);
}

SIMD struct depth_range disc_block(const struct window_filter *filter, const struct depth_block *block, bool orthographic)
{
    struct extent extent = extent_start();
    struct disc_shape shape;
    disc_shape_of(filter, block->range.min, &shape);
    for (int x = 0; x < BLOCK_WIDTH; x += VLEN) {
        struct depth_range rows[BLOCK_HEIGHT + 2 * PLANE_BORDER];
        disc_rows(block->in + x, block->stride, shape.reach, rows);
        for (int y = 0; y < BLOCK_HEIGHT; y++) {
            ptrdiff_t at = y * block->stride + x;
            struct pixels pixels = pixels_load(block->in + at, block->range.min);
            vf result = pixels.depth;
            if (vm_any(pixels.fluid)) {
                result = disc_pixels(filter, block, &pixels, x, y, &shape, rows + shape.reach[AXIS_Y] + y, orthographic);
            }
            pixels_store(&pixels, result, block->out + at, &extent);
        }
    }
    return extent_range(&extent);
}

static struct depth_range disc(const struct window_filter *filter, const struct depth_block *block, int axis)
{
    (void)axis;
    return filter->fit->orthographic ? disc_block(filter, block, true) : disc_block(filter, block, false);
}

const struct plane_fit_kernels SIMD_NAME(mns_plane_fit_kernels) = {.disc = disc, .disc_plain = disc};
