/* classify_block.c: Weber number, air and density into foam, spray and noise, in loops that compilers make vectors of. */
#include "particles/classify.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

/* Air in the surroundings, over foam_air, below which nothing foams: densities inside a fluid differ by a percent or two. */
static const float AIR_LEAST = 0.2f;

/* Defaults in the fluid's own time V / gravity = sqrt(L / gravity), in which a drop falls half of L. */
static const double LIFETIME = 4, FADE_IN = 0.5, FADE_OUT = 1.5, COOLDOWN = 2;

/* noise_tau: a jolt, in V, on top of what falling freely gains. */
static const double JOLT = 0.15;

static inline float least(float a, float b) { return a < b ? a : b; }
static inline float most(float a, float b) { return a > b ? a : b; }

static inline float ramp_at(const struct ramp *ramp, float value)
{
    float x = (value - ramp->low) * ramp->scale;
    x = least(most(x, 0), 1);           /* NaN: 0 */
    return value >= ramp->high ? 1 : x; /* where low and high are equal */
}

/* Within 1e-6 of the root for x in [0, 1]; exact at 0 and 1. */
static inline float cube_root(float x)
{
    int32_t bits;
    memcpy(&bits, &x, sizeof(bits));
    bits = (int32_t)((float)bits * (1.0f / 3)) + 709958130; /* a third of the exponent: within 4 % */
    float y;
    memcpy(&y, &bits, sizeof(y));
    for (int i = 0; i < 2; i++) { /* Halley: the error to the third power */
        float cube = y * y * y;
        y = y * (cube + 2 * x) / (2 * cube + x);
    }
    return x > 1e-9f ? x < 1 ? y : 1 : 0;
}

/* Weber number -> cause of foam, and what is remembered of it. */
static void age_foam(const struct rule *rule, const struct classify_block *block, float *restrict weber)
{
    const float *restrict vx = block->velocity[0], *restrict vy = block->velocity[1], *restrict vz = block->velocity[2];
    const float *restrict density = block->density, *restrict strength = block->before[KEEP_STRENGTH];
    const float *restrict life = block->before[KEEP_LIFE], *restrict youth = block->before[KEEP_YOUTH];
    const float *restrict foam = block->before[KEEP_FOAM];
    float *restrict new_strength = block->after[KEEP_STRENGTH], *restrict new_life = block->after[KEEP_LIFE];
    float *restrict new_youth = block->after[KEEP_YOUTH], *restrict new_foam = block->after[KEEP_FOAM];
    for (size_t i = 0; i < block->count; i++) {
        float we = rule->weber * density[i] * (vx[i] * vx[i] + vy[i] * vy[i] + vz[i] * vz[i]);
        we = we >= 0 ? we : 0; /* the velocity is unknown */
        float cause = ramp_at(&rule->foam, we) * (rule->everywhere ? 1 : ramp_at(&rule->air, 1 - density[i]));
        float s = most(cause, strength[i] - rule->strength_fall);
        float l = cause > 0 ? 1 : most(life[i] - rule->life_fall, 0);
        weber[i] = we;
        new_strength[i] = s;
        new_life[i] = l;
        new_youth[i] = least(l, youth[i] + rule->rise);
        new_foam[i] = least(least(s, l * rule->life_scale), foam[i] + rule->rise);
    }
}

static void cool_noise(const struct rule *rule, const struct classify_block *block, const float *restrict weber)
{
    const float *restrict vx = block->velocity[0], *restrict vy = block->velocity[1], *restrict vz = block->velocity[2];
    const float *restrict ux = block->before[KEEP_X], *restrict uy = block->before[KEEP_Y], *restrict uz = block->before[KEEP_Z];
    const float *restrict heat = block->before[KEEP_HEAT], *restrict noise = block->before[KEEP_NOISE];
    float *restrict new_heat = block->after[KEEP_HEAT], *restrict new_noise = block->after[KEEP_NOISE];
    for (size_t i = 0; i < block->count; i++) {
        float dx = vx[i] - ux[i], dy = vy[i] - uy[i], dz = vz[i] - uz[i];
        float h = dx * dx + dy * dy + dz * dz > rule->tau2 ? 1 : most(heat[i] - rule->heat_fall, 0); /* [LGS09] eq. 12 */
        float calm = rule->calm * least(weber[i] * rule->calm_scale, 1);
        new_heat[i] = h;
        new_noise[i] = least(h + (1 - h) * calm, noise[i] + rule->rise);
    }
}

/* What was one particle is parted by volume: spray, foam^3 and water^3 add up to 1. */
static void share(const struct rule *rule, const struct classify_block *block)
{
    const float *restrict density = block->density, *restrict level = block->after[KEEP_FOAM];
    const float *restrict youth = block->after[KEEP_YOUTH], *restrict amplitude = block->after[KEEP_NOISE];
    float *restrict water = block->water, *restrict foam = block->foam, *restrict age = block->foam_age;
    float *restrict spray = block->spray, *restrict noise = block->noise;
    for (size_t i = 0; i < block->count; i++) {
        float rest = ramp_at(&rule->water, density[i]), f = level[i];
        spray[i] = 1 - rest;
        foam[i] = f * cube_root(rest);
        water[i] = cube_root(rest * (1 - f * f * f));
        age[i] = 1 - youth[i];
        noise[i] = amplitude[i];
    }
}

void mns_classify_block(const struct rule *rule, const struct classify_block *block)
{
    float weber[CLASSIFY_BLOCK];
    age_foam(rule, block, weber);
    cool_noise(rule, block, weber);
    share(rule, block);
}

static struct ramp ramp_of(double low, double high)
{
    return (struct ramp){.low = (float)low, .high = (float)high, .scale = high > low ? (float)(1 / (high - low)) : 0};
}

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
                                                 : ramp_of(INFINITY, INFINITY), /* noise knows no foam particles */
        .air = ramp_of((double)(AIR_LEAST * params->foam_air), (double)params->foam_air),
        .water = ramp_of((double)params->spray_low, (double)params->spray_high),
        .strength_fall = fall(step, 2 * times.lifetime),
        .life_fall = fall(step, times.lifetime),
        .heat_fall = fall(step, times.cooldown),
        .rise = step > 0 ? fall(step, times.fade_in) : 1, /* a first frame shows what there is */
        .life_scale = times.fade_out > 0 ? (float)fmin(times.lifetime / times.fade_out, 1e30) : 1e30f,
        .tau2 = (float)fmin(tau * tau, 1e30),
        .calm = params->noise_calm,
        .calm_scale = params->foam_weber_high > 0 ? 1 / params->foam_weber_high : 1e30f,
        .everywhere = params->foam_air <= 0,
    };
}
