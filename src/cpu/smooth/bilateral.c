/* bilateral.c: the bilateral filter: whole (2-D), or along rows and columns in turn, which is not the same, since a range weight does not
 * separate, but much faster ([LGS09] table 2). */
#include "cpu/smooth/bilateral.h"

#include "cpu/smooth/filter.h"

void mns_smooth_bilateral(struct backend *cpu, const struct frame *frame)
{
    const struct bilateral_kernels *kernels = cpu->kernels->smooth->bilateral;
    struct window_filter filter = mns_window_resolve(frame);
    for (int i = 0; i < frame->params.iterations; i++) {
        if (frame->params.filter == MNS_FILTER_BILATERAL) {
            mns_window_pass(cpu, &filter, WINDOW_DISC, kernels->disc, kernels->disc_plain);
        } else {
            mns_window_pass(cpu, &filter, WINDOW_LINE_X, kernels->line, kernels->line_plain);
            mns_window_pass(cpu, &filter, WINDOW_LINE_Y, kernels->line, kernels->line_plain);
        }
    }
}
