/* narrow_range.c: the narrow-range filter: whole (2-D), or along rows and columns in turn, with or without a last 5x5 pass.
 *
 * Based on: [TY18] Truong, Yuksel, "A Narrow-Range Filter for Screen-Space Fluid Rendering", 2018. The kernels do the arithmetic
 * (narrow_range.h); here lengths become pixels and blocks find their kernel. */
#include "cpu/smooth/filter.h"
#include "cpu/smooth/narrow_range.h"

#include <math.h>
#include <string.h>

/* The kernel of the 5x5 pass ends where the first pixel outside it stands, so that it is the widest one of that size. */
static const float SQUARE_END = 3; /* pixels */

static struct narrow_range resolve(const struct frame *frame)
{
    const struct mns_params *params = &frame->params;
    const struct view *view = &frame->view;
    float radius = frame->splat_radius, cut = params->kernel_cut;
    struct narrow_range filter = {
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

enum shape { SHAPE_LINE_X, SHAPE_LINE_Y, SHAPE_DISC, SHAPE_SQUARE };

struct pass {
    struct narrow_range filter;
    const struct depth_plane *in;
    struct depth_plane *out;
    narrow_range_function *kernel, *plain;
    enum shape shape;
};

/* Pixels that taps of a block may be away from it. */
struct reach {
    int x, y;
};

static struct reach block_reach(const struct pass *pass, float nearest)
{
    if (pass->shape == SHAPE_SQUARE) {
        return (struct reach){2, 2};
    }
    int x = narrow_range_reach(&pass->filter, AXIS_X, nearest), y = narrow_range_reach(&pass->filter, AXIS_Y, nearest);
    int ring = x > y ? x : y;
    return pass->shape == SHAPE_LINE_X   ? (struct reach){x, 0}
           : pass->shape == SHAPE_LINE_Y ? (struct reach){0, y}
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

/* Whether the plain kernel does: narrow_range.h. */
static bool is_plain(const struct narrow_range *filter, const struct depth_block *block)
{
    return block->around.max - block->around.min <= filter->delta && block->range.max - block->range.min <= PLAIN_SPREAD * block->range.min;
}

/* A block without fluid. What is empty in out already is left alone: most of it is, from the last pass or the last picture. */
static void copy_empty(const struct depth_block *block, struct depth_range *out)
{
    if (out->min >= DEPTH_LIMIT) {
        return;
    }
    for (int y = 0; y < BLOCK_HEIGHT; y++) {
        memcpy(block->out + y * block->stride, block->in + y * block->stride, BLOCK_WIDTH * sizeof(float));
    }
    *out = block->range;
}

static void run_block(const struct pass *pass, int bx, int by)
{
    int index = by * pass->in->blocks_x + bx;
    ptrdiff_t stride = pass->in->plane.stride, at = by * BLOCK_HEIGHT * stride + bx * BLOCK_WIDTH;
    struct depth_block block = {
        .in = pass->in->plane.data + at, .out = pass->out->plane.data + at, .stride = stride, .range = pass->in->ranges[index]};
    if (block.range.min >= DEPTH_LIMIT) {
        copy_empty(&block, &pass->out->ranges[index]);
        return;
    }
    block.around = depths_around(pass, bx, by, block.range.min);
    narrow_range_function *kernel = is_plain(&pass->filter, &block) ? pass->plain : pass->kernel;
    pass->out->ranges[index] = kernel(&pass->filter, &block, pass->shape == SHAPE_LINE_Y ? AXIS_Y : AXIS_X);
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

/* Whether any depth is less than delta. No pass brings fluid nearer than the nearest there was, but for rounding. */
static bool any_at_lens(const struct depth_plane *plane, float delta)
{
    float nearest = DEPTH_EMPTY;
    for (int i = 0; i < plane->blocks_x * plane->blocks_y; i++) {
        nearest = lesser(nearest, plane->ranges[i].min);
    }
    return nearest < 1.001f * delta;
}

/* From cpu->smoothed to the other plane, which then is cpu->smoothed. */
static void run_pass(struct backend *cpu, struct pass *pass, enum shape shape)
{
    const struct narrow_range_kernels *kernels = cpu->kernels->smooth->narrow_range;
    pass->shape = shape;
    pass->kernel = shape == SHAPE_DISC ? kernels->disc : shape == SHAPE_SQUARE ? kernels->square : kernels->line;
    pass->plain = shape == SHAPE_DISC ? kernels->disc_plain : shape == SHAPE_SQUARE ? kernels->square_plain : kernels->line_plain;
    pass->in = cpu->smoothed;
    pass->out = cpu->smoothed == &cpu->depth[0] ? &cpu->depth[1] : &cpu->depth[0];
    cpu_run(cpu, run_row, pass, pass->in->blocks_y);
    cpu->smoothed = pass->out;
}

/* Gives a plane its size; where that changes it, or its ranges are new, no block passes for empty. */
static bool resize(struct depth_plane *plane, struct memory *memory, const struct view *view)
{
    const struct depth_range *ranges = plane->ranges;
    bool same = plane->plane.width == view->width && plane->plane.height == view->height;
    if (!mns_depth_plane_resize(plane, memory, view->width, view->height)) {
        return false;
    }
    same = same && plane->ranges == ranges;
    for (int i = 0; !same && i < plane->blocks_x * plane->blocks_y; i++) {
        plane->ranges[i] = (struct depth_range){0, 0};
    }
    return true;
}

mns_result mns_smooth_narrow_range(struct backend *cpu, const struct frame *frame)
{
    for (int i = 0; i < 2; i++) {
        if (!resize(&cpu->depth[i], cpu->host.memory, &frame->view)) {
            return cpu_out_of_memory(cpu);
        }
    }
    struct pass pass = {.filter = resolve(frame)};
    pass.filter.at_lens = any_at_lens(&cpu->depth_raw, pass.filter.delta);
    for (int i = 0; i < frame->params.iterations; i++) {
        if (frame->params.filter == MNS_FILTER_NARROW_RANGE) {
            run_pass(cpu, &pass, SHAPE_DISC);
        } else {
            run_pass(cpu, &pass, SHAPE_LINE_X);
            run_pass(cpu, &pass, SHAPE_LINE_Y);
        }
    }
    if (frame->params.filter == MNS_FILTER_NARROW_RANGE_1D_CLEANUP) {
        run_pass(cpu, &pass, SHAPE_SQUARE);
    }
    return MNS_OK;
}
