/* render.c: `meniscus render`: pictures from particle files. */
#include "inputs.h"
#include "load.h"
#include "look.h"
#include "outputs.h"
#include "program.h"
#include "progress.h"
#include "stats.h"
#include "survey.h"
#include "view.h"

#include <stdlib.h>
#include <string.h>

struct render {
    struct options *options;
    struct inputs inputs;
    bool *chosen; /* [inputs.count]: by --frames */
    size_t chosen_count;
    struct outputs outputs;
    struct survey survey; /* of a sequence */
    mns_renderer *renderer;
    cJSON *stats; /* NULL: not asked for */
    struct progress progress;
    size_t failed;
};

/* ---- before the first frame ---- */

static int find_inputs(struct render *render)
{
    struct options *options = render->options;
    if (options->input_count == 0) {
        return program_usage("render needs an input: meniscus render INPUT... -o OUTPUT");
    }
    int status = options->camera_file ? view_read_camera(options, options->camera_file) : STATUS_DONE;
    if (status == STATUS_DONE && options->input_count == 1 && view_is_case(options->inputs[0])) {
        char *particles;
        status = view_read_case(options, options->inputs[0], &particles);
        status = status == STATUS_DONE ? inputs_add(&render->inputs, particles) : status;
        free(particles);
    } else {
        for (size_t i = 0; status == STATUS_DONE && i < options->input_count; i++) {
            status = inputs_add(&render->inputs, options->inputs[i]);
        }
    }
    inputs_number(&render->inputs);
    for (size_t i = 0; status == STATUS_DONE && render->inputs.count > 1 && i < render->inputs.count; i++) {
        if (!strcmp(render->inputs.list[i].path, "-")) { /* frames are read more than once */
            status = program_usage("-: standard input must be the only input");
        }
    }
    return status;
}

static int choose_frames(struct render *render)
{
    const struct options *options = render->options;
    const struct inputs *inputs = &render->inputs;
    long long lowest = inputs->list[0].number, highest = lowest;
    render->chosen = calloc(inputs->count, sizeof(*render->chosen));
    if (!render->chosen) {
        return program_fail("out of memory");
    }
    for (size_t i = 0; i < inputs->count; i++) {
        lowest = inputs->list[i].number < lowest ? inputs->list[i].number : lowest;
        highest = inputs->list[i].number > highest ? inputs->list[i].number : highest;
    }
    long long first = options->has_first ? options->first : lowest, last = options->has_last ? options->last : highest;
    for (size_t i = 0; i < inputs->count; i++) {
        long long number = inputs->list[i].number;
        render->chosen[i] = number >= first && number <= last && (number - first) % options->step == 0;
        render->chosen_count += render->chosen[i];
    }
    return render->chosen_count
               ? STATUS_DONE
               : program_usage("--frames chooses none of the %zu frames, whose numbers are %lld to %lld", inputs->count, lowest, highest);
}

static int begin(struct render *render)
{
    int status = find_inputs(render);
    status = status == STATUS_DONE ? choose_frames(render) : status;
    status = status == STATUS_DONE ? program_check_picture(render->options->width, render->options->height) : status;
    status = status == STATUS_DONE ? outputs_plan(&render->outputs, render->options, &render->inputs, render->chosen_count) : status;
    if (status == STATUS_DONE && render->options->stats) {
        status = program_check_place(render->options->stats);
    }
    if (status == STATUS_DONE && render->options->save_look) {
        status = look_write(render->options->save_look, &render->options->params);
    }
    if (status == STATUS_DONE && render->inputs.count > 1) {
        status = survey_inputs(&render->survey, &render->inputs, render->options);
    }
    if (status == STATUS_DONE && render->options->stats && !(render->stats = stats_create(render->options))) {
        status = program_fail("%s: out of memory", render->options->stats);
    }
    return status == STATUS_DONE ? program_renderer(&render->renderer, render->options) : status;
}

/* ---- one frame ---- */

static void warn_if_empty(const struct render *render, const char *path, const struct mns_stats *stats)
{
    if (stats->pixels_covered > 0 || render->options->quiet) {
        return;
    }
    program_warn("%s: %s; the picture is the background", path,
                 stats->measure.count > 0 ? "none of the particles is in view" : "holds no particles");
}

/* Draws the prepared particles of input i. */
static int draw(struct render *render, size_t i, const struct mns_particles *particles)
{
    const struct options *options = render->options;
    struct mns_params params = options->params;
    struct survey survey = render->survey;
    struct mns_stats stats;
    mns_stats_init(&stats);
    if (render->inputs.count == 1) {
        mns_renderer_stats(render->renderer, &stats);
        survey_from_measure(&survey, &stats.measure);
    } else {
        survey_fix_params(&survey, particles->radius.data != NULL, particles->mass.data != NULL, &params);
    }
    struct mns_camera camera;
    int status = view_camera(&camera, options, &survey, (double)i, (double)render->inputs.list[i].number);
    if (status != STATUS_DONE) {
        return status;
    }
    struct mns_frame frame;
    mns_frame_init(&frame);
    frame.camera = &camera;
    frame.params = &params;
    frame.outputs = render->outputs.images;
    frame.output_count = render->outputs.count;
    if (mns_renderer_draw(render->renderer, &frame) != MNS_OK) {
        return program_fail("%s: %s", render->inputs.list[i].path, mns_renderer_message(render->renderer));
    }
    mns_renderer_stats(render->renderer, &stats);
    warn_if_empty(render, render->inputs.list[i].path, &stats);
    return STATUS_DONE;
}

static void note(struct render *render, const struct input *input, struct frame_times times)
{
    struct mns_stats stats;
    mns_stats_init(&stats);
    mns_renderer_stats(render->renderer, &stats);
    if (render->stats) {
        stats_add_frame(render->stats, input->number, input->path, &stats, times);
    }
    if (render->options->verbose) {
        program_say("%s: %zu particles, radius %g, read %.1f ms, prepare %.1f ms, draw %.1f ms, write %.1f ms", input->path,
                    stats.measure.count, stats.splat_radius / (double)render->options->params.radius_scale, times.read_ms, stats.prepare_ms,
                    stats.draw_ms, times.write_ms);
    }
}

/* A frame that cannot be read: passed over and counted, or the end. */
static int fail_frame(struct render *render, const char *text)
{
    render->failed++;
    if (!render->options->keep_going) {
        return program_fail("%s", text);
    }
    program_warn("%s", text);
    return STATUS_DONE;
}

static int render_frame(struct render *render, size_t i)
{
    const struct input *input = &render->inputs.list[i];
    struct frame_times times;
    struct mns_message message;
    mns_particle_set *set;
    double start = program_seconds();
    if (load_particles(&set, input->path, render->options, &message) != MNS_OK) {
        return fail_frame(render, message.text);
    }
    times.read_ms = 1e3 * (program_seconds() - start);
    const struct mns_particles *particles = mns_particle_set_particles(set);
    int status = STATUS_DONE;
    if (mns_renderer_prepare(render->renderer, particles) != MNS_OK) {
        status = program_fail("%s: %s", input->path, mns_renderer_message(render->renderer));
    }
    status = status == STATUS_DONE ? draw(render, i, particles) : status;
    mns_particle_set_destroy(&set);
    start = program_seconds();
    status = status == STATUS_DONE ? outputs_write(&render->outputs, input->number) : status;
    times.write_ms = 1e3 * (program_seconds() - start);
    if (status == STATUS_DONE) {
        note(render, input, times);
    }
    return status;
}

/* ---- all of them ---- */

static int render_frames(struct render *render)
{
    int status = STATUS_DONE;
    progress_begin(&render->progress, render->chosen_count, render->options->quiet);
    for (size_t i = 0; status == STATUS_DONE && i < render->inputs.count && !program_signal(); i++) {
        if (!render->chosen[i]) {
            continue;
        }
        if (render->options->resume && outputs_exist(&render->outputs, render->inputs.list[i].number)) {
            progress_skip(&render->progress);
            continue;
        }
        status = render_frame(render, i);
        progress_step(&render->progress, render->inputs.list[i].path);
    }
    progress_clear();
    return status;
}

static int finish(struct render *render, int status)
{
    if (render->stats) {
        int written = stats_write(render->options->stats, render->stats, render->failed);
        render->stats = NULL;
        status = status == STATUS_DONE ? written : status;
    }
    if (status == STATUS_DONE && program_signal()) {
        program_say("stopped by a signal; --resume goes on from here");
        return STATUS_SIGNAL + program_signal();
    }
    if (status == STATUS_DONE && render->failed) {
        return program_fail("%zu of %zu frames could not be read and were skipped", render->failed, render->chosen_count);
    }
    return status;
}

int command_render(struct options *options)
{
    struct render render = {.options = options};
    program_catch_interrupts();
    int status = begin(&render);
    if (status == STATUS_DONE) {
        status = finish(&render, render_frames(&render));
    }
    mns_renderer_destroy(&render.renderer);
    outputs_free(&render.outputs);
    inputs_free(&render.inputs);
    cJSON_Delete(render.stats);
    free(render.chosen);
    return status;
}
