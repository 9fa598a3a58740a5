/* plane_fit.c: the plane-fit filter: each pixel's ray meets the plane through the mean position of its neighbourhood, with their mean normal.
 *
 * Based on: Imai, Kanamori, Mitani, "Real-time screen-space liquid rendering with complex refractions", 2016, as compared in [TY18]. The normals
 * are those of each pass's own input. */
#include "cpu/smooth/plane_fit.h"

#include "cpu/smooth/filter.h"

struct normal_run {
    struct backend *cpu;
    struct shade_optics optics; /* what normals depend on, the rest 0 */
};

/* A job: the normals of one row of blocks. */
static void run_normals(void *context, int by)
{
    const struct normal_run *run = context;
    const struct plane *depth = &run->cpu->smoothed->plane;
    for (int y = by * BLOCK_HEIGHT; y < (by + 1) * BLOCK_HEIGHT && y < depth->height; y++) {
        for (int x = 0; x < depth->width; x += SHADE_SPAN) {
            ptrdiff_t at = y * depth->stride + x;
            int count = depth->width - x < SHADE_SPAN ? depth->width - x : SHADE_SPAN;
            float *out[3];
            for (int c = 0; c < 3; c++) {
                out[c] = run->cpu->depth_normal[c].data + at;
            }
            run->cpu->kernels->shade->normals(&run->optics, depth->data + at, depth->stride, NULL, x, y, count, out[0], out[1], out[2]);
        }
    }
}

void mns_smooth_plane_fit(struct backend *cpu, const struct frame *frame)
{
    const struct plane_fit_kernels *kernels = cpu->kernels->smooth->plane_fit;
    const struct view *view = &frame->view;
    struct normal_run run = {.cpu = cpu,
                             .optics = {.orthographic = view->orthographic,
                                        .fx = view->fx,
                                        .fy = view->fy,
                                        .cx = view->cx,
                                        .cy = view->cy,
                                        .step_x = 1 / view->fx,
                                        .step_y = 1 / view->fy,
                                        .edge = frame->params.edge_threshold * frame->splat_radius}};
    struct plane_fit fit = {
        .step_x = 1 / view->fx, .step_y = 1 / view->fy, .cx = view->cx, .cy = view->cy, .orthographic = view->orthographic};
    for (int c = 0; c < 3; c++) {
        fit.normal[c] = cpu->depth_normal[c].data;
    }
    struct window_filter filter = mns_window_resolve(frame);
    filter.fit = &fit;
    for (int i = 0; i < frame->params.iterations; i++) {
        cpu_run(cpu, run_normals, &run, cpu->smoothed->blocks_y);
        mns_window_pass(cpu, &filter, WINDOW_DISC, kernels->disc, kernels->disc_plain);
    }
}
