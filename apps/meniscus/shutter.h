/* shutter.h: the light of several pictures in one. */
#ifndef MENISCUS_SHUTTER_H
#define MENISCUS_SHUTTER_H

#include <meniscus/common.h>

struct shutter; /* opaque */

/* NULL: out of memory. */
struct shutter *shutter_create(int width, int height);
void shutter_destroy(struct shutter *shutter); /* NULL is fine */

void shutter_open(struct shutter *shutter); /* begins a picture */

/* Where the next sample is drawn: 4 channels float32, linear, straight alpha. */
struct mns_image shutter_image(struct shutter *shutter);

/* Takes the sample in. white: what is brighter counts as this: 1 where the picture holds no more, so that a glint that is far brighter than white
 * leaves a streak and no row of white dots; else INFINITY. */
void shutter_add(struct shutter *shutter, float white);

/* The mean of the samples: linear light, weighted by alpha, in the pixels that out has (3 or 4 channels of any type). */
void shutter_close(struct shutter *shutter, const struct mns_image *out);

#endif
