/* meniscus/anisotropy.h: ellipsoids that follow the fluid's surface in place of spheres (Yu and Turk 2013), before mns_renderer_prepare.
 *
 *     mns_anisotropy_create -> (mns_anisotropy_step -> mns_anisotropy_attach -> mns_renderer_prepare ...) for each frame -> destroy
 *
 * Each particle gets the shape of its neighbourhood: round inside the fluid, flat at its surface, of the same volume, and its centre moves
 * towards its neighbours' mean. A particle on its own is a small sphere. No frame depends on another. docs/pipeline.md has the formulas.
 * The same input gives the same bytes for every number of threads; instruction sets differ by rounding. */
#ifndef MENISCUS_ANISOTROPY_H
#define MENISCUS_ANISOTROPY_H

#include <meniscus/common.h>
#include <meniscus/params.h>
#include <meniscus/particles.h>
#include <meniscus/renderer.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct mns_anisotropy mns_anisotropy; /* opaque; one thread at a time */

struct mns_anisotropy_params {
    size_t struct_size;             /* set by mns_anisotropy_params_init */
    enum mns_isa isa;               /* default: auto, the best there is */
    int threads;                    /* 1 to 1024; 0 (default): as many as this process may use */
    struct mns_allocator allocator; /* default: the C library's; kept until destroy */
    struct mns_log log;             /* default: none; kept until destroy */
    struct mns_parallel parallel;   /* default: the object's own threads; kept until destroy */
};

MNS_API void mns_anisotropy_params_init_sized(struct mns_anisotropy_params *params, size_t size);
static inline void mns_anisotropy_params_init(struct mns_anisotropy_params *params)
{
    mns_anisotropy_params_init_sized(params, sizeof(*params));
}

/* params NULL: all defaults. On success the caller owns *out; on failure *out is NULL and message (may be NULL) says why. */
MNS_API mns_result mns_anisotropy_create(mns_anisotropy **out, const struct mns_anisotropy_params *params, struct mns_message *message);
MNS_API void mns_anisotropy_destroy(mns_anisotropy **anisotropy); /* sets *anisotropy to NULL; NULL is fine */

/* Finds the shapes of a frame's particles. params NULL: defaults; its group "anisotropy", radius and radius_scale are read, whether `anisotropy`
 * is on is not. The spacing, and where neither params nor particles give a radius half of it, is measured on the first frame and kept. The caller's arrays are free again
 * afterwards. Where the radius is so wrong that nearly all particles are neighbours, spheres stay and the log is told.
 * Errors: invalid argument, unsupported, out of memory: then there is nothing to attach. */
MNS_API mns_result mns_anisotropy_step(mns_anisotropy *anisotropy, const struct mns_particles *particles, const struct mns_params *params);

/* Gives the particles of the last step their shape, their moved position, in the positions' own type, and the spacing that they had. The arrays are the object's, and stand
 * until its next call but this. */
MNS_API void mns_anisotropy_attach(const mns_anisotropy *anisotropy, struct mns_particles *particles);

/* What went wrong in the last call, in words; "" when nothing did. Valid until the next call. */
MNS_API const char *mns_anisotropy_message(const mns_anisotropy *anisotropy);

struct mns_shape_stats {
    size_t struct_size; /* set by mns_shape_stats_init */
    size_t count;       /* particles with a shape in the last step */
    double radius;      /* metres: of a particle, as it was taken */
    double reach;       /* metres: how far neighbours were looked for */
    double step_ms;     /* time of the last step */
    size_t bytes;       /* memory held */
};
MNS_API void mns_shape_stats_init_sized(struct mns_shape_stats *stats, size_t size);
static inline void mns_shape_stats_init(struct mns_shape_stats *stats) { mns_shape_stats_init_sized(stats, sizeof(*stats)); }
MNS_API void mns_anisotropy_stats(const mns_anisotropy *anisotropy, struct mns_shape_stats *out);

#ifdef __cplusplus
}
#endif

#endif
