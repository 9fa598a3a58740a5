/* window.c: the lengths of window filters, and passes over the picture: blocks find their kernel here, the kernels do the arithmetic. */
#include "cpu/smooth/window.h"

#include "cpu/smooth/filter.h"

#include <math.h>

/* The kernel of the 5x5 pass ends where the first pixel outside it stands, so that it is the widest one of that size. */
static const float SQUARE_END = 3; /* pixels */

struct window_filter mns_window_resolve(const struct frame *frame)
{
    const struct mns_params *params = &frame->params;
    const struct view *view = &frame->view;
    float radius = frame->splat_radius, cut = params->kernel_cut;
    struct window_filter filter = {
        .delta = params->delta * radius,
        .mu = params->mu * radius,
        .grow = params->dynamic_range ? params->delta * radius : -RANGE_FIXED,
        .cut = cut,
        .weight_cut = expf(-0.5f * cut * cut),
        .sigma_max = (float)(PLANE_BORDER - 1) / cut,
        .bias_correction = params->bias_correction != 0,
    };
    const float focal[2] = {[AXIS_X] = view->fx, [AXIS_Y] = view->fy};
    for (int axis = 0; axis < 2; axis++) {
        float inverse = 1.0f / (params->sigma * radius * fabsf(focal[axis])); /* eq. 5 */
        filter.inverse[axis].slope = view->orthographic ? 0 : inverse;
        filter.inverse[axis].offset = view->orthographic ? inverse : 0;
    }
    float sigma = SQUARE_END / cut;
    for (int y = 0; y < 3; y++) {
        for (int x = 0; x < 3; x++) {
            filter.square[y][x] = greater(expf(-0.5f * (float)(x * x + y * y) / (sigma * sigma)) - filter.weight_cut, 0);
        }
    }
    return filter;
}

struct pass {
    const struct window_filter *filter;
    const struct depth_plane *in;
    struct depth_plane *out;
    window_function *kernel, *plain;
    enum window_shape shape;
};

/* Pixels that taps of a block may be away from it. */
struct reach {
    int x, y;
};

static struct reach block_reach(const struct pass *pass, float nearest)
{
    if (pass->shape == WINDOW_SQUARE) {
        return (struct reach){2, 2};
    }
    int x = window_reach(pass->filter, AXIS_X, nearest), y = window_reach(pass->filter, AXIS_Y, nearest);
    int ring = x > y ? x : y;
    return pass->shape == WINDOW_LINE_X   ? (struct reach){x, 0}
           : pass->shape == WINDOW_LINE_Y ? (struct reach){0, y}
                                          : (struct reach){ring, ring};
}

/* Bounds on what taps of block (bx, by) meet: depth_block.around. */
static struct depth_range depths_around(const struct pass *pass, int bx, int by, float nearest)
{
    const struct depth_plane *in = pass->in;
    struct reach reach = block_reach(pass, nearest);
    int left = bx * BLOCK_WIDTH - reach.x, right = bx * BLOCK_WIDTH + BLOCK_WIDTH - 1 + reach.x;
    int top = by * BLOCK_HEIGHT - reach.y, bottom = by * BLOCK_HEIGHT + BLOCK_HEIGHT - 1 + reach.y;
    if (left < 0 || right >= in->plane.width || top < 0 || bottom >= in->plane.height) {
        return (struct depth_range){0, DEPTH_EMPTY};
    }
    struct depth_range around = {DEPTH_EMPTY, 0};
    for (int y = top / BLOCK_HEIGHT; y <= bottom / BLOCK_HEIGHT; y++) {
        for (int x = left / BLOCK_WIDTH; x <= right / BLOCK_WIDTH; x++) {
            const struct depth_range *other = &in->ranges[y * in->blocks_x + x];
            around.min = lesser(around.min, other->min);
            around.max = greater(around.max, other->max);
        }
    }
    return around;
}

/* Whether the plain kernel does: window.h. */
static bool is_plain(const struct window_filter *filter, const struct depth_block *block)
{
    return block->around.max - block->around.min <= filter->delta && block->range.max - block->range.min <= PLAIN_SPREAD * block->range.min;
}

static void run_block(const struct pass *pass, int bx, int by)
{
    int index = by * pass->in->blocks_x + bx;
    ptrdiff_t stride = pass->in->plane.stride, at = by * BLOCK_HEIGHT * stride + bx * BLOCK_WIDTH;
    struct depth_block block = {.in = pass->in->plane.data + at,
                                .out = pass->out->plane.data + at,
                                .stride = stride,
                                .range = pass->in->ranges[index],
                                .x = bx * BLOCK_WIDTH,
                                .y = by * BLOCK_HEIGHT};
    if (block.range.min >= DEPTH_LIMIT) {
        mns_smooth_copy_block(pass->in, pass->out, bx, by);
        return;
    }
    block.around = depths_around(pass, bx, by, block.range.min);
    window_function *kernel = is_plain(pass->filter, &block) ? pass->plain : pass->kernel;
    pass->out->ranges[index] = kernel(pass->filter, &block, pass->shape == WINDOW_LINE_Y ? AXIS_Y : AXIS_X);
}

/* A job: one row of blocks. Along columns too: narrow tall tiles, which keep a column's lines in the nearest cache, were slower by a
 * third, since each new line then comes from memory by itself. */
static void run_row(void *context, int by)
{
    const struct pass *pass = context;
    for (int bx = 0; bx < pass->in->blocks_x; bx++) {
        run_block(pass, bx, by);
    }
}

void mns_window_pass(struct backend *cpu, const struct window_filter *filter, enum window_shape shape, window_function *kernel,
                     window_function *plain)
{
    struct pass pass = {.filter = filter, .in = cpu->smoothed, .out = smooth_target(cpu), .kernel = kernel, .plain = plain, .shape = shape};
    cpu_run(cpu, run_row, &pass, pass.in->blocks_y);
    cpu->smoothed = pass.out;
}
