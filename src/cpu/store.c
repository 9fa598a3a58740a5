/* store.c: the arrays of a particle store: which there are, their values from a caller's attributes, the chunks' boxes. */
#include "cpu/store.h"

#include "util/prefetch.h"

#include <float.h>

/* Radius of a diffuse particle that brings none, over the fluid's: FoamGenerator and its like sow many for each particle of the fluid. */
static const float DIFFUSE_RADIUS = 0.5f;

enum { ARRAYS = 24, BOXES = 9 };

struct fill {
    struct particle_store *store;
    const struct store_source *source;
    size_t first; /* place in the store of the first entry */
    int slices;
};

static size_t padded(size_t chunks) { return chunks * CHUNK_SIZE; }
static size_t padded_chunks(size_t chunks) { return (chunks + 15) / 16 * 16; }

static void list_arrays(struct particle_store *store, float **out[ARRAYS])
{
    float **const arrays[ARRAYS] = {
        &store->x,           &store->y,           &store->z,        &store->radius,   &store->factor,   &store->mass,
        &store->color[0],    &store->color[1],    &store->color[2], &store->age,      &store->opacity,  &store->velocity[0],
        &store->velocity[1], &store->velocity[2], &store->seed,     &store->shape[0], &store->shape[1], &store->shape[2],
        &store->shape[3],    &store->shape[4],    &store->shape[5], &store->noise,    &store->id,       NULL};
    memcpy(out, arrays, sizeof(arrays));
}

static void list_boxes(struct particle_store *store, float **out[BOXES])
{
    float **const boxes[BOXES] = {&store->box_min[0], &store->box_min[1], &store->box_min[2], &store->box_max[0], &store->box_max[1],
                                  &store->box_max[2], &store->box_radius, &store->box_factor, &store->box_stretch};
    memcpy(out, boxes, sizeof(boxes));
}

void mns_particle_store_free(struct particle_store *store, struct memory *memory)
{
    float **arrays[ARRAYS], **boxes[BOXES];
    list_arrays(store, arrays);
    list_boxes(store, boxes);
    for (int i = 0; i < ARRAYS && arrays[i]; i++) {
        mns_memory_put(memory, *arrays[i], padded(store->capacity), sizeof(float));
    }
    for (int i = 0; i < BOXES; i++) {
        mns_memory_put(memory, *boxes[i], padded_chunks(store->capacity), sizeof(float));
    }
    *store = (struct particle_store){0};
}

/* Which arrays the store has once the source is in it, beside those that it had. */
static void list_wanted(const struct particle_store *store, const struct store_source *source, bool out[ARRAYS])
{
    const struct mns_particles *in = source->particles;
    bool water = source->kind == STORE_WATER, foam = source->kind == STORE_FOAM, spray = source->kind == STORE_SPRAY;
    bool color = water && in->color.data, shape = water && in->shape.data, keeps = water && store->facts.keeps_passes;
    bool velocity = (spray && (store->velocity[0] || in->velocity.data)) || (keeps && in->velocity.data);
    const bool wanted[ARRAYS] = {true,
                                 true,
                                 true,
                                 store->facts.has_radius,
                                 !water || in->water.data,
                                 !spray && store->facts.has_mass,
                                 color,
                                 color,
                                 color,
                                 foam && (store->age || in->foam_age.data),
                                 spray,
                                 velocity,
                                 velocity,
                                 velocity,
                                 true,
                                 shape,
                                 shape,
                                 shape,
                                 shape,
                                 shape,
                                 shape,
                                 water && in->noise.data,
                                 keeps};
    memcpy(out, wanted, sizeof(wanted));
}

static bool allocate(struct particle_store *store, struct memory *memory, const bool wanted[ARRAYS])
{
    float **arrays[ARRAYS], **boxes[BOXES];
    list_arrays(store, arrays);
    list_boxes(store, boxes);
    store->capacity = store->chunk_count = (store->count + CHUNK_SIZE - 1) / CHUNK_SIZE;
    bool done = true;
    for (int i = 0; i < ARRAYS && arrays[i]; i++) {
        *arrays[i] = wanted[i] ? mns_memory_get(memory, padded(store->chunk_count), sizeof(float)) : NULL;
        done = done && (*arrays[i] || !wanted[i]);
    }
    for (int i = 0; i < BOXES; i++) {
        *boxes[i] = mns_memory_get(memory, padded_chunks(store->chunk_count), sizeof(float));
        done = done && *boxes[i];
    }
    return done;
}

/* A value held to 0 to 1; NaN: missing. */
static float unit_value(const struct mns_attr *attr, size_t i, float missing)
{
    double value = attr->data ? mns_attr_get(attr, attr->type, 1, i, 0) : (double)missing;
    return value >= 0 ? value < 1 ? (float)value : 1 : value < 0 ? 0 : missing;
}

float mns_store_member(const struct mns_particles *particles, enum store_kind kind, bool diffuse, size_t i)
{
    float member = 0;
    if (!diffuse) {
        member = kind == STORE_WATER  ? unit_value(&particles->water, i, 1)
                 : kind == STORE_FOAM ? unit_value(&particles->foam, i, 0)
                                      : unit_value(&particles->spray, i, 0);
    } else if (kind != STORE_WATER) {
        double what = particles->kind.data ? mns_attr_get(&particles->kind, particles->kind.type, 1, i, 0) : MNS_KIND_FOAM;
        if ((what == MNS_KIND_SPRAY) == (kind == STORE_SPRAY)) {
            member = unit_value(kind == STORE_SPRAY ? &particles->spray : &particles->foam, i, 1);
        }
    }
    return member > MEMBER_LEAST ? member : 0;
}

/* A whole number under 2^24, as even as can be whatever the ids are. */
static float seed_of(const struct mns_particles *in, size_t i)
{
    uint64_t id = (uint64_t)i;
    if (in->id.data) {
        double value = mns_attr_get(&in->id, in->id.type, 1, i, 0);
        id = value >= 0 && value < 0x1p53 ? (uint64_t)value : 0;
    }
    id = (id ^ id >> 32) * 0x9e3779b97f4a7c15u;
    return (float)(id >> 40);
}

/* What stands at one place of the store beside the position. */
static void gather_rest(const struct fill *fill, size_t place, size_t i)
{
    struct particle_store *store = fill->store;
    const struct store_source *source = fill->source;
    const struct mns_particles *in = source->particles;
    float radius = (float)source->radius, factor = mns_store_member(in, source->kind, source->diffuse, i), ratio = 1;
    if (in->radius.data) {
        radius = (float)mns_attr_get(&in->radius, in->radius.type, 1, i, 0);
        ratio = source->diffuse ? radius / (float)source->radius : 1;
    } else if (source->diffuse) {
        ratio = DIFFUSE_RADIUS;
        radius *= ratio;
    }
    if (store->opacity) {
        store->opacity[place] = factor;
        factor = 1;
    }
    if (store->radius) {
        store->radius[place] = radius * factor;
    } else {
        factor *= ratio;
    }
    if (store->factor) {
        store->factor[place] = factor;
    }
    if (store->mass) {
        float volume = store->radius ? ratio * ratio * ratio : 1; /* where there are radii the mass is of the sphere before its factor */
        store->mass[place] = source->diffuse ? source->mass * volume : (float)mns_attr_get(&in->mass, in->mass.type, 1, i, 0);
    }
    for (int k = 0; k < 3 && store->color[k]; k++) {
        double value = mns_attr_get(&in->color, in->color.type, 3, i, k);
        store->color[k][place] = value > 0 ? value < 1 ? (float)value : 1 : 0; /* NaN: 0 */
    }
    if (store->age) {
        store->age[place] = unit_value(&in->foam_age, i, 0);
    }
    for (int k = 0; k < 3 && store->velocity[k]; k++) {
        double value = in->velocity.data ? mns_attr_get(&in->velocity, in->velocity.type, 3, i, k) : 0;
        store->velocity[k][place] = fabs(value) < 1e15 ? (float)value : 0; /* NaN too */
    }
    if (store->noise) {
        store->noise[place] = unit_value(&in->noise, i, 1);
    }
    if (store->id) {
        store->id[place] = in->id.data ? (float)mns_attr_get(&in->id, in->id.type, 1, i, 0) : (float)i;
    }
    for (int k = 0; k < 6 && store->shape[k]; k++) {
        store->shape[k][place] = (float)mns_attr_get(&in->shape, in->shape.type, 6, i, k);
    }
}

/* Whether gather_rest has anything to do: of most sets it has not. */
static bool has_rest(const struct particle_store *store)
{
    return store->radius || store->factor || store->mass || store->color[0] || store->shape[0] || store->noise || store->id;
}

/* Copies one chunk's particles to their places; what of the chunk was there before, or is past the end, stays. */
static void gather_chunk(const struct fill *fill, size_t chunk, enum mns_type type)
{
    enum { AHEAD = 16 }; /* particles, from anywhere in the caller's array */
    const struct store_source *source = fill->source;
    const struct mns_particles *in = source->particles;
    struct particle_store *store = fill->store;
    size_t stride = in->position.stride ? in->position.stride : 3 * mns_type_size(type), last = source->count - 1;
    size_t begin = chunk * CHUNK_SIZE > fill->first ? chunk * CHUNK_SIZE : fill->first;
    bool rest = has_rest(store);
    for (size_t i = begin; i < (chunk + 1) * CHUNK_SIZE; i++) {
        size_t at = i - fill->first;
        size_t index = source->entries[at < last ? at : last].index, ahead = source->entries[at + AHEAD < last ? at + AHEAD : last].index;
        mns_prefetch((const char *)in->position.data + ahead * stride);
        float p[3];
        store_position(in, type, store->facts.origin, index, p);
        store->x[i] = p[0];
        store->y[i] = p[1];
        store->z[i] = p[2];
        store->seed[i] = seed_of(in, index);
        if (rest) {
            gather_rest(fill, i, index);
        }
    }
}

/* A bound on the longest semi-axis at a place: the largest sum of a row's magnitudes (Gershgorin). */
static float stretch_at(float *const a[6], size_t i)
{
    float x = fabsf(a[0][i]) + fabsf(a[3][i]) + fabsf(a[4][i]), y = fabsf(a[3][i]) + fabsf(a[1][i]) + fabsf(a[5][i]);
    return fmaxf(fmaxf(x, y), fabsf(a[4][i]) + fabsf(a[5][i]) + fabsf(a[2][i]));
}

static void measure_chunk(struct particle_store *store, size_t chunk)
{
    const float *positions[3] = {store->x, store->y, store->z}, *sizes[2] = {store->radius, store->factor};
    float *largest[2] = {store->box_radius, store->box_factor};
    for (int k = 0; k < 3; k++) {
        float min = FLT_MAX, max = -FLT_MAX;
        for (size_t i = chunk * CHUNK_SIZE; i < (chunk + 1) * CHUNK_SIZE; i++) {
            float p = positions[k][i];
            min = p < min ? p : min;
            max = p > max ? p : max;
        }
        store->box_min[k][chunk] = min;
        store->box_max[k][chunk] = max;
    }
    for (int k = 0; k < 2; k++) {
        float most = 0;
        for (size_t i = chunk * CHUNK_SIZE; sizes[k] && i < (chunk + 1) * CHUNK_SIZE; i++) {
            most = sizes[k][i] > most ? sizes[k][i] : most;
        }
        largest[k][chunk] = most;
    }
    store->box_stretch[chunk] = 0;
    for (size_t i = chunk * CHUNK_SIZE; store->shape[0] && i < (chunk + 1) * CHUNK_SIZE; i++) {
        store->box_stretch[chunk] = fmaxf(store->box_stretch[chunk], stretch_at(store->shape, i));
    }
}

static void gather_job(void *context, int slice)
{
    const struct fill *fill = context;
    enum mns_type type = fill->source->particles->position.type;
    size_t from = fill->first / CHUNK_SIZE, count = fill->store->chunk_count - from, n = (size_t)fill->slices, i = (size_t)slice;
    size_t begin = from + count / n * i + count % n * i / n, end = from + count / n * (i + 1) + count % n * (i + 1) / n;
    for (size_t chunk = begin; chunk < end; chunk++) {
        if (type == MNS_F32) {
            gather_chunk(fill, chunk, MNS_F32);
        } else {
            gather_chunk(fill, chunk, MNS_F64);
        }
        measure_chunk(fill->store, chunk);
    }
}

/* Copies the arrays and boxes of one store into another with room for them; an array that only the new one has holds 0. */
static void copy_store(struct particle_store *to, struct particle_store *from)
{
    float **arrays[2][ARRAYS], **boxes[2][BOXES];
    list_arrays(to, arrays[0]);
    list_arrays(from, arrays[1]);
    list_boxes(to, boxes[0]);
    list_boxes(from, boxes[1]);
    for (int i = 0; i < ARRAYS && arrays[0][i]; i++) {
        if (*arrays[0][i] && *arrays[1][i]) {
            memcpy(*arrays[0][i], *arrays[1][i], from->count * sizeof(float));
        } else if (*arrays[0][i]) {
            memset(*arrays[0][i], 0, from->count * sizeof(float));
        }
    }
    for (int i = 0; i < BOXES && from->chunk_count > 0; i++) {
        memcpy(*boxes[0][i], *boxes[1][i], from->chunk_count * sizeof(float));
    }
}

bool mns_store_fill(struct particle_store *store, const struct store_source *source, struct memory *memory,
                    const struct mns_parallel *parallel, int slices)
{
    if (source->count == 0) {
        return true;
    }
    struct particle_store grown = {.count = store->count + source->count, .own = source->diffuse ? store->own : source->count};
    grown.facts = store->facts;
    bool wanted[ARRAYS];
    list_wanted(store, source, wanted);
    if (!allocate(&grown, memory, wanted)) {
        mns_particle_store_free(&grown, memory);
        return false;
    }
    copy_store(&grown, store);
    struct fill fill = {.store = &grown, .source = source, .first = store->count, .slices = slices};
    parallel->run(parallel->user, gather_job, &fill, slices);
    mns_particle_store_free(store, memory);
    *store = grown;
    return true;
}

void mns_store_drop_diffuse(struct particle_store *store, struct memory *memory)
{
    if (store->own == store->count) {
        return;
    }
    if (store->own == 0) {
        struct particle_facts facts = store->facts;
        mns_particle_store_free(store, memory);
        store->facts = facts;
        return;
    }
    float **arrays[ARRAYS];
    list_arrays(store, arrays);
    store->count = store->own;
    store->chunk_count = (store->count + CHUNK_SIZE - 1) / CHUNK_SIZE;
    for (int i = 0; i < ARRAYS && arrays[i]; i++) { /* the last chunk is padded again */
        for (size_t place = store->count; *arrays[i] && place < padded(store->chunk_count); place++) {
            (*arrays[i])[place] = (*arrays[i])[store->count - 1];
        }
    }
    measure_chunk(store, store->chunk_count - 1);
}
