/* scene.c: stage scene: the caller's picture and depth, or sky, floor and shadow. */
#include "cpu/cpu.h"
#include "cpu/environment.h"
#include "cpu/objects.h"
#include "cpu/pixels.h"
#include "cpu/shadow.h"

#include <math.h>
#include <string.h>

enum { ROWS_PER_JOB = 16 };

/* The sun's disc: radius as seen from the earth, half the width of its drawn rim, radians; radiance over that of sunlit white. */
static const float DISC_RADIUS = 0.00465f, DISC_RIM = 0.0006f, DISC_RADIANCE = 20;

struct scene_run {
    struct surroundings surroundings;
    struct backend *cpu;
    const struct frame *frame;
    struct backdrop backdrop;
    struct srgb_decoder decoder;
    atomic_int next;
};

static float dot(const float a[3], const float b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static void resolve_floor(struct backdrop *out, const struct frame *frame)
{
    const struct scene_look *look = &frame->look;
    const struct view *view = &frame->view;
    const struct mns_params *params = &frame->params;
    const int axes[2] = {look->axis_u, look->axis_v};
    float *rotated[2] = {out->axis_u, out->axis_v}, *offsets[2] = {&out->offset_u, &out->offset_v};
    out->plane = dot(out->sky.up, view->translation) + look->floor_height;
    out->has_floor = look->has_floor && (view->orthographic || out->plane < 0);
    out->inv_cell = 1 / look->floor_cell;
    for (int i = 0; i < 2; i++) {
        const float axis[3] = {axes[i] == 0, axes[i] == 1, axes[i] == 2};
        sky_rotate(rotated[i], view->rotation, axis);
        double offset = ((double)look->floor_phase[i] - (double)dot(rotated[i], view->translation)) / (double)look->floor_cell;
        *offsets[i] = (float)fmod(offset, 2);
    }
    for (int c = 0; c < 3; c++) {
        out->albedo_mean[c] = 0.5f * (params->floor_light[c] + params->floor_dark[c]);
        out->albedo_half[c] = 0.5f * (params->floor_light[c] - params->floor_dark[c]);
    }
}

static mns_result resolve_light(struct backdrop *out, struct backend *cpu, const struct frame *frame)
{
    float sun[3], sine = frame->look.sun[frame->look.axis_up];
    for (int c = 0; c < 3; c++) {
        sun[c] = out->sky.sun_light[c] * sine;
        out->light_open[c] = sun[c] + out->sky.sky_light[c];
    }
    if (!(out->has_floor || frame->objects) || !frame->params.shadow || cpu->stores[STORE_WATER].count == 0) {
        return MNS_OK;
    }
    mns_result result = mns_shadow_update(cpu, frame, sun, out->sky.sky_light);
    const struct shadow *shadow = cpu->scene.shadow;
    if (result == MNS_OK) {
        out->light = shadow->light;
        out->light_width = shadow->width;
        out->light_height = shadow->height;
        out->light_scale = 1 / shadow->texel;
        out->light_u = (-dot(out->axis_u, frame->view.translation) - shadow->min_u) * out->light_scale;
        out->light_v = (-dot(out->axis_v, frame->view.translation) - shadow->min_v) * out->light_scale;
    }
    return result;
}

static mns_result resolve_backdrop(struct backdrop *out, struct backend *cpu, const struct frame *frame, bool has_environment)
{
    const struct view *view = &frame->view;
    *out = (struct backdrop){.has_sky = frame->params.background == MNS_BACKGROUND_SKY && !has_environment,
                             .fades = has_environment,
                             .pattern = frame->params.floor_pattern,
                             .orthographic = view->orthographic,
                             .step_x = 1 / view->fx,
                             .step_y = 1 / view->fy,
                             .cx = view->cx,
                             .cy = view->cy,
                             .near_plane = view->near_plane,
                             .disc_inner = (DISC_RADIUS - DISC_RIM) * (DISC_RADIUS - DISC_RIM),
                             .disc_outer = (DISC_RADIUS + DISC_RIM) * (DISC_RADIUS + DISC_RIM)};
    mns_sky_resolve(&out->sky, frame);
    bool colored = frame->params.background == MNS_BACKGROUND_COLOR;
    for (int c = 0; c < 3; c++) {
        out->color[c] = colored ? frame->params.background_color[c] : 0;
        out->disc[c] = DISC_RADIANCE * out->sky.sun_light[c];
    }
    out->color[3] = colored;
    resolve_floor(out, frame);
    return resolve_light(out, cpu, frame);
}

/* The caller's depth of one pixel: what is no distance counts as nothing there, what is behind the eye as right before it. */
static float scene_depth_of(float depth)
{
    if (!(depth < DEPTH_LIMIT)) {
        return DEPTH_EMPTY;
    }
    return depth > 0 ? depth : 0;
}

static void copy_row(struct scene_run *run, int y)
{
    const struct mns_scene *scene = run->frame->scene;
    struct scene_image *out = &run->cpu->scene;
    mns_pixels_decode(&run->decoder, &scene->color, y, out->color + 4 * (ptrdiff_t)y * out->stride);
    if (out->has_depth) {
        const float *from = (const float *)mns_pixels_row(&scene->depth, y);
        float *to = out->depth.data + y * out->depth.stride;
        for (int x = 0; x < scene->depth.width; x++) {
            to[x] = scene_depth_of(from[x]);
        }
    }
}

static void draw_row(struct scene_run *run, int y)
{
    struct scene_image *out = &run->cpu->scene;
    float unused[SCENE_SPAN];
    for (int x = 0; x < run->frame->view.width; x += SCENE_SPAN) {
        int count = run->frame->view.width - x < SCENE_SPAN ? run->frame->view.width - x : SCENE_SPAN;
        float *depth = out->has_depth ? out->depth.data + y * out->depth.stride + x : unused;
        float *color = out->color + 4 * ((ptrdiff_t)y * out->stride + x);
        run->cpu->kernels->scene->backdrop(&run->backdrop, x, y, count, color, depth);
        if (run->surroundings.environment) {
            mns_surroundings_behind(&run->surroundings, &run->backdrop, x, y, count, color);
        }
    }
    if (run->frame->objects) {
        mns_objects_row(run->cpu, run->frame, &run->backdrop, y);
    }
}

static void write_colors(const struct scene_run *run, const struct mns_image *to, int y)
{
    const struct shade_kernels *kernels = run->cpu->kernels->shade;
    const float *from = run->cpu->scene.color + 4 * (ptrdiff_t)y * run->cpu->scene.stride;
    float planes[4][SHADE_SPAN];
    for (int x = 0; x < to->width; x += SHADE_SPAN) {
        int count = to->width - x < SHADE_SPAN ? to->width - x : SHADE_SPAN;
        kernels->split(from + 4 * (ptrdiff_t)x, count, planes);
        kernels->encode(planes, count, 1, PIXEL_COLOR, to->pixel, to->channels, mns_pixels_at(to, x, y));
    }
}

static void write_layers(const struct scene_run *run, int y)
{
    const struct scene_image *scene = &run->cpu->scene;
    const struct mns_image *color = mns_frame_output(run->frame, MNS_LAYER_SCENE_COLOR);
    if (color) {
        write_colors(run, color, y);
    }
    const struct mns_image *depth = mns_frame_output(run->frame, MNS_LAYER_SCENE_DEPTH);
    if (depth) {
        float *to = (float *)mns_pixels_row(depth, y);
        const float *from = scene->has_depth ? scene->depth.data + y * scene->depth.stride : NULL;
        for (int x = 0; x < depth->width; x++) {
            to[x] = from && from[x] < DEPTH_LIMIT ? from[x] : INFINITY;
        }
    }
}

static void scene_job(void *context, int index)
{
    (void)index;
    struct scene_run *run = context;
    int height = run->frame->view.height;
    for (;;) {
        int begin = atomic_fetch_add(&run->next, ROWS_PER_JOB);
        if (begin >= height) {
            return;
        }
        for (int y = begin; y < begin + ROWS_PER_JOB && y < height; y++) {
            if (run->frame->scene) {
                copy_row(run, y);
            } else {
                draw_row(run, y);
            }
            write_layers(run, y);
        }
    }
}

/* Room for the picture, with a row to spare so that bilinear taps need no test, nor do they beside a single column. */
static bool resize(struct scene_image *scene, struct memory *memory, int width, int height)
{
    ptrdiff_t stride = (width + BLOCK_WIDTH - 1) / BLOCK_WIDTH * BLOCK_WIDTH;
    size_t pixels = (size_t)stride * ((size_t)height + 1);
    scene->stride = stride;
    scene->color = mns_memory_reserve(memory, scene->color, &scene->capacity, pixels, 4 * sizeof(float));
    bool done = scene->color != NULL;
    if (done) {
        ptrdiff_t rows = width > 1 ? height : 0;
        memset(scene->color + 4 * stride * rows, 0, (pixels - (size_t)(stride * rows)) * 4 * sizeof(float));
    }
    return done && (!scene->has_depth || mns_plane_resize(&scene->depth, memory, width, height, 0));
}

mns_result mns_cpu_scene(struct backend *cpu, const struct frame *frame)
{
    struct scene_run run = {.cpu = cpu, .frame = frame};
    struct scene_image *scene = &cpu->scene;
    cpu->stats.shadow_ms = 0;
    mns_surroundings_resolve(&run.surroundings, frame);
    mns_result result = resolve_backdrop(&run.backdrop, cpu, frame, run.surroundings.environment != NULL);
    if (result != MNS_OK) {
        return result;
    }
    const struct scene_look *look = &frame->look;
    scene->has_depth = frame->scene ? frame->scene->depth.data != NULL : run.backdrop.has_floor || frame->objects;
    scene->cuts_fluid = scene->has_depth && (frame->scene || frame->objects ||
                                             look->floor_height > frame->facts->bounds_min[look->axis_up] - frame->splat_radius);
    if (!resize(scene, cpu->host.memory, frame->view.width, frame->view.height)) {
        return cpu_out_of_memory(cpu);
    }
    if (frame->scene) {
        mns_srgb_decoder_init(&run.decoder, frame->scene->color.pixel);
    }
    cpu_run(cpu, scene_job, &run, cpu->host.threads);
    return MNS_OK;
}

void mns_scene_destroy(struct backend *cpu)
{
    struct memory *memory = cpu->host.memory;
    mns_shadow_destroy(cpu);
    mns_memory_put(memory, cpu->scene.color, cpu->scene.capacity, 4 * sizeof(float));
    mns_plane_free(&cpu->scene.depth, memory);
}
