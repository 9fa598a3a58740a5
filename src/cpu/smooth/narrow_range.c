/* narrow_range.c: the narrow-range filter: whole (2-D), or along rows and columns in turn, with or without a last 5x5 pass.
 *
 * Based on: [TY18] Truong, Yuksel, "A Narrow-Range Filter for Screen-Space Fluid Rendering", 2018. */
#include "cpu/smooth/narrow_range.h"

#include "cpu/smooth/filter.h"

/* Whether any depth is less than delta. No pass brings fluid nearer than the nearest there was, but for rounding. */
static bool any_at_lens(const struct depth_plane *plane, float delta)
{
    float nearest = DEPTH_EMPTY;
    for (int i = 0; i < plane->blocks_x * plane->blocks_y; i++) {
        nearest = lesser(nearest, plane->ranges[i].min);
    }
    return nearest < 1.001f * delta;
}

void mns_smooth_narrow_range(struct backend *cpu, const struct frame *frame)
{
    const struct narrow_range_kernels *kernels = cpu->kernels->smooth->narrow_range;
    struct window_filter filter = mns_window_resolve(frame);
    filter.at_lens = any_at_lens(cpu->smoothed, filter.delta);
    for (int i = 0; i < frame->params.iterations; i++) {
        if (frame->params.filter == MNS_FILTER_NARROW_RANGE) {
            mns_window_pass(cpu, &filter, WINDOW_DISC, kernels->disc, kernels->disc_plain);
        } else {
            mns_window_pass(cpu, &filter, WINDOW_LINE_X, kernels->line, kernels->line_plain);
            mns_window_pass(cpu, &filter, WINDOW_LINE_Y, kernels->line, kernels->line_plain);
        }
    }
    if (frame->params.filter == MNS_FILTER_NARROW_RANGE_1D_CLEANUP) {
        mns_window_pass(cpu, &filter, WINDOW_SQUARE, kernels->square, kernels->square_plain);
    }
}
