/* smooth.c: stage smooth: depth_raw -> depth, by the filter that the parameters name. */
#include "cpu/cpu.h"

#include "cpu/smooth/filter.h"

typedef mns_result filter_function(struct backend *cpu, const struct frame *frame);

static filter_function *const filters[] = {
    [MNS_FILTER_NONE] = NULL,
    [MNS_FILTER_NARROW_RANGE] = mns_smooth_narrow_range,
    [MNS_FILTER_NARROW_RANGE_1D] = mns_smooth_narrow_range,
    [MNS_FILTER_NARROW_RANGE_1D_CLEANUP] = mns_smooth_narrow_range,
};

mns_result mns_cpu_smooth(struct backend *cpu, const struct frame *frame)
{
    cpu->smoothed = &cpu->depth_raw;
    filter_function *filter = filters[frame->params.filter];
    return filter ? filter(cpu, frame) : MNS_OK;
}
