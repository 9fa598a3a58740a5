/* sky.h: the sky's radiance in plain C (cpu/sky.h). */
#ifndef MNS_CPU_SCALAR_SKY_H
#define MNS_CPU_SCALAR_SKY_H

#include "cpu/sky.h"

#include <math.h>

static inline float sky_phase(float g, float q)
{
    float narrow = (1 - g) * (1 - g), ratio = narrow / (narrow + g * q);
    return ratio * sqrtf(ratio);
}

/* h = d . up and q = |d - sun|^2 of the direction. */
static inline void sky_radiance(const struct sky *sky, float h, float q, float out[3])
{
    const float *far = h >= 0 ? sky->zenith : sky->ground;
    float root = 1 / (1 + SKY_HAZE * fabsf(h)), haze = root * root;
    float wide = sky_phase(SKY_WIDE_G, q), narrow = sky_phase(SKY_NARROW_G, q);
    for (int c = 0; c < 3; c++) {
        out[c] = far[c] + (sky->horizon[c] - far[c]) * haze + wide * sky->glow_wide[c] + narrow * sky->glow_narrow[c];
    }
}

/* |d - sun|^2 for a direction d. */
static inline float sky_sun_distance2(const struct sky *sky, const float d[3])
{
    float x = d[0] - sky->sun[0], y = d[1] - sky->sun[1], z = d[2] - sky->sun[2];
    return x * x + y * y + z * z;
}

#endif
