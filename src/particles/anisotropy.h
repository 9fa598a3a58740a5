/* anisotropy.h: inside of mns_anisotropy. */
#ifndef MNS_PARTICLES_ANISOTROPY_H
#define MNS_PARTICLES_ANISOTROPY_H

#include <meniscus/anisotropy.h>

#include "cpu/kernels.h"
#include "particles/grid.h"

#include <string.h>

struct mns_anisotropy {
    struct memory memory;
    struct mns_log log;
    struct mns_message message;
    struct pool *pool; /* NULL: the caller's threads */
    struct mns_parallel parallel;
    int threads;
    const struct anisotropy_kernels *kernels;
    struct grid grid;
    double spacing; /* as measured, metres; 0: not yet */

    /* Of the last step. */
    size_t count;   /* 0: nothing to attach */
    float *shape;   /* [count][6] */
    void *position; /* [count][3] of position_type, with room for doubles */
    enum mns_type position_type;
    size_t shape_room, position_room;
    double radius, reach, step_ms;
};

/* Sets one coordinate of a particle's position. */
static inline void anisotropy_place(mns_anisotropy *self, size_t particle, int axis, double value)
{
    if (self->position_type == MNS_F32) {
        ((float *)self->position)[3 * particle + (size_t)axis] = (float)value;
    } else {
        ((double *)self->position)[3 * particle + (size_t)axis] = value;
    }
}

/* Fills shape and position of all particles in the grid. */
void mns_anisotropy_shapes(mns_anisotropy *self, const struct mns_params *params);

#endif
