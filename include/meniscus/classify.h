/* meniscus/classify.h: which particles are foam, which are spray, and how noisy their surface is: over a sequence, before mns_renderer_prepare.
 *
 *     mns_classifier_create -> (mns_classifier_step -> mns_classifier_attach -> mns_renderer_prepare ...) for each frame in turn -> destroy
 *
 * A particle is spray by its density, foam by its Weber number ([BSW10] eq. 5) near air, noisy by the change of its velocity ([LGS09] eq. 12).
 * Foam outlasts its cause, grows and shrinks: that is remembered from frame to frame, by id, else by index, for as many seconds as
 * mns_classifier_memory tells. What is missing is derived: velocities from the positions of the frame before, densities from the neighbours.
 * docs/foam.md has the formulas. The same input gives the same bytes for every number of threads. */
#ifndef MENISCUS_CLASSIFY_H
#define MENISCUS_CLASSIFY_H

#include <meniscus/common.h>
#include <meniscus/params.h>
#include <meniscus/particles.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct mns_classifier mns_classifier; /* opaque; one thread at a time */

struct mns_classifier_params {
    size_t struct_size;             /* set by mns_classifier_params_init */
    int threads;                    /* 1 to 1024; 0 (default): as many as this process may use */
    struct mns_allocator allocator; /* default: the C library's; kept until destroy */
    struct mns_log log;             /* default: none; kept until destroy. Each kind of warning is given once */
    struct mns_parallel parallel;   /* default: the classifier's own threads; kept until destroy */
};

MNS_API void mns_classifier_params_init_sized(struct mns_classifier_params *params, size_t size);
static inline void mns_classifier_params_init(struct mns_classifier_params *params)
{
    mns_classifier_params_init_sized(params, sizeof(*params));
}

/* params NULL: all defaults. On success the caller owns *out; on failure *out is NULL and message (may be NULL) says why. */
MNS_API mns_result mns_classifier_create(mns_classifier **out, const struct mns_classifier_params *params, struct mns_message *message);
MNS_API void mns_classifier_destroy(mns_classifier **classifier); /* sets *classifier to NULL; NULL is fine */

/* Classifies the next frame. time: seconds, greater than that of the frame before. params NULL: defaults; with foam none nothing is done
 * but to forget. The first frame has the foam that its velocities alone tell; without velocities it has none.
 * In a sequence params should give fluid_size, or it is told from each frame anew. The caller's arrays are free again afterwards.
 * Errors: invalid argument, out of memory: then the classifier has forgotten all, and has nothing to attach. */
MNS_API mns_result mns_classifier_step(mns_classifier *classifier, const struct mns_particles *particles, double time,
                                       const struct mns_params *params);

/* Adds to the particles of the last step what was found: noise; spray, foam, foam_age and water where there is foam or spray; velocity and
 * density where they were derived. What the particles have of their own stays; having any of water, foam and spray, they get none of these. The
 * arrays are the classifier's, and stand through its next step, so that two frames can be blended. */
MNS_API void mns_classifier_attach(const mns_classifier *classifier, struct mns_particles *particles);

/* Forgets all frames: the next one is the first of a sequence. */
MNS_API void mns_classifier_reset(mns_classifier *classifier);

/* Seconds of earlier frames that decide a frame's result: one that has seen those, and two frames more, gives the same bytes as one that has
 * seen all. params must give fluid_size unless foam_lifetime, foam_fade_in and noise_cooldown are given. */
MNS_API double mns_classifier_memory(const struct mns_params *params);

/* What went wrong in the last call on this classifier, in words; "" when nothing did. Valid until the next call. */
MNS_API const char *mns_classifier_message(const mns_classifier *classifier);

/* What the last step found. */
struct mns_class_stats {
    size_t struct_size;  /* set by mns_class_stats_init */
    size_t count;        /* particles */
    size_t foam, spray;  /* of them with foam above 0, with spray above 0 */
    double foam_volume;  /* sum of foam^3: in particles' worth of foam */
    size_t appeared;     /* not in the frame before */
    size_t vanished;     /* of the frame before, not in this one */
    size_t returned;     /* of those that appeared: their ids were there in some earlier frame */
    size_t repeated;     /* particles with the id of one before them in the set: both go on from the same state */
    size_t fast;         /* particles that would cross the scene before the next frame, by the time since the last */
    double rest_density; /* kg/m^3 that densities were compared with; 0: unknown */
    double step_ms;      /* time of the step */
    size_t bytes;        /* memory held by the classifier */
};
MNS_API void mns_class_stats_init_sized(struct mns_class_stats *stats, size_t size);
static inline void mns_class_stats_init(struct mns_class_stats *stats) { mns_class_stats_init_sized(stats, sizeof(*stats)); }
MNS_API void mns_classifier_stats(const mns_classifier *classifier, struct mns_class_stats *out);

#ifdef __cplusplus
}
#endif

#endif
