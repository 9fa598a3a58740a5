/* anisotropy.c: the public entry of meniscus/anisotropy.h: takes a frame in, has its shapes found, and hands out attributes. */
#include "particles/anisotropy.h"

#include "core/attr.h"
#include "core/message.h"
#include "util/clock.h"
#include "util/pool.h"

#include <math.h>
#include <stdio.h>

enum { THREADS_MAX = 1024 };

/* Mean number of particles in the cells around one, from which on neighbours are not looked for: the radius must be wrong by a factor. */
static const double CANDIDATES_MOST = 20000;

void mns_anisotropy_params_init_sized(struct mns_anisotropy_params *params, size_t size)
{
    memset(params, 0, size);
    params->struct_size = size;
}

void mns_shape_stats_init_sized(struct mns_shape_stats *stats, size_t size)
{
    memset(stats, 0, size);
    stats->struct_size = size;
}

static void run_in_pool(void *user, void (*job)(void *context, int index), void *context, int count)
{
    mns_pool_run(user, job, context, count);
}

static mns_result resolve(struct mns_anisotropy_params *out, const struct mns_anisotropy_params *in, struct mns_message *message)
{
    mns_anisotropy_params_init(out);
    if (in) {
        if (in->struct_size < sizeof(in->struct_size)) {
            return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "params.struct_size is %zu; call mns_anisotropy_params_init first",
                            in->struct_size);
        }
        memcpy(out, in, in->struct_size < sizeof(*out) ? in->struct_size : sizeof(*out));
    }
    if (out->threads < 0 || out->threads > THREADS_MAX) {
        return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "threads is %d; it must be 1 to %d, or 0 for as many as there are processors",
                        out->threads, THREADS_MAX);
    }
    out->threads = out->threads ? out->threads : mns_processor_count();
    out->isa = out->isa == MNS_ISA_AUTO ? mns_isa_best() : out->isa;
    if (!mns_kernels_get(out->isa)) {
        const char *name = mns_isa_name(out->isa);
        return mns_fail(message, MNS_ERR_UNSUPPORTED, "this processor or this build has no instruction set %s",
                        name ? name : "of that number");
    }
    return MNS_OK;
}

mns_result mns_anisotropy_create(mns_anisotropy **out, const struct mns_anisotropy_params *params, struct mns_message *message)
{
    *out = NULL;
    struct mns_anisotropy_params wanted;
    mns_result result = resolve(&wanted, params, message);
    if (result != MNS_OK) {
        return result;
    }
    struct memory memory;
    mns_memory_init(&memory, &wanted.allocator);
    mns_anisotropy *self = mns_memory_get(&memory, 1, sizeof(*self));
    if (!self) {
        return mns_fail(message, MNS_ERR_OUT_OF_MEMORY, "out of memory");
    }
    *self = (struct mns_anisotropy){.memory = memory,
                                    .log = wanted.log,
                                    .parallel = wanted.parallel,
                                    .threads = wanted.threads,
                                    .kernels = mns_kernels_get(wanted.isa)->anisotropy};
    if (!wanted.parallel.run) {
        self->pool = mns_pool_create(wanted.threads, &wanted.allocator);
        if (!self->pool) {
            mns_anisotropy_destroy(&self);
            return mns_fail(message, MNS_ERR_OUT_OF_MEMORY, "%d threads cannot be started", wanted.threads);
        }
        self->parallel = (struct mns_parallel){.run = run_in_pool, .user = self->pool};
    }
    *out = self;
    return MNS_OK;
}

void mns_anisotropy_destroy(mns_anisotropy **anisotropy)
{
    mns_anisotropy *self = *anisotropy;
    *anisotropy = NULL;
    if (!self) {
        return;
    }
    struct memory *memory = &self->memory;
    mns_memory_put(memory, self->shape, self->shape_room, 6 * sizeof(*self->shape));
    mns_memory_put(memory, self->position, self->position_room, 3 * sizeof(double));
    mns_grid_free(&self->grid, memory);
    mns_pool_destroy(self->pool);
    struct memory last = self->memory;
    mns_memory_put(&last, self, 1, sizeof(*self));
}

/* The spacing, which smoothed positions tell no longer, and the radius of a particle: as given, the mean of the particles' own, or half the
 * spacing. */
static mns_result find_sizes(mns_anisotropy *self, const struct mns_particles *in, const struct mns_params *params)
{
    double sum = 0;
    size_t counted = 0;
    bool has_volume = params->particle_volume > 0 || (in->mass.data && params->rest_density > 0);
    for (size_t i = 0; in->radius.data && params->radius <= 0 && i < in->count; i++) {
        double radius = mns_attr_get(&in->radius, in->radius.type, 1, i, 0);
        bool good = radius > 0 && radius < INFINITY;
        sum += good ? radius : 0;
        counted += good;
    }
    if (in->spacing > 0 && in->spacing < INFINITY) {
        self->spacing = in->spacing;
    } else if (self->spacing <= 0 && (!has_volume || (params->radius <= 0 && counted == 0))) {
        struct mns_measure measure;
        mns_result result = mns_particles_measure(in, &self->memory.allocator, &measure, &self->message);
        if (result != MNS_OK) {
            return result;
        }
        self->spacing = measure.spacing;
    }
    self->radius = params->radius > 0 ? (double)params->radius : counted > 0 ? sum / (double)counted : 0.5 * self->spacing;
    return MNS_OK;
}

/* Spheres where they are, for particles that are in no grid. */
static void fill_plain(mns_anisotropy *self, const struct mns_particles *in)
{
    for (size_t i = 0; i < in->count; i++) {
        for (int k = 0; k < 6; k++) {
            self->shape[6 * i + (size_t)k] = k < 3;
        }
        for (int k = 0; k < 3; k++) {
            anisotropy_place(self, i, k, mns_attr_get(&in->position, in->position.type, 3, i, k));
        }
    }
}

static mns_result run(mns_anisotropy *self, const struct mns_particles *in, const struct mns_params *params)
{
    mns_result result = find_sizes(self, in, params);
    if (result != MNS_OK || self->radius <= 0) {
        return result; /* no two particles in different places: spheres */
    }
    self->reach = (double)(params->anisotropy_reach * params->radius_scale) * self->radius;
    result = mns_grid_fill(&self->grid, &self->memory, &self->parallel, self->threads, in, self->reach, &self->message);
    if (result != MNS_OK || self->grid.count == 0) {
        return result;
    }
    if (self->grid.candidates > CANDIDATES_MOST) {
        if (self->log.message) {
            char text[160];
            snprintf(text, sizeof(text), "particles stay spheres: one has %.0f others within %g m; is the radius, %g m, right?",
                     self->grid.candidates, 2 * self->reach, self->radius);
            self->log.message(self->log.user, MNS_LOG_WARNING, text);
        }
        return MNS_OK;
    }
    self->shape = mns_memory_reserve(&self->memory, self->shape, &self->shape_room, in->count, 6 * sizeof(*self->shape));
    self->position = mns_memory_reserve(&self->memory, self->position, &self->position_room, in->count, 3 * sizeof(double));
    if (!self->shape || !self->position) {
        return mns_fail(&self->message, MNS_ERR_OUT_OF_MEMORY, "out of memory for %zu particles", in->count);
    }
    self->position_type = in->position.type;
    if (self->grid.count < in->count) {
        fill_plain(self, in);
    }
    mns_anisotropy_shapes(self, params);
    self->count = in->count;
    return MNS_OK;
}

mns_result mns_anisotropy_step(mns_anisotropy *anisotropy, const struct mns_particles *particles, const struct mns_params *params)
{
    mns_anisotropy *self = anisotropy;
    struct mns_particles known;
    struct mns_params wanted;
    double start = mns_clock_ms();
    self->message.text[0] = '\0';
    self->count = 0;
    self->reach = self->radius = 0;
    mns_particles_init(&known);
    mns_params_init(&wanted);
    if (particles->struct_size < sizeof(particles->struct_size)) {
        return mns_fail(&self->message, MNS_ERR_INVALID_ARGUMENT, "particles.struct_size is %zu; call mns_particles_init first",
                        particles->struct_size);
    }
    memcpy(&known, particles, particles->struct_size < sizeof(known) ? particles->struct_size : sizeof(known));
    if (params) {
        memcpy(&wanted, params, params->struct_size < sizeof(wanted) ? params->struct_size : sizeof(wanted));
    }
    mns_result result = mns_params_check(&wanted, &self->message);
    result = result == MNS_OK ? run(self, &known, &wanted) : result;
    self->step_ms = mns_clock_ms() - start;
    return result;
}

void mns_anisotropy_attach(const mns_anisotropy *anisotropy, struct mns_particles *particles)
{
    if (anisotropy->count > 0 && anisotropy->count == particles->count) {
        particles->shape = (struct mns_attr){.data = anisotropy->shape, .type = MNS_F32};
        particles->position = (struct mns_attr){.data = anisotropy->position, .type = anisotropy->position_type};
        particles->spacing = anisotropy->spacing;
    }
}

const char *mns_anisotropy_message(const mns_anisotropy *anisotropy) { return anisotropy->message.text; }

void mns_anisotropy_stats(const mns_anisotropy *anisotropy, struct mns_shape_stats *out)
{
    struct mns_shape_stats stats = {.struct_size = out->struct_size,
                                    .count = anisotropy->count,
                                    .radius = anisotropy->radius,
                                    .reach = anisotropy->reach,
                                    .step_ms = anisotropy->step_ms,
                                    .bytes = anisotropy->memory.bytes};
    memcpy(out, &stats, out->struct_size < sizeof(stats) ? out->struct_size : sizeof(stats));
}
