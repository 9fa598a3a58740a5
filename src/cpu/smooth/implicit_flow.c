/* implicit_flow.c: the filter implicit-curvature-flow: implicit steps along rows and columns in turn. Which pixels are fluid does not change, so
 * that after the first pass all happens in one plane. */
#include "cpu/smooth/implicit_flow.h"

#include "cpu/smooth/filter.h"
#include "cpu/smooth/flow.h"
#include "cpu/smooth/lines.h"
#include "cpu/smooth/window.h"

#include <math.h>

/* Arrays that a strip needs: its lines, and the scratch of solve. */
enum { ARRAYS = 3 };

static struct implicit_flow resolve(const struct frame *frame)
{
    const struct view *view = &frame->view;
    float root = sqrtf(2.0f * (float)frame->params.iterations), sigma = frame->params.flow_sigma * frame->splat_radius;
    struct implicit_flow flow = {.apart = frame->params.edge_threshold * frame->splat_radius, .slant = FLOW_SLOPE_MAX * sigma / root};
    const float focal[2] = {[AXIS_X] = view->fx, [AXIS_Y] = view->fy};
    for (int axis = 0; axis < 2; axis++) {
        float inverse = root / (sigma * fabsf(focal[axis]));
        flow.inverse[axis].slope = view->orthographic ? 0 : inverse;
        flow.inverse[axis].offset = view->orthographic ? inverse : 0;
    }
    return flow;
}

struct flow_pass {
    struct implicit_flow flow;
    const struct line_kernels *lines;
    const struct implicit_flow_kernels *kernels;
    const struct depth_plane *in;
    struct depth_plane *out;
    int steps; /* one or two, since each second step begins with the axis that the one before ended with */
};

/* Rows lie side by side in scratch while they are solved; columns do in the plane. */
static void run_rows(void *context, const struct line_run *run, float *scratch)
{
    const struct flow_pass *pass = context;
    ptrdiff_t stride = pass->out->plane.stride, at = run->first * stride + run->begin;
    int count = run->end - run->begin;
    float *lines = scratch, *rest = scratch + (ptrdiff_t)count * LINES;
    pass->lines->gather(pass->in->plane.data + at, stride, count, lines);
    for (int i = 0; i < pass->steps; i++) {
        pass->kernels->solve(&pass->flow, AXIS_X, lines, LINES, count, rest);
    }
    pass->lines->scatter(lines, count, run->across, pass->out->plane.data + at, stride);
}

static void run_columns(void *context, const struct line_run *run, float *scratch)
{
    const struct flow_pass *pass = context;
    ptrdiff_t stride = pass->out->plane.stride;
    float *columns = pass->out->plane.data + run->begin * stride + run->first;
    for (int i = 0; i < pass->steps; i++) {
        pass->kernels->solve(&pass->flow, AXIS_Y, columns, stride, run->end - run->begin, scratch);
    }
}

bool mns_implicit_flow_reserve(struct backend *cpu) { return mns_lines_reserve(cpu, ARRAYS); }

/* Steps go rows, columns; columns, rows; rows, columns ... */
void mns_smooth_implicit_flow(struct backend *cpu, const struct frame *frame)
{
    const struct depth_plane *start = cpu->smoothed;
    struct flow_pass pass = {.flow = resolve(frame),
                             .lines = cpu->kernels->smooth->lines,
                             .kernels = cpu->kernels->smooth->implicit_flow,
                             .in = start,
                             .out = smooth_target(cpu)};
    mns_smooth_copy_empty(cpu, start);
    for (int step = 0; step <= frame->params.iterations; step++) {
        pass.steps = step > 0 && step < frame->params.iterations ? 2 : 1;
        mns_lines_pass(cpu, start, step % 2 ? AXIS_Y : AXIS_X, ARRAYS, step % 2 ? run_columns : run_rows, &pass);
        pass.in = pass.out;
    }
    cpu->smoothed = pass.out;
    mns_smooth_measure(cpu);
}
