/* source.h: the frames of a sequence, read ahead while others are drawn. */
#ifndef MENISCUS_SOURCE_H
#define MENISCUS_SOURCE_H

#include "coloring.h"
#include "inputs.h"
#include "load.h"
#include "options.h"

/* A frame as it was read. set NULL: it cannot be read, and message says why. */
struct source_frame {
    size_t input; /* its index in the inputs */
    mns_particle_set *set;
    struct mns_particles particles; /* of the set, painted */
    struct painted painted;
    struct mns_message message;
    struct load_notes notes; /* not told yet */
    double read_ms;
};

struct source; /* opaque */

/* Starts to read the inputs whose wanted[i] is true, in their order. coloring NULL: particles keep their own colours. NULL after telling why. All
 * arguments must outlive it. */
struct source *source_start(const struct inputs *inputs, const bool *wanted, const struct options *options,
                            const struct coloring *coloring);

/* The next wanted frame; waits until it is read. NULL: there is no more. At most two may be the caller's at a time. */
struct source_frame *source_next(struct source *source);

/* Gives a frame back, with its set; NULL is fine. */
void source_release(struct source *source, struct source_frame *frame);

/* Waits for what is being read, and frees all. NULL is fine. */
void source_stop(struct source *source);

#endif
