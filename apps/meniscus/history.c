/* history.c: leads the frames of a sequence through the classifier. */
#include "history.h"

#include "load.h"
#include "program.h"

#include <math.h>

/* Frames beyond the memory in seconds: a velocity and its change are told from two more. */
enum { BEYOND = 2 };

/* When the simulation was as a frame has it: as a .pvd tells, else by --fps, of which --retime puts in more pictures. */
static double time_of(const struct history *history, size_t input)
{
    const struct options *options = history->options;
    return history->timed ? history->inputs->list[input].time : (double)input * options->retime * options->fps[1] / options->fps[0];
}

int history_begin(struct history *history, const struct options *options, const struct inputs *inputs, const struct survey *survey)
{
    *history = (struct history){.options = options, .inputs = inputs, .params = options->params, .timed = inputs_timed(inputs)};
    if (options->params.foam == MNS_FOAM_NONE) {
        return STATUS_DONE;
    }
    if (survey) {
        survey_fix_params(survey, false, false, &history->params);
    }
    return program_classifier(&history->classifier, options);
}

void history_end(struct history *history) { mns_classifier_destroy(&history->classifier); }

size_t history_depth(const struct history *history)
{
    if (!history->classifier || history->inputs->count < 2) {
        return 0;
    }
    double step = INFINITY; /* the least */
    for (size_t i = 1; i < history->inputs->count; i++) {
        step = fmin(step, time_of(history, i) - time_of(history, i - 1));
    }
    double frames = ceil(mns_classifier_memory(&history->params) / step) + BEYOND;
    return frames < (double)history->inputs->count ? (size_t)frames : history->inputs->count;
}

int history_step(struct history *history, size_t input, struct mns_particles *particles)
{
    if (!history->classifier) {
        return STATUS_DONE;
    }
    const char *name = history->inputs->list[input].path;
    if (input != history->next) {
        mns_classifier_reset(history->classifier);
    }
    history->next = input + 1;
    if (history->inputs->count == 1 && !particles->velocity.data && particles->count > 0 && !history->options->quiet) {
        program_warn("%s: one frame without velocities tells of no foam; an attribute with the role velocity does, or the frame before",
                     name);
    }
    if (mns_classifier_step(history->classifier, particles, time_of(history, input), &history->params) != MNS_OK) {
        return program_fail("%s: %s", name, mns_classifier_message(history->classifier));
    }
    mns_classifier_attach(history->classifier, particles);
    if (history->options->verbose) {
        struct mns_class_stats stats;
        mns_class_stats_init(&stats);
        mns_classifier_stats(history->classifier, &stats);
        program_say("%s: %zu particles with foam (%.0f whole ones), %zu with spray, classify %.1f ms", name, stats.foam, stats.foam_volume,
                    stats.spray, stats.step_ms);
    }
    return STATUS_DONE;
}

void history_skip(struct history *history, size_t input) { history->next = input == history->next ? input + 1 : history->next; }
