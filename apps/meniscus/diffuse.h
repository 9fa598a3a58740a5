/* diffuse.h: a simulation's own foam, spray and bubbles, matched with the frames by number. */
#ifndef MENISCUS_DIFFUSE_H
#define MENISCUS_DIFFUSE_H

#include "inputs.h"
#include "options.h"

struct diffuse; /* opaque */

/* The files of --foam-particles. *out NULL: none are asked for. Names that match no frame are told, those of which no file does are refused. Returns a
 * status; on failure it was told why. diffuse_end may always be called. */
int diffuse_begin(struct diffuse **out, const struct options *options, const struct inputs *inputs);
void diffuse_end(struct diffuse *diffuse);

/* Reads the frame's files, and gives their particles to the renderer, whose own are prepared. diffuse NULL: nothing to do. Returns a status; on failure it
 * was told why. */
int diffuse_prepare(struct diffuse *diffuse, mns_renderer *renderer, long long number);

#endif
