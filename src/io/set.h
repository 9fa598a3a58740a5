/* set.h: the inside of a particle set, shared by the files that fill and finish it. */
#ifndef MNS_IO_SET_H
#define MNS_IO_SET_H

#include "core/memory.h"
#include "io/reader.h"

enum { ATTRIBUTE_MAX = 4096 }; /* per file: no simulator comes near, and names are searched one by one */

struct attribute {
    struct mns_attribute is; /* what callers see */
    uint8_t *data;           /* [capacity][components], or a view into a kept file (capacity 0) */
    size_t capacity;         /* particles */
    size_t filled;           /* particles of the pieces so far that had it */
    bool dropped;            /* pieces disagree; freed when the piece ends */
    bool hidden;             /* a role's array in a type the renderer takes; not listed */
    bool joined;             /* put together from other attributes, which are listed too */
};

struct block {
    void *data;
    size_t size;
};

struct mns_particle_set {
    struct memory memory;
    const char *format;
    size_t count;       /* particles in all pieces so far; of the set once finished */
    size_t piece_count; /* of these, in the piece in hand */
    size_t file_count, dropped;
    struct attribute *attributes; /* [attribute_capacity] */
    size_t attribute_count, attribute_capacity, listed_count;
    struct block *files; /* whose bytes attributes point into */
    size_t file_blocks, file_capacity;
    struct mns_particles particles;
    mns_result fault; /* of the last mns_read_fail */
};

/* Gives the set a file's bytes, which came from mns_read_alloc(size, 1). false: out of memory, the bytes stay the caller's. */
bool mns_set_keep_file(struct read_context *context, struct bytes file);

/* After the last piece: drops attributes that not all pieces have. */
void mns_set_end(struct read_context *context);

/* Adds an array for all particles once the pieces have ended; NULL: failed, message set. Moves the other attributes. */
struct attribute *mns_set_extra(struct read_context *context, const char *name, enum mns_type type, int components, bool hidden);

/* Keeps particle i where keep[i] is not 0. keep: [set->count] */
void mns_set_compact(mns_particle_set *set, const uint8_t *keep);

void mns_set_free(mns_particle_set *set); /* all it holds, not itself */

/* Finds a listed attribute by its name, exactly; NULL: none. */
struct attribute *mns_set_find(const mns_particle_set *set, const char *name, size_t length);

/* "density, velocity[3], id": for messages. Ends in "..." when it does not fit; "nothing" for none. */
void mns_set_list(const mns_particle_set *set, char *text, size_t size);

/* roles.c: finds out which attribute is what, from the table of known names and params->roles; joins u, v, w and the like. */
mns_result mns_roles_assign(struct read_context *context);
mns_result mns_roles_views(struct read_context *context); /* fills set->particles; the set is compacted by now */

/* where.c: clears keep[i] of particles for which the expression is not true. */
mns_result mns_where(struct read_context *context, const char *expression, uint8_t *keep);

#endif
