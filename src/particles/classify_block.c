/* classify_block.c: Weber number, air and density into foam, spray and noise, in loops that compilers make vectors of. */
#include "particles/classify.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

/* Air in the surroundings, over foam_air, below which nothing foams: densities inside a fluid differ by a percent or two. */
static const float AIR_LEAST = 0.2f;

/* Defaults in the fluid's own time V / gravity = sqrt(L / gravity), in which a drop falls half of L. */
static const double LIFETIME = 3, FADE_IN = 0.5, FADE_OUT = 1.5, COOLDOWN = 2;

/* noise_tau: a jolt, in V, on top of what falling freely gains. */
static const double JOLT = 0.15;

/* Turns what is above 0 into 1 and more, whatever it is. */
static const float HUGE_FACTOR = 1e30f;

/* With one NaN the second one. Loops of these alone become vectors; branches would not. */
static inline float least(float a, float b) { return a < b ? a : b; }
static inline float most(float a, float b) { return a > b ? a : b; }

static inline float ramp_at(struct ramp ramp, float value) { return least(most((value - ramp.low) * ramp.scale, 0), 1); }

/* Within 1e-6 of the root for x in [0, 1]; exact at 0 and 1. */
static inline float cube_root(float x)
{
    float positive = x + 1e-12f; /* powers of 0's first guess would be denormal, which is slow */
    int32_t bits;
    memcpy(&bits, &positive, sizeof(bits));
    bits = (int32_t)((float)bits * (1.0f / 3)) + 710235456; /* a third of the exponent: within 6 %, and 1 of 1 */
    float y;
    memcpy(&y, &bits, sizeof(y));
    for (int i = 0; i < 2; i++) { /* Halley: the error to the third power */
        float cube = y * y * y;
        y = y * ((cube + 2 * positive) / (2 * cube + positive));
    }
    return least(y, 1) * least(x * 1e12f, 1);
}

/* The loops. Each array is its own: `restrict` in the parameters is what lets a compiler make vectors of them. */

/* [BSW10] eq. 5, and what of it makes foam. */
static void find_cause(const struct rule *rule, size_t count, const float *restrict x, const float *restrict y, const float *restrict z,
                       const float *restrict density, float *restrict weber, float *restrict cause)
{
    const struct rule on = *rule;
    for (size_t i = 0; i < count; i++) {
        float we = most(on.weber * density[i] * (x[i] * x[i] + y[i] * y[i] + z[i] * z[i]), 0); /* NaN where the velocity is unknown: 0 */
        weber[i] = we;
        cause[i] = ramp_at(on.foam, we) * ramp_at(on.air, 1 - density[i]);
    }
}

static void outlast(const struct rule *rule, size_t count, const float *restrict cause, const float *restrict strength,
                    const float *restrict life, float *restrict new_strength, float *restrict new_life)
{
    const struct rule on = *rule;
    for (size_t i = 0; i < count; i++) {
        new_strength[i] = most(cause[i], strength[i] - on.strength_fall);
        new_life[i] = least(most(life[i] - on.life_fall, cause[i] * HUGE_FACTOR), 1); /* 1 where there is a cause */
    }
}

static void grow(const struct rule *rule, size_t count, const float *restrict strength, const float *restrict life,
                 const float *restrict youth, const float *restrict foam, float *restrict new_youth, float *restrict new_foam)
{
    const struct rule on = *rule;
    for (size_t i = 0; i < count; i++) {
        new_youth[i] = least(life[i], youth[i] + on.rise);
        new_foam[i] = least(least(strength[i], life[i] * on.life_scale), foam[i] + on.rise);
    }
}

/* [LGS09] eq. 12: above 0 where the velocity changed by more than tau; NaN where one of the two is unknown. */
static void find_jolt(const struct rule *rule, size_t count, const float *const velocity[3], const float *const before[3],
                      float *restrict jolt)
{
    for (size_t i = 0; i < count; i++) {
        jolt[i] = -rule->tau2;
    }
    for (int k = 0; k < 3; k++) {
        const float *v = velocity[k], *u = before[k];
        for (size_t i = 0; i < count; i++) {
            jolt[i] += (v[i] - u[i]) * (v[i] - u[i]);
        }
    }
}

static void cool(const struct rule *rule, size_t count, const float *restrict jolt, const float *restrict weber, const float *restrict heat,
                 const float *restrict noise, float *restrict new_heat, float *restrict new_noise)
{
    const struct rule on = *rule;
    for (size_t i = 0; i < count; i++) {
        float h = least(most(most(jolt[i] * HUGE_FACTOR, heat[i] - on.heat_fall), 0), 1);
        float calm = on.calm * least(weber[i] * on.calm_scale, 1);
        new_heat[i] = h;
        new_noise[i] = least(h + (1 - h) * calm, noise[i] + on.rise);
    }
}

/* What was one particle is parted by volume: spray, foam^3 and water^3 add up to 1. */
static void share(const struct rule *rule, size_t count, const float *restrict density, const float *restrict level, float *restrict spray,
                  float *restrict foam, float *restrict water)
{
    const struct rule on = *rule;
    for (size_t i = 0; i < count; i++) {
        float rest = ramp_at(on.water, density[i]), f = level[i];
        spray[i] = 1 - rest;
        foam[i] = f * cube_root(rest);
        water[i] = cube_root(rest * (1 - f * f * f));
    }
}

void mns_classify_block(const struct rule *rule, const struct classify_block *block)
{
    float weber[CLASSIFY_BLOCK], cause[CLASSIFY_BLOCK], jolt[CLASSIFY_BLOCK];
    const size_t count = block->count;
    const float *const *was = block->before;
    float *const *is = block->after;
    find_cause(rule, count, block->velocity[0], block->velocity[1], block->velocity[2], block->density, weber, cause);
    outlast(rule, count, cause, was[KEEP_STRENGTH], was[KEEP_LIFE], is[KEEP_STRENGTH], is[KEEP_LIFE]);
    grow(rule, count, is[KEEP_STRENGTH], is[KEEP_LIFE], was[KEEP_YOUTH], was[KEEP_FOAM], is[KEEP_YOUTH], is[KEEP_FOAM]);
    find_jolt(rule, count, block->velocity, &was[KEEP_X], jolt);
    cool(rule, count, jolt, weber, was[KEEP_HEAT], was[KEEP_NOISE], is[KEEP_HEAT], is[KEEP_NOISE]);
    share(rule, count, block->density, is[KEEP_FOAM], block->spray, block->foam, block->water);
    for (size_t i = 0; i < count; i++) {
        block->foam_age[i] = 1 - is[KEEP_YOUTH][i];
        block->noise[i] = is[KEEP_NOISE][i];
    }
}

/* low and high may be equal: then it is as steep as floats allow, and 1 at high. */
static struct ramp ramp_of(double low, double high)
{
    low = fmin(low, high - fmax(1e-6 * high, 1e-30));
    return (struct ramp){.low = (float)low, .scale = (float)(1 / (high - low))};
}

static const struct ramp NEVER = {.low = 0, .scale = 0}, ALWAYS = {.low = -1e30f, .scale = 1};

/* What falls by in a step of what lasts so long. */
static float fall(double step, double lasts) { return step < lasts ? (float)(step / lasts) : 1; }

struct foam_times mns_foam_times(const struct mns_params *params, double fluid_size)
{
    double own = sqrt(fluid_size / (double)params->gravity), long_own = own * (double)params->foam_persistence;
    struct foam_times times = {
        .lifetime = params->foam_lifetime >= 0 ? (double)params->foam_lifetime : LIFETIME * long_own,
        .fade_in = params->foam_fade_in >= 0 ? (double)params->foam_fade_in : FADE_IN * own,
        .fade_out = params->foam_fade_out >= 0 ? (double)params->foam_fade_out : FADE_OUT * long_own,
        .cooldown = params->noise_cooldown >= 0 ? (double)params->noise_cooldown : COOLDOWN * long_own,
    };
    times.fade_out = fmin(times.fade_out, times.lifetime);
    return times;
}

void mns_classify_rule(struct rule *rule, const struct mns_params *params, double fluid_size, double radius, double rest_density,
                       double step)
{
    double gravity = (double)params->gravity, energy = gravity * fluid_size; /* V^2 */
    struct foam_times times = mns_foam_times(params, fluid_size);
    double tau = params->noise_tau >= 0 ? (double)params->noise_tau : JOLT * sqrt(energy) + gravity * step;
    *rule = (struct rule){
        .weber = (float)(params->surface_tension > 0 ? rest_density * 2 * radius / (double)params->surface_tension : 1 / energy),
        .foam = params->foam == MNS_FOAM_LAYERED ? ramp_of((double)params->foam_weber_low, (double)params->foam_weber_high)
                                                 : NEVER, /* noise knows no foam particles */
        .air = params->foam_air > 0 ? ramp_of((double)(AIR_LEAST * params->foam_air), (double)params->foam_air) : ALWAYS,
        .water = ramp_of((double)params->spray_low, (double)params->spray_high),
        .strength_fall = fall(step, 2 * times.lifetime),
        .life_fall = fall(step, times.lifetime),
        .heat_fall = fall(step, times.cooldown),
        .rise = step > 0 ? fall(step, times.fade_in) : 1, /* a first frame shows what there is */
        .life_scale = times.fade_out > 0 ? (float)fmin(times.lifetime / times.fade_out, 1e30) : 1e30f,
        .tau2 = (float)fmin(tau * tau, 1e30),
        .calm = params->noise_calm,
        .calm_scale = params->foam_weber_low > 0 ? 1 / params->foam_weber_low : 1e30f,
    };
}
