/* plane_fit.c: the plane-fit filter over simd.h. The arithmetic is that of cpu/scalar/plane_fit.c, with these differences: the exponential is
 * a polynomial; taps are added with their mirrors; all lanes go as far as the widest kernel of the block, with weight 0 beyond their own. */
#include "cpu/smooth/plane_fit.h"

#include "cpu/simd/window.h"

/* Sums over the taps, as in plain C; row: what the taps of one row add to y, per pixel that it is away. */
struct sums {
    vf weights, depth, x, y, row;
    vf normal[3];
};

/* What does not change from tap to tap. */
struct centre {
    vf depth, delta, inverse_delta;
    const float *at, *normal[3]; /* the first pixel and its normal */
};

/* A tap, dx pixels to the right and `tap` floats on, and its mirror. */
SIMD void sums_add(struct sums *sums, const struct centre *centre, vf weight, int dx, ptrdiff_t tap, enum taps taps, bool orthographic)
{
    vf a = vf_loadu(centre->at + tap), b = vf_loadu(centre->at - tap);
    if (taps == TAPS_BORDER) {
        weight = vf_keep(both_inside(a, b), weight);
    }
    vf from_a = from_pixel(a, centre->depth, centre->delta, taps), from_b = from_pixel(b, centre->depth, centre->delta, taps);
    vf t_a = from_a * centre->inverse_delta, t_b = from_b * centre->inverse_delta;
    vf weight_a = weight * range_weight(t_a * t_a), weight_b = weight * range_weight(t_b * t_b);
    sums->weights = sums->weights + weight_a + weight_b;
    sums->depth = vf_fma(from_b, weight_b, vf_fma(from_a, weight_a, sums->depth));
    for (int c = 0; c < 3; c++) {
        const float *normal = centre->normal[c];
        sums->normal[c] = vf_fma(vf_loadu(normal - tap), weight_b, vf_fma(vf_loadu(normal + tap), weight_a, sums->normal[c]));
    }
    if (!orthographic) {
        weight_a = weight_a * (centre->depth + from_a);
        weight_b = weight_b * (centre->depth + from_b);
    }
    sums->x = vf_fma(weight_a - weight_b, vf_set1((float)dx), sums->x);
    sums->row = sums->row + (weight_a - weight_b);
}

SIMD vf meet(const struct window_filter *filter, const struct sums *sums, vf depth, int x, int y)
{
    const struct plane_fit *fit = filter->fit;
    const vf *n = sums->normal;
    vf inverse = vf_rcp(sums->weights), mean = vf_fma(sums->depth, inverse, depth), ray_x = vf_zero(), ray_y = vf_zero();
    if (!fit->orthographic) {
        ray_x = (vf_iota() + vf_set1((float)x + 0.5f - fit->cx)) * vf_set1(fit->step_x);
        ray_y = vf_set1(((float)y + 0.5f - fit->cy) * fit->step_y);
    }
    vf facing = vf_fma(n[0], ray_x, vf_fma(n[1], ray_y, n[2]));
    vf lean = vf_fma(n[0] * vf_set1(fit->step_x), sums->x, n[1] * vf_set1(fit->step_y) * sums->y);
    vf square = vf_fma(n[0], n[0], vf_fma(n[1], n[1], n[2] * n[2]));
    vf ray = vf_fma(ray_x, ray_x, vf_fma(ray_y, ray_y, vf_set1(1.0f)));
    vm meets = vf_gt(facing * facing, square * ray * vf_set1(PLANE_FIT_GRAZING * PLANE_FIT_GRAZING));
    vf delta = vf_set1(filter->delta), met = vf_fma(lean * inverse, vf_rcp(facing), mean);
    met = vf_max(vf_min(met, mean + delta), vf_max(mean - delta, mean * vf_set1(0.5f)));
    return vf_select(meets, met, mean);
}

SIMD vf disc_pixels(const struct window_filter *filter, const struct depth_block *block, vf depth, int column, int row, const int reach[2],
                    enum taps taps, bool orthographic)
{
    vf along_x[PLANE_BORDER], along_y[PLANE_BORDER];
    gaussian_table(exponent(filter, AXIS_X, depth), reach[AXIS_X], along_x);
    gaussian_table(exponent(filter, AXIS_Y, depth), reach[AXIS_Y], along_y);
    ptrdiff_t stride = block->stride, at = (block->y + row) * stride + block->x + column;
    struct centre centre = {depth, vf_set1(filter->delta), vf_set1(1.0f / filter->delta), block->in + row * stride + column, {0}};
    vf own = vf_set1((1.0f - filter->weight_cut) * (1.0f - RANGE_END));
    struct sums sums = {own, vf_zero(), vf_zero(), vf_zero(), vf_zero(), {vf_zero(), vf_zero(), vf_zero()}};
    for (int c = 0; c < 3; c++) {
        centre.normal[c] = filter->fit->normal[c] + at;
        sums.normal[c] = vf_load(centre.normal[c]) * own;
    }
    for (int y = 0; y <= reach[AXIS_Y]; y++) {
        int end = row_reach(filter, reach, block->range.min, y);
        for (int x = y ? -end : 1; x <= end; x++) { /* half of the taps; their mirrors are the others */
            vf weight = weight_above_cut(along_x[absolute(x)] * along_y[y], filter);
            sums_add(&sums, &centre, weight, x, y * stride + x, taps, orthographic);
        }
        sums.y = vf_fma(sums.row, vf_set1((float)y), sums.y);
        sums.row = vf_zero();
    }
    return meet(filter, &sums, depth, block->x + column, block->y + row);
}

SIMD struct depth_range disc_block(const struct window_filter *filter, const struct depth_block *block, enum taps taps, bool orthographic)
{
    struct extent extent = extent_start();
    const int reach[2] = {window_reach(filter, AXIS_X, block->range.min), window_reach(filter, AXIS_Y, block->range.min)};
    for (int y = 0; y < BLOCK_HEIGHT; y++) {
        for (int x = 0; x < BLOCK_WIDTH; x += VLEN) {
            ptrdiff_t at = y * block->stride + x;
            struct pixels pixels = pixels_load(block->in + at, block->range.min);
            vf result = pixels.depth;
            if (vm_any(pixels.fluid)) {
                result = disc_pixels(filter, block, pixels.depth, x, y, reach, taps, orthographic);
            }
            pixels_store(&pixels, result, block->out + at, &extent);
        }
    }
    return extent_range(&extent);
}

static struct depth_range disc(const struct window_filter *filter, const struct depth_block *block, int axis)
{
    (void)axis;
    return filter->fit->orthographic ? disc_block(filter, block, TAPS_BORDER, true) : disc_block(filter, block, TAPS_BORDER, false);
}

static struct depth_range disc_plain(const struct window_filter *filter, const struct depth_block *block, int axis)
{
    (void)axis;
    return filter->fit->orthographic ? disc_block(filter, block, TAPS_PLAIN, true) : disc_block(filter, block, TAPS_PLAIN, false);
}

const struct plane_fit_kernels SIMD_NAME(mns_plane_fit_kernels) = {.disc = disc, .disc_plain = disc_plain};
