/* plane_fit.c: the plane-fit filter in plain C. */
#include "cpu/smooth/plane_fit.h"

#include "cpu/scalar/window.h"

/* Sums over the taps. */
struct sums {
    float weights, depth; /* depth: relative to the pixel's */
    float x, y;           /* positions relative to the points of the pixel's ray at the same depths, times fx and fy */
    float normal[3];
};

/* One tap, dx and dy pixels from the centre; normal: at the tap. */
static void sums_add(const struct window_filter *filter, struct sums *sums, float weight, float depth, float sample, int dx, int dy,
                     const float *const normal[3])
{
    float from = sample - depth, t = from / filter->delta;
    if (t * t < 1) {
        weight *= expf(-RANGE_FALL * t * t) - RANGE_END;
        float scaled = filter->fit->orthographic ? weight : weight * sample;
        sums->weights += weight;
        sums->depth += weight * from;
        sums->x += scaled * (float)dx;
        sums->y += scaled * (float)dy;
        for (int c = 0; c < 3; c++) {
            sums->normal[c] += weight * *normal[c];
        }
    }
}

/* Pixel (x, y)'s new depth. */
static float meet(const struct window_filter *filter, const struct sums *sums, float depth, int x, int y)
{
    const struct plane_fit *fit = filter->fit;
    const float *n = sums->normal;
    float mean = depth + sums->depth / sums->weights;
    float ray_x = fit->orthographic ? 0 : ((float)x + 0.5f - fit->cx) * fit->step_x;
    float ray_y = fit->orthographic ? 0 : ((float)y + 0.5f - fit->cy) * fit->step_y;
    float facing = n[0] * ray_x + n[1] * ray_y + n[2], lean = n[0] * sums->x * fit->step_x + n[1] * sums->y * fit->step_y;
    float least = PLANE_FIT_GRAZING * PLANE_FIT_GRAZING * (n[0] * n[0] + n[1] * n[1] + n[2] * n[2]) * (ray_x * ray_x + ray_y * ray_y + 1);
    if (!(facing * facing > least)) {
        return mean;
    }
    return greater(lesser(mean + lean / (facing * sums->weights), mean + filter->delta), greater(mean - filter->delta, 0.5f * mean));
}

static float disc_pixel(const struct window_filter *filter, const struct depth_block *block, int column, int row)
{
    ptrdiff_t stride = block->stride, at = (block->y + row) * stride + block->x + column;
    const float *in = block->in + row * stride + column;
    int reach_x = window_reach(filter, AXIS_X, *in), reach_y = window_reach(filter, AXIS_Y, *in);
    float along_x[PLANE_BORDER], along_y[PLANE_BORDER];
    gaussian_table(filter, AXIS_X, *in, reach_x, along_x);
    gaussian_table(filter, AXIS_Y, *in, reach_y, along_y);
    struct sums sums = {0};
    for (int y = -reach_y; y <= reach_y; y++) {
        for (int x = -reach_x; x <= reach_x; x++) {
            ptrdiff_t tap = y * stride + x;
            float weight = along_x[x < 0 ? -x : x] * along_y[y < 0 ? -y : y] - filter->weight_cut;
            if (weight > 0 && in[tap] > 0 && in[-tap] > 0) {
                const float *const normal[3] = {filter->fit->normal[0] + at + tap, filter->fit->normal[1] + at + tap,
                                                filter->fit->normal[2] + at + tap};
                sums_add(filter, &sums, weight, *in, in[tap], x, y, normal);
            }
        }
    }
    return meet(filter, &sums, *in, block->x + column, block->y + row);
}

static struct depth_range disc(const struct window_filter *filter, const struct depth_block *block, int axis)
{
    (void)axis;
    struct depth_range range = {DEPTH_EMPTY, 0};
    for (int y = 0; y < BLOCK_HEIGHT; y++) {
        for (int x = 0; x < BLOCK_WIDTH; x++) {
            float depth = block->in[y * block->stride + x], *out = block->out + y * block->stride + x;
            *out = depth > 0 && depth < DEPTH_LIMIT ? disc_pixel(filter, block, x, y) : depth;
            range.min = depth > 0 ? lesser(range.min, *out) : range.min;
            range.max = greater(range.max, *out);
        }
    }
    return range;
}

const struct plane_fit_kernels mns_plane_fit_kernels_scalar = {.disc = disc, .disc_plain = disc};
