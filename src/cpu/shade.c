/* shade.c: stage shade: depth, thickness, color and scene -> normal, curvature, color, transmittance, alpha, depth, beauty. */
#include "cpu/shade.h"

#include "cpu/cpu.h"
#include "cpu/display.h"
#include "cpu/environment.h"
#include "cpu/silhouette.h"
#include "cpu/splat.h"
#include "cpu/spray.h"

#include <math.h>
#include <string.h>

/* Part of the light on a white surface that deep fluid of a white particle colour scatters back. */
static const float SCATTER_WHITE = 0.3f;

/* Foam about the water's surface: within this many R of it the surface in front changes smoothly from one to the other. */
static const float FOAM_BLEND = 1;

/* Whole rows at a time: the scene comes from memory in streams that are as long as can be. */
enum { ROWS_PER_JOB = 16 };

/* Room for a row of normals with its margins, aligned as vectors want it. */
enum { NORMALS_WIDTH = SHADE_SPAN + 2 * SHADE_MARGIN };

struct shade_run {
    struct backend *cpu;
    const struct frame *frame;
    struct shade_optics optics;
    struct surroundings surroundings;
    const struct plane *surface; /* depth that is shaded: smoothed, or raw in display spheres */
    const struct foam *foam;     /* NULL: none shows */
    const struct plane *noise;   /* on the surface, or NULL */
    float noise_height;          /* metres */
    const struct spray *spray;   /* NULL: none shows */
    struct display_range range;
    float gain;
    bool has_color, needs_color, needs_curvature, needs_optics, needs_layers;
    atomic_int next;
};

static void resolve_optics(struct shade_optics *out, const struct backend *cpu, const struct frame *frame)
{
    const struct view *view = &frame->view;
    const struct mns_params *params = &frame->params;
    *out = (struct shade_optics){.orthographic = view->orthographic,
                                 .fx = view->fx,
                                 .fy = view->fy,
                                 .cx = view->cx,
                                 .cy = view->cy,
                                 .step_x = 1 / view->fx,
                                 .step_y = 1 / view->fy,
                                 .edge = params->edge_threshold * frame->splat_radius,
                                 .one_sided = params->display == MNS_DISPLAY_SPHERES,
                                 .schlick = params->fresnel == MNS_FRESNEL_SCHLICK,
                                 .index = params->refraction_index,
                                 .refraction = params->refraction_strength,
                                 .reflection = params->reflection,
                                 .specular = params->specular,
                                 .shininess = params->shininess,
                                 .scene = cpu->scene.color,
                                 .scene_stride = cpu->scene.stride,
                                 .foam_extinction = params->foam_extinction / frame->splat_radius,
                                 .foam_range_extinction = params->foam_range_extinction / frame->splat_radius,
                                 .foam_blend = FOAM_BLEND * frame->splat_radius,
                                 .width = view->width,
                                 .height = view->height,
                                 .transparent = params->background == MNS_BACKGROUND_TRANSPARENT && !frame->scene};
    if (cpu->scene.has_depth && cpu->scene.cuts_fluid) { /* a floor under all fluid hides none of it */
        out->scene_depth = cpu->scene.depth.data;
        out->scene_depth_stride = cpu->scene.depth.stride;
    }
    mns_sky_resolve(&out->sky, frame);
    float sine = frame->look.sun[frame->look.axis_up];
    for (int c = 0; c < 3; c++) {
        float light = out->sky.sun_light[c] * sine + out->sky.sky_light[c];
        out->absorption[c] = frame->absorption[c];
        out->absorption_mean += frame->absorption[c] / 3;
        out->scatter[c] = params->fluid_color[c] * light;
        out->scatter_light[c] = SCATTER_WHITE * light;
        out->opaque[c] = params->opaque_color[c];
        /* A drop is lit from all around: half of it by the sun, all of it by the means of the sky and the ground. */
        out->spray[c] =
            params->spray_color[c] * (0.5f * out->sky.sun_light[c] + 0.5f * (out->sky.sky_light[c] + 0.5f * out->sky.ground[c]));
        out->grey[c] = params->noise_color[c] * light; /* of the surface as a whole: on the waves foam would be specks of dark and light */
        out->foam_front[c] = params->foam_front_color[c] * light;
        out->foam_back[c] = params->foam_back_color[c] * light;
    }
}

/* Thickness and colour at the row's pixels. */
static void sample_thickness(const struct shade_run *run, struct shade_row *row)
{
    const struct thickness_image *in = &run->cpu->blurred;
    const struct blur_kernels *blur = run->cpu->kernels->blur;
    int top;
    float weight = blur_rows_of(row->y, in->scale, &top);
    const float *rows = in->thickness.data + top * in->thickness.stride;
    blur->upsample(rows, rows + in->thickness.stride, weight, in->scale, row->x, row->count, row->thickness);
    for (int c = 0; c < 3 && run->needs_color; c++) {
        rows = in->color[c].data + top * in->color[c].stride;
        blur->upsample(rows, rows + in->color[c].stride, weight, in->scale, row->x, row->count, row->color[c]);
        for (int i = 0; i < row->count; i++) {
            row->color[c][i] = row->thickness[i] > 0 ? row->color[c][i] / row->thickness[i] : 0;
        }
    }
}

/* Foam at the row's pixels: its planes hold something in tiles with foam only. Returns whether there is any. */
static bool sample_foam(const struct shade_run *run, struct shade_row *row)
{
    const struct foam *foam = run->foam;
    if (!foam) {
        return false;
    }
    bool any = false;
    const unsigned char *tiles = foam->tiles + row->y / TILE_SIZE * foam->columns;
    for (int begin = 0, end; begin < row->count; begin = end) {
        end = (row->x + begin) / TILE_SIZE * TILE_SIZE + TILE_SIZE - row->x;
        end = end < row->count ? end : row->count;
        size_t bytes = sizeof(float) * (size_t)(end - begin);
        if (tiles[(row->x + begin) / TILE_SIZE]) {
            int x = row->x + begin;
            memcpy(row->foam_depth + begin, foam->depth.plane.data + row->y * foam->depth.plane.stride + x, bytes);
            memcpy(row->foam + begin, foam->thickness.data + row->y * foam->thickness.stride + x, bytes);
            memcpy(row->foam_range + begin, foam->front.data + row->y * foam->front.stride + x, bytes);
            any = true;
            continue;
        }
        for (int i = begin; i < end; i++) {
            row->foam_depth[i] = DEPTH_EMPTY;
            row->foam[i] = row->foam_range[i] = 0;
        }
    }
    if (any) {
        const struct blur_kernels *blur = run->cpu->kernels->blur;
        int top, scale = run->cpu->blurred.scale;
        float weight = blur_rows_of(row->y, scale, &top);
        const float *rows = foam->before.data + top * foam->before.stride;
        blur->upsample(rows, rows + foam->before.stride, weight, scale, row->x, row->count, row->before);
        for (int i = 0; i < row->count; i++) {
            row->before[i] *= row->thickness[i];
        }
        run->cpu->kernels->shade->veil(&run->optics, row);
    }
    return any;
}

/* Depths with the noise on them, and those above and below: what the normals are those of ([LGS09] 3.4). Returns where the row's first stands. A
 * scene before the fluid is moved along, so that it hides the same pixels. */
static const float *add_waves(const struct shade_run *run, const struct shade_row *row, float depths[3][NORMALS_WIDTH], float *scene_depth)
{
    int width = row->count + 2 * SHADE_MARGIN;
    for (int r = 0; r < 3; r++) {
        const float *depth = run->surface->data + (row->y + r - 1) * run->surface->stride + row->x - SHADE_MARGIN;
        const float *noise = run->noise->data + (row->y + r - 1) * run->noise->stride + row->x - SHADE_MARGIN;
        for (int i = 0; i < width; i++) {
            depths[r][i] = depth[i] - run->noise_height * noise[i];
        }
    }
    const float *noise = run->noise->data + row->y * run->noise->stride + row->x;
    const float *scene = run->optics.scene_depth + row->y * run->optics.scene_depth_stride + row->x;
    for (int i = 0; i < row->count && run->optics.scene_depth; i++) {
        scene_depth[i] = scene[i] - run->noise_height * noise[i];
    }
    return depths[1] + SHADE_MARGIN;
}

/* Normals of the row, of what shows. Returns how many pixels have fluid. */
static int row_normals(const struct shade_run *run, struct shade_row *row, const float *depth)
{
    const struct shade_optics *optics = &run->optics;
    const float *scene_depth = optics->scene_depth ? optics->scene_depth + row->y * optics->scene_depth_stride + row->x : NULL;
    ptrdiff_t stride = run->surface->stride;
    float waves[3][NORMALS_WIDTH], waves_scene[SHADE_SPAN];
    if (run->noise) {
        depth = add_waves(run, row, waves, waves_scene);
        stride = NORMALS_WIDTH;
        scene_depth = scene_depth ? waves_scene : NULL;
    }
    return run->cpu->kernels->shade->normals(optics, depth, stride, scene_depth, row->x, row->y, row->count, row->nx, row->ny, row->nz);
}

/* Grey foam where the noise is large ([LGS09] 3.5). */
static void cover_with_grey(const struct shade_run *run, struct shade_row *row)
{
    const struct mns_params *params = &run->frame->params;
    const float *noise = run->noise->data + row->y * run->noise->stride + row->x;
    for (int i = 0; i < row->count; i++) {
        float part = params->noise_foam * (fabsf(noise[i]) - params->noise_threshold);
        row->grey[i] = part > 0 ? part < 1 ? part : 1 : 0;
    }
}

/* Spray over what is there: that behind the water through as much of it as the scene behind is seen through. */
static void add_spray(const struct shade_run *run, struct shade_row *row, bool has_foam)
{
    const struct spray *spray = run->spray;
    const float *front = spray->front.data + row->y * spray->front.stride + row->x;
    const float *behind = spray->behind.data + row->y * spray->behind.stride + row->x;
    bool water = run->frame->params.display == MNS_DISPLAY_BEAUTY;
    for (int i = 0; i < row->count; i++) {
        if (!(front[i] > 0) && !(behind[i] > 0)) {
            continue;
        }
        float over = 1 - expf(-front[i]), under = water && row->nz[i] != 0 ? 1 - expf(-behind[i]) : 0, veil = has_foam ? row->veil[i] : 1;
        float alpha = row->out[3][i], light[3], hidden = 0;
        for (int c = 0; c < 3; c++) {
            light[c] = alpha * row->out[c][i];
            if (under > 0) {
                float through = under * veil * (1 - row->fresnel[i]) * row->transmittance[c][i];
                light[c] += through * (run->optics.spray[c] - (run->optics.transparent ? 0 : row->behind[4 * i + c]));
                hidden += run->optics.transparent ? through / 3 : 0;
            }
        }
        float covers = over + (1 - over) * fminf(alpha + hidden, 1);
        for (int c = 0; c < 3; c++) {
            row->out[c][i] = covers > 0 ? (over * run->optics.spray[c] + (1 - over) * light[c]) / covers : 0;
        }
        row->out[3][i] = covers;
    }
}

static void row_curvature(const struct shade_run *run, const struct shade_row *row, float *curvature)
{
    float normals[3][3][NORMALS_WIDTH];
    struct shade_normals at;
    const float *depth = run->surface->data + row->y * run->surface->stride + row->x;
    for (int r = 0; r < 3; r++) {
        run->cpu->kernels->shade->normals(&run->optics, depth - SHADE_MARGIN + (r - 1) * run->surface->stride, run->surface->stride, NULL,
                                          row->x - SHADE_MARGIN, row->y + r - 1, row->count + 2 * SHADE_MARGIN, normals[r][0],
                                          normals[r][1], normals[r][2]);
        for (int c = 0; c < 3; c++) {
            at.n[r][c] = normals[r][c] + SHADE_MARGIN;
        }
    }
    run->cpu->kernels->shade->curvature(&run->optics, &at, depth, run->surface->stride, row->x, row->y, row->count, curvature);
    for (int i = 0; i < row->count; i++) {
        curvature[i] = row->nz[i] != 0 ? curvature[i] : 0;
    }
}

/* The first value of the row in a layer of float32, or NULL where it is not asked for. */
static float *layer_at(const struct shade_run *run, enum mns_layer layer, const struct shade_row *row)
{
    const struct mns_image *image = mns_frame_output(run->frame, layer);
    return image ? (float *)mns_pixels_row(image, row->y) + (ptrdiff_t)image->channels * row->x : NULL;
}

static void write_layers(const struct shade_run *run, const struct shade_row *row, bool has_foam, const float *curvature)
{
    float *depth = layer_at(run, MNS_LAYER_DEPTH, row), *normal = layer_at(run, MNS_LAYER_NORMAL, row);
    float *curved = layer_at(run, MNS_LAYER_CURVATURE, row), *color = layer_at(run, MNS_LAYER_COLOR, row);
    float *transmittance = layer_at(run, MNS_LAYER_TRANSMITTANCE, row), *alpha = layer_at(run, MNS_LAYER_ALPHA, row);
    float *noise = layer_at(run, MNS_LAYER_NOISE, row);
    for (int i = 0; i < row->count; i++) {
        bool fluid = row->nz[i] != 0;
        if (depth) {
            depth[i] = fluid ? row->depth[i] : INFINITY;
        }
        if (normal) { /* view space is (x, -y, -z) of image space */
            normal[3 * i] = row->nx[i];
            normal[3 * i + 1] = fluid ? -row->ny[i] : 0;
            normal[3 * i + 2] = fluid ? -row->nz[i] : 0;
        }
        if (curved) {
            curved[i] = curvature[i];
        }
        if (noise) {
            noise[i] = fluid && run->noise ? run->noise->data[row->y * run->noise->stride + row->x + i] : 0;
        }
        float sum = 0, veil = run->spray ? expf(-run->spray->front.data[row->y * run->spray->front.stride + row->x + i]) : 1;
        veil *= has_foam ? row->veil[i] : run->noise && fluid ? 1 - row->grey[i] : 1;
        for (int c = 0; c < 3; c++) {
            float through = veil * (fluid ? row->transmittance[c][i] * (1 - row->fresnel[i]) : 1);
            sum += through;
            if (color) {
                color[3 * i + c] = fluid && run->has_color ? row->color[c][i] : 0;
            }
            if (transmittance) {
                transmittance[3 * i + c] = through;
            }
        }
        if (alpha) {
            alpha[i] = fluid || veil < 1 ? 1 - sum / 3 : 0;
        }
    }
}

static void write_foam_layers(const struct shade_run *run, const struct shade_row *row, bool has_foam)
{
    float *depth = layer_at(run, MNS_LAYER_FOAM_DEPTH, row), *foam = layer_at(run, MNS_LAYER_FOAM_THICKNESS, row);
    float *range = layer_at(run, MNS_LAYER_FOAM_FRONT_THICKNESS, row), *front = layer_at(run, MNS_LAYER_THICKNESS_FRONT, row);
    float *back = layer_at(run, MNS_LAYER_THICKNESS_BACK, row);
    for (int i = 0; i < row->count; i++) {
        bool here = has_foam && row->foam_depth[i] < DEPTH_LIMIT;
        float before = here ? row->before[i] : 0;
        if (depth) {
            depth[i] = here ? row->foam_depth[i] : INFINITY;
        }
        if (foam) {
            foam[i] = here ? row->foam[i] : 0;
        }
        if (range) {
            range[i] = here ? row->foam_range[i] : 0;
        }
        if (front) {
            front[i] = before;
        }
        if (back) {
            back[i] = row->thickness[i] - before;
        }
    }
}

/* Narkowicz 2016: a fit to the curve of the Academy's (ACES) reference for screens, for light times 0.6. */
static float filmic(float v)
{
    v = 0.6f * fmaxf(v, 0);
    return fminf(v * (2.51f * v + 0.03f) / (v * (2.43f * v + 0.59f) + 0.14f), 1);
}

/* Reinhard and others 2002, eq. 4. */
static float reinhard(float v)
{
    enum { WHITE = 4 };
    v = fmaxf(v, 0);
    return v * (1 + v / (WHITE * WHITE)) / (1 + v);
}

/* Colours times the gain to 0 to 1, in place. An infinite one is white. */
static void map_tones(const struct shade_run *run, struct shade_row *row)
{
    bool film = run->frame->params.tone_map == MNS_TONE_MAP_FILMIC;
    for (int c = 0; c < 3; c++) {
        for (int i = 0; i < row->count; i++) {
            float v = fminf(row->out[c][i] * run->gain, 1e6f);
            row->out[c][i] = film ? filmic(v) : reinhard(v);
        }
    }
}

static void draw(struct shade_run *run, struct shade_row *row, bool has_foam, const float *curvature)
{
    const struct shade_kernels *kernels = run->cpu->kernels->shade;
    if (run->optics.has_mirrored) {
        mns_surroundings_mirror(&run->surroundings, &run->optics, row);
    }
    switch (run->frame->params.display) {
    case MNS_DISPLAY_BEAUTY:
        if (!run->optics.transparent) {
            kernels->fetch(&run->optics, row);
        }
        if (has_foam) {
            kernels->layered(&run->optics, run->has_color, row);
        } else {
            kernels->water(&run->optics, run->has_color, row);
        }
        break;
    case MNS_DISPLAY_OPAQUE:
    case MNS_DISPLAY_SPHERES: kernels->opaque(&run->optics, run->has_color, row); break;
    case MNS_DISPLAY_COLOR: mns_display_color(&run->optics, run->has_color, row); return;
    default: mns_display_row(run->frame, &run->range, row, curvature); return;
    }
    if (run->noise) {
        kernels->grey(&run->optics, row);
    }
}

static void shade_row(struct shade_run *run, struct shade_row *row)
{
    const struct shade_optics *optics = &run->optics;
    const float *depth = run->surface->data + row->y * run->surface->stride + row->x;
    const struct mns_image *beauty = mns_frame_output(run->frame, MNS_LAYER_BEAUTY);
    float curvature[SHADE_SPAN];
    int display = run->frame->params.display;
    bool diagram = mns_display_is_diagram(display);
    int found = row_normals(run, row, depth);
    if (found > 0 || run->foam || run->needs_layers) {
        sample_thickness(run, row);
    }
    bool has_foam = sample_foam(run, row);
    if (found > 0) {
        memcpy(row->depth, depth, sizeof(float) * (size_t)row->count);
        if (run->noise) {
            cover_with_grey(run, row);
        }
        if (run->needs_curvature) {
            row_curvature(run, row, curvature);
        }
        if (run->needs_optics) {
            run->cpu->kernels->shade->optics(optics, run->has_color, row);
        }
    } else {
        memset(curvature, 0, sizeof(curvature));
    }
    if (run->needs_layers) {
        write_layers(run, row, has_foam, curvature);
        write_foam_layers(run, row, has_foam);
    }
    if (!beauty) {
        return;
    }
    if (found > 0 || diagram || has_foam) {
        draw(run, row, has_foam, curvature);
    } else {
        run->cpu->kernels->shade->split(optics->scene + 4 * (row->y * optics->scene_stride + row->x), row->count, row->out);
    }
    if (run->spray && !diagram && display != MNS_DISPLAY_COLOR) {
        add_spray(run, row, has_foam);
    }
    bool as_is = diagram || display == MNS_DISPLAY_COLOR; /* to be compared with a scale */
    bool mapped = !as_is && run->frame->params.tone_map != MNS_TONE_MAP_NONE && beauty->pixel != MNS_PIXEL_F32;
    if (mapped) {
        map_tones(run, row);
    }
    run->cpu->kernels->shade->encode(row->out, row->count, as_is || mapped ? 1 : run->gain, diagram ? PIXEL_CODE : PIXEL_COLOR,
                                     beauty->pixel, beauty->channels, mns_pixels_at(beauty, row->x, row->y));
}

static void shade_job(void *context, int index)
{
    (void)index;
    struct shade_run *run = context;
    struct shade_row row;
    int width = run->optics.width, height = run->optics.height;
    for (;;) {
        int top = atomic_fetch_add(&run->next, ROWS_PER_JOB);
        if (top >= height) {
            return;
        }
        for (row.y = top; row.y < top + ROWS_PER_JOB && row.y < height; row.y++) {
            for (row.x = 0; row.x < width; row.x += SHADE_SPAN) {
                row.count = width - row.x < SHADE_SPAN ? width - row.x : SHADE_SPAN;
                shade_row(run, &row);
            }
        }
    }
}

mns_result mns_cpu_shade(struct backend *cpu, const struct frame *frame)
{
    const unsigned wanted = frame->wanted;
    int display = frame->params.display;
    struct shade_run run = {.cpu = cpu, .frame = frame, .gain = exp2f(frame->params.exposure)};
    run.foam = cpu->foam && cpu->foam->shows ? cpu->foam : NULL;
    run.surface = display == MNS_DISPLAY_SPHERES ? &cpu->depth_raw.plane : &cpu->smoothed->plane;
    if (frame->params.foam == MNS_FOAM_NOISE && display != MNS_DISPLAY_SPHERES) {
        run.noise = &cpu->noise;
        run.noise_height = frame->params.noise_height * frame->splat_radius;
    }
    run.spray = cpu->spray && cpu->spray->shows ? cpu->spray : NULL;
    resolve_optics(&run.optics, cpu, frame);
    mns_surroundings_resolve(&run.surroundings, frame);
    run.optics.has_mirrored = run.surroundings.environment != NULL;
    run.has_color = cpu->blurred.has_color;
    run.needs_color = run.has_color;
    run.needs_curvature = (wanted >> MNS_LAYER_CURVATURE & 1) || display == MNS_DISPLAY_CURVATURE;
    run.needs_optics = display == MNS_DISPLAY_BEAUTY || (wanted & (1u << MNS_LAYER_TRANSMITTANCE | 1u << MNS_LAYER_ALPHA)) != 0;
    run.needs_layers = (wanted & ~(1u << MNS_LAYER_BEAUTY)) != 0;
    if (wanted >> MNS_LAYER_BEAUTY & 1) {
        run.range = mns_display_measure(cpu, frame);
    }
    cpu_run(cpu, shade_job, &run, cpu->host.threads);
    const struct mns_image *beauty = mns_frame_output(frame, MNS_LAYER_BEAUTY);
    if (frame->params.antialias && beauty && !mns_display_is_diagram(display)) {
        const struct shade_optics *optics = &run.optics;
        struct silhouette silhouette = {.depth = display == MNS_DISPLAY_SPHERES ? &cpu->depth_raw : cpu->smoothed,
                                        .scene_depth = optics->scene_depth ? &cpu->scene.depth : NULL,
                                        .edge = optics->edge,
                                        .slope = SHADE_SLOPE_MAX * fmaxf(fabsf(optics->step_x), fabsf(optics->step_y)),
                                        .orthographic = optics->orthographic,
                                        .image = beauty};
        return mns_silhouette_blend(cpu, &silhouette) ? MNS_OK : cpu_out_of_memory(cpu);
    }
    return MNS_OK;
}
