/* load.h: particles from a file or from standard input, and a renderer for them, as the options say. */
#ifndef MENISCUS_LOAD_H
#define MENISCUS_LOAD_H

#include "options.h"

/* "-" is standard input, which can be read once. On failure *out is NULL and message says why; warnings are told unless quiet. */
mns_result load_particles(mns_particle_set **out, const char *path, const struct options *options, struct mns_message *message);

/* Where the library's warnings go. */
struct mns_log program_log(const struct options *options);

/* A renderer as the options want it. Returns STATUS_DONE or, after telling why, STATUS_FAILED. */
int program_renderer(mns_renderer **out, const struct options *options);

#endif
