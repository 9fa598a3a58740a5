/* meniscus/particles.h: particles as the caller holds them, and what can be measured on them. */
#ifndef MENISCUS_PARTICLES_H
#define MENISCUS_PARTICLES_H

#include <meniscus/common.h>

#ifdef __cplusplus
extern "C" {
#endif

/* One attribute of the particles in the caller's memory. data NULL: the particles do not have it.
 * Elements of one particle are adjacent; particles are stride bytes apart. Needs no alignment beyond the type's. */
struct mns_attr {
    const void *data;
    size_t stride;      /* bytes from one particle to the next; 0: packed */
    enum mns_type type; /* of one element */
};

/* A set of particles. Borrowed: read during the call, never kept, never written.
 * Particles whose position is not finite are left out and counted (struct mns_measure); the others may span 1e12 m along each axis, wherever in
 * the world. Attributes may have any type unless a line says otherwise. */
struct mns_particles {
    size_t struct_size;       /* set by mns_particles_init */
    size_t count;             /* at most 2^32 - 65 */
    struct mns_attr position; /* [count][3], metres, world space; float32 or float64. Required unless count is 0 */
    struct mns_attr radius;   /* [count], metres, 1e-12 to 1e12; half the rest spacing. Absent: mns_params.radius */
    struct mns_attr mass;     /* [count], kg, 1e-30 to 1e18. With mns_params.rest_density it gives the rest volume */
    struct mns_attr color;    /* [count][3], linear RGB, held to 0 to 1 (NaN: 0). Absent: the fluid has its own colour */
    struct mns_attr velocity; /* [count][3], m/s. The renderer stretches spray along it */
    struct mns_attr density;  /* [count], kg/m^3. Not read by the renderer */
    struct mns_attr id;       /* [count], integer: what tells a particle from one frame to the next. Absent: its index */

    /* What each particle is drawn as. meniscus/classify.h and meniscus/anisotropy.h derive them; an engine may give its own. Held to 0 to 1 where
     * a line says so; what is NaN counts as absent. The renderer rounds 0.001 and less to 0 in water, foam and spray. */
    struct mns_attr water; /* [count], 0 to 1: factor on the radius of its water sphere, whose volume goes with the cube; 0: no water there.
                                 Absent: 1 */
    struct mns_attr foam;  /* [count], 0 to 1: factor on the radius of its foam sphere, likewise. Absent: 0, none */
    struct mns_attr foam_age; /* [count], 0 to 1: the part of its foam's life that has passed. Absent: 0 */
    struct mns_attr spray;    /* [count], 0 to 1: opacity of the soft drop that it is drawn as. Absent: 0, none */
    struct mns_attr noise;    /* [count], 0 to 1: amplitude of its surface noise. Absent: 1 */
    struct mns_attr shape; /* [count][6]: xx, yy, zz, xy, xz, yz of a symmetric positive matrix A, world space: the splat is the ellipsoid
                                 { c + R A u, |u| = 1 }, of the same rest volume as without. Eigenvalues from 0.01 to 100, the largest at most
                                 100 times the least. Absent: the identity, a sphere */
    struct mns_attr kind; /* [count], integer, enum mns_kind. Read of diffuse particles only (mns_renderer_prepare_diffuse). Absent: foam */

    double
        spacing; /* metres: the rest spacing where it is known; 0 (or less, or not finite): told from the positions (struct mns_measure) */
};

/* Kinds of diffuse particles. */
enum mns_kind { MNS_KIND_FOAM = 0, MNS_KIND_SPRAY = 1, MNS_KIND_BUBBLE = 2 };

/* No particles, no attributes. size: sizeof(struct mns_particles) as the caller knows it. */
MNS_API void mns_particles_init_sized(struct mns_particles *particles, size_t size);
static inline void mns_particles_init(struct mns_particles *particles) { mns_particles_init_sized(particles, sizeof(*particles)); }

/* What a set of particles measures. Bounds are those of the centres; all zero when no particle is finite. */
struct mns_measure {
    size_t count;                        /* particles with a finite position */
    size_t dropped;                      /* particles without */
    double bounds_min[3], bounds_max[3]; /* metres: all finite particles */
    double inner_min[3], inner_max[3];   /* metres: the 0.1 % and 99.9 % quantiles of each coordinate */
    double spacing;                      /* metres: estimated rest spacing; 0 when it cannot be told (under 2 distinct particles) */
    double radius;                       /* metres: the median of the given radii where there are some, else spacing / 2 */
};

/* Measures a set. The spacing is (4 pi d_k^3 / (3 k))^(1/3) with d_k the distance to the k = 20th neighbour (fewer particles: the
 * last), the 20th percentile over a fixed sample of the particles: deterministic, and within a few percent on SPH output.
 * allocator, message: may be NULL. Errors: invalid argument, out of memory. */
MNS_API mns_result mns_particles_measure(const struct mns_particles *particles, const struct mns_allocator *allocator,
                                         struct mns_measure *out, struct mns_message *message);

#ifdef __cplusplus
}
#endif

#endif
