/* measure.c: the rest spacing from the distances to the k-th neighbours, found by boxes of chunks and boxes of those. */
#include "cpu/measure.h"

#include <float.h>
#include <math.h>
#include <stdatomic.h>

enum {
    NEIGHBOUR = 20,      /* SPEC 1: k */
    SPACING_SAMPLE = 512 /* particles whose neighbours are sought: the percentile then stands within 2 % */
};

float mns_select(float *values, size_t count, size_t rank)
{
    size_t low = 0, high = count - 1;
    while (low < high) { /* Hoare's partition about the middle value */
        float pivot = values[low + (high - low) / 2];
        size_t i = low, j = high;
        for (;;) {
            while (values[i] < pivot) {
                i++;
            }
            while (values[j] > pivot) {
                j--;
            }
            if (i >= j) {
                break;
            }
            float swapped = values[i];
            values[i++] = values[j];
            values[j--] = swapped;
        }
        if (rank <= j) {
            high = j;
        } else {
            low = j + 1;
        }
    }
    return values[rank];
}

struct box {
    float min[3], max[3];
};

static float box_distance2(const struct box *box, const float p[3])
{
    float sum = 0;
    for (int k = 0; k < 3; k++) {
        float below = box->min[k] - p[k], above = p[k] - box->max[k];
        float d = below > 0 ? below : above > 0 ? above : 0;
        sum += d * d;
    }
    return sum;
}

/* The k smallest squared distances so far, in order. */
struct nearest {
    float distance2[NEIGHBOUR];
    int k;
};

static void nearest_add(struct nearest *nearest, float distance2)
{
    if (distance2 >= nearest->distance2[nearest->k - 1]) {
        return;
    }
    int at = nearest->k - 1;
    for (; at > 0 && nearest->distance2[at - 1] > distance2; at--) {
        nearest->distance2[at] = nearest->distance2[at - 1];
    }
    nearest->distance2[at] = distance2;
}

struct search {
    const struct particle_store *store;
    struct box *groups; /* of CHUNK_SIZE chunks each */
    size_t group_count;
    int k;
    size_t samples;
    float *distance; /* [samples] to the k-th neighbour */
    atomic_size_t next;
};

static struct box chunk_box(const struct particle_store *store, size_t chunk)
{
    struct box box;
    for (int k = 0; k < 3; k++) {
        box.min[k] = store->box_min[k][chunk];
        box.max[k] = store->box_max[k][chunk];
    }
    return box;
}

static void visit_chunk(const struct particle_store *store, size_t chunk, size_t self, const float p[3], struct nearest *nearest)
{
    size_t end = (chunk + 1) * CHUNK_SIZE < store->count ? (chunk + 1) * CHUNK_SIZE : store->count;
    for (size_t i = chunk * CHUNK_SIZE; i < end; i++) {
        float dx = store->x[i] - p[0], dy = store->y[i] - p[1], dz = store->z[i] - p[2];
        if (i != self) {
            nearest_add(nearest, dx * dx + dy * dy + dz * dz);
        }
    }
}

static float neighbour_distance(const struct search *search, size_t self)
{
    const struct particle_store *store = search->store;
    const float p[3] = {store->x[self], store->y[self], store->z[self]};
    struct nearest nearest = {.k = search->k};
    for (int i = 0; i < search->k; i++) {
        nearest.distance2[i] = FLT_MAX;
    }
    size_t own = self / CHUNK_SIZE;
    visit_chunk(store, own, self, p, &nearest);
    for (size_t group = 0; group < search->group_count; group++) {
        if (box_distance2(&search->groups[group], p) >= nearest.distance2[search->k - 1]) {
            continue;
        }
        size_t end = (group + 1) * CHUNK_SIZE < store->chunk_count ? (group + 1) * CHUNK_SIZE : store->chunk_count;
        for (size_t chunk = group * CHUNK_SIZE; chunk < end; chunk++) {
            struct box box = chunk_box(store, chunk);
            if (chunk != own && box_distance2(&box, p) < nearest.distance2[search->k - 1]) {
                visit_chunk(store, chunk, self, p, &nearest);
            }
        }
    }
    return sqrtf(nearest.distance2[search->k - 1]);
}

static void search_job(void *context, int index)
{
    struct search *search = context;
    (void)index;
    for (;;) {
        size_t i = atomic_fetch_add(&search->next, 1);
        if (i >= search->samples) {
            return;
        }
        search->distance[i] = neighbour_distance(search, i * (search->store->count / search->samples));
    }
}

bool mns_measure_spacing(const struct particle_store *store, struct memory *memory, const struct mns_parallel *parallel, double *spacing)
{
    *spacing = 0;
    if (store->count < 2) {
        return true;
    }
    struct search search = {.store = store, .group_count = (store->chunk_count + CHUNK_SIZE - 1) / CHUNK_SIZE};
    search.k = store->count - 1 < NEIGHBOUR ? (int)(store->count - 1) : NEIGHBOUR;
    search.samples = store->count < SPACING_SAMPLE ? store->count : SPACING_SAMPLE;
    search.groups = mns_memory_get(memory, search.group_count, sizeof(*search.groups));
    search.distance = mns_memory_get(memory, search.samples, sizeof(*search.distance));
    bool done = search.groups && search.distance;
    if (done) {
        for (size_t group = 0; group < search.group_count; group++) {
            struct box *box = &search.groups[group];
            *box = chunk_box(store, group * CHUNK_SIZE);
            for (size_t chunk = group * CHUNK_SIZE; chunk < (group + 1) * CHUNK_SIZE && chunk < store->chunk_count; chunk++) {
                for (int k = 0; k < 3; k++) {
                    box->min[k] = fminf(box->min[k], store->box_min[k][chunk]);
                    box->max[k] = fmaxf(box->max[k], store->box_max[k][chunk]);
                }
            }
        }
        parallel->run(parallel->user, search_job, &search, 64);
        size_t apart = 0; /* particles on top of one another tell nothing */
        for (size_t i = 0; i < search.samples; i++) {
            if (search.distance[i] > 0) {
                search.distance[apart++] = search.distance[i];
            }
        }
        if (apart > 0) {
            double d = (double)mns_select(search.distance, apart, apart / 5); /* SPEC 1: the 20th percentile */
            *spacing = d * cbrt(4 * 3.14159265358979323846 / (3 * search.k));
        }
    }
    mns_memory_put(memory, search.distance, search.samples, sizeof(*search.distance));
    mns_memory_put(memory, search.groups, search.group_count, sizeof(*search.groups));
    return done;
}

static void run_in_turn(void *user, void (*job)(void *context, int index), void *context, int count)
{
    (void)user;
    for (int i = 0; i < count; i++) {
        job(context, i);
    }
}

mns_result mns_particles_measure(const struct mns_particles *particles, const struct mns_allocator *allocator, struct mns_measure *out,
                                 struct mns_message *message)
{
    struct memory memory;
    mns_memory_init(&memory, allocator);
    const struct mns_parallel parallel = {.run = run_in_turn};
    struct particle_store stores[STORE_KINDS] = {{0}};
    struct mns_particles whole = *particles;
    whole.water.data = whole.foam.data = whole.spray.data = NULL; /* what they are drawn as changes no measure */
    mns_result result = mns_particle_stores_fill(stores, &memory, &parallel, 1, &whole, false, out, message);
    mns_particle_store_free(&stores[STORE_WATER], &memory);
    return result;
}
