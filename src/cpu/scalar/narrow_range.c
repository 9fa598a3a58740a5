/* narrow_range.c: the narrow-range filter in plain C.
 *
 * Based on: [TY18] Truong, Yuksel, "A Narrow-Range Filter for Screen-Space Fluid Rendering", 2018. */
#include "cpu/smooth/narrow_range.h"

#include "cpu/scalar/window.h"

/* What a sample's depth, relative to the pixel's, may be: eq. 7 with -near for delta_high and far for delta_low. */
struct bounds {
    float near, far;
    float floor; /* near stays above it, so that what is outside the picture (0) is too near however wide the range grew */
};

static struct bounds bounds_start(const struct window_filter *filter, float depth)
{
    float floor = -0.999999f * depth;
    return (struct bounds){.near = greater(-filter->delta, floor), .far = filter->delta, .floor = floor};
}

/* Eq. 8, 9: a sample in range widens it. */
static void bounds_widen(const struct window_filter *filter, struct bounds *bounds, float sample)
{
    bounds->near = greater(lesser(bounds->near, sample - filter->grow), bounds->floor);
    bounds->far = greater(bounds->far, sample + filter->grow);
}

/* The numerator and the denominator of eq. 1. */
struct mean {
    float sum, weights;
};

/* What takes a sample's mirror with it: too near a sample, with bias correction (eq. 6); else (eq. 3) only what is outside the picture. */
static float pair_bound(const struct window_filter *filter, const struct bounds *bounds)
{
    return filter->bias_correction ? bounds->near : bounds->floor;
}

/* A sample and its mirror, relative to the pixel's depth. */
static void mean_add(const struct window_filter *filter, struct mean *mean, float weight, float a, const struct bounds *bounds_a, float b,
                     const struct bounds *bounds_b)
{
    float weight_a = a < bounds_a->near || b < pair_bound(filter, bounds_b) ? 0 : weight;
    float weight_b = b < bounds_b->near || a < pair_bound(filter, bounds_a) ? 0 : weight;
    float value_a = a > bounds_a->far ? filter->mu : a; /* eq. 2 */
    float value_b = b > bounds_b->far ? filter->mu : b;
    mean->sum += weight_a * value_a + weight_b * value_b;
    mean->weights += weight_a + weight_b;
}

static bool in_range(const struct bounds *bounds, float sample) { return sample >= bounds->near && sample <= bounds->far; }

static float line_pixel(const struct window_filter *filter, const float *in, ptrdiff_t step, int axis)
{
    float depth = *in;
    struct bounds ahead = bounds_start(filter, depth), behind = ahead;
    struct mean mean = {.weights = 1 - filter->weight_cut};
    int reach = window_reach(filter, axis, depth);
    struct gaussian g = gaussian_start(window_sigma(filter, axis, depth));
    for (ptrdiff_t i = 1; i <= reach; i++, gaussian_step(&g)) {
        float a = in[i * step] - depth, b = in[-i * step] - depth;
        mean_add(filter, &mean, greater(g.weight - filter->weight_cut, 0), a, &ahead, b, &behind);
        if (in_range(&ahead, a)) {
            bounds_widen(filter, &ahead, a);
        }
        if (in_range(&behind, b)) {
            bounds_widen(filter, &behind, b);
        }
    }
    return depth + mean.sum / mean.weights;
}

static float line_plain_pixel(const struct window_filter *filter, const float *in, ptrdiff_t step, int axis)
{
    struct mean mean = {.weights = 1 - filter->weight_cut};
    int reach = window_reach(filter, axis, *in);
    struct gaussian g = gaussian_start(window_sigma(filter, axis, *in));
    for (ptrdiff_t i = 1; i <= reach; i++, gaussian_step(&g)) {
        float weight = greater(g.weight - filter->weight_cut, 0);
        mean.sum += weight * ((in[i * step] - *in) + (in[-i * step] - *in));
        mean.weights += 2 * weight;
    }
    return *in + mean.sum / mean.weights;
}

/* One 2-D pixel: rings of growing distance max(|dx|, |dy|) from the centre outwards, one pair of bounds. All taps of a ring are tested
 * against the bounds that the ring before it left, so that no order inside a ring, and no mirror, changes the result. Every tap of a
 * ring counts for the bounds, also those in its corners that have no weight: sigma alone never moves a bound. */
struct disc {
    float depth;
    struct bounds bounds, next;
    struct mean mean;
};

static void disc_add(const struct window_filter *filter, struct disc *disc, float weight, float a, float b)
{
    a -= disc->depth;
    b -= disc->depth;
    mean_add(filter, &disc->mean, weight, a, &disc->bounds, b, &disc->bounds);
    if (in_range(&disc->bounds, a)) {
        bounds_widen(filter, &disc->next, a);
    }
    if (in_range(&disc->bounds, b)) {
        bounds_widen(filter, &disc->next, b);
    }
}

static struct disc disc_start(const struct window_filter *filter, float depth, float own_weight)
{
    struct bounds bounds = bounds_start(filter, depth);
    return (struct disc){.depth = depth, .bounds = bounds, .next = bounds, .mean = {.weights = own_weight}};
}

static float disc_pixel(const struct window_filter *filter, const float *in, ptrdiff_t stride, int axis)
{
    (void)axis;
    int reach_x = window_reach(filter, AXIS_X, *in), reach_y = window_reach(filter, AXIS_Y, *in);
    int reach = reach_x > reach_y ? reach_x : reach_y;
    float along_x[PLANE_BORDER], along_y[PLANE_BORDER];
    gaussian_table(filter, AXIS_X, *in, reach, along_x);
    gaussian_table(filter, AXIS_Y, *in, reach, along_y);
    struct disc disc = disc_start(filter, *in, 1 - filter->weight_cut);
    for (int ring = 1; ring <= reach; ring++) {
        for (int x = -ring; x <= ring; x++) { /* its lower and upper side */
            float weight = greater(along_x[x < 0 ? -x : x] * along_y[ring] - filter->weight_cut, 0);
            disc_add(filter, &disc, weight, in[ring * stride + x], in[-ring * stride - x]);
        }
        for (int y = 1 - ring; y < ring; y++) { /* its right and left side */
            float weight = greater(along_x[ring] * along_y[y < 0 ? -y : y] - filter->weight_cut, 0);
            disc_add(filter, &disc, weight, in[y * stride + ring], in[-y * stride - ring]);
        }
        disc.bounds = disc.next;
    }
    return disc.depth + disc.mean.sum / disc.mean.weights;
}

static float square_pixel(const struct window_filter *filter, const float *in, ptrdiff_t stride, int axis)
{
    (void)axis;
    struct disc disc = disc_start(filter, *in, filter->square[0][0]);
    for (int ring = 1; ring <= 2; ring++) {
        for (int x = -ring; x <= ring; x++) {
            disc_add(filter, &disc, filter->square[ring][x < 0 ? -x : x], in[ring * stride + x], in[-ring * stride - x]);
        }
        for (int y = 1 - ring; y < ring; y++) {
            disc_add(filter, &disc, filter->square[y < 0 ? -y : y][ring], in[y * stride + ring], in[-y * stride - ring]);
        }
        disc.bounds = disc.next;
    }
    return disc.depth + disc.mean.sum / disc.mean.weights;
}

static struct depth_range line(const struct window_filter *filter, const struct depth_block *block, int axis)
{
    return each_pixel(filter, block, axis == AXIS_X ? 1 : block->stride, axis, line_pixel);
}

static struct depth_range line_plain(const struct window_filter *filter, const struct depth_block *block, int axis)
{
    return each_pixel(filter, block, axis == AXIS_X ? 1 : block->stride, axis, line_plain_pixel);
}

static struct depth_range disc(const struct window_filter *filter, const struct depth_block *block, int axis)
{
    return each_pixel(filter, block, block->stride, axis, disc_pixel);
}

static struct depth_range square(const struct window_filter *filter, const struct depth_block *block, int axis)
{
    return each_pixel(filter, block, block->stride, axis, square_pixel);
}

/* In two dimensions the tests cost little beside the rest of the plain loop: one definition serves both. */
const struct narrow_range_kernels mns_narrow_range_kernels_scalar = {
    .line = line, .line_plain = line_plain, .disc = disc, .disc_plain = disc, .square = square, .square_plain = square};
