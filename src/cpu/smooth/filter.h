/* filter.h: the filters of stage smooth, one file each.
 *
 * A filter takes the depth from cpu->smoothed, which it leaves alone, works in cpu->depth[0] and cpu->depth[1], which have its size, and
 * leaves cpu->smoothed at the plane of its result, ranges included. */
#ifndef MNS_CPU_SMOOTH_FILTER_H
#define MNS_CPU_SMOOTH_FILTER_H

#include "cpu/cpu.h"

void mns_smooth_narrow_range(struct backend *cpu, const struct frame *frame); /* all three */
void mns_smooth_gaussian(struct backend *cpu, const struct frame *frame);
void mns_smooth_bilateral(struct backend *cpu, const struct frame *frame); /* both */
void mns_smooth_plane_fit(struct backend *cpu, const struct frame *frame);

/* The plane of cpu->depth that a pass from cpu->smoothed writes to. */
static inline struct depth_plane *smooth_target(struct backend *cpu)
{
    return cpu->smoothed == &cpu->depth[0] ? &cpu->depth[1] : &cpu->depth[0];
}

#endif
