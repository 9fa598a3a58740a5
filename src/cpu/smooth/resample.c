/* resample.c: smoothing at half or quarter size: depth_raw down to texels, and the smoothed texels back to pixels. */
#include "cpu/smooth/filter.h"

#include "cpu/shade.h"

#include <math.h>
#include <string.h>

struct run {
    struct backend *cpu;
    struct resample resample;
    atomic_int next;
};

static struct run run_of(struct backend *cpu, const struct frame *frame)
{
    float scale = (float)frame->params.smooth_scale;
    return (struct run){.cpu = cpu,
                        .resample = {.scale = frame->params.smooth_scale,
                                     .orthographic = frame->view.orthographic,
                                     .edge = frame->params.edge_threshold * frame->splat_radius,
                                     .slant_x = SHADE_SLOPE_MAX * scale / frame->view.fx,
                                     .slant_y = SHADE_SLOPE_MAX * scale / frame->view.fy}};
}

static void run_job(struct run *run, void (*job)(void *context, int index))
{
    atomic_store(&run->next, 0);
    cpu_run(run->cpu, job, run, run->cpu->host.threads);
}

/* A run of blocks that are not empty in depth_raw, in row `by`: its first block, from `begin` on, and its end. */
static bool find_fluid(const struct depth_plane *raw, int by, int begin, int *first, int *end)
{
    const struct depth_range *ranges = raw->ranges + by * raw->blocks_x;
    for (*first = begin; *first < raw->blocks_x && ranges[*first].min >= DEPTH_LIMIT; ++*first) {
    }
    for (*end = *first; *end < raw->blocks_x && ranges[*end].min < DEPTH_LIMIT; ++*end) {
    }
    return *first < raw->blocks_x;
}

struct view mns_resample_view(const struct view *view, int scale)
{
    struct view small = *view;
    float part = 1 / (float)scale;
    small.width = (view->width + scale - 1) / scale;
    small.height = (view->height + scale - 1) / scale;
    small.fx *= part;
    small.fy *= part;
    small.cx *= part;
    small.cy *= part;
    return small;
}

bool mns_resample_reserve(struct backend *cpu, const struct frame *frame)
{
    struct memory *memory = cpu->host.memory;
    struct view small = mns_resample_view(&frame->view, frame->params.smooth_scale);
    bool done = mns_depth_plane_resize(&cpu->depth_texels, memory, small.width, small.height) &&
                mns_smooth_resize(&cpu->depth_pixels, memory, &frame->view);
    for (int i = 0; i < 3; i++) {
        done = done && mns_plane_resize(&cpu->tangents[i], memory, small.width, small.height, PLANE_BORDER);
    }
    return done;
}

void mns_resample_destroy(struct backend *cpu)
{
    mns_depth_plane_free(&cpu->depth_texels, cpu->host.memory);
    mns_depth_plane_free(&cpu->depth_pixels, cpu->host.memory);
    for (int i = 0; i < 3; i++) {
        mns_plane_free(&cpu->tangents[i], cpu->host.memory);
    }
}

/* The texels of a row of blocks of pixels. */
static void reduce_blocks(struct run *run, int by)
{
    const struct depth_plane *raw = &run->cpu->depth_raw;
    const struct plane *in = &raw->plane, *out = &run->cpu->depth_texels.plane;
    int scale = run->resample.scale, top = by * BLOCK_HEIGHT / scale, rows = BLOCK_HEIGHT / scale;
    for (int y = top; y < top + rows && y < out->height; y++) {
        int pixels = in->height - y * scale < scale ? in->height - y * scale : scale;
        float *to = out->data + y * out->stride;
        for (int x = 0; x < out->width; x++) {
            to[x] = DEPTH_EMPTY;
        }
        for (int first = 0, end; find_fluid(raw, by, first, &first, &end); first = end) {
            int left = first * BLOCK_WIDTH / scale, right = end * BLOCK_WIDTH / scale;
            right = right < out->width ? right : out->width;
            run->cpu->kernels->smooth->resample->reduce(&run->resample, in->data + y * scale * in->stride + left * scale, in->stride,
                                                        pixels, in->width - left * scale, right - left, to + left);
        }
        for (int x = out->width; x % BLOCK_WIDTH != 0; x++) { /* vectors write past the edge */
            to[x] = 0;
        }
    }
}

static void reduce_job(void *context, int index)
{
    (void)index;
    struct run *run = context;
    for (int by; (by = atomic_fetch_add(&run->next, 1)) < run->cpu->depth_raw.blocks_y;) {
        reduce_blocks(run, by);
    }
}

void mns_resample_down(struct backend *cpu, const struct frame *frame)
{
    struct run run = run_of(cpu, frame);
    run_job(&run, reduce_job);
    cpu->smoothed = &cpu->depth_texels;
    memset(cpu->smoothed->ranges, 0, sizeof(struct depth_range) * (size_t)cpu->smoothed->blocks_x * (size_t)cpu->smoothed->blocks_y);
    mns_smooth_measure(cpu);
}

static void tangents_job(void *context, int index)
{
    (void)index;
    struct run *run = context;
    const struct plane *in = &run->cpu->smoothed->plane, *out = run->cpu->tangents;
    for (int y; (y = atomic_fetch_add(&run->next, 1)) < in->height;) {
        ptrdiff_t at = y * out->stride;
        run->cpu->kernels->smooth->resample->tangents(&run->resample, in->data + y * in->stride, in->stride, in->width, out[0].data + at,
                                                      out[1].data + at, out[2].data + at);
    }
}

static void interpolate_row(struct run *run, int x, int y, int count)
{
    const struct plane *raw = &run->cpu->depth_raw.plane, *out = &run->cpu->depth_pixels.plane, *in = run->cpu->tangents;
    int scale = run->resample.scale, middle = y / scale;
    struct texel_row rows[3];
    for (int j = 0; j < 3; j++) { /* beyond the picture: the border, which is no fluid */
        ptrdiff_t at = (middle + j - 1) * in->stride + x / scale;
        rows[j] = (struct texel_row){in[0].data + at, in[1].data + at, in[2].data + at};
    }
    run->cpu->kernels->smooth->resample->interpolate(&run->resample, rows, y % scale, raw->data + y * raw->stride + x, count,
                                                     out->data + y * out->stride + x);
}

/* A row of blocks of pixels; their ranges while they are at hand. */
static void interpolate_blocks(struct run *run, int by)
{
    const struct depth_plane *raw = &run->cpu->depth_raw;
    struct depth_plane *out = &run->cpu->depth_pixels;
    int done = 0;
    for (int first = 0, end; done < raw->blocks_x; first = done = end) {
        find_fluid(raw, by, first, &first, &end);
        for (int bx = done; bx < first; bx++) {
            mns_smooth_copy_block(raw, out, bx, by);
        }
        int left = first * BLOCK_WIDTH, right = end * BLOCK_WIDTH < raw->plane.width ? end * BLOCK_WIDTH : raw->plane.width;
        for (int y = by * BLOCK_HEIGHT; y < (by + 1) * BLOCK_HEIGHT && y < raw->plane.height; y++) {
            interpolate_row(run, left, y, right - left);
        }
        for (int bx = first; bx < end; bx++) {
            out->ranges[by * raw->blocks_x + bx] = mns_smooth_range(&out->plane, bx, by);
        }
    }
}

static void interpolate_job(void *context, int index)
{
    (void)index;
    struct run *run = context;
    for (int by; (by = atomic_fetch_add(&run->next, 1)) < run->cpu->depth_raw.blocks_y;) {
        interpolate_blocks(run, by);
    }
}

void mns_resample_up(struct backend *cpu, const struct frame *frame)
{
    struct run run = run_of(cpu, frame);
    run_job(&run, tangents_job);
    run_job(&run, interpolate_job);
    cpu->smoothed = &cpu->depth_pixels;
}
