/* sky.h: the procedural sky: a clear midday sky with haze at the horizon, the glow around the sun, and the ground's mean below.
 *
 * Radiance of a direction d (unit) with h = d . up, q = |d - sun|^2:
 *   haze = 1 / (1 + SKY_HAZE |h|)^2                     1 at the horizon, 0.02 overhead
 *   base = far + (horizon - far) haze                   far: zenith above the horizon, ground below it
 *   glow = wide p(0.8) + narrow p(0.97), p(g) = ((1 - g)^2 / ((1 - g)^2 + g q))^1.5
 * p is the Henyey-Greenstein phase function of haze, scaled to 1 towards the sun. The disc itself is drawn by stage scene alone: in
 * reflections the highlight stands for it ([LGS09] eq. 13). */
#ifndef MNS_CPU_SKY_H
#define MNS_CPU_SKY_H

#include "core/frame.h"

#define SKY_HAZE     6.0f
#define SKY_WIDE_G   0.8f
#define SKY_NARROW_G 0.97f

/* Width of the joints between tiles of the floor, in cells. */
#define FLOOR_JOINT 0.03f

struct sky {
    float up[3], sun[3];         /* unit, image space */
    float zenith[3], horizon[3]; /* linear radiance, where a white surface under the default sun has about 1.6 */
    float ground[3];             /* below the horizon */
    float glow_wide[3], glow_narrow[3];
    float sun_light[3]; /* of a white surface that faces the sun */
    float sky_light[3]; /* of a white surface that faces up, by the sky alone */
};

/* In the image space of the frame's view. */
void mns_sky_resolve(struct sky *sky, const struct frame *frame);

/* The same light for others, in world space. */
void mns_cpu_light(const struct frame *frame, struct mns_light *out);

/* out = rotation * v: a direction of the set's space in image space. */
static inline void sky_rotate(float out[3], const float rotation[9], const float v[3])
{
    for (int i = 0; i < 3; i++) {
        out[i] = rotation[3 * i] * v[0] + rotation[3 * i + 1] * v[1] + rotation[3 * i + 2] * v[2];
    }
}

#endif
