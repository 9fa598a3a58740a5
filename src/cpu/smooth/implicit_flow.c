/* implicit_flow.c: the filter implicit-curvature-flow: implicit steps along rows and columns in turn. Which pixels are fluid does not change, so
 * that after the first pass all happens in one plane. */
#include "cpu/smooth/implicit_flow.h"

#include "cpu/smooth/filter.h"
#include "cpu/smooth/flow.h"
#include "cpu/smooth/window.h"

#include <math.h>

/* A strip of FLOW_LINES lines, in blocks across it. */
static const int strip_blocks[2] = {[AXIS_X] = FLOW_LINES / BLOCK_HEIGHT, [AXIS_Y] = FLOW_LINES / BLOCK_WIDTH};

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

/* A pass along one axis. Workers take strips; which takes which makes no difference. */
struct pass {
    const struct implicit_flow *flow;
    const struct implicit_flow_kernels *kernels;
    const struct depth_plane *start; /* whose ranges tell what is fluid */
    const struct depth_plane *in;
    struct depth_plane *out;
    float *scratch; /* of all workers */
    size_t scratch_size;
    int axis, steps; /* steps: one or two, since each second step begins with the axis that the one before ended with */
    int strips;
    atomic_int next;
};

/* Floats that a worker needs: lines and scratch of mns_implicit_flow_kernels.solve. */
static size_t scratch_size(const struct depth_plane *plane)
{
    int across = plane->blocks_x * BLOCK_WIDTH, down = plane->blocks_y * BLOCK_HEIGHT;
    return (size_t)3 * FLOW_LINES * (size_t)(across > down ? across : down);
}

bool mns_implicit_flow_reserve(struct backend *cpu)
{
    size_t size = scratch_size(&cpu->depth[0]) * (size_t)cpu->host.threads;
    cpu->flow_scratch = mns_memory_reserve(cpu->host.memory, cpu->flow_scratch, &cpu->flow_scratch_capacity, size, sizeof(float));
    return cpu->flow_scratch != NULL;
}

/* Whether any of the blocks of a strip, at position k along it, has fluid. */
static bool has_fluid(const struct pass *pass, int strip, int k)
{
    const struct depth_plane *start = pass->start;
    for (int i = 0; i < strip_blocks[pass->axis]; i++) {
        int other = strip * strip_blocks[pass->axis] + i;
        int bx = pass->axis == AXIS_X ? k : other, by = pass->axis == AXIS_X ? other : k;
        if (bx < start->blocks_x && by < start->blocks_y && start->ranges[by * start->blocks_x + bx].min < DEPTH_LIMIT) {
            return true;
        }
    }
    return false;
}

/* Rows lie side by side in scratch while they are solved; columns do in the plane. */
static void solve_run(const struct pass *pass, int strip, int begin, int end, float *scratch)
{
    const struct implicit_flow_kernels *kernels = pass->kernels;
    ptrdiff_t stride = pass->out->plane.stride;
    if (pass->axis == AXIS_Y) {
        float *columns = pass->out->plane.data + (ptrdiff_t)begin * BLOCK_HEIGHT * stride + (ptrdiff_t)strip * FLOW_LINES;
        for (int i = 0; i < pass->steps; i++) {
            kernels->solve(pass->flow, AXIS_Y, columns, stride, (end - begin) * BLOCK_HEIGHT, scratch);
        }
        return;
    }
    ptrdiff_t at = (ptrdiff_t)strip * FLOW_LINES * stride + (ptrdiff_t)begin * BLOCK_WIDTH;
    int count = (end - begin) * BLOCK_WIDTH;
    float *lines = scratch, *rest = scratch + (ptrdiff_t)count * FLOW_LINES;
    kernels->gather(pass->in->plane.data + at, stride, count, lines);
    for (int i = 0; i < pass->steps; i++) {
        kernels->solve(pass->flow, AXIS_X, lines, FLOW_LINES, count, rest);
    }
    kernels->scatter(lines, count, pass->out->plane.data + at, stride);
}

/* Between blocks that have fluid lines fall apart. */
static void solve_strip(const struct pass *pass, int strip, float *scratch)
{
    int blocks = pass->axis == AXIS_X ? pass->start->blocks_x : pass->start->blocks_y, begin = 0;
    for (int k = 0; k <= blocks; k++) {
        if (k < blocks && has_fluid(pass, strip, k)) {
            continue;
        }
        if (begin < k) {
            solve_run(pass, strip, begin, k, scratch);
        }
        begin = k + 1;
    }
}

static void work(void *context, int worker)
{
    struct pass *pass = context;
    float *scratch = pass->scratch + (size_t)worker * pass->scratch_size;
    for (int strip; (strip = atomic_fetch_add(&pass->next, 1)) < pass->strips;) {
        solve_strip(pass, strip, scratch);
    }
}

static void run_pass(struct backend *cpu, struct pass *pass, int axis, int steps)
{
    int blocks = axis == AXIS_X ? pass->start->blocks_y : pass->start->blocks_x;
    pass->axis = axis;
    pass->steps = steps;
    pass->strips = (blocks + strip_blocks[axis] - 1) / strip_blocks[axis];
    atomic_store(&pass->next, 0);
    cpu_run(cpu, work, pass, cpu->host.threads);
    pass->in = pass->out;
}

/* Steps go rows, columns; columns, rows; rows, columns ... */
void mns_smooth_implicit_flow(struct backend *cpu, const struct frame *frame)
{
    struct implicit_flow flow = resolve(frame);
    struct pass pass = {.flow = &flow,
                        .kernels = cpu->kernels->smooth->implicit_flow,
                        .start = cpu->smoothed,
                        .in = cpu->smoothed,
                        .out = smooth_target(cpu),
                        .scratch = cpu->flow_scratch,
                        .scratch_size = scratch_size(cpu->smoothed)};
    mns_smooth_copy_empty(cpu, pass.start);
    int axis = AXIS_X;
    for (int step = 0; step <= frame->params.iterations; step++) {
        run_pass(cpu, &pass, axis, step > 0 && step < frame->params.iterations ? 2 : 1);
        axis = axis == AXIS_X ? AXIS_Y : AXIS_X;
    }
    cpu->smoothed = pass.out;
    mns_smooth_measure(cpu);
}
