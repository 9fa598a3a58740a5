/* sink.h: pictures on their way to their files: written while the next ones are drawn. */
#ifndef MENISCUS_SINK_H
#define MENISCUS_SINK_H

#include "outputs.h"
#include "stats.h"

/* A picture in hand: the caller draws into its images and says what it is; the sink writes it. */
struct picture {
    struct mns_output images[OUTPUT_MAX]; /* [outputs.count] */
    long long number;
    const char *input;        /* path */
    struct mns_camera camera; /* set where outputs_tell_camera asks for it */
    struct mns_stats stats;
    struct frame_times times; /* write_ms is the sink's */
    struct mns_message message;
    bool failed; /* it could not be written; message says why */
};

struct sink; /* opaque */

/* report is called for each picture once it is written or could not be, in the order of sink_put, in the thread that calls the sink.
 * count: pictures that will come. NULL after telling why. */
struct sink *sink_start(const struct outputs *outputs, size_t count, void (*report)(void *user, const struct picture *picture), void *user);

/* A picture to draw into; waits until one is free. NULL after telling why: no memory. */
struct picture *sink_take(struct sink *sink);

void sink_put(struct sink *sink, struct picture *picture);  /* to be written */
void sink_drop(struct sink *sink, struct picture *picture); /* not to be written after all */

/* Reports what has been written by now; waits for all there is where wait is true. */
void sink_collect(struct sink *sink, bool wait);

/* Collects the rest and frees all. NULL is fine. */
void sink_stop(struct sink *sink);

#endif
