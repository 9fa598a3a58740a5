/* progress.h: a bar with rate and time left on standard error. */
#ifndef MENISCUS_PROGRESS_H
#define MENISCUS_PROGRESS_H

#include <stdbool.h>
#include <stddef.h>

struct progress {
    size_t done, skipped, total; /* skipped: of those done, those that took no time */
    double start;                /* seconds */
    bool shown;
};

/* Nothing is shown unless standard error is a terminal and there is more than one thing to do. */
void progress_begin(struct progress *progress, size_t total, bool quiet);
void progress_step(struct progress *progress, const char *what);
void progress_stage(const struct progress *progress, const char *stage, const char *what); /* "drawing" a frame */
void progress_skip(struct progress *progress, size_t count);                               /* those that are done already */
void progress_clear(void); /* takes the bar away, for a line of text or at the end */

#endif
