/* scenery.h: what stands around the fluid: the environment, and meshes, read for each frame and drawn into its scene. */
#ifndef MENISCUS_SCENERY_H
#define MENISCUS_SCENERY_H

#include "options.h"

struct scenery;

/* Reads what stands still; *out NULL where the options name neither mesh nor environment. Returns a status; scenery_destroy may always be called. */
int scenery_create(struct scenery **out, const struct options *options);
void scenery_destroy(struct scenery *scenery); /* NULL is fine */

/* Fills frame->environment and frame->objects for the frame of that number, whose particles the renderer holds. NULL scenery: does nothing. Returns a status. */
int scenery_draw(struct scenery *scenery, mns_renderer *renderer, long long number, struct mns_frame *frame);

#endif
