/* renderer.c: the public entry: checks, runs the backend's stages in order, keeps the times. */
#include "core/backend.h"
#include "core/message.h"
#include "util/clock.h"
#include "util/pool.h"

#include <stdio.h>
#include <string.h>

enum { THREADS_MAX = 1024 };

const char *const mns_stage_names[STAGE_COUNT] = {"scene", "bin", "splat", "smooth", "noise", "blur", "foam", "spray", "shade", "passes"};

struct mns_renderer {
    struct memory memory;
    struct mns_log log;
    struct mns_message message;
    struct pool *pool; /* NULL: the caller's threads */
    struct backend_host host;
    const struct backend_functions *functions;
    struct backend *backend;

    struct mns_measure measure;
    struct particle_facts facts;
    double prepare_ms, draw_ms, stage_ms[STAGE_COUNT];
    int stages_run;
    float splat_radius, fluid_size;
};

void mns_renderer_params_init_sized(struct mns_renderer_params *params, size_t size)
{
    memset(params, 0, size);
    params->struct_size = size;
}

void mns_stats_init_sized(struct mns_stats *stats, size_t size)
{
    memset(stats, 0, size);
    stats->struct_size = size;
}

void mns_light_init_sized(struct mns_light *light, size_t size)
{
    memset(light, 0, size);
    light->struct_size = size;
}

static void run_in_pool(void *user, void (*job)(void *context, int index), void *context, int count)
{
    mns_pool_run(user, job, context, count);
}

/* The caller's words, with defaults for what an older caller does not know. */
static mns_result resolve(struct mns_renderer_params *out, const struct mns_renderer_params *in, struct mns_message *message)
{
    mns_renderer_params_init(out);
    if (in) {
        if (in->struct_size < sizeof(in->struct_size)) {
            return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "params.struct_size is %zu; call mns_renderer_params_init first",
                            in->struct_size);
        }
        memcpy(out, in, in->struct_size < sizeof(*out) ? in->struct_size : sizeof(*out));
    }
    if (out->backend != MNS_BACKEND_AUTO && out->backend != MNS_BACKEND_CPU) {
        return mns_fail(message, MNS_ERR_UNSUPPORTED, "there is no backend %d in this build", (int)out->backend);
    }
    if (out->threads < 0 || out->threads > THREADS_MAX) {
        return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "threads is %d; it must be 1 to %d, or 0 for as many as there are processors",
                        out->threads, THREADS_MAX);
    }
    if (out->threads == 0) {
        out->threads = mns_processor_count();
    }
    return MNS_OK;
}

mns_result mns_renderer_create(mns_renderer **out, const struct mns_renderer_params *params, struct mns_message *message)
{
    *out = NULL;
    struct mns_renderer_params wanted;
    mns_result result = resolve(&wanted, params, message);
    if (result != MNS_OK) {
        return result;
    }
    struct memory memory;
    mns_memory_init(&memory, &wanted.allocator);
    struct mns_renderer *renderer = mns_memory_get(&memory, 1, sizeof(*renderer));
    if (!renderer) {
        return mns_fail(message, MNS_ERR_OUT_OF_MEMORY, "out of memory");
    }
    *renderer = (struct mns_renderer){.memory = memory, .log = wanted.log, .functions = &mns_backend_cpu};
    renderer->host = (struct backend_host){.memory = &renderer->memory,
                                           .log = wanted.log,
                                           .parallel = wanted.parallel,
                                           .threads = wanted.threads,
                                           .passes = wanted.passes != 0,
                                           .message = &renderer->message};
    if (!wanted.parallel.run) {
        renderer->pool = mns_pool_create(wanted.threads, &wanted.allocator);
        if (!renderer->pool) {
            mns_renderer_destroy(&renderer);
            return mns_fail(message, MNS_ERR_OUT_OF_MEMORY, "%d threads cannot be started", wanted.threads);
        }
        renderer->host.parallel = (struct mns_parallel){.run = run_in_pool, .user = renderer->pool};
    }
    result = renderer->functions->create(&renderer->backend, &renderer->host, &wanted);
    if (result != MNS_OK) {
        if (message) {
            *message = renderer->message;
        }
        mns_renderer_destroy(&renderer);
        return result;
    }
    *out = renderer;
    return MNS_OK;
}

void mns_renderer_destroy(mns_renderer **renderer)
{
    struct mns_renderer *r = *renderer;
    *renderer = NULL;
    if (!r) {
        return;
    }
    if (r->backend) {
        r->functions->destroy(r->backend);
    }
    mns_pool_destroy(r->pool);
    struct memory memory = r->memory;
    mns_memory_put(&memory, r, 1, sizeof(*r));
}

/* Tells the caller's log what the message says. */
static mns_result finish(struct mns_renderer *renderer, mns_result result)
{
    if (result != MNS_OK && renderer->log.message) {
        renderer->log.message(renderer->log.user, MNS_LOG_ERROR, renderer->message.text);
    }
    return result;
}

static void warn_dropped(const struct mns_renderer *renderer, mns_result result, size_t dropped, const char *what)
{
    if (result == MNS_OK && dropped > 0 && renderer->log.message) {
        char text[128];
        snprintf(text, sizeof(text), "%zu %s dropped: their positions are not finite", dropped, what);
        renderer->log.message(renderer->log.user, MNS_LOG_WARNING, text);
    }
}

mns_result mns_renderer_prepare(mns_renderer *renderer, const struct mns_particles *particles)
{
    renderer->message.text[0] = '\0';
    struct mns_particles known;
    mns_particles_init(&known);
    if (particles->struct_size < sizeof(particles->struct_size)) {
        return finish(renderer, mns_fail(&renderer->message, MNS_ERR_INVALID_ARGUMENT,
                                         "particles.struct_size is %zu; call mns_particles_init first", particles->struct_size));
    }
    memcpy(&known, particles, particles->struct_size < sizeof(known) ? particles->struct_size : sizeof(known));
    double start = mns_clock_ms();
    mns_result result = renderer->functions->prepare(renderer->backend, &known, &renderer->measure, &renderer->facts);
    renderer->prepare_ms = mns_clock_ms() - start;
    renderer->draw_ms = 0;
    renderer->stages_run = 0;
    warn_dropped(renderer, result, renderer->measure.dropped, "particles");
    return finish(renderer, result);
}

mns_result mns_renderer_prepare_diffuse(mns_renderer *renderer, const struct mns_particles *particles)
{
    renderer->message.text[0] = '\0';
    struct mns_particles known;
    mns_particles_init(&known);
    if (particles && particles->struct_size < sizeof(particles->struct_size)) {
        return finish(renderer, mns_fail(&renderer->message, MNS_ERR_INVALID_ARGUMENT,
                                         "particles.struct_size is %zu; call mns_particles_init first", particles->struct_size));
    }
    if (particles) {
        memcpy(&known, particles, particles->struct_size < sizeof(known) ? particles->struct_size : sizeof(known));
    }
    double start = mns_clock_ms();
    size_t dropped;
    mns_result result = renderer->functions->prepare_diffuse(renderer->backend, &known, &dropped);
    renderer->prepare_ms += mns_clock_ms() - start;
    warn_dropped(renderer, result, dropped, "diffuse particles");
    return finish(renderer, result);
}

static mns_result run_stages(struct mns_renderer *renderer, const struct frame *frame)
{
    for (int stage = 0; stage < STAGE_COUNT; stage++) {
        double start = mns_clock_ms();
        mns_result result = renderer->functions->stages[stage](renderer->backend, frame);
        if (result != MNS_OK) {
            return result;
        }
        renderer->stage_ms[stage] = mns_clock_ms() - start;
        renderer->stages_run = stage + 1;
    }
    return MNS_OK;
}

/* The shadow of a new set is made once for the set, so its time counts as preparing. */
static void move_shadow_time(struct mns_renderer *renderer)
{
    struct backend_stats stats;
    renderer->functions->stats(renderer->backend, &stats);
    renderer->prepare_ms += stats.shadow_ms;
    renderer->stage_ms[STAGE_SCENE] -= stats.shadow_ms;
    renderer->draw_ms -= stats.shadow_ms;
}

/* The caller's frame with what an older caller does not know left empty, checked and resolved. */
static mns_result resolve_frame(mns_renderer *renderer, const struct mns_frame *frame, struct frame *out)
{
    struct mns_frame known;
    mns_frame_init(&known);
    if (frame->struct_size < sizeof(frame->struct_size)) {
        return mns_fail(&renderer->message, MNS_ERR_INVALID_ARGUMENT, "frame.struct_size is %zu; call mns_frame_init first",
                        frame->struct_size);
    }
    memcpy(&known, frame, frame->struct_size < sizeof(known) ? frame->struct_size : sizeof(known));
    return mns_frame_resolve(out, &known, &renderer->facts, &renderer->message);
}

mns_result mns_renderer_light(mns_renderer *renderer, const struct mns_frame *frame, struct mns_light *out)
{
    renderer->message.text[0] = '\0';
    struct frame resolved;
    mns_result result = resolve_frame(renderer, frame, &resolved);
    if (result == MNS_OK) {
        struct mns_light light;
        mns_light_init(&light);
        renderer->functions->light(&resolved, &light);
        light.struct_size = out->struct_size;
        memcpy(out, &light, out->struct_size < sizeof(light) ? out->struct_size : sizeof(light));
    }
    return finish(renderer, result);
}

mns_result mns_renderer_draw(mns_renderer *renderer, const struct mns_frame *frame)
{
    renderer->message.text[0] = '\0';
    double start = mns_clock_ms();
    struct frame resolved;
    mns_result result = resolve_frame(renderer, frame, &resolved);
    renderer->stages_run = 0;
    if (result == MNS_OK) {
        renderer->splat_radius = resolved.splat_radius;
        renderer->fluid_size = resolved.fluid_size;
        result = run_stages(renderer, &resolved);
    }
    renderer->draw_ms = mns_clock_ms() - start;
    if (result == MNS_OK) {
        move_shadow_time(renderer);
    }
    return finish(renderer, result);
}

const char *mns_renderer_message(const mns_renderer *renderer) { return renderer->message.text; }

void mns_renderer_stats(const mns_renderer *renderer, struct mns_stats *out)
{
    struct backend_stats backend;
    renderer->functions->stats(renderer->backend, &backend);
    struct mns_stats stats;
    mns_stats_init(&stats);
    stats.backend = renderer->functions->name;
    stats.isa = backend.isa;
    stats.threads = renderer->host.threads;
    stats.measure = renderer->measure;
    stats.splat_radius = (double)renderer->splat_radius;
    stats.fluid_size = (double)renderer->fluid_size;
    stats.particles_visible = backend.particles_visible;
    stats.particles_splatted = backend.particles_splatted;
    stats.pixels_covered = backend.pixels_covered;
    stats.prepare_ms = renderer->prepare_ms;
    stats.draw_ms = renderer->draw_ms;
    stats.stage_count = renderer->stages_run;
    for (int stage = 0; stage < renderer->stages_run; stage++) {
        stats.stage_name[stage] = mns_stage_names[stage];
        stats.stage_ms[stage] = renderer->stage_ms[stage];
    }
    stats.bytes = renderer->memory.bytes;
    stats.peak_bytes = renderer->memory.peak_bytes;
    size_t size = out->struct_size < sizeof(stats) ? out->struct_size : sizeof(stats);
    stats.struct_size = out->struct_size;
    memcpy(out, &stats, size);
}
