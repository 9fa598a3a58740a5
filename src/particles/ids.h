/* ids.h: which particle of the frame before a particle is, by its id. */
#ifndef MNS_PARTICLES_IDS_H
#define MNS_PARTICLES_IDS_H

#include "core/memory.h"

#include <meniscus/particles.h>

#include <stdbool.h>

static const uint32_t ID_NONE = UINT32_MAX;

/* What became of the ids from one set to the next. */
struct id_news {
    size_t appeared, vanished;              /* particles not in the set before; particles of the set before not in this one */
    size_t returned;                        /* of those that appeared: in some earlier set */
    size_t repeated;                        /* particles with the id of one before them in the same set */
    int64_t first_repeated, first_returned; /* one such id of each kind, where there is one */
};

/* A table of the ids seen, open addressing. Zero before the first use. */
struct ids {
    struct id_entry *entries; /* [capacity] */
    size_t capacity;          /* 0 or 2^bits */
    int bits;
    size_t used, distinct; /* entries; different ids in the last set */
    uint32_t set;          /* number of the last set, from 1 */
    uint32_t *slots;       /* [slots_room] of the last set's particles */
    size_t slots_room;
};

/* from[i]: the index in the set before of the particle with the id of particle i, or ID_NONE. Of particles with one id the first stands for
 * all. false: out of memory. */
bool mns_ids_match(struct ids *ids, struct memory *memory, const struct mns_parallel *parallel, const struct mns_attr *id, size_t count,
                   uint32_t *from, struct id_news *news);

void mns_ids_forget(struct ids *ids); /* the next set is the first; keeps the memory */
void mns_ids_free(struct ids *ids, struct memory *memory);

#endif
