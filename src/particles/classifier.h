/* classifier.h: the classifier, and the parts of a step. */
#ifndef MNS_PARTICLES_CLASSIFIER_H
#define MNS_PARTICLES_CLASSIFIER_H

#include <meniscus/classify.h>

#include "core/memory.h"
#include "particles/classify.h"
#include "particles/grid.h"
#include "particles/ids.h"

enum warning { WARN_COUNT, WARN_REPEATED, WARN_VANISHED, WARN_RETURNED, WARN_FAST, WARN_DENSE, WARN_KINDS };

/* Attributes handed out, one float per particle. */
enum output { OUT_WATER, OUT_FOAM, OUT_AGE, OUT_SPRAY, OUT_NOISE, OUT_DENSITY, OUT_COUNT };

/* What one job of a step counted. */
struct tally {
    size_t foam, spray, fast;
    double foam_volume;
};

struct mns_classifier {
    struct memory memory;
    struct mns_log log;
    struct mns_message message;
    struct pool *pool; /* NULL: the caller's threads */
    struct mns_parallel parallel;
    int threads;
    bool warned[WARN_KINDS];

    /* The last step. */
    bool has_frame, by_id;
    size_t count;
    double time;
    int foam; /* enum mns_foam: what is attached */
    bool derived_velocity, derived_density;
    struct mns_class_stats stats;

    /* [..._room] particles' worth each; of pairs, [now] is the last step's. */
    int now;
    float *kept[2][KEEP_COUNT];
    size_t kept_room[2][KEEP_COUNT];
    double *places[2]; /* [count][3], world space, of steps whose velocities are derived */
    size_t places_room[2];
    bool has_places;
    float *out[2][OUT_COUNT];
    size_t out_room[2][OUT_COUNT];
    float *velocity[2]; /* [count][3], derived */
    size_t velocity_room[2];
    uint32_t *from; /* index in the frame before, where there are ids */
    struct tally *tallies;
    float *sample;
    size_t from_room, tally_room, sample_room;
    struct ids ids;
    struct grid grid;
    double spacing; /* estimated of the first set that needed it, metres; 0: not yet */
};

/* One step. */
struct step {
    mns_classifier *self;
    const struct mns_particles *particles;
    struct mns_params params;
    struct rule rule;
    size_t before;     /* particles of the frame before; 0: there is none */
    double seconds;    /* since then */
    double reference;  /* density of the fluid at rest, in the unit of the densities; 0: unknown */
    double unit;       /* kg/m^3 of a derived density at rest */
    const float *sums; /* derived densities in any unit, or NULL */
};

/* Tells the caller's log; each kind once. */
void mns_classifier_warn(mns_classifier *self, enum warning kind, const char *format, ...)
#ifdef __GNUC__
    __attribute__((format(printf, 3, 4)))
#endif
    ;

/* Which particle is which: fills from where there are ids, and counts. */
mns_result mns_step_match(struct step *step);

/* L and the radius, metres; the radius only where something is measured in it. */
mns_result mns_step_sizes(struct step *step, double *fluid_size, double *radius);

/* The density of the fluid at rest; where the particles bring none, the densities too. */
mns_result mns_step_densities(struct step *step, double radius);

/* Everything per particle: what is kept, what is handed out, and counts. */
mns_result mns_step_run(struct step *step);

#endif
