/* shadow.h: the light on the floor, with the fluid's own shadow in it. */
#ifndef MNS_CPU_SHADOW_H
#define MNS_CPU_SHADOW_H

#include "cpu/cpu.h"
#include "cpu/sky.h"

/* Texels along the longer side of the map, at most. */
enum { SHADOW_SIZE = 1024 };

/* light: [height][width][4] linear light on a white floor (the fourth is 0); texel (i, j) stands at (min_u + i * texel, min_v + j * texel) along
 * the floor's axes, relative to the set's origin, metres. No particle throws a shadow beyond the map's edge. */
struct shadow {
    float *light;
    size_t light_capacity;   /* floats */
    float *sums[3];          /* thickness along the sun, thickness upwards at a quarter of the resolution, a pass in between */
    size_t sums_capacity[3]; /* floats */
    int width, height;
    float min_u, min_v, texel;
    struct shadow_key *key; /* what the map was made from */
};

/* Makes cpu->scene.shadow the map for the frame, unless it is that already. Each texel has
 *   sun * exp(-absorption * thickness towards the sun) * what the surface lets in  +  sky * exp(-absorption * mean thickness above):
 * Beer-Lambert per channel, and the contact darkening of fluid that hides the sky. light: of the sun and of the sky on the open floor. */
mns_result mns_shadow_update(struct backend *cpu, const struct frame *frame, const float sun_light[3], const float sky_light[3]);

void mns_shadow_destroy(struct backend *cpu);

#endif
