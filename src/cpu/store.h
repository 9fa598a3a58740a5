/* store.h: the arrays of a particle store, filled from a caller's attributes in a given order. */
#ifndef MNS_CPU_STORE_H
#define MNS_CPU_STORE_H

#include "core/attr.h"
#include "cpu/particles.h"

#include <math.h>

/* Factors and opacities up to this count as 0: a sphere a thousandth as large shows nowhere. */
#define MEMBER_LEAST 1e-3f

/* A particle's place in the order. */
struct store_entry {
    uint32_t key, index;
};

/* What a store is filled from. Attributes of diffuse particles that are absent have other defaults. */
struct store_source {
    const struct mns_particles *particles;
    const struct store_entry *entries; /* in order */
    size_t count;                      /* of entries */
    enum store_kind kind;
    bool diffuse;
    double radius; /* of the fluid's particles, metres, and their mean mass, kg: what diffuse ones are measured by */
    float mass;
};

/* The factor or opacity that makes particle i one of the kind: 0 to 1. */
float mns_store_member(const struct mns_particles *particles, enum store_kind kind, bool diffuse, size_t i);

/* The position of particle i relative to the origin. false: it is not finite. type: of the positions, apart so that loops compile to plain loads. */
static inline bool store_position(const struct mns_particles *particles, enum mns_type type, const double origin[3], size_t i, float out[3])
{
    bool finite = true;
    for (int k = 0; k < 3; k++) {
        double p = mns_attr_get(&particles->position, type, 3, i, k);
        finite = finite && isfinite(p);
        out[k] = (float)(p - origin[k]);
    }
    return finite;
}

/* Fills an empty store (of which facts are set), or adds diffuse particles to one. false: out of memory, and the store is as it was. */
bool mns_store_fill(struct particle_store *store, const struct store_source *source, struct memory *memory,
                    const struct mns_parallel *parallel, int slices);

/* Drops what is diffuse. */
void mns_store_drop_diffuse(struct particle_store *store, struct memory *memory);

#endif
