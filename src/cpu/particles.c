/* particles.c: takes a caller's particles in: finite ones only, relative to the set's centre, in Morton order, in chunks with boxes. */
#include "cpu/particles.h"

#include "core/attr.h"
#include "core/message.h"
#include "cpu/measure.h"
#include "util/prefetch.h"

#include <float.h>
#include <math.h>

enum { RADIX_BITS = 10, RADIX = 1 << RADIX_BITS, KEY_BITS = 30, SLICE_MAX = 64 };

/* Cubes of lengths in the picture's arithmetic must stay finite. */
static const double LARGEST_EXTENT = 1e12;

/* A particle on its way to its place. */
struct entry {
    uint32_t key, index;
};

struct fill {
    struct particle_store *store;
    const struct mns_particles *particles;
    const struct mns_parallel *parallel;
    int slices;
    struct {
        double min[3], max[3];
        size_t finite;
    } part[SLICE_MAX]; /* of each slice */
    double origin[3];
    float grid_min[3], grid_scale; /* Morton grid, relative to the origin */
    struct entry *from, *to;
    int shift;
    uint32_t (*counts)[RADIX]; /* [slices] */
};

/* Slice i of n things in `slices` parts. The partition changes nothing in the result: the sort is stable, the rest are minima and copies. */
static size_t slice_begin(size_t count, int slice, int slices)
{
    size_t i = (size_t)slice, n = (size_t)slices;
    return count / n * i + count % n * i / n;
}

static inline void bounds_loop(struct fill *fill, int slice, enum mns_type type)
{
    const struct mns_attr *position = &fill->particles->position;
    double min[3] = {INFINITY, INFINITY, INFINITY}, max[3] = {-INFINITY, -INFINITY, -INFINITY};
    size_t finite = 0, end = slice_begin(fill->particles->count, slice + 1, fill->slices);
    for (size_t i = slice_begin(fill->particles->count, slice, fill->slices); i < end; i++) {
        double p[3];
        for (int k = 0; k < 3; k++) {
            p[k] = mns_attr_get(position, type, 3, i, k);
        }
        if (!isfinite(p[0]) || !isfinite(p[1]) || !isfinite(p[2])) {
            continue;
        }
        finite++;
        for (int k = 0; k < 3; k++) {
            min[k] = p[k] < min[k] ? p[k] : min[k];
            max[k] = p[k] > max[k] ? p[k] : max[k];
        }
    }
    for (int k = 0; k < 3; k++) {
        fill->part[slice].min[k] = min[k];
        fill->part[slice].max[k] = max[k];
    }
    fill->part[slice].finite = finite;
}

static void bounds_job(void *context, int slice)
{
    struct fill *fill = context;
    if (fill->particles->position.type == MNS_F32) {
        bounds_loop(fill, slice, MNS_F32);
    } else {
        bounds_loop(fill, slice, MNS_F64);
    }
}

/* Spreads the lower 10 bits of x to every third bit. */
static uint32_t spread(uint32_t x)
{
    x = (x | x << 16) & 0x030000ff;
    x = (x | x << 8) & 0x0300f00f;
    x = (x | x << 4) & 0x030c30c3;
    return (x | x << 2) & 0x09249249;
}

static uint32_t morton_key(const struct fill *fill, const float p[3])
{
    uint32_t key = 0;
    for (int k = 0; k < 3; k++) {
        float cell = (p[k] - fill->grid_min[k]) * fill->grid_scale;
        key |= spread((uint32_t)(cell > 0 ? cell < 1023 ? cell : 1023 : 0)) << k;
    }
    return key;
}

static inline bool position_of(const struct fill *fill, enum mns_type type, size_t i, float out[3])
{
    bool finite = true;
    for (int k = 0; k < 3; k++) {
        double p = mns_attr_get(&fill->particles->position, type, 3, i, k);
        finite = finite && isfinite(p);
        out[k] = (float)(p - fill->origin[k]);
    }
    return finite;
}

/* Finite particles of the slice, with their keys, behind those of the slices before. */
static void keys_job(void *context, int slice)
{
    struct fill *fill = context;
    enum mns_type type = fill->particles->position.type;
    struct entry *out = fill->from;
    for (int before = 0; before < slice; before++) {
        out += fill->part[before].finite;
    }
    size_t end = slice_begin(fill->particles->count, slice + 1, fill->slices);
    for (size_t i = slice_begin(fill->particles->count, slice, fill->slices); i < end; i++) {
        float p[3];
        if (type == MNS_F32 ? position_of(fill, MNS_F32, i, p) : position_of(fill, MNS_F64, i, p)) {
            *out++ = (struct entry){.key = morton_key(fill, p), .index = (uint32_t)i};
        }
    }
}

static void count_job(void *context, int slice)
{
    struct fill *fill = context;
    uint32_t *counts = fill->counts[slice];
    memset(counts, 0, sizeof(fill->counts[slice]));
    size_t end = slice_begin(fill->store->count, slice + 1, fill->slices);
    for (size_t i = slice_begin(fill->store->count, slice, fill->slices); i < end; i++) {
        counts[fill->from[i].key >> fill->shift & (RADIX - 1)]++;
    }
}

static void scatter_job(void *context, int slice)
{
    struct fill *fill = context;
    uint32_t *places = fill->counts[slice];
    size_t end = slice_begin(fill->store->count, slice + 1, fill->slices);
    for (size_t i = slice_begin(fill->store->count, slice, fill->slices); i < end; i++) {
        fill->to[places[fill->from[i].key >> fill->shift & (RADIX - 1)]++] = fill->from[i];
    }
}

static void sort_entries(struct fill *fill)
{
    for (fill->shift = 0; fill->shift < KEY_BITS; fill->shift += RADIX_BITS) {
        fill->parallel->run(fill->parallel->user, count_job, fill, fill->slices);
        uint32_t place = 0;
        for (int digit = 0; digit < RADIX; digit++) {
            for (int slice = 0; slice < fill->slices; slice++) {
                uint32_t count = fill->counts[slice][digit];
                fill->counts[slice][digit] = place;
                place += count;
            }
        }
        fill->parallel->run(fill->parallel->user, scatter_job, fill, fill->slices);
        struct entry *swapped = fill->from;
        fill->from = fill->to;
        fill->to = swapped;
    }
}

/* Copies one chunk's particles to their places and measures its box. */
static void gather_chunk(struct fill *fill, size_t chunk, enum mns_type type)
{
    enum { AHEAD = 16 }; /* particles, from anywhere in the caller's array */
    struct particle_store *store = fill->store;
    const struct mns_particles *in = fill->particles;
    float min[3] = {FLT_MAX, FLT_MAX, FLT_MAX}, max[3] = {-FLT_MAX, -FLT_MAX, -FLT_MAX}, radius = 0;
    size_t stride = in->position.stride ? in->position.stride : 3 * mns_type_size(type), last = store->count - 1;
    for (size_t i = chunk * CHUNK_SIZE; i < (chunk + 1) * CHUNK_SIZE; i++) {
        size_t index = fill->from[i < last ? i : last].index, ahead = fill->from[i + AHEAD < last ? i + AHEAD : last].index;
        mns_prefetch((const char *)in->position.data + ahead * stride);
        float p[3];
        position_of(fill, type, index, p);
        store->x[i] = p[0];
        store->y[i] = p[1];
        store->z[i] = p[2];
        for (int k = 0; k < 3; k++) {
            min[k] = p[k] < min[k] ? p[k] : min[k];
            max[k] = p[k] > max[k] ? p[k] : max[k];
        }
        if (store->radius) {
            float r = (float)mns_attr_get(&in->radius, in->radius.type, 1, index, 0);
            store->radius[i] = r;
            radius = r > radius ? r : radius;
        }
        if (store->mass) {
            store->mass[i] = (float)mns_attr_get(&in->mass, in->mass.type, 1, index, 0);
        }
        for (int k = 0; k < 3 && store->color[k]; k++) {
            double value = mns_attr_get(&in->color, in->color.type, 3, index, k);
            store->color[k][i] = value > 0 ? value < 1 ? (float)value : 1 : 0; /* NaN: 0 */
        }
    }
    for (int k = 0; k < 3; k++) {
        store->box_min[k][chunk] = min[k];
        store->box_max[k][chunk] = max[k];
    }
    store->box_radius[chunk] = radius;
}

static void gather_job(void *context, int slice)
{
    struct fill *fill = context;
    enum mns_type type = fill->particles->position.type;
    size_t end = slice_begin(fill->store->chunk_count, slice + 1, fill->slices);
    for (size_t chunk = slice_begin(fill->store->chunk_count, slice, fill->slices); chunk < end; chunk++) {
        gather_chunk(fill, chunk, type);
    }
}

static size_t padded(const struct particle_store *store) { return store->chunk_count * CHUNK_SIZE; }

static size_t padded_chunks(const struct particle_store *store) { return (store->chunk_count + 15) / 16 * 16; }

void mns_particle_store_free(struct particle_store *store, struct memory *memory)
{
    float *arrays[] = {store->x, store->y, store->z, store->radius, store->mass, store->color[0], store->color[1], store->color[2]};
    for (size_t i = 0; i < sizeof(arrays) / sizeof(arrays[0]); i++) {
        mns_memory_put(memory, arrays[i], padded(store), sizeof(float));
    }
    for (int k = 0; k < 3; k++) {
        mns_memory_put(memory, store->box_min[k], padded_chunks(store), sizeof(float));
        mns_memory_put(memory, store->box_max[k], padded_chunks(store), sizeof(float));
    }
    mns_memory_put(memory, store->box_radius, padded_chunks(store), sizeof(float));
    *store = (struct particle_store){0};
}

static bool allocate_store(struct particle_store *store, struct memory *memory, const struct mns_particles *in)
{
    store->chunk_count = (store->count + CHUNK_SIZE - 1) / CHUNK_SIZE;
    float **arrays[] = {&store->x,    &store->y,        &store->z,        &store->radius,
                        &store->mass, &store->color[0], &store->color[1], &store->color[2]};
    const bool wanted[] = {true, true, true, in->radius.data, in->mass.data, in->color.data, in->color.data, in->color.data};
    bool done = true;
    for (size_t i = 0; i < sizeof(arrays) / sizeof(arrays[0]); i++) {
        *arrays[i] = wanted[i] ? mns_memory_get(memory, padded(store), sizeof(float)) : NULL;
        done = done && (*arrays[i] || !wanted[i]);
    }
    float **boxes[] = {&store->box_min[0], &store->box_min[1], &store->box_min[2], &store->box_max[0],
                       &store->box_max[1], &store->box_max[2], &store->box_radius};
    for (size_t i = 0; i < sizeof(boxes) / sizeof(boxes[0]); i++) {
        *boxes[i] = mns_memory_get(memory, padded_chunks(store), sizeof(float));
        done = done && *boxes[i];
    }
    return done;
}

/* What every particle must have right. */
static mns_result check_range(const struct mns_particles *in, const struct mns_attr *attr, const char *what, float least, float most,
                              struct mns_message *message)
{
    for (size_t i = 0; attr->data && i < in->count; i++) {
        double value = mns_attr_get(attr, attr->type, 1, i, 0);
        if (!((float)value >= least) || !((float)value <= most)) {
            return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "the %s of particle %zu is %g; it must be from %g to %g", what, i, value,
                            (double)least, (double)most);
        }
    }
    return MNS_OK;
}

static mns_result check(const struct mns_particles *in, struct mns_message *message)
{
    if (in->count > UINT32_MAX - 64) {
        return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "%zu particles; at most %lu can be drawn at once", in->count,
                        (unsigned long)UINT32_MAX - 64);
    }
    if (in->count > 0 && !in->position.data) {
        return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "particles without positions");
    }
    if (in->position.type != MNS_F32 && in->position.type != MNS_F64) {
        return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "positions are %s; they must be float32 or float64",
                        mns_type_name(in->position.type));
    }
    mns_result result = check_range(in, &in->radius, "radius", 1e-12f, 1e12f, message); /* as the parameter `radius` */
    return result == MNS_OK ? check_range(in, &in->mass, "mass", 1e-30f, 1e18f, message) : result;
}

/* Bounds of the finite particles, the origin in their middle, and how many there are. */
static void measure_bounds(struct fill *fill, struct mns_measure *measure)
{
    fill->parallel->run(fill->parallel->user, bounds_job, fill, fill->slices);
    double min[3] = {INFINITY, INFINITY, INFINITY}, max[3] = {-INFINITY, -INFINITY, -INFINITY};
    size_t finite = 0;
    for (int slice = 0; slice < fill->slices; slice++) {
        finite += fill->part[slice].finite;
        for (int k = 0; k < 3; k++) {
            min[k] = fmin(min[k], fill->part[slice].min[k]);
            max[k] = fmax(max[k], fill->part[slice].max[k]);
        }
    }
    *measure = (struct mns_measure){.count = finite, .dropped = fill->particles->count - finite};
    struct particle_facts *facts = &fill->store->facts;
    fill->store->count = facts->count = finite;
    for (int k = 0; k < 3 && finite > 0; k++) {
        measure->bounds_min[k] = min[k];
        measure->bounds_max[k] = max[k];
        fill->origin[k] = facts->origin[k] = 0.5 * min[k] + 0.5 * max[k];
        facts->bounds_min[k] = (float)(min[k] - facts->origin[k]);
        facts->bounds_max[k] = (float)(max[k] - facts->origin[k]);
    }
}

/* One particle of each run of `step`, at a place in it that no order of the particles follows: every step-th would meet the same few
 * columns of a set that is written row by row. */
static size_t sample_index(size_t run, size_t step)
{
    uint32_t hash = (uint32_t)run * 2654435761u;
    hash = (hash ^ hash >> 15) * 2246822519u;
    return run * step + (hash ^ hash >> 13) % step;
}

/* The sample that quantiles are told from: values[0..2] positions, values[3] radii if there are some. [QUANTILE_SAMPLE + 1] each. Returns how
 * many. */
static size_t take_sample(const struct fill *fill, float *values[4])
{
    const struct mns_particles *in = fill->particles;
    size_t step = in->count / QUANTILE_SAMPLE + 1, taken = 0;
    for (size_t run = 0; run * step < in->count; run++) {
        size_t i = sample_index(run, step);
        float p[3];
        if (i < in->count && position_of(fill, in->position.type, i, p)) {
            for (int k = 0; k < 3; k++) {
                values[k][taken] = p[k];
            }
            values[3][taken++] = in->radius.data ? (float)mns_attr_get(&in->radius, in->radius.type, 1, i, 0) : 0;
        }
    }
    return taken;
}

/* The inner bounds, the median radius, and the grid that the order is taken on: stray particles must not make it coarse. */
static bool measure_quantiles(struct fill *fill, struct memory *memory, struct mns_measure *measure)
{
    const size_t room = 4 * (QUANTILE_SAMPLE + 1);
    float *sample = mns_memory_get(memory, room, sizeof(float)), *values[4], extent = 0;
    if (!sample) {
        return false;
    }
    for (int k = 0; k < 4; k++) {
        values[k] = sample + k * (QUANTILE_SAMPLE + 1);
    }
    size_t taken = take_sample(fill, values);
    for (int k = 0; k < 3; k++) {
        float low = fill->store->facts.bounds_min[k], high = fill->store->facts.bounds_max[k];
        if (taken > 0) {
            low = mns_select(values[k], taken, taken / 1000);
            high = mns_select(values[k], taken, taken - 1 - taken / 1000);
        }
        measure->inner_min[k] = fill->origin[k] + (double)low;
        measure->inner_max[k] = fill->origin[k] + (double)high;
        fill->grid_min[k] = low;
        extent = fmaxf(extent, high - low);
    }
    fill->grid_scale = extent > 0 ? 1023.0f / extent : 0;
    if (fill->particles->radius.data && taken > 0) {
        measure->radius = (double)mns_select(values[3], taken, taken / 2);
    }
    mns_memory_put(memory, sample, room, sizeof(float));
    return true;
}

static bool order(struct fill *fill, struct memory *memory)
{
    size_t count = fill->store->count;
    struct entry *entries[2] = {mns_memory_get(memory, count, sizeof(struct entry)), mns_memory_get(memory, count, sizeof(struct entry))};
    fill->counts = mns_memory_get(memory, (size_t)fill->slices, sizeof(*fill->counts));
    bool done = entries[0] && entries[1] && fill->counts;
    if (done) {
        fill->from = entries[0];
        fill->to = entries[1];
        fill->parallel->run(fill->parallel->user, keys_job, fill, fill->slices);
        sort_entries(fill);
        fill->parallel->run(fill->parallel->user, gather_job, fill, fill->slices);
    }
    mns_memory_put(memory, fill->counts, (size_t)fill->slices, sizeof(*fill->counts));
    mns_memory_put(memory, entries[1], count, sizeof(struct entry));
    mns_memory_put(memory, entries[0], count, sizeof(struct entry));
    return done;
}

static void fill_facts(struct particle_store *store, const struct mns_measure *measure)
{
    struct particle_facts *facts = &store->facts;
    facts->spacing = measure->spacing;
    facts->radius = measure->radius;
    facts->has_radius = store->radius != NULL;
    facts->has_mass = store->mass != NULL;
    facts->has_color = store->color[0] != NULL;
    for (size_t i = 0; store->radius && i < store->count; i++) {
        double r = (double)store->radius[i];
        facts->radius_cubed_sum += r * r * r;
    }
    for (size_t i = 0; store->mass && i < store->count; i++) {
        facts->mass_sum += (double)store->mass[i];
    }
}

mns_result mns_particle_store_fill(struct particle_store *store, struct memory *memory, const struct mns_parallel *parallel, int threads,
                                   const struct mns_particles *particles, struct mns_measure *measure, struct mns_message *message)
{
    mns_particle_store_free(store, memory);
    *measure = (struct mns_measure){0};
    mns_result result = check(particles, message);
    if (result != MNS_OK) {
        return result;
    }
    struct fill fill = {.store = store, .particles = particles, .parallel = parallel};
    fill.slices = threads < 1 ? 1 : threads < SLICE_MAX ? threads : SLICE_MAX;
    measure_bounds(&fill, measure);
    if (store->count == 0) {
        return MNS_OK;
    }
    for (int k = 0; k < 3; k++) {
        if (!(measure->bounds_max[k] - measure->bounds_min[k] < LARGEST_EXTENT)) {
            *store = (struct particle_store){0};
            return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "the particles span %g m along %c; at most %g can be drawn",
                            measure->bounds_max[k] - measure->bounds_min[k], "xyz"[k], LARGEST_EXTENT);
        }
    }
    bool done = measure_quantiles(&fill, memory, measure) && allocate_store(store, memory, particles) && order(&fill, memory) &&
                mns_measure_spacing(store, memory, parallel, &measure->spacing);
    if (!done) {
        mns_particle_store_free(store, memory);
        return mns_fail(message, MNS_ERR_OUT_OF_MEMORY, "out of memory for %zu particles", particles->count);
    }
    measure->radius = store->radius ? measure->radius : 0.5 * measure->spacing;
    fill_facts(store, measure);
    return MNS_OK;
}
