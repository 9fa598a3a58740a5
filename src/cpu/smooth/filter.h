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
void mns_smooth_curvature_flow(struct backend *cpu, const struct frame *frame); /* curvature-flow, adaptive-curvature-flow */
void mns_smooth_implicit_flow(struct backend *cpu, const struct frame *frame);
void mns_smooth_spline(struct backend *cpu, const struct frame *frame);

/* The plane of cpu->depth that a pass from cpu->smoothed writes to. */
static inline struct depth_plane *smooth_target(struct backend *cpu)
{
    return cpu->smoothed == &cpu->depth[0] ? &cpu->depth[1] : &cpu->depth[0];
}

/* Copies a block without fluid. What is empty in out already is left alone: most of it is, from the last pass or the last picture. */
void mns_smooth_copy_block(const struct depth_plane *in, struct depth_plane *out, int bx, int by);

/* For filters that pass over blocks without fluid, before their first step: copies those of start to both planes of cpu->depth. */
void mns_smooth_copy_empty(struct backend *cpu, const struct depth_plane *start);

/* ... and after their last: the ranges of cpu->smoothed. */
void mns_smooth_measure(struct backend *cpu);

/* The range of one block. */
struct depth_range mns_smooth_range(const struct plane *depth, int bx, int by);

/* Gives a plane its size; where that changes it, or its ranges are new, no block passes for empty. */
bool mns_smooth_resize(struct depth_plane *plane, struct memory *memory, const struct view *view);

/* Smoothing at part of the size (resample.h): the view of the texels; the planes it needs; cpu->depth_raw to texels in cpu->smoothed; and the
 * smoothed texels back to pixels there. */
struct view mns_resample_view(const struct view *view, int scale);
bool mns_resample_reserve(struct backend *cpu, const struct frame *frame); /* false: out of memory */
void mns_resample_down(struct backend *cpu, const struct frame *frame);
void mns_resample_up(struct backend *cpu, const struct frame *frame);
void mns_resample_destroy(struct backend *cpu);

/* Memory of the filters that solve rows and columns, after the planes have their size. false: out of memory. */
bool mns_implicit_flow_reserve(struct backend *cpu);
bool mns_spline_reserve(struct backend *cpu);

#endif
