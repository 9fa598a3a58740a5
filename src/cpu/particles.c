/* particles.c: takes a caller's particles in: finite ones only, relative to the set's centre, in Morton order, in chunks with boxes. */
#include "cpu/particles.h"

#include "core/attr.h"
#include "core/message.h"
#include "cpu/measure.h"
#include "cpu/store.h"

#include <math.h>

enum { RADIX_BITS = 10, RADIX = 1 << RADIX_BITS, KEY_BITS = 30, SLICE_MAX = 64 };

/* Cubes of lengths in the picture's arithmetic must stay finite. */
static const double LARGEST_EXTENT = 1e12;

struct fill {
    size_t count; /* of entries: finite particles */
    const struct mns_particles *particles;
    const struct mns_parallel *parallel;
    int slices;
    struct {
        double min[3], max[3];
        size_t finite;
    } part[SLICE_MAX]; /* of each slice */
    struct particle_facts facts;
    float grid_min[3], grid_scale; /* Morton grid, relative to the origin */
    struct store_entry *from, *to;
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

/* Finite particles of the slice, with their keys, behind those of the slices before. */
static void keys_job(void *context, int slice)
{
    struct fill *fill = context;
    enum mns_type type = fill->particles->position.type;
    struct store_entry *out = fill->from;
    for (int before = 0; before < slice; before++) {
        out += fill->part[before].finite;
    }
    size_t end = slice_begin(fill->particles->count, slice + 1, fill->slices);
    for (size_t i = slice_begin(fill->particles->count, slice, fill->slices); i < end; i++) {
        float p[3];
        if (type == MNS_F32 ? store_position(fill->particles, MNS_F32, fill->facts.origin, i, p)
                            : store_position(fill->particles, MNS_F64, fill->facts.origin, i, p)) {
            *out++ = (struct store_entry){.key = morton_key(fill, p), .index = (uint32_t)i};
        }
    }
}

static void count_job(void *context, int slice)
{
    struct fill *fill = context;
    uint32_t *counts = fill->counts[slice];
    memset(counts, 0, sizeof(fill->counts[slice]));
    size_t end = slice_begin(fill->count, slice + 1, fill->slices);
    for (size_t i = slice_begin(fill->count, slice, fill->slices); i < end; i++) {
        counts[fill->from[i].key >> fill->shift & (RADIX - 1)]++;
    }
}

static void scatter_job(void *context, int slice)
{
    struct fill *fill = context;
    uint32_t *places = fill->counts[slice];
    size_t end = slice_begin(fill->count, slice + 1, fill->slices);
    for (size_t i = slice_begin(fill->count, slice, fill->slices); i < end; i++) {
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
        struct store_entry *swapped = fill->from;
        fill->from = fill->to;
        fill->to = swapped;
    }
}

/* The entries of the particles of a kind, in order, in fill->to. */
struct choice {
    struct fill *fill;
    enum store_kind kind;
    bool diffuse;
    size_t chosen[SLICE_MAX];
};

static void choose_job(void *context, int slice)
{
    struct choice *choice = context;
    struct fill *fill = choice->fill;
    size_t begin = slice_begin(fill->count, slice, fill->slices), end = slice_begin(fill->count, slice + 1, fill->slices), chosen = begin;
    for (size_t i = begin; i < end; i++) {
        if (mns_store_member(fill->particles, choice->kind, choice->diffuse, fill->from[i].index) > 0) {
            fill->to[chosen++] = fill->from[i];
        }
    }
    choice->chosen[slice] = chosen - begin;
}

static size_t choose(struct fill *fill, enum store_kind kind, bool diffuse)
{
    struct choice choice = {.fill = fill, .kind = kind, .diffuse = diffuse};
    fill->parallel->run(fill->parallel->user, choose_job, &choice, fill->slices);
    size_t count = 0;
    for (int slice = 0; slice < fill->slices; slice++) {
        memmove(fill->to + count, fill->to + slice_begin(fill->count, slice, fill->slices), choice.chosen[slice] * sizeof(*fill->to));
        count += choice.chosen[slice];
    }
    return count;
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

/* Whether a symmetric matrix has three positive eigenvalues, in the range of struct mns_particles: the Frobenius norms of A and of its inverse
 * bound them. */
static bool is_shape(const double a[6])
{
    double adjugate[6] = {a[1] * a[2] - a[5] * a[5], a[0] * a[2] - a[4] * a[4], a[0] * a[1] - a[3] * a[3],
                          a[4] * a[5] - a[3] * a[2], a[3] * a[5] - a[4] * a[1], a[3] * a[4] - a[0] * a[5]};
    double det = a[0] * adjugate[0] + a[3] * adjugate[3] + a[4] * adjugate[4], square = 0, inverse = 0;
    for (int k = 0; k < 6; k++) {
        square += (k < 3 ? 1 : 2) * a[k] * a[k];
        inverse += (k < 3 ? 1 : 2) * adjugate[k] * adjugate[k] / (det * det);
    }
    const double most = 3.001e4; /* three squares of 100, and rounding */
    return a[0] > 0 && adjugate[2] > 0 && det > 0 && square <= most && inverse <= most && square * inverse <= most;
}

static mns_result check_shapes(const struct mns_particles *in, struct mns_message *message)
{
    for (size_t i = 0; in->shape.data && i < in->count; i++) {
        double a[6];
        for (int k = 0; k < 6; k++) {
            a[k] = mns_attr_get(&in->shape, in->shape.type, 6, i, k);
        }
        if (!is_shape(a)) {
            return mns_fail(
                message, MNS_ERR_INVALID_ARGUMENT,
                "the shape of particle %zu is %g, %g, %g, %g, %g, %g; it must be a symmetric matrix xx, yy, zz, xy, xz, yz whose "
                "eigenvalues are from 0.01 to 100, the largest at most 100 times the least",
                i, a[0], a[1], a[2], a[3], a[4], a[5]);
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
    result = result == MNS_OK ? check_range(in, &in->mass, "mass", 1e-30f, 1e18f, message) : result;
    return result == MNS_OK ? check_shapes(in, message) : result;
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
    struct particle_facts *facts = &fill->facts;
    fill->count = facts->count = finite;
    for (int k = 0; k < 3 && finite > 0; k++) {
        measure->bounds_min[k] = min[k];
        measure->bounds_max[k] = max[k];
        facts->origin[k] = 0.5 * min[k] + 0.5 * max[k];
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
        if (i < in->count && store_position(in, in->position.type, fill->facts.origin, i, p)) {
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
        float low = fill->facts.bounds_min[k], high = fill->facts.bounds_max[k];
        if (taken > 0) {
            low = mns_select(values[k], taken, taken / 1000);
            high = mns_select(values[k], taken, taken - 1 - taken / 1000);
        }
        measure->inner_min[k] = fill->facts.origin[k] + (double)low;
        measure->inner_max[k] = fill->facts.origin[k] + (double)high;
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

/* Calls fill_stores(fill, context) with the particles in Morton order in fill->from, and as much room in fill->to. false: out of memory. */
static bool in_order(struct fill *fill, struct memory *memory, bool (*fill_stores)(struct fill *fill, void *context), void *context)
{
    size_t count = fill->count;
    struct store_entry *entries[2] = {mns_memory_get(memory, count, sizeof(struct store_entry)),
                                      mns_memory_get(memory, count, sizeof(struct store_entry))};
    fill->counts = mns_memory_get(memory, (size_t)fill->slices, sizeof(*fill->counts));
    bool done = entries[0] && entries[1] && fill->counts;
    if (done) {
        fill->from = entries[0];
        fill->to = entries[1];
        fill->parallel->run(fill->parallel->user, keys_job, fill, fill->slices);
        sort_entries(fill);
        done = fill_stores(fill, context);
    }
    mns_memory_put(memory, fill->counts, (size_t)fill->slices, sizeof(*fill->counts));
    mns_memory_put(memory, entries[1], count, sizeof(struct store_entry));
    mns_memory_put(memory, entries[0], count, sizeof(struct store_entry));
    return done;
}

/* all: every particle of the set as it is given. */
static bool measure_all(struct fill *fill, const struct particle_store *all, struct memory *memory, struct mns_measure *measure)
{
    struct particle_facts *facts = &fill->facts;
    double known = fill->particles->spacing;
    bool is_known = known > 0 && known < LARGEST_EXTENT;
    if (!is_known && !mns_measure_spacing(all, memory, fill->parallel, &measure->spacing)) {
        return false;
    }
    measure->spacing = is_known ? known : measure->spacing;
    measure->radius = all->radius ? measure->radius : 0.5 * measure->spacing;
    facts->spacing = measure->spacing;
    facts->radius = measure->radius;
    for (size_t i = 0; all->radius && i < all->count; i++) {
        double r = (double)all->radius[i];
        facts->radius_cubed_sum += r * r * r;
    }
    for (size_t i = 0; all->mass && i < all->count; i++) {
        facts->mass_sum += (double)all->mass[i];
    }
    return true;
}

struct own {
    struct particle_store *stores;
    struct memory *memory;
    struct mns_measure *measure;
};

/* What part of the water turned into something else must change no radius and no volume: where there is an attribute `water` the whole set is
 * measured in a store that is then dropped. */
static bool measure_whole(struct fill *fill, const struct own *own)
{
    struct mns_particles whole = *fill->particles;
    whole.water.data = whole.color.data = NULL;
    const struct store_source source = {.particles = &whole, .entries = fill->from, .count = fill->count, .kind = STORE_WATER};
    struct particle_store all = {.facts = fill->facts};
    bool done =
        mns_store_fill(&all, &source, own->memory, fill->parallel, fill->slices) && measure_all(fill, &all, own->memory, own->measure);
    mns_particle_store_free(&all, own->memory);
    return done;
}

static bool fill_own(struct fill *fill, void *context)
{
    const struct own *own = context;
    const struct mns_particles *in = fill->particles;
    if (in->water.data && !measure_whole(fill, own)) {
        return false;
    }
    const struct mns_attr *const members[STORE_KINDS] = {&in->water, &in->foam, &in->spray};
    for (int kind = 0; kind < STORE_KINDS; kind++) {
        struct store_source source = {.particles = in, .entries = fill->from, .count = fill->count, .kind = (enum store_kind)kind};
        if (members[kind]->data) {
            source.count = choose(fill, source.kind, false);
            source.entries = fill->to;
        }
        own->stores[kind].facts = fill->facts;
        if ((kind == STORE_WATER || members[kind]->data) &&
            !mns_store_fill(&own->stores[kind], &source, own->memory, fill->parallel, fill->slices)) {
            return false;
        }
        if (kind == STORE_WATER && !in->water.data && !measure_all(fill, &own->stores[kind], own->memory, own->measure)) {
            return false;
        }
    }
    for (int kind = 0; kind < STORE_KINDS; kind++) {
        own->stores[kind].facts = fill->facts;
    }
    return true;
}

static void free_stores(struct particle_store stores[STORE_KINDS], struct memory *memory)
{
    for (int kind = 0; kind < STORE_KINDS; kind++) {
        mns_particle_store_free(&stores[kind], memory);
    }
}

static mns_result check_extent(const double min[3], const double max[3], struct mns_message *message)
{
    for (int k = 0; k < 3; k++) {
        if (!(max[k] - min[k] < LARGEST_EXTENT)) {
            return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "the particles span %g m along %c; at most %g can be drawn", max[k] - min[k],
                            "xyz"[k], LARGEST_EXTENT);
        }
    }
    return MNS_OK;
}

static struct fill begin_fill(const struct mns_particles *particles, const struct mns_parallel *parallel, int threads)
{
    struct fill fill = {.particles = particles, .parallel = parallel};
    fill.slices = threads < 1 ? 1 : threads < SLICE_MAX ? threads : SLICE_MAX;
    return fill;
}

mns_result mns_particle_stores_fill(struct particle_store stores[STORE_KINDS], struct memory *memory, const struct mns_parallel *parallel,
                                    int threads, const struct mns_particles *particles, bool passes, struct mns_measure *measure,
                                    struct mns_message *message)
{
    free_stores(stores, memory);
    *measure = (struct mns_measure){0};
    mns_result result = check(particles, message);
    if (result != MNS_OK) {
        return result;
    }
    struct fill fill = begin_fill(particles, parallel, threads);
    fill.facts.has_radius = particles->radius.data != NULL;
    fill.facts.has_mass = particles->mass.data != NULL;
    fill.facts.has_color = particles->color.data != NULL;
    fill.facts.keeps_passes = passes;
    measure_bounds(&fill, measure);
    if (fill.count == 0) {
        return MNS_OK;
    }
    result = check_extent(measure->bounds_min, measure->bounds_max, message);
    if (result != MNS_OK) {
        return result;
    }
    struct own own = {.stores = stores, .memory = memory, .measure = measure};
    if (!measure_quantiles(&fill, memory, measure) || !in_order(&fill, memory, fill_own, &own)) {
        free_stores(stores, memory);
        return mns_fail(message, MNS_ERR_OUT_OF_MEMORY, "out of memory for %zu particles", particles->count);
    }
    return MNS_OK;
}

static bool fill_diffuse(struct fill *fill, void *context)
{
    const struct own *own = context;
    for (int kind = STORE_FOAM; kind < STORE_KINDS; kind++) {
        struct particle_store *store = &own->stores[kind];
        const struct particle_facts *facts = &store->facts;
        const struct store_source source = {.particles = fill->particles,
                                            .entries = fill->to,
                                            .count = choose(fill, (enum store_kind)kind, true),
                                            .kind = (enum store_kind)kind,
                                            .diffuse = true,
                                            .radius = facts->radius > 0 ? facts->radius : 1,
                                            .mass = facts->count > 0 ? (float)(facts->mass_sum / (double)facts->count) : 0};
        if (!mns_store_fill(store, &source, own->memory, fill->parallel, fill->slices)) {
            return false;
        }
        for (int k = 0; k < 3; k++) {
            store->facts.bounds_min[k] = fminf(store->facts.bounds_min[k], fill->facts.bounds_min[k]);
            store->facts.bounds_max[k] = fmaxf(store->facts.bounds_max[k], fill->facts.bounds_max[k]);
        }
    }
    return true;
}

mns_result mns_particle_stores_diffuse(struct particle_store stores[STORE_KINDS], struct memory *memory,
                                       const struct mns_parallel *parallel, int threads, const struct mns_particles *diffuse,
                                       size_t *dropped, struct mns_message *message)
{
    *dropped = 0;
    for (int kind = STORE_FOAM; kind < STORE_KINDS; kind++) {
        mns_store_drop_diffuse(&stores[kind], memory);
        stores[kind].facts = stores[STORE_WATER].facts;
    }
    mns_result result = check(diffuse, message);
    if (result != MNS_OK) {
        return result;
    }
    struct fill fill = begin_fill(diffuse, parallel, threads);
    struct mns_measure measure;
    measure_bounds(&fill, &measure);
    *dropped = measure.dropped;
    if (fill.count == 0) {
        return MNS_OK;
    }
    const struct particle_facts *facts = &stores[STORE_WATER].facts;
    float extent = 0;
    for (int k = 0; k < 3; k++) { /* all stores have one origin */
        fill.facts.origin[k] = facts->origin[k];
        fill.facts.bounds_min[k] = (float)(measure.bounds_min[k] - facts->origin[k]);
        fill.facts.bounds_max[k] = (float)(measure.bounds_max[k] - facts->origin[k]);
        fill.grid_min[k] = fill.facts.bounds_min[k];
        extent = fmaxf(extent, fill.facts.bounds_max[k] - fill.facts.bounds_min[k]);
        measure.bounds_min[k] = fmin(measure.bounds_min[k], facts->origin[k]);
        measure.bounds_max[k] = fmax(measure.bounds_max[k], facts->origin[k]);
    }
    fill.grid_scale = extent > 0 ? 1023.0f / extent : 0;
    result = check_extent(measure.bounds_min, measure.bounds_max, message);
    if (result != MNS_OK) {
        return result;
    }
    struct own own = {.stores = stores, .memory = memory};
    if (!in_order(&fill, memory, fill_diffuse, &own)) {
        for (int kind = STORE_FOAM; kind < STORE_KINDS; kind++) {
            mns_store_drop_diffuse(&stores[kind], memory);
        }
        return mns_fail(message, MNS_ERR_OUT_OF_MEMORY, "out of memory for %zu diffuse particles", diffuse->count);
    }
    return MNS_OK;
}
