/* blur.c: stage blur: thickness_raw and its colour sums -> thickness, color: a separable Gaussian of the width of the splats in the world.
 *
 * sigma = thickness_blur * R in pixels at the texel's own smoothed depth, so that it does not jump with the distance; each texel gathers with its
 * own sigma, so a near drop does not spread over the water far behind it more than that water's own sigma reaches. From two pixels per
 * texel on sigma is 1.5 texels at least: volumes are gathered bilinearly there, which a narrower Gaussian would leave visible. */
#include "cpu/cpu.h"
#include "cpu/pixels.h"

#include <math.h>
#include <string.h>

enum { ROWS_PER_JOB = 8 };

static const float SIGMA_LEAST = 1.5f;

struct blur_run {
    struct backend *cpu;
    const struct frame *frame;
    struct blur_sigma sigma;
    const struct plane *in;
    struct plane *out;
    int width, height, scale; /* texels; pixels per texel */
};

/* Calls row(run, y) for all rows of texels, in parallel. */
struct rows {
    struct blur_run *run;
    void (*row)(struct blur_run *run, int y);
    int count;
    atomic_int next;
};

static void rows_job(void *context, int index)
{
    (void)index;
    struct rows *rows = context;
    for (;;) {
        int begin = atomic_fetch_add(&rows->next, ROWS_PER_JOB);
        if (begin >= rows->count) {
            return;
        }
        for (int y = begin; y < begin + ROWS_PER_JOB && y < rows->count; y++) {
            rows->row(rows->run, y);
        }
    }
}

static void run_rows(struct blur_run *run, void (*row)(struct blur_run *run, int y), int count)
{
    struct rows rows = {.run = run, .row = row, .count = count};
    cpu_run(run->cpu, rows_job, &rows, run->cpu->host.threads);
}

/* The nearest of the rows of pixels under a row of texels, pixels x to x + count - 1. */
static void nearest_rows(const struct plane *depth, int first, int rows, int x, int count, float *nearest)
{
    const float *from = depth->data + first * depth->stride + x;
    memcpy(nearest, from, sizeof(float) * (size_t)count);
    for (int row = 1; row < rows; row++) {
        from += depth->stride;
        for (int i = 0; i < count; i++) {
            nearest[i] = from[i] < nearest[i] ? from[i] : nearest[i];
        }
    }
}

enum { PIECE = 256 };

/* The nearest depth in each texel, and a border of nothing around the picture. */
static void depth_row(struct blur_run *run, int y)
{
    const struct plane *depth = &run->cpu->smoothed->plane;
    struct plane *half = &run->cpu->blur_half;
    int scale = run->scale, rest = depth->height - y * scale, rows = rest < scale ? rest : scale;
    float *to = half->data + y * half->stride, nearest[PIECE];
    for (int x = 0; x < depth->width; x += PIECE) {
        int count = depth->width - x < PIECE ? depth->width - x : PIECE;
        nearest_rows(depth, y * scale, rows, x, count, nearest);
        for (int i = 0; i < count; i += scale) {
            float z = nearest[i];
            for (int k = 1; k < scale && i + k < count; k++) {
                z = nearest[i + k] < z ? nearest[i + k] : z;
            }
            to[(x + i) / scale] = z;
        }
    }
    to[-1] = to[run->width] = DEPTH_EMPTY;
    for (int x = -1; x <= run->width && y == 0; x++) {
        half->data[x - half->stride] = half->data[x + run->height * half->stride] = DEPTH_EMPTY;
    }
}

static void decay_row(struct blur_run *run, int y)
{
    const struct plane *half = &run->cpu->blur_half, *decay = &run->cpu->blur_decay;
    run->cpu->kernels->blur->decay(&run->sigma, half->data + y * half->stride, half->stride, run->width, decay->data + y * decay->stride);
}

static void across_row(struct blur_run *run, int y)
{
    const struct plane *half = &run->cpu->blur_half, *decay = &run->cpu->blur_decay;
    const struct blur_line line = {.in = run->in->data + y * run->in->stride,
                                   .step = 1,
                                   .decay = decay->data + y * decay->stride,
                                   .out = half->data + y * half->stride,
                                   .before = 0,
                                   .after = run->width - 1,
                                   .slope = 1,
                                   .count = run->width};
    run->cpu->kernels->blur->line(&line);
}

static void down_row(struct blur_run *run, int y)
{
    const struct plane *half = &run->cpu->blur_half, *decay = &run->cpu->blur_decay;
    float *out = run->out->data + y * run->out->stride;
    const struct blur_line line = {.in = half->data + y * half->stride,
                                   .step = half->stride,
                                   .decay = decay->data + y * decay->stride,
                                   .out = out,
                                   .before = y,
                                   .after = run->height - 1 - y,
                                   .slope = 0,
                                   .count = run->width};
    run->cpu->kernels->blur->line(&line);
    out[-1] = out[0]; /* the edge repeated, for the way back to full size */
    out[run->width] = out[run->width - 1];
}

static void repeat_edges(struct plane *plane)
{
    for (int x = -1; x <= plane->width; x++) {
        plane->data[x - plane->stride] = plane->data[x];
        plane->data[x + plane->height * plane->stride] = plane->data[x + (plane->height - 1) * plane->stride];
    }
}

static void blur_plane(struct blur_run *run, const struct plane *in, struct plane *out)
{
    run->in = in;
    run->out = out;
    run_rows(run, across_row, run->height);
    run_rows(run, down_row, run->height);
    repeat_edges(out);
}

static void thickness_layer_row(struct blur_run *run, int y)
{
    const struct mns_image *image = mns_frame_output(run->frame, MNS_LAYER_THICKNESS);
    const struct plane *thickness = &run->cpu->blurred.thickness;
    int top;
    float weight = blur_rows_of(y, run->scale, &top);
    const float *rows = thickness->data + top * thickness->stride;
    float *to = mns_pixels_row(image, y), piece[PIECE];
    for (int x = 0; x < image->width; x += PIECE) {
        int count = image->width - x < PIECE ? image->width - x : PIECE;
        run->cpu->kernels->blur->upsample(rows, rows + thickness->stride, weight, run->scale, x, count, piece);
        for (int i = 0; i < count; i++) {
            to[x + i] = piece[i];
        }
    }
}

static bool resize(struct blur_run *run)
{
    struct backend *cpu = run->cpu;
    struct memory *memory = cpu->host.memory;
    struct thickness_image *out = &cpu->blurred;
    bool done = mns_plane_resize(&cpu->blur_half, memory, run->width, run->height, PLANE_BORDER) &&
                mns_plane_resize(&cpu->blur_decay, memory, run->width, run->height, 0) &&
                mns_plane_resize(&out->thickness, memory, run->width, run->height, 1);
    for (int c = 0; c < 3 && out->has_color; c++) {
        done = done && mns_plane_resize(&out->color[c], memory, run->width, run->height, 1);
    }
    return done;
}

mns_result mns_cpu_blur(struct backend *cpu, const struct frame *frame)
{
    const struct view *view = &frame->view;
    struct blur_run run = {.cpu = cpu, .frame = frame, .scale = cpu->raw.scale};
    run.width = (view->width + run.scale - 1) / run.scale;
    run.height = (view->height + run.scale - 1) / run.scale;
    run.sigma =
        (struct blur_sigma){.scale = frame->params.thickness_blur * frame->splat_radius * sqrtf(view->fx * view->fy) / (float)run.scale,
                            .least = run.scale > 1 ? SIGMA_LEAST : 1e-3f, /* that small: the texel alone */
                            .orthographic = view->orthographic};
    cpu->blurred.scale = run.scale;
    cpu->blurred.has_color = cpu->raw.has_color;
    if (!resize(&run)) {
        return cpu_out_of_memory(cpu);
    }
    run_rows(&run, depth_row, run.height);
    run_rows(&run, decay_row, run.height);
    blur_plane(&run, &cpu->raw.thickness, &cpu->blurred.thickness);
    for (int c = 0; c < 3 && cpu->raw.has_color; c++) {
        blur_plane(&run, &cpu->raw.color[c], &cpu->blurred.color[c]);
    }
    if (mns_frame_output(frame, MNS_LAYER_THICKNESS)) {
        run_rows(&run, thickness_layer_row, view->height);
    }
    return MNS_OK;
}

void mns_cpu_blur_plane(struct backend *cpu, const struct frame *frame, const struct plane *in, struct plane *out)
{
    struct blur_run run = {.cpu = cpu, .frame = frame, .scale = cpu->raw.scale, .width = in->width, .height = in->height};
    blur_plane(&run, in, out);
}

void mns_blur_destroy(struct backend *cpu)
{
    mns_plane_free(&cpu->blur_half, cpu->host.memory);
    mns_plane_free(&cpu->blur_decay, cpu->host.memory);
}
