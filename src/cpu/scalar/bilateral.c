/* bilateral.c: the bilateral filter in plain C. */
#include "cpu/smooth/bilateral.h"

#include "cpu/scalar/window.h"

struct mean {
    float depth, inverse_delta;
    float sum, weights; /* sum relative to depth */
};

static struct mean mean_start(const struct window_filter *filter, float depth)
{
    return (struct mean){.depth = depth, .inverse_delta = 1 / filter->delta, .weights = (1 - filter->weight_cut) * (1 - RANGE_END)};
}

static void mean_add(struct mean *mean, float weight, float sample)
{
    float t = (sample - mean->depth) * mean->inverse_delta, square = t * t;
    if (square < 1) {
        weight *= expf(-RANGE_FALL * square) - RANGE_END;
        mean->sum += weight * (sample - mean->depth);
        mean->weights += weight;
    }
}

/* A sample and its mirror. */
static void mean_add_pair(struct mean *mean, float weight, float a, float b)
{
    if (a > 0 && b > 0) {
        mean_add(mean, weight, a);
        mean_add(mean, weight, b);
    }
}

static float mean_result(const struct mean *mean) { return mean->depth + mean->sum / mean->weights; }

static float line_pixel(const struct window_filter *filter, const float *in, ptrdiff_t step, int axis)
{
    struct mean mean = mean_start(filter, *in);
    int reach = window_reach(filter, axis, *in);
    struct gaussian g = gaussian_start(window_sigma(filter, axis, *in));
    for (ptrdiff_t i = 1; i <= reach; i++, gaussian_step(&g)) {
        mean_add_pair(&mean, greater(g.weight - filter->weight_cut, 0), in[i * step], in[-i * step]);
    }
    return mean_result(&mean);
}

static float disc_pixel(const struct window_filter *filter, const float *in, ptrdiff_t stride, int axis)
{
    (void)axis;
    int reach_x = window_reach(filter, AXIS_X, *in), reach_y = window_reach(filter, AXIS_Y, *in);
    float along_x[PLANE_BORDER], along_y[PLANE_BORDER];
    gaussian_table(filter, AXIS_X, *in, reach_x, along_x);
    gaussian_table(filter, AXIS_Y, *in, reach_y, along_y);
    struct mean mean = mean_start(filter, *in);
    for (int y = 0; y <= reach_y; y++) {
        for (int x = y ? -reach_x : 1; x <= reach_x; x++) { /* half of the taps; their mirrors are the others */
            float weight = greater(along_x[x < 0 ? -x : x] * along_y[y] - filter->weight_cut, 0);
            mean_add_pair(&mean, weight, in[y * stride + x], in[-y * stride - x]);
        }
    }
    return mean_result(&mean);
}

static struct depth_range line(const struct window_filter *filter, const struct depth_block *block, int axis)
{
    return each_pixel(filter, block, axis == AXIS_X ? 1 : block->stride, axis, line_pixel);
}

static struct depth_range disc(const struct window_filter *filter, const struct depth_block *block, int axis)
{
    return each_pixel(filter, block, block->stride, axis, disc_pixel);
}

/* The exponentials cost so much more than the tests that one definition serves both. */
const struct bilateral_kernels mns_bilateral_kernels_scalar = {.line = line, .line_plain = line, .disc = disc, .disc_plain = disc};
