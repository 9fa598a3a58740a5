/* particles.h: the prepared set: structure of arrays in spatial order, in chunks with boxes. */
#ifndef MNS_CPU_PARTICLES_H
#define MNS_CPU_PARTICLES_H

#include "core/frame.h"
#include "core/memory.h"

enum { CHUNK_SIZE = 64 };

/* Particle i of chunk c is at [c * CHUNK_SIZE + i]; the last chunk is padded with copies of its last particle to a whole chunk, so that
 * kernels may load whole vectors; count tells how many are real. Positions are relative to facts.origin. */
struct particle_store {
    size_t count, chunk_count;
    float *x, *y, *z; /* metres */
    float *radius;    /* metres, or NULL: all the same */
    float *mass;      /* kg, or NULL */
    float *color[3];  /* linear, or NULL */
    /* Boxes of the chunks' centres, and the largest radius in each (0 when radius is NULL). [chunk_count rounded up to 16] */
    float *box_min[3], *box_max[3], *box_radius;
    struct particle_facts facts;
};

/* Copies and orders a set. Fills measure and store->facts. On failure the store is empty. */
mns_result mns_particle_store_fill(struct particle_store *store, struct memory *memory, const struct mns_parallel *parallel, int threads,
                                   const struct mns_particles *particles, struct mns_measure *measure, struct mns_message *message);
void mns_particle_store_free(struct particle_store *store, struct memory *memory);

#endif
