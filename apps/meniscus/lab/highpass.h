/* highpass.h: the part of a deviation that changes from particle to particle. */
#ifndef MENISCUS_LAB_HIGHPASS_H
#define MENISCUS_LAB_HIGHPASS_H

#include "measure.h"

/* Planes of [height][width]. */
struct lab_highpass {
    float *turn[3];
};

/* The turn of the normals less its own mean, weighted by a Gaussian whose sigma is 1.5 spacings in the middle of the scene, over the pixels that
 * count. false: out of memory. lab_highpass_free may always be called. */
bool lab_highpass_make(struct lab_highpass *out, const struct lab_residual *residual);
void lab_highpass_free(struct lab_highpass *high);

#endif
