/* draw.c: one picture from particles. */
#include "draw.h"

#include "fluids.h"
#include "program.h"
#include "view.h"

#include <math.h>

void draw_warn_if_empty(const struct drawing *drawing, const char *name, const struct mns_stats *stats)
{
    if (stats->pixels_covered > 0 || drawing->options->quiet) {
        return;
    }
    program_warn("%s: %s; the picture is the background", name,
                 stats->measure.count > 0 ? "none of the particles is in view" : "holds no particles");
}

int draw_camera(const struct drawing *drawing, const struct mns_stats *stats, const struct moment *moment, struct mns_camera *camera)
{
    struct survey survey;
    if (drawing->survey) {
        survey = *drawing->survey;
    } else {
        survey_from_measure(&survey, &stats->measure);
    }
    return view_camera(camera, drawing->options, &survey, moment->index, moment->number);
}

/* Gives the particles shapes. */
static int find_shapes(const struct drawing *drawing, const char *name, const struct mns_params *params, struct mns_particles *particles)
{
    if (mns_anisotropy_step(drawing->anisotropy, particles, params) != MNS_OK) {
        return program_fail("%s: %s", name, mns_anisotropy_message(drawing->anisotropy));
    }
    mns_anisotropy_attach(drawing->anisotropy, particles);
    return STATUS_DONE;
}

int draw_picture(const struct drawing *drawing, const struct mns_particles *particles, const struct moment *moment,
                 const struct mns_output *images, size_t image_count, struct mns_stats *stats)
{
    struct mns_particles shaped = *particles;
    struct mns_params params = drawing->options->params;
    mns_stats_init(stats);
    if (drawing->fluids) {
        return fluids_draw(drawing, particles, moment, images, image_count, stats);
    }
    if (drawing->survey) {
        survey_fix_params(drawing->survey, particles->radius.data != NULL, particles->mass.data != NULL, &params);
    }
    if (drawing->anisotropy && find_shapes(drawing, moment->name, &params, &shaped) != STATUS_DONE) {
        return STATUS_FAILED;
    }
    if (mns_renderer_prepare(drawing->renderer, &shaped) != MNS_OK) {
        return program_fail("%s: %s", moment->name, mns_renderer_message(drawing->renderer));
    }
    int status = diffuse_prepare(drawing->diffuse, drawing->renderer, (long long)floor(moment->number));
    if (status != STATUS_DONE) {
        return status;
    }
    if (drawing->diffuse && params.foam == MNS_FOAM_NONE) { /* they alone, of which nothing need be told */
        params.foam = MNS_FOAM_LAYERED;
    }
    struct mns_camera camera;
    mns_renderer_stats(drawing->renderer, stats);
    status = draw_camera(drawing, stats, moment, &camera);
    if (status != STATUS_DONE) {
        return status;
    }
    struct mns_frame frame;
    mns_frame_init(&frame);
    frame.camera = &camera;
    frame.params = &params;
    frame.outputs = images;
    frame.output_count = image_count;
    status = scenery_draw(drawing->scenery, drawing->renderer, (long long)moment->number, &frame);
    if (status != STATUS_DONE) {
        return status;
    }
    if (mns_renderer_draw(drawing->renderer, &frame) != MNS_OK) {
        return program_fail("%s: %s", moment->name, mns_renderer_message(drawing->renderer));
    }
    mns_renderer_stats(drawing->renderer, stats);
    return STATUS_DONE;
}
