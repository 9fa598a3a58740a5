/* smooth.c: stage smooth: depth_raw -> depth, by the filter that the parameters name. */
#include "cpu/cpu.h"

#include "cpu/smooth/filter.h"

#include <string.h>

typedef void filter_function(struct backend *cpu, const struct frame *frame);

static filter_function *const filters[] = {
    [MNS_FILTER_NONE] = NULL,
    [MNS_FILTER_NARROW_RANGE] = mns_smooth_narrow_range,
    [MNS_FILTER_NARROW_RANGE_1D] = mns_smooth_narrow_range,
    [MNS_FILTER_NARROW_RANGE_1D_CLEANUP] = mns_smooth_narrow_range,
    [MNS_FILTER_GAUSSIAN] = mns_smooth_gaussian,
    [MNS_FILTER_BILATERAL] = mns_smooth_bilateral,
    [MNS_FILTER_BILATERAL_1D] = mns_smooth_bilateral,
    [MNS_FILTER_CURVATURE_FLOW] = mns_smooth_curvature_flow,
    [MNS_FILTER_ADAPTIVE_CURVATURE_FLOW] = mns_smooth_curvature_flow,
    [MNS_FILTER_IMPLICIT_CURVATURE_FLOW] = mns_smooth_implicit_flow,
    [MNS_FILTER_PLANE_FIT] = mns_smooth_plane_fit,
    [MNS_FILTER_SMOOTHING_SPLINE] = mns_smooth_spline,
};

bool mns_smooth_resize(struct depth_plane *plane, struct memory *memory, const struct view *view)
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

void mns_smooth_copy_block(const struct depth_plane *in, struct depth_plane *out, int bx, int by)
{
    int index = by * in->blocks_x + bx;
    if (out->ranges[index].min >= DEPTH_LIMIT) {
        return;
    }
    ptrdiff_t at = by * BLOCK_HEIGHT * in->plane.stride + bx * BLOCK_WIDTH;
    for (int y = 0; y < BLOCK_HEIGHT; y++, at += in->plane.stride) {
        memcpy(out->plane.data + at, in->plane.data + at, BLOCK_WIDTH * sizeof(float));
    }
    out->ranges[index] = in->ranges[index];
}

void mns_smooth_copy_empty(struct backend *cpu, const struct depth_plane *start)
{
    for (int i = 0; i < 2; i++) {
        for (int block = 0; block < start->blocks_x * start->blocks_y; block++) {
            if (start->ranges[block].min >= DEPTH_LIMIT) {
                mns_smooth_copy_block(start, &cpu->depth[i], block % start->blocks_x, block / start->blocks_x);
            } else {
                cpu->depth[i].ranges[block] = start->ranges[block];
            }
        }
    }
}

/* Past the picture's edge blocks hold 0, which is not part of their range. */
struct depth_range mns_smooth_range(const struct plane *depth, int bx, int by)
{
    int bottom = depth->height - by * BLOCK_HEIGHT, rows = bottom < BLOCK_HEIGHT ? bottom : BLOCK_HEIGHT;
    int right = depth->width - bx * BLOCK_WIDTH, columns = right < BLOCK_WIDTH ? right : BLOCK_WIDTH;
    const float *at = depth->data + by * BLOCK_HEIGHT * depth->stride + bx * BLOCK_WIDTH;
    float nearest[BLOCK_WIDTH], farthest[BLOCK_WIDTH];
    memcpy(nearest, at, sizeof(nearest));
    memcpy(farthest, at, sizeof(farthest));
    for (int y = 1; y < rows; y++) {
        for (int x = 0; x < BLOCK_WIDTH; x++) {
            float value = at[y * depth->stride + x];
            nearest[x] = value < nearest[x] ? value : nearest[x];
            farthest[x] = value > farthest[x] ? value : farthest[x];
        }
    }
    struct depth_range range = {DEPTH_EMPTY, 0};
    for (int x = 0; x < columns; x++) {
        range.min = nearest[x] < range.min ? nearest[x] : range.min;
        range.max = farthest[x] > range.max ? farthest[x] : range.max;
    }
    return range;
}

static void measure_row(void *context, int by)
{
    struct depth_plane *depth = context;
    for (int bx = 0; bx < depth->blocks_x; bx++) {
        struct depth_range *range = &depth->ranges[by * depth->blocks_x + bx];
        if (range->min < DEPTH_LIMIT) {
            *range = mns_smooth_range(&depth->plane, bx, by);
        }
    }
}

void mns_smooth_measure(struct backend *cpu)
{
    if (cpu->smoothed != &cpu->depth_raw) {
        cpu_run(cpu, measure_row, cpu->smoothed, cpu->smoothed->blocks_y);
    }
}

static bool reserve(struct backend *cpu, const struct frame *frame)
{
    for (int i = 0; i < 2; i++) {
        if (!mns_smooth_resize(&cpu->depth[i], cpu->host.memory, &frame->view)) {
            return false;
        }
    }
    for (int i = 0; i < 3 && frame->params.filter == MNS_FILTER_PLANE_FIT; i++) {
        if (!mns_plane_resize(&cpu->depth_normal[i], cpu->host.memory, frame->view.width, frame->view.height, PLANE_BORDER)) {
            return false;
        }
    }
    if (frame->params.filter == MNS_FILTER_IMPLICIT_CURVATURE_FLOW && !mns_implicit_flow_reserve(cpu)) {
        return false;
    }
    if (frame->params.filter == MNS_FILTER_SMOOTHING_SPLINE && !mns_spline_reserve(cpu)) {
        return false;
    }
    size_t blocks = (size_t)cpu->depth[0].blocks_x * (size_t)cpu->depth[0].blocks_y;
    cpu->block_values = mns_memory_reserve(cpu->host.memory, cpu->block_values, &cpu->block_values_capacity, 3 * blocks, sizeof(float));
    return cpu->block_values != NULL;
}

/* Filters at half or quarter size: everything that they read of the frame in pixels is in its view. */
static mns_result smooth_texels(struct backend *cpu, const struct frame *frame, filter_function *filter)
{
    struct frame small = *frame;
    small.view = mns_resample_view(&frame->view, frame->params.smooth_scale);
    if (!mns_resample_reserve(cpu, frame) || !reserve(cpu, &small)) {
        return cpu_out_of_memory(cpu);
    }
    mns_resample_down(cpu, frame);
    filter(cpu, &small);
    mns_resample_up(cpu, frame);
    return MNS_OK;
}

static bool is_depth(float value) { return value >= 0 && value <= DEPTH_EMPTY; }

/* A job: what is no depth (NaN, infinite, behind the eye) in one row of blocks becomes empty. Splats give no such thing; this holds for any other
 * source of depth, and what it reads the filter finds in the caches. */
static void enter_row(void *context, int by)
{
    struct depth_plane *depth = context;
    ptrdiff_t stride = depth->plane.stride;
    for (int bx = 0; bx < depth->blocks_x; bx++) {
        struct depth_range *range = &depth->ranges[by * depth->blocks_x + bx];
        if (range->min == DEPTH_EMPTY && range->max == DEPTH_EMPTY) {
            continue;
        }
        float *at = depth->plane.data + by * BLOCK_HEIGHT * stride + bx * BLOCK_WIDTH;
        int wrong = 0;
        for (int y = 0; y < BLOCK_HEIGHT; y++) {
            for (int x = 0; x < BLOCK_WIDTH; x++) {
                float value = at[y * stride + x];
                wrong |= !(value >= 0) | !(value <= DEPTH_EMPTY); /* without a branch: vectors */
            }
        }
        for (int i = 0; wrong && i < BLOCK_WIDTH * BLOCK_HEIGHT; i++) {
            float *value = at + i / BLOCK_WIDTH * stride + i % BLOCK_WIDTH;
            *value = is_depth(*value) ? *value : DEPTH_EMPTY;
        }
        if (wrong) {
            *range = mns_smooth_range(&depth->plane, bx, by);
        }
    }
}

mns_result mns_cpu_smooth(struct backend *cpu, const struct frame *frame)
{
    cpu->smoothed = &cpu->depth_raw;
    cpu_run(cpu, enter_row, cpu->smoothed, cpu->smoothed->blocks_y);
    filter_function *filter = filters[frame->params.filter];
    if (!filter) {
        return MNS_OK;
    }
    if (frame->params.smooth_scale > 1) {
        return smooth_texels(cpu, frame, filter);
    }
    if (!reserve(cpu, frame)) {
        return cpu_out_of_memory(cpu);
    }
    filter(cpu, frame);
    return MNS_OK;
}
