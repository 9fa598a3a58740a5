/* classify.h: the arithmetic of one step: what becomes of a block of particles. */
#ifndef MNS_PARTICLES_CLASSIFY_H
#define MNS_PARTICLES_CLASSIFY_H

#include <meniscus/params.h>

#include <stdbool.h>
#include <stddef.h>

/* What is remembered of a particle. All but the velocity are 0 to 1, and 0 for a new particle; each falls at a constant rate unless its cause
 * lifts it, and what rises does so at a limited rate: so each is a largest or least value over a bounded past, and nothing older matters. */
enum remembered {
    KEEP_STRENGTH, /* how foamy it was at most: falls to 0 in two lifetimes */
    KEEP_LIFE,     /* part of its foam's life that is left: 1 as long as there is a cause */
    KEEP_YOUTH,    /* the same, rising no faster than foam fades in */
    KEEP_FOAM,     /* its foam's radius: min(strength, life * lifetime / fade-out), rising no faster than foam fades in */
    KEEP_HEAT,     /* 1 at a change of velocity, then cooling down */
    KEEP_NOISE,    /* its noise, rising no faster than foam fades in */
    KEEP_X,        /* velocity, m/s; NaN: unknown */
    KEEP_Y,
    KEEP_Z,
    KEEP_COUNT
};

/* 0 up to low, 1 from low + 1 / scale on, linear between. */
struct ramp {
    float low, scale;
};

/* The thresholds of a step, resolved. */
struct rule {
    float weber;                                     /* We = weber * (density / rest density) * speed^2: [BSW10] eq. 5 */
    struct ramp foam;                                /* over We */
    struct ramp air;                                 /* over the part of the surroundings that is air: 1 - density / rest density */
    struct ramp water;                               /* over density / rest density; what is not water is spray */
    float strength_fall, life_fall, heat_fall, rise; /* per step */
    float life_scale;                                /* lifetime / fade-out */
    float tau2;                                      /* m^2/s^2: square of the change of velocity that heats */
    float calm, calm_scale;                          /* noise of a calm particle: calm * min(1, We * calm_scale) */
};

enum { CLASSIFY_BLOCK = 256 }; /* particles whose arrays fit the nearest cache */

/* [count] each. In: velocity, density over the rest density (1 where unknown), what was remembered. Out: what is to be remembered (its velocity is
 * the caller's to fill), and the attributes of struct mns_particles. No output may overlap an input. */
struct classify_block {
    size_t count; /* at most CLASSIFY_BLOCK */
    const float *velocity[3], *density;
    const float *before[KEEP_COUNT];
    float *after[KEEP_COUNT];
    float *water, *foam, *foam_age, *spray, *noise;
};

void mns_classify_block(const struct rule *rule, const struct classify_block *block);

/* The thresholds that checked parameters stand for. fluid_size: L, metres. radius: metres, for surface_tension. rest_density: kg/m^3, the same. step:
 * seconds since the frame before; 0: there is none. */
void mns_classify_rule(struct rule *rule, const struct mns_params *params, double fluid_size, double radius, double rest_density,
                       double step);

/* The times of the foam where they are auto, seconds. */
struct foam_times {
    double lifetime, fade_in, fade_out, cooldown;
};
struct foam_times mns_foam_times(const struct mns_params *params, double fluid_size);

#endif
