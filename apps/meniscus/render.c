/* render.c: `meniscus render`: plans the pictures, and leads frames from the source over drawing to the sink. */
#include "fluids.h"
#include "history.h"
#include "legend.h"
#include "look.h"
#include "plan.h"
#include "program.h"
#include "progress.h"
#include "shoot.h"
#include "source.h"
#include "view.h"

#include <stdlib.h>
#include <string.h>

struct render {
    const struct options *options;
    struct inputs inputs;
    struct plan plan;
    struct outputs outputs;
    struct survey survey; /* of a sequence */
    struct coloring coloring;
    struct history history;
    struct drawing drawing;
    struct shooting shooting;
    struct source *source;
    struct source_frame *here, *there; /* the shot's, and the one behind it; NULL: none yet */
    bool fresh;                        /* no shot of these two was drawn yet */
    struct sink *sink;
    size_t next;  /* shot */
    size_t lost;  /* shots whose frames could not be read */
    cJSON *stats; /* NULL: not asked for */
    struct progress progress;
    int write_status; /* STATUS_FAILED once a picture could not be written */
    size_t failed;    /* frames that could not be read */
};

/* ---- before the first frame ---- */

static int find_inputs(struct render *render, struct options *options)
{
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

static int begin(struct render *render, struct options *options)
{
    int status = find_inputs(render, options);
    status = status == STATUS_DONE ? plan_make(&render->plan, &render->inputs, options) : status;
    status = status == STATUS_DONE ? program_check_picture(options->width, options->height) : status;
    status = status == STATUS_DONE ? outputs_plan(&render->outputs, options, &render->inputs, render->plan.count) : status;
    if (status == STATUS_DONE && options->stats) {
        status = program_check_place(options->stats);
    }
    if (status == STATUS_DONE && options->save_look) {
        status = look_write(options->save_look, &options->params);
    }
    if (status == STATUS_DONE && options->color.by) {
        status = coloring_begin(&render->coloring, options);
    }
    bool surveyed = render->inputs.count > 1 || options->fluid_count > 0;
    struct fluids *fluids = NULL;
    if (status == STATUS_DONE && surveyed) {
        status = survey_inputs(&render->survey, &render->inputs, options);
    }
    status = status == STATUS_DONE ? fluids_begin(&fluids, options, &render->inputs, &render->outputs, &render->survey) : status;
    if (status == STATUS_DONE && options->color.by) {
        coloring_survey(&render->coloring, surveyed ? &render->survey : NULL);
    }
    if (status == STATUS_DONE) {
        status = history_begin(&render->history, options, &render->inputs, render->inputs.count > 1 ? &render->survey : NULL);
    }
    if (status == STATUS_DONE && options->stats && !(render->stats = stats_create(options))) {
        status = program_fail("%s: out of memory", options->stats);
    }
    render->drawing = (struct drawing){.options = options, .survey = surveyed ? &render->survey : NULL, .fluids = fluids};
    status = status == STATUS_DONE ? diffuse_begin(&render->drawing.diffuse, options, &render->inputs) : status;
    status = status == STATUS_DONE ? scenery_create(&render->drawing.scenery, options) : status;
    status = status == STATUS_DONE ? program_anisotropy(&render->drawing.anisotropy, options) : status;
    return status == STATUS_DONE ? program_renderer(&render->drawing.renderer, options) : status;
}

/* ---- what was written ---- */

/* The sink's news of a picture. */
static void report(void *user, const struct picture *picture)
{
    struct render *render = user;
    if (picture->failed) {
        if (picture->message.text[0]) { /* those behind it were not tried */
            render->write_status = program_fail("%s", picture->message.text);
        }
        return;
    }
    const struct mns_stats *stats = &picture->stats;
    if (render->stats) {
        stats_add_frame(render->stats, picture->number, picture->input, stats, picture->times);
    }
    if (render->options->verbose) {
        program_say("%s: %zu particles, radius %g, read %.1f ms, prepare %.1f ms, draw %.1f ms, write %.1f ms", picture->input,
                    stats->measure.count, stats->splat_radius / (double)render->options->params.radius_scale, picture->times.read_ms,
                    stats->prepare_ms, stats->draw_ms, picture->times.write_ms);
    }
    progress_step(&render->progress, picture->input);
}

/* ---- one frame ---- */

/* A frame that cannot be read: passed over and counted, or the end. What was drawn before it is written first. */
static int fail_frame(struct render *render, const struct source_frame *frame)
{
    render->failed++;
    sink_collect(render->sink, true);
    if (render->write_status != STATUS_DONE) {
        return render->write_status;
    }
    if (!render->options->keep_going) {
        return program_fail("%s", frame->message.text);
    }
    program_warn("%s", frame->message.text);
    return STATUS_DONE;
}

/* The next frame from the source, with its news told. */
static int pull(struct render *render, struct source_frame **out)
{
    progress_stage(&render->progress, "reading", "");
    struct source_frame *frame = *out = source_next(render->source);
    if (!frame) {
        return STATUS_DONE;
    }
    const struct source_frame *bad = fluids_next(render->drawing.fluids);
    if (frame->set && bad) {
        mns_particle_set_destroy(&frame->set);
        return fail_frame(render, bad);
    }
    if (!frame->set) {
        history_skip(&render->history, frame->input);
        return fail_frame(render, frame);
    }
    load_tell(&frame->notes, render->inputs.list[frame->input].path, render->options);
    return history_step(&render->history, frame->input, &frame->particles);
}

/* Pulls frames until a shot's are here. */
static int reach(struct render *render, const struct shot *shot)
{
    int status = STATUS_DONE;
    while (status == STATUS_DONE && (!render->here || render->here->input != shot->input)) {
        source_release(render->source, render->here);
        render->here = render->there;
        render->there = NULL;
        render->fresh = true;
        status = render->here ? STATUS_DONE : pull(render, &render->here);
        if (status == STATUS_DONE && !render->here) {
            return program_fail("%s: was not read", render->inputs.list[shot->input].path); /* the plan needs what no one read */
        }
    }
    if (status == STATUS_DONE && !render->there && shot_moves(shot, render->options) && shot->input + 1 < render->inputs.count) {
        status = pull(render, &render->there);
    }
    return status;
}

static int render_shot(struct render *render, const struct shot *shot)
{
    int status = reach(render, shot);
    if (status != STATUS_DONE) {
        return status;
    }
    bool moves = shot_moves(shot, render->options);
    if (!render->here->set || (moves && render->there && !render->there->set)) {
        render->lost++;
        return STATUS_DONE;
    }
    const char *path = render->inputs.list[shot->input].path;
    progress_stage(&render->progress, "writing", path);
    struct picture *picture = sink_take(render->sink);
    if (!picture) {
        return STATUS_FAILED;
    }
    picture->number = shot->number;
    picture->input = path;
    progress_stage(&render->progress, "drawing", path);
    picture->times.read_ms = render->here->read_ms;
    status = shoot(&render->shooting, shot, &render->here->particles, moves && render->there ? &render->there->particles : NULL,
                   render->fresh, picture, render->outputs.count);
    if (status == STATUS_DONE && render->options->color.legend) {
        status = legend_draw(&render->coloring, &render->here->painted, picture->images, render->outputs.count);
    }
    render->fresh = render->fresh && !moves;
    if (status == STATUS_DONE) {
        sink_put(render->sink, picture);
    } else {
        sink_drop(render->sink, picture);
    }
    return status == STATUS_DONE ? render->write_status : status;
}

/* ---- all of them ---- */

/* Leads all frames through. */
static int stream(struct render *render)
{
    plan_needs(&render->plan, &render->inputs, render->options);
    plan_reach_back(&render->plan, &render->inputs, history_depth(&render->history));
    progress_begin(&render->progress, render->plan.skipped + render->plan.count, render->options->quiet);
    progress_skip(&render->progress, render->plan.skipped);
    render->sink = sink_start(&render->outputs, render->plan.count, report, render);
    render->source = render->sink ? source_start(&render->inputs, render->plan.needed, render->options,
                                                 render->options->color.by ? &render->coloring : NULL)
                                  : NULL;
    int status = render->source
                     ? fluids_start(render->drawing.fluids, render->plan.needed, render->options->color.by ? &render->coloring : NULL)
                     : STATUS_FAILED;
    render->shooting = (struct shooting){.drawing = &render->drawing, .inputs = &render->inputs};
    while (status == STATUS_DONE && render->next < render->plan.count && !program_signal()) {
        status = render_shot(render, &render->plan.shots[render->next]);
        render->next += status == STATUS_DONE;
    }
    progress_stage(&render->progress, "writing", "");
    sink_stop(render->sink);
    shoot_end(&render->shooting);
    source_stop(render->source);
    fluids_stop(render->drawing.fluids);
    progress_clear();
    return status == STATUS_DONE ? render->write_status : status;
}

static int render_frames(struct render *render)
{
    if (render->options->resume) {
        plan_resume(&render->plan, &render->outputs);
    }
    if (render->plan.count == 0) {
        return STATUS_DONE;
    }
    int status = outputs_open(&render->outputs, render->options);
    status = status == STATUS_DONE ? stream(render) : status;
    int closed = outputs_close(&render->outputs, status == STATUS_DONE && render->next == render->plan.count);
    return status == STATUS_DONE ? closed : status;
}

static int finish(struct render *render, int status)
{
    if (render->stats) {
        int written = stats_write(render->options->stats, render->stats, render->failed);
        render->stats = NULL;
        status = status == STATUS_DONE ? written : status;
    }
    if (status == STATUS_DONE && program_signal()) {
        program_say("stopped by a signal%s", outputs_in_order(&render->outputs) ? "" : "; --resume goes on from here");
        return STATUS_SIGNAL + program_signal();
    }
    if (status == STATUS_DONE && render->failed) {
        return program_fail("%zu of %zu pictures are missing: frames could not be read", render->lost,
                            render->plan.skipped + render->plan.count);
    }
    return status;
}

int command_render(struct options *options)
{
    struct render render = {.options = options};
    program_catch_interrupts();
    program_steady_memory();
    int status = begin(&render, options);
    if (status == STATUS_DONE) {
        status = finish(&render, render_frames(&render));
    }
    mns_renderer_destroy(&render.drawing.renderer);
    mns_anisotropy_destroy(&render.drawing.anisotropy);
    scenery_destroy(render.drawing.scenery);
    diffuse_end(render.drawing.diffuse);
    fluids_end(render.drawing.fluids);
    history_end(&render.history);
    plan_free(&render.plan);
    inputs_free(&render.inputs);
    cJSON_Delete(render.stats);
    return status;
}
