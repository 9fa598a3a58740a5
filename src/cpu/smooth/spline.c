/* spline.c: the filter smoothing-spline: rows and columns in turn, each iteration with half the sigma of the one before.
 *
 * The first takes the particles out. What it leaves are streaks along the columns beside edges, where neighbouring columns end at different pixels; on
 * smooth surfaces the narrower ones change nothing, and there they take out streaks down to half their own width. */
#include "cpu/smooth/spline.h"

#include "cpu/smooth/filter.h"
#include "cpu/smooth/lines.h"
#include "cpu/smooth/window.h"

#include <math.h>

/* Arrays that a strip needs: its lines, and the scratch of solve. */
enum { ARRAYS = 4 };

/* Iterations with less than 1 / 1000 of sigma would change nothing. */
enum { ITERATIONS_MOST = 10 };

static struct spline resolve(const struct frame *frame, int iteration)
{
    const struct view *view = &frame->view;
    float part = ldexpf(1, -iteration), radius = frame->splat_radius;
    struct spline spline = {
        .orthographic = view->orthographic, .radius = radius, .apart = frame->params.edge_threshold, .mu = frame->params.mu * part};
    const float focal[2] = {[AXIS_X] = fabsf(view->fx), [AXIS_Y] = fabsf(view->fy)};
    for (int axis = 0; axis < 2; axis++) {
        spline.width[axis] = frame->params.spline_sigma * part * focal[axis] * (view->orthographic ? radius : 1);
        spline.slant[axis] = SHADE_SLOPE_MAX / (focal[axis] * (view->orthographic ? radius : 1));
    }
    return spline;
}

struct spline_pass {
    struct spline spline;
    const struct line_kernels *lines;
    const struct spline_kernels *kernels;
    const struct depth_plane *raw;
    struct depth_plane *out; /* depth where it is finished, else v */
    bool enters, leaves;     /* whether it is the first, the last */
};

static float beyond(bool picture_edge) { return picture_edge ? SPLINE_OUTSIDE : SPLINE_EMPTY; }

static void run_rows(void *context, const struct line_run *run, float *scratch)
{
    const struct spline_pass *pass = context;
    ptrdiff_t stride = pass->out->plane.stride, at = run->first * stride + run->begin;
    int count = run->end - run->begin;
    float *lines = scratch, *rest = scratch + (ptrdiff_t)count * LINES;
    pass->lines->gather((pass->enters ? pass->raw : pass->out)->plane.data + at, stride, count, lines);
    if (pass->enters) {
        pass->kernels->enter(&pass->spline, lines, count * LINES);
        pass->kernels->fill(&pass->spline, AXIS_X, lines, LINES, count);
    }
    pass->kernels->solve(&pass->spline, AXIS_X, lines, LINES, count, beyond(run->opens), beyond(run->ends), rest);
    pass->lines->scatter(lines, count, run->across, pass->out->plane.data + at, stride);
}

static void run_columns(void *context, const struct line_run *run, float *scratch)
{
    const struct spline_pass *pass = context;
    ptrdiff_t stride = pass->out->plane.stride;
    float *columns = pass->out->plane.data + run->begin * stride + run->first;
    if (pass->enters) {
        pass->kernels->fill(&pass->spline, AXIS_Y, columns, stride, run->end - run->begin);
    }
    pass->kernels->solve(&pass->spline, AXIS_Y, columns, stride, run->end - run->begin, beyond(run->opens), beyond(run->ends), scratch);
    if (!pass->leaves) {
        return;
    }
    for (int y = run->begin; y < run->end; y += BLOCK_HEIGHT) {
        for (int x = run->first; x < run->first + run->across; x += BLOCK_WIDTH) {
            ptrdiff_t at = y * stride + x;
            pass->out->ranges[y / BLOCK_HEIGHT * pass->out->blocks_x + x / BLOCK_WIDTH] =
                pass->kernels->leave(&pass->spline, pass->raw->plane.data + at, pass->out->plane.data + at, stride);
        }
    }
}

bool mns_spline_reserve(struct backend *cpu) { return mns_lines_reserve(cpu, ARRAYS); }

void mns_smooth_spline(struct backend *cpu, const struct frame *frame)
{
    int iterations = frame->params.iterations < ITERATIONS_MOST ? frame->params.iterations : ITERATIONS_MOST;
    struct spline_pass pass = {
        .lines = cpu->kernels->smooth->lines, .kernels = cpu->kernels->smooth->spline, .raw = cpu->smoothed, .out = smooth_target(cpu)};
    mns_smooth_copy_empty(cpu, pass.raw);
    for (int i = 0; i < iterations; i++) {
        pass.spline = resolve(frame, i);
        pass.enters = i == 0;
        pass.leaves = i == iterations - 1;
        mns_lines_pass(cpu, pass.raw, AXIS_X, ARRAYS, run_rows, &pass);
        mns_lines_pass(cpu, pass.raw, AXIS_Y, ARRAYS, run_columns, &pass);
    }
    cpu->smoothed = pass.out;
}
