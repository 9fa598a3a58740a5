/* classifier.c: the public entry: takes a frame in, lets the parts of a step work on it, and hands out attributes. */
#include "particles/classifier.h"

#include "core/frame.h"
#include "core/message.h"
#include "util/clock.h"
#include "util/pool.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

enum { THREADS_MAX = 1024 };

void mns_classifier_params_init_sized(struct mns_classifier_params *params, size_t size)
{
    memset(params, 0, size);
    params->struct_size = size;
}

void mns_class_stats_init_sized(struct mns_class_stats *stats, size_t size)
{
    memset(stats, 0, size);
    stats->struct_size = size;
}

static void run_in_pool(void *user, void (*job)(void *context, int index), void *context, int count)
{
    mns_pool_run(user, job, context, count);
}

/* ---- life of a classifier ---- */

static mns_result resolve(struct mns_classifier_params *out, const struct mns_classifier_params *in, struct mns_message *message)
{
    mns_classifier_params_init(out);
    if (in) {
        if (in->struct_size < sizeof(in->struct_size)) {
            return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "params.struct_size is %zu; call mns_classifier_params_init first",
                            in->struct_size);
        }
        memcpy(out, in, in->struct_size < sizeof(*out) ? in->struct_size : sizeof(*out));
    }
    if (out->threads < 0 || out->threads > THREADS_MAX) {
        return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "threads is %d; it must be 1 to %d, or 0 for as many as there are processors",
                        out->threads, THREADS_MAX);
    }
    out->threads = out->threads ? out->threads : mns_processor_count();
    return MNS_OK;
}

mns_result mns_classifier_create(mns_classifier **out, const struct mns_classifier_params *params, struct mns_message *message)
{
    *out = NULL;
    struct mns_classifier_params wanted;
    mns_result result = resolve(&wanted, params, message);
    if (result != MNS_OK) {
        return result;
    }
    struct memory memory;
    mns_memory_init(&memory, &wanted.allocator);
    mns_classifier *self = mns_memory_get(&memory, 1, sizeof(*self));
    if (!self) {
        return mns_fail(message, MNS_ERR_OUT_OF_MEMORY, "out of memory");
    }
    *self = (struct mns_classifier){.memory = memory, .log = wanted.log, .parallel = wanted.parallel, .threads = wanted.threads};
    if (!wanted.parallel.run) {
        self->pool = mns_pool_create(wanted.threads, &wanted.allocator);
        if (!self->pool) {
            mns_classifier_destroy(&self);
            return mns_fail(message, MNS_ERR_OUT_OF_MEMORY, "%d threads cannot be started", wanted.threads);
        }
        self->parallel = (struct mns_parallel){.run = run_in_pool, .user = self->pool};
    }
    *out = self;
    return MNS_OK;
}

void mns_classifier_destroy(mns_classifier **classifier)
{
    mns_classifier *self = *classifier;
    *classifier = NULL;
    if (!self) {
        return;
    }
    struct memory *memory = &self->memory;
    for (int now = 0; now < 2; now++) {
        for (int i = 0; i < KEEP_COUNT; i++) {
            mns_memory_put(memory, self->kept[now][i], self->kept_room[now][i], sizeof(float));
        }
        for (int i = 0; i < OUT_COUNT; i++) {
            mns_memory_put(memory, self->out[now][i], self->out_room[now][i], sizeof(float));
        }
        mns_memory_put(memory, self->velocity[now], self->velocity_room[now], 3 * sizeof(float));
        mns_memory_put(memory, self->places[now], self->places_room[now], 3 * sizeof(double));
    }
    mns_memory_put(memory, self->from, self->from_room, sizeof(*self->from));
    mns_memory_put(memory, self->sample, self->sample_room, sizeof(float));
    mns_memory_put(memory, self->tallies, self->tally_room, sizeof(*self->tallies));
    mns_ids_free(&self->ids, memory);
    mns_grid_free(&self->grid, memory);
    mns_pool_destroy(self->pool);
    struct memory last = self->memory;
    mns_memory_put(&last, self, 1, sizeof(*self));
}

/* The next frame is the first. */
static void forget(mns_classifier *self)
{
    self->has_frame = self->has_places = false;
    self->count = 0;
    self->foam = MNS_FOAM_NONE;
    self->stats = (struct mns_class_stats){0};
    mns_ids_forget(&self->ids);
}

void mns_classifier_reset(mns_classifier *classifier)
{
    classifier->message.text[0] = '\0';
    forget(classifier);
}

const char *mns_classifier_message(const mns_classifier *classifier) { return classifier->message.text; }

double mns_classifier_memory(const struct mns_params *params)
{
    struct foam_times times = mns_foam_times(params, (double)params->fluid_size);
    return fmax(2 * times.lifetime, times.cooldown) + times.fade_in;
}

void mns_classifier_warn(mns_classifier *self, enum warning kind, const char *format, ...)
{
    if (self->warned[kind] || !self->log.message) {
        return;
    }
    self->warned[kind] = true;
    char text[512];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof(text), format, arguments);
    va_end(arguments);
    self->log.message(self->log.user, MNS_LOG_WARNING, text);
}

/* ---- a frame ---- */

static mns_result check(mns_classifier *self, const struct mns_particles *in, double time)
{
    struct mns_message *message = &self->message;
    if (in->count > UINT32_MAX - 64) {
        return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "%zu particles; at most %lu can be classified", in->count,
                        (unsigned long)UINT32_MAX - 64);
    }
    if (in->count > 0 && !in->position.data) {
        return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "particles without positions");
    }
    if (in->position.type != MNS_F32 && in->position.type != MNS_F64) {
        return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "positions are %s; they must be float32 or float64",
                        mns_type_name(in->position.type));
    }
    if (self->has_frame && !(time - self->time > 0 && time - self->time < INFINITY)) {
        return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "time is %g s and was %g s in the frame before; it must go up", time,
                        self->time);
    }
    return MNS_OK;
}

static mns_result run(mns_classifier *self, const struct mns_particles *in, const struct mns_params *params, double seconds)
{
    struct step step = {.self = self, .particles = in, .params = *params, .before = self->count, .seconds = seconds};
    double fluid_size, radius;
    mns_result result = mns_step_match(&step);
    result = result == MNS_OK ? mns_step_sizes(&step, &fluid_size, &radius) : result;
    result = result == MNS_OK ? mns_step_densities(&step, radius) : result;
    if (result == MNS_OK) {
        double rest = in->density.data ? step.reference : step.unit;
        mns_classify_rule(&step.rule, params, fluid_size, radius, rest, seconds);
        result = mns_step_run(&step);
    }
    return result;
}

mns_result mns_classifier_step(mns_classifier *self, const struct mns_particles *particles, double time, const struct mns_params *params)
{
    double start = mns_clock_ms();
    struct mns_params resolved;
    struct mns_particles known;
    self->message.text[0] = '\0';
    mns_result result = mns_params_resolve(&resolved, params, &self->message);
    mns_particles_init(&known);
    if (result == MNS_OK && particles->struct_size < sizeof(particles->struct_size)) {
        result = mns_fail(&self->message, MNS_ERR_INVALID_ARGUMENT, "particles.struct_size is %zu; call mns_particles_init first",
                          particles->struct_size);
    }
    if (result == MNS_OK) {
        memcpy(&known, particles, particles->struct_size < sizeof(known) ? particles->struct_size : sizeof(known));
        result = check(self, &known, time);
    }
    if (result != MNS_OK || resolved.foam == MNS_FOAM_NONE) {
        forget(self);
        return result;
    }
    self->stats = (struct mns_class_stats){.count = known.count};
    self->derived_velocity = self->derived_density = false;
    result = run(self, &known, &resolved, self->has_frame ? time - self->time : 0);
    if (result != MNS_OK) {
        forget(self);
        return result;
    }
    self->has_frame = true;
    self->count = known.count;
    self->time = time;
    self->foam = resolved.foam;
    self->stats.step_ms = mns_clock_ms() - start;
    self->stats.bytes = self->memory.bytes;
    return MNS_OK;
}

static struct mns_attr view(const float *data) { return (struct mns_attr){.data = data, .type = MNS_F32}; }

void mns_classifier_attach(const mns_classifier *self, struct mns_particles *particles)
{
    if (self->foam == MNS_FOAM_NONE) {
        return;
    }
    float *const *out = self->out[self->now];
    struct mns_particles known;
    mns_particles_init(&known);
    size_t size = particles->struct_size < sizeof(known) ? particles->struct_size : sizeof(known);
    memcpy(&known, particles, size);
    bool parted = known.water.data || known.foam.data || known.spray.data;
    if (!known.noise.data) {
        known.noise = view(out[OUT_NOISE]);
    }
    if (!parted && self->stats.foam > 0) {
        known.foam = view(out[OUT_FOAM]);
        known.foam_age = view(out[OUT_AGE]);
    }
    if (!parted && self->stats.spray > 0) {
        known.spray = view(out[OUT_SPRAY]);
    }
    if (!parted && (self->stats.foam > 0 || self->stats.spray > 0)) {
        known.water = view(out[OUT_WATER]);
    }
    if (self->derived_velocity) {
        known.velocity = view(self->velocity[self->now]);
    }
    if (self->derived_density) {
        known.density = view(out[OUT_DENSITY]);
    }
    known.struct_size = particles->struct_size;
    memcpy(particles, &known, size);
}

void mns_classifier_stats(const mns_classifier *self, struct mns_class_stats *out)
{
    struct mns_class_stats stats = self->stats;
    size_t size = out->struct_size < sizeof(stats) ? out->struct_size : sizeof(stats);
    stats.struct_size = out->struct_size;
    memcpy(out, &stats, size);
}
