/* shadow.h: the light on the floor, with the fluid's own shadow in it. */
#ifndef MNS_CPU_SHADOW_H
#define MNS_CPU_SHADOW_H

#include "cpu/cpu.h"
#include "cpu/sky.h"

/* Texels along the longer side of the map, at most. */
enum { SHADOW_SIZE = 1024 };

/* Steps of the table of what comes through fluid: its interpolation is within 1e-4 of light that falls by e^-20 over them. */
enum { SHADOW_STEPS = 1024 };

/* light: [height][width][4] linear light on a white floor, and the metres of fluid above it; texel (i, j) stands at (min_u + i * texel, min_v + j * texel) along
 * the floor's axes, relative to the set's origin, metres. No particle throws a shadow beyond the map's edge. */
struct shadow {
    float *light;
    size_t light_capacity; /* floats */
    float *sums[5];        /* thickness along the sun, thickness upwards at a quarter of the resolution, a pass in between; with objects the
                              * thickness along the sun times the height over the floor, and times its square */
    size_t sums_capacity[5]; /* floats */
    float thickest;          /* largest thickness along the sun, metres; with objects */
    float through[SHADOW_STEPS + 2]
                 [3]; /* part of the sun's light that i / SHADOW_STEPS of it lets through; one more than that, for interpolation */
    float sun_loss;   /* part of the sun's light that a body of fluid's two surfaces reflect */
    int width, height;
    float min_u, min_v, texel;
    struct shadow_key *key; /* what the map was made from */
};

/* Makes cpu->scene.shadow the map for the frame, unless it is that already. Each texel has
 *   sun * exp(-absorption * thickness towards the sun) * what the surface lets in  +  sky * exp(-absorption * mean thickness above):
 * Beer-Lambert per channel, and the contact darkening of fluid that hides the sky. light: of the sun and of the sky on the open floor. */
mns_result mns_shadow_update(struct backend *cpu, const struct frame *frame, const float sun_light[3], const float sky_light[3]);

/* Part of the sun's light that the fluid lets through to a point at u, v (texels) of the map and a height over the floor: 1 outside the map. From three
 * moments of the fluid along the sun, as if it were a slab of their mean and variance: exact for one, smooth for all. Needs a frame with objects. */
void mns_shadow_at(const struct shadow *shadow, float u, float v, float height, float out[3]);

/* The sky's light on the floor under so many metres of fluid. */
void mns_shadow_sky(const struct shadow *shadow, float above, float out[3]);

void mns_shadow_destroy(struct backend *cpu);

#endif
