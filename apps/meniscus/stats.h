/* stats.h: what the renderer and the program measured, as JSON. */
#ifndef MENISCUS_STATS_H
#define MENISCUS_STATS_H

#include "options.h"

#include <cjson/cJSON.h>

struct frame_times {
    double read_ms, write_ms;
};

/* The object that --stats writes: {"width", ..., "frames": []}. NULL: out of memory. */
cJSON *stats_create(const struct options *options);
void stats_add_frame(cJSON *stats, long long number, const char *input, const struct mns_stats *measured, struct frame_times times);
int stats_write(const char *path, cJSON *stats, size_t failed); /* deletes stats; returns a status */

/* {name: ms} of the stages. */
void stats_add_stages(cJSON *object, int count, const char *const *names, const double *ms);

#endif
