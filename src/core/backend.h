/* backend.h: what a backend is: one function per stage, in pipeline order. Nothing above asks which backend it has. */
#ifndef MNS_CORE_BACKEND_H
#define MNS_CORE_BACKEND_H

#include "core/frame.h"
#include "core/memory.h"

/* The stages of a draw, in order. The same names stand in src/cpu, docs/pipeline.md and the statistics. */
enum stage {
    STAGE_SCENE,  /* -> scene_color, scene_depth: the caller's, or sky and floor with the fluid's shadow */
    STAGE_BIN,    /* particles -> chunks per tile */
    STAGE_SPLAT,  /* tiles -> depth_raw, thickness_raw, color sums */
    STAGE_SMOOTH, /* depth_raw -> depth */
    STAGE_NOISE,  /* particles near depth -> noise */
    STAGE_BLUR,   /* thickness_raw -> thickness, color */
    STAGE_FOAM,   /* foam and water before it, thickness_raw -> foam_depth, foam_thickness, foam_front_thickness, thickness_front */
    STAGE_SPRAY,  /* spray, depth -> optical depths of its drops before and behind the surface */
    STAGE_SHADE,  /* depth, thickness, color, scene -> normal, curvature, transmittance, alpha, beauty */
    STAGE_PASSES, /* chunks per tile, depth -> velocity, motion, id, position; free where none is asked for */
    STAGE_COUNT
};

extern const char *const mns_stage_names[STAGE_COUNT];

struct backend; /* each backend's own */

struct backend_host {
    struct memory *memory;
    struct mns_log log;
    struct mns_parallel parallel; /* always set */
    int threads;                  /* jobs to hand to parallel.run */
    bool passes;                  /* velocities and ids are kept */
    struct mns_message *message;  /* of the renderer: mns_fail(host->message, ...) */
};

struct backend_stats {
    const char *isa;
    size_t particles_visible, particles_splatted, pixels_covered;
    double shadow_ms; /* spent in the last scene stage on the shadow of a new set; 0 when it was kept */
};

struct backend_functions {
    const char *name;
    mns_result (*create)(struct backend **out, const struct backend_host *host, const struct mns_renderer_params *params);
    void (*destroy)(struct backend *backend);
    mns_result (*prepare)(struct backend *backend, const struct mns_particles *particles, struct mns_measure *measure,
                          struct particle_facts *facts);
    mns_result (*prepare_diffuse)(struct backend *backend, const struct mns_particles *diffuse, size_t *dropped);
    mns_result (*stages[STAGE_COUNT])(struct backend *backend, const struct frame *frame);
    void (*light)(const struct frame *frame, struct mns_light *out); /* but for struct_size */
    void (*stats)(const struct backend *backend, struct backend_stats *out);
};

extern const struct backend_functions mns_backend_cpu;

#endif
