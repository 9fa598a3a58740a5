/* filter.h: the filters of stage smooth, one file each.
 *
 * A filter reads cpu->depth_raw, works in cpu->depth[0] and cpu->depth[1] and leaves cpu->smoothed at the plane of its result, ranges
 * included. */
#ifndef MNS_CPU_SMOOTH_FILTER_H
#define MNS_CPU_SMOOTH_FILTER_H

#include "cpu/cpu.h"

mns_result mns_smooth_narrow_range(struct backend *cpu, const struct frame *frame);

#endif
