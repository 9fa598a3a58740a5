/* run.c: draws a scene with a filter through the public library, and measures the result. */
#include "run.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Pixels to the right and down from frame to frame: no fraction that a frame could share with another. */
static const double SHIFT_RIGHT = 1.0 / 3, SHIFT_DOWN = 1.0 / 5;

static const struct mns_param *filter_row(void) { return mns_param_find("filter"); }

int lab_filter_count(void) { return (int)filter_row()->maximum + 1; }

const char *lab_filter_name(int filter) { return filter_row()->choices[filter]; }

int lab_filter_find(const char *name)
{
    for (int i = 0; i < lab_filter_count(); i++) {
        if (!strcmp(name, lab_filter_name(i))) {
            return i;
        }
    }
    return -1;
}

static mns_result fail(struct lab *lab, mns_result result, const char *text)
{
    snprintf(lab->message.text, sizeof(lab->message.text), "%s", text);
    return result;
}

mns_result lab_fail(struct lab *lab, mns_result result) { return fail(lab, result, mns_result_text(result)); }

static mns_result fail_memory(struct lab *lab) { return lab_fail(lab, MNS_ERR_OUT_OF_MEMORY); }

static mns_result fail_renderer(struct lab *lab, mns_result result)
{
    return result == MNS_OK ? result : fail(lab, result, mns_renderer_message(lab->renderer));
}

/* ---- a lab ---- */

static bool allocate(struct lab *lab)
{
    size_t pixels = (size_t)lab->settings.width * (size_t)lab->settings.height;
    lab->depth = malloc(pixels * sizeof(*lab->depth));
    lab->normal = malloc(3 * pixels * sizeof(*lab->normal));
    bool good = lab->depth && lab->normal;
    for (int i = 0; i < LAB_FRAMES; i++) {
        lab->raw[i] = malloc(pixels * sizeof(*lab->raw[i]));
        good = good && lab->raw[i];
    }
    return good;
}

static mns_result create_anisotropy(struct lab *lab)
{
    struct mns_anisotropy_params params;
    mns_anisotropy_params_init(&params);
    params.isa = lab->settings.isa;
    params.threads = lab->settings.threads;
    return mns_anisotropy_create(&lab->anisotropy, &params, &lab->message);
}

mns_result lab_create(struct lab *lab, const struct lab_settings *settings)
{
    *lab = (struct lab){.settings = *settings, .scene = -1};
    struct mns_params *params = &lab->settings.params;
    params->radius = 0.5f;
    params->floor = params->shadow = 0;
    params->background = MNS_BACKGROUND_COLOR;
    struct lab_view view = lab_view_make(settings->width, settings->height);
    for (int i = 0; i < LAB_FRAMES; i++) {
        lab->view[i] = lab_view_shift(&view, i * SHIFT_RIGHT, i * SHIFT_DOWN);
    }
    struct mns_renderer_params renderer;
    mns_renderer_params_init(&renderer);
    renderer.isa = settings->isa;
    renderer.threads = settings->threads;
    mns_stats_init(&lab->stats);
    mns_result result = allocate(lab) ? mns_renderer_create(&lab->renderer, &renderer, &lab->message) : fail_memory(lab);
    return result == MNS_OK && params->anisotropy ? create_anisotropy(lab) : result;
}

static void leave(struct lab *lab)
{
    for (int i = 0; i < LAB_FRAMES; i++) {
        lab_reference_free(&lab->reference[i]);
    }
    lab->scene = -1;
}

void lab_destroy(struct lab *lab)
{
    leave(lab);
    for (int i = 0; i < LAB_FRAMES; i++) {
        free(lab->raw[i]);
    }
    free(lab->depth);
    free(lab->normal);
    mns_renderer_destroy(&lab->renderer);
    mns_anisotropy_destroy(&lab->anisotropy);
}

struct mns_params lab_params(const struct lab *lab, int filter)
{
    struct mns_params params = lab->settings.params;
    params.filter = filter;
    return params;
}

double lab_radius_pixels(const struct lab *lab) { return (double)lab->settings.params.radius_scale * 0.5 * LAB_SPACING_PIXELS; }

/* ---- drawing ---- */

static double smooth_ms(const struct mns_stats *stats)
{
    for (int i = 0; i < stats->stage_count; i++) {
        if (!strcmp(stats->stage_name[i], "smooth")) {
            return stats->stage_ms[i];
        }
    }
    return NAN;
}

mns_result lab_draw(struct lab *lab, const struct mns_params *params, int frame, int repeat, double *ms)
{
    static const double enough = 100; /* ms: what takes so long is told as well by fewer draws */
    struct mns_image image = {.width = lab->settings.width, .height = lab->settings.height, .channels = 1};
    struct mns_output outputs[] = {{MNS_LAYER_DEPTH_RAW, image}, {MNS_LAYER_DEPTH, image}, {MNS_LAYER_NORMAL, image}};
    outputs[0].image.data = lab->raw[frame];
    outputs[1].image.data = lab->depth;
    outputs[2].image.data = lab->normal;
    outputs[2].image.channels = 3;
    struct mns_camera camera;
    struct mns_frame picture;
    mns_frame_init(&picture);
    picture.camera = &camera;
    picture.params = params;
    picture.outputs = outputs;
    picture.output_count = sizeof(outputs) / sizeof(outputs[0]);
    mns_result result = lab_view_camera(&lab->view[frame], &camera);
    double best = INFINITY, spent = 0;
    for (int i = 0; result == MNS_OK && i < repeat && spent < enough; i++) {
        result = mns_renderer_draw(lab->renderer, &picture);
        mns_renderer_stats(lab->renderer, &lab->stats);
        best = fmin(best, smooth_ms(&lab->stats));
        spent += smooth_ms(&lab->stats);
    }
    if (ms) {
        *ms = best;
    }
    return fail_renderer(lab, result);
}

/* Gives the particles shapes where the parameters say so. */
static mns_result find_shapes(struct lab *lab, struct mns_particles *particles)
{
    if (!lab->anisotropy) {
        return MNS_OK;
    }
    mns_result result = mns_anisotropy_step(lab->anisotropy, particles, &lab->settings.params);
    if (result != MNS_OK) {
        snprintf(lab->message.text, sizeof(lab->message.text), "%s", mns_anisotropy_message(lab->anisotropy));
        return result;
    }
    mns_anisotropy_attach(lab->anisotropy, particles);
    return MNS_OK;
}

static mns_result prepare(struct lab *lab, const struct lab_scene *scene)
{
    struct lab_cloud cloud;
    struct mns_particles particles;
    lab_scene_particles(scene, &lab->view[0], &cloud);
    mns_particles_init(&particles);
    particles.count = cloud.count;
    particles.position = (struct mns_attr){.data = cloud.position, .type = MNS_F32};
    mns_result result = cloud.failed ? fail_memory(lab) : find_shapes(lab, &particles);
    result = result == MNS_OK ? fail_renderer(lab, mns_renderer_prepare(lab->renderer, &particles)) : result;
    lab_cloud_free(&cloud);
    return result;
}

/* ---- scenes ---- */

/* Measures what was drawn last, the first frame. */
static bool measure_picture(const struct lab *lab, struct lab_values *out)
{
    struct lab_residual residual;
    bool good =
        lab_residual_make(&residual, &lab->reference[0], lab->depth, lab->normal) && lab_measure(&residual, lab->raw[0], lab->depth, out);
    lab_residual_free(&residual);
    return good;
}

/* What is known of a frame before any filter runs. */
static mns_result learn_frame(struct lab *lab, const struct lab_scene *scene, int frame)
{
    struct mns_params params = lab_params(lab, MNS_FILTER_NONE);
    struct lab_reference *reference = &lab->reference[frame];
    mns_result result = lab_draw(lab, &params, frame, 1, NULL);
    if (result != MNS_OK) {
        return result;
    }
    const struct lab_view *view = &lab->view[frame];
    double radius = lab->stats.splat_radius;
    bool good = frame == 0 ? lab_reference_make(reference, scene, view, lab->raw[frame], radius)
                           : lab_reference_fill(reference, scene, view, lab->raw[frame], radius, &lab->reference[0].offsets);
    if (good && frame == 0) {
        lab->unsmoothed = lab_values_none();
        good = measure_picture(lab, &lab->unsmoothed);
    }
    return good ? MNS_OK : fail_memory(lab);
}

mns_result lab_enter(struct lab *lab, int index)
{
    if (lab->scene == index) {
        return MNS_OK;
    }
    struct lab_scene scene;
    leave(lab);
    lab_scene_make(&scene, index, &lab->view[0]);
    lab->frames = scene.tells & LAB_TELLS_FLICKER ? LAB_FRAMES : 1;
    mns_result result = prepare(lab, &scene);
    for (int i = 0; result == MNS_OK && i < lab->frames; i++) {
        result = learn_frame(lab, &scene, i);
    }
    lab->scene = result == MNS_OK ? index : -1;
    return result;
}

/* ---- measuring ---- */

static mns_result draw_residual(struct lab *lab, const struct mns_params *params, int frame, struct lab_residual *out)
{
    mns_result result = lab_draw(lab, params, frame, 1, NULL);
    bool good = result != MNS_OK || lab_residual_make(out, &lab->reference[frame], lab->depth, lab->normal);
    return good ? result : fail_memory(lab);
}

/* The mean square over the moves to the second frame, to the third and back to the first, as a root. */
static void combine_flicker(const struct lab_residual residuals[LAB_FRAMES], struct lab_values *out)
{
    double depth = 0, normal = 0;
    for (int i = 0; i < LAB_FRAMES; i++) {
        int next = (i + 1) % LAB_FRAMES;
        lab_measure_flicker(&residuals[i], &residuals[next], (next - i) * SHIFT_RIGHT, (next - i) * SHIFT_DOWN, out);
        depth += out->of[LAB_FLICKER_DEPTH] * out->of[LAB_FLICKER_DEPTH];
        normal += out->of[LAB_FLICKER_NORMAL] * out->of[LAB_FLICKER_NORMAL];
    }
    out->of[LAB_FLICKER_DEPTH] = sqrt(depth / LAB_FRAMES);
    out->of[LAB_FLICKER_NORMAL] = sqrt(normal / LAB_FRAMES);
}

mns_result lab_run(struct lab *lab, const struct mns_params *params, struct lab_values *out)
{
    *out = lab_values_none();
    if (lab->settings.proceed && !lab->settings.proceed(lab->settings.user)) {
        return fail(lab, MNS_ERR_UNSUPPORTED, "stopped");
    }
    struct lab_residual residuals[LAB_FRAMES] = {{0}};
    mns_result result = lab_draw(lab, params, 0, lab->settings.repeat, &out->of[LAB_MS]);
    if (result == MNS_OK && (!lab_residual_make(&residuals[0], &lab->reference[0], lab->depth, lab->normal) ||
                             !lab_measure(&residuals[0], lab->raw[0], lab->depth, out))) {
        result = fail_memory(lab);
    }
    for (int i = 1; result == MNS_OK && i < lab->frames; i++) {
        result = draw_residual(lab, params, i, &residuals[i]);
    }
    if (result == MNS_OK && lab->frames == LAB_FRAMES) {
        combine_flicker(residuals, out);
    }
    for (int i = 0; i < LAB_FRAMES; i++) {
        lab_residual_free(&residuals[i]);
    }
    return result;
}
