/* sky.h: the sky's radiance over simd.h (cpu/sky.h). */
#ifndef MNS_CPU_SIMD_SKY_H
#define MNS_CPU_SIMD_SKY_H

#include "cpu/simd.h"
#include "cpu/sky.h"

/* Square root of a positive normal number by vf_rsqrt. */
SIMD vf vf_root(vf a) { return a * vf_rsqrt(a); }

SIMD vf vf_dot(const float a[3], vf x, vf y, vf z) { return vf_fma(vf_set1(a[0]), x, vf_fma(vf_set1(a[1]), y, vf_set1(a[2]) * z)); }

SIMD vf sky_phase(float g, vf q)
{
    float narrow = (1 - g) * (1 - g);
    vf root = vf_rsqrt(vf_fma(vf_set1(g / narrow), q, vf_set1(1.0f)));
    return root * root * root;
}

/* h = d . up and q = |d - sun|^2 of the directions. */
SIMD void sky_radiance(const struct sky *sky, vf h, vf q, vf out[3])
{
    vm above = vf_ge(h, vf_zero());
    vf root = vf_rcp(vf_fma(vf_set1(SKY_HAZE), vf_abs(h), vf_set1(1.0f))), haze = root * root;
    vf wide = sky_phase(SKY_WIDE_G, q), narrow = sky_phase(SKY_NARROW_G, q);
    for (int c = 0; c < 3; c++) {
        vf far = vf_select(above, vf_set1(sky->zenith[c]), vf_set1(sky->ground[c]));
        vf base = vf_fma(vf_set1(sky->horizon[c]) - far, haze, far);
        out[c] = vf_fma(wide, vf_set1(sky->glow_wide[c]), vf_fma(narrow, vf_set1(sky->glow_narrow[c]), base));
    }
}

/* |d - sun|^2 */
SIMD vf sky_sun_distance2(const struct sky *sky, vf x, vf y, vf z)
{
    x = x - vf_set1(sky->sun[0]);
    y = y - vf_set1(sky->sun[1]);
    z = z - vf_set1(sky->sun[2]);
    return vf_fma(x, x, vf_fma(y, y, z * z));
}

#endif
