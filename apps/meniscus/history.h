/* history.h: what particles are drawn as, which depends on the frames before. */
#ifndef MENISCUS_HISTORY_H
#define MENISCUS_HISTORY_H

#include "inputs.h"
#include "options.h"
#include "survey.h"

/* Zero is one that does nothing, as without foam. */
struct history {
    const struct options *options;
    const struct inputs *inputs;
    struct mns_params params; /* with the fluid's size fixed */
    mns_classifier *classifier;
    size_t next; /* input */
    bool timed;  /* the inputs tell their times */
};

/* survey: of the sequence; NULL: a single frame. Returns a status; on failure it was told why. history_end may always be called. */
int history_begin(struct history *history, const struct options *options, const struct inputs *inputs, const struct survey *survey);
void history_end(struct history *history);

/* How many frames before a picture's must be seen for it to be the picture of the whole sequence. */
size_t history_depth(const struct history *history);

/* Takes in the next frame, and attaches what it found, which stands through the step after this one. Where frames were left out it begins anew.
 * Returns a status; on failure it was told why. */
int history_step(struct history *history, size_t input, struct mns_particles *particles);

/* A frame that cannot be read is passed over. */
void history_skip(struct history *history, size_t input);

#endif
