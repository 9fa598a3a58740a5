/* particles.h: the prepared set: structure of arrays in spatial order, in chunks with boxes; a store for each thing that is drawn. */
#ifndef MNS_CPU_PARTICLES_H
#define MNS_CPU_PARTICLES_H

#include "core/frame.h"
#include "core/memory.h"

enum { CHUNK_SIZE = 64 };

/* Water: particles with water > 0. Foam: with foam > 0, and diffuse foam and bubbles. Spray: with spray > 0, and diffuse spray. A particle may be in
 * several. */
enum store_kind { STORE_WATER, STORE_FOAM, STORE_SPRAY, STORE_KINDS };

/* Particle i of chunk c is at [c * CHUNK_SIZE + i]; the last chunk is padded with copies of its last particle to a whole chunk, so that
 * kernels may load whole vectors; count tells how many are real. Positions are relative to facts.origin, which all stores share. */
struct particle_store {
    size_t count, chunk_count;
    size_t own;         /* of count: of the set itself; the rest are diffuse */
    size_t capacity;    /* chunks that there is room for */
    float *x, *y, *z;   /* metres */
    float *radius;      /* metres: as given, times the factor; NULL: none is given */
    float *factor;      /* of water or foam, on the radius; NULL: all 1 */
    float *mass;        /* kg, or NULL */
    float *color[3];    /* water: linear, or NULL */
    float *shape[6];    /* water: xx, yy, zz, xy, xz, yz of A, world space, or NULL: spheres */
    float *age;         /* foam: 0 to 1, or NULL: all 0 */
    float *opacity;     /* spray: 0 to 1 */
    float *velocity[3]; /* spray, and water that keeps passes: m/s, world space, or NULL */
    float *noise;       /* water: amplitude, 0 to 1, or NULL: all 1 */
    float *id;          /* water that keeps passes: its id, else its index; else NULL */
    float *seed;        /* a whole number under 2^24 for each particle, by its id, else its index */
    /* Boxes of the chunks' centres, the largest radius, the largest factor and a bound on the longest semi-axis of A in each (0 when there are
     * none). [chunk_count rounded up to 16] */
    float *box_min[3], *box_max[3], *box_radius, *box_factor, *box_stretch;
    struct particle_facts facts; /* of the whole set, whatever the store holds of it */
};

/* Copies and orders a set. passes: the water keeps velocities and ids. Fills measure and the stores' facts. On failure all are empty. */
mns_result mns_particle_stores_fill(struct particle_store stores[STORE_KINDS], struct memory *memory, const struct mns_parallel *parallel,
                                    int threads, const struct mns_particles *particles, bool passes, struct mns_measure *measure,
                                    struct mns_message *message);

/* Puts diffuse particles in the place of those that there are. *dropped: whose positions are not finite. On failure there are none. */
mns_result mns_particle_stores_diffuse(struct particle_store stores[STORE_KINDS], struct memory *memory,
                                       const struct mns_parallel *parallel, int threads, const struct mns_particles *diffuse,
                                       size_t *dropped, struct mns_message *message);

void mns_particle_store_free(struct particle_store *store, struct memory *memory);

#endif
