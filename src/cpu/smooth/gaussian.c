/* gaussian.c: the Gaussian filter: rows and columns in turn, across every edge between fluid and fluid. It shows what the other filters are
 * for: it is exact and smooth, and it glues a drop to what is behind it. */
#include "cpu/smooth/filter.h"

/* Metres: the plain kernel's sums of depths farther apart, times the fourth powers of pixels, might be infinite. */
static const float PLAIN_RANGE = 1e27f;

void mns_smooth_gaussian(struct backend *cpu, const struct frame *frame)
{
    window_function *line = cpu->kernels->smooth->gaussian->line, *plain = cpu->kernels->smooth->narrow_range->line_plain;
    struct window_filter filter = mns_window_resolve(frame);
    filter.delta = PLAIN_RANGE; /* of no other use here */
    for (int i = 0; i < frame->params.iterations; i++) {
        mns_window_pass(cpu, &filter, WINDOW_LINE_X, line, plain);
        mns_window_pass(cpu, &filter, WINDOW_LINE_Y, line, plain);
    }
}
