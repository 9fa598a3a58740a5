/* smooth.c: stage smooth: depth_raw -> depth, by the filter that the parameters name. */
#include "cpu/cpu.h"

#include "cpu/smooth/filter.h"

typedef void filter_function(struct backend *cpu, const struct frame *frame);

static filter_function *const filters[] = {
    [MNS_FILTER_NONE] = NULL,
    [MNS_FILTER_NARROW_RANGE] = mns_smooth_narrow_range,
    [MNS_FILTER_NARROW_RANGE_1D] = mns_smooth_narrow_range,
    [MNS_FILTER_NARROW_RANGE_1D_CLEANUP] = mns_smooth_narrow_range,
    [MNS_FILTER_GAUSSIAN] = mns_smooth_gaussian,
    [MNS_FILTER_BILATERAL] = mns_smooth_bilateral,
    [MNS_FILTER_BILATERAL_1D] = mns_smooth_bilateral,
    [MNS_FILTER_PLANE_FIT] = mns_smooth_plane_fit,
};

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

mns_result mns_cpu_smooth(struct backend *cpu, const struct frame *frame)
{
    cpu->smoothed = &cpu->depth_raw;
    filter_function *filter = filters[frame->params.filter];
    if (!filter) {
        return MNS_OK;
    }
    for (int i = 0; i < 2; i++) {
        if (!resize(&cpu->depth[i], cpu->host.memory, &frame->view)) {
            return cpu_out_of_memory(cpu);
        }
    }
    for (int i = 0; i < 3 && frame->params.filter == MNS_FILTER_PLANE_FIT; i++) {
        if (!mns_plane_resize(&cpu->depth_normal[i], cpu->host.memory, frame->view.width, frame->view.height, PLANE_BORDER)) {
            return cpu_out_of_memory(cpu);
        }
    }
    filter(cpu, frame);
    return MNS_OK;
}
