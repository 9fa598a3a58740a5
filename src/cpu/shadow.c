/* shadow.c: the fluid's volume, gathered along the sun and along the vertical on the floor, and the light that comes through it.
 *
 * Each row band of a map goes through all chunks of particles in order and takes what falls on its own rows, so the sums have one order
 * whatever the threads, and need no memory per thread. */
#include "cpu/shadow.h"

#include "cpu/measure.h"
#include "util/clock.h"

#include <math.h>
#include <string.h>

enum {
    BAND = 32,         /* rows of a map per job: the boxes of all chunks are looked at once per band */
    SKY_REDUCTION = 4, /* texels of the light per texel of the thickness upwards, which is blurred widely */
    BLUR_TAPS = 256    /* of one side of a blur, at most */
};

/* Texels per splat radius beyond which a finer map shows nothing more. */
static const float TEXELS_PER_RADIUS = 3;
/* Standard deviation of a particle's own shadow, in R; and of the vicinity that hides the sky from a point of the floor, in L. */
static const float SUN_SIGMA = 1.2f, SKY_SIGMA = 0.05f;
/* Blurs end here, in sigma. */
static const float BLUR_CUT = 3;
/* Part of the sky's light that a floor under much fluid loses because the fluid's sides reflect it away. */
static const float SKY_LOSS = 0.45f;
/* Part of the sunlight that goes astray at the fluid's surfaces, refracted out of its way. */
static const float SUN_ASTRAY = 0.3f;
/* How much of the water's hue its shadow has: with all of it one cannot tell where the water ends and its shadow begins. */
static const float SHADOW_HUE = 0.35f;
/* Thickness from which on fluid counts as a body, in R. */
static const float BODY = 4;
/* Most that one particle adds to a texel, metres, so that sums stay finite whatever its volume. */
static const float THICKEST = 1e20f;
/* The map holds all but stray particles: a thousandth of them at each end may lie outside. */
enum { STRAYS = 1000 };

/* All members have four bytes: no padding, so that keys can be compared as bytes. */
struct shadow_key {
    unsigned generation;
    int axis_up;
    float sun[3], floor_height;
    float splat_radius, volume, volume_per_mass, volume_per_cube, fluid_size, absorption[3], refraction_index;
    float sun_light[3], sky_light[3];
    unsigned has_moments;
};

/* Where particles fall on a map: u = p[axis_u] - shear_u * height over the floor, likewise v. */
struct projection {
    int axis_u, axis_v, axis_up;
    float floor_height, shear_u, shear_v;
};

struct deposit {
    const struct particle_store *particles;
    const struct frame *frame;
    struct projection projection;
    float *sums; /* [height][width] */
    int width, height;
    float min_u, min_v, per_metre; /* texels per metre */
    float per_volume;              /* thickness of a texel per m^3 */
    int moment;                    /* 1, 2: the thickness times that power of the height over the floor is gathered */
};

static const float *axis_of(const struct particle_store *store, int axis) { return axis == 0 ? store->x : axis == 1 ? store->y : store->z; }

static float volume_of(const struct frame *frame, const struct particle_store *store, size_t i)
{
    float r = store->radius ? store->radius[i] : 0, factor = store->factor ? store->factor[i] : 1;
    if (frame->volume_per_cube > 0) {
        return frame->volume_per_cube * r * r * r; /* the factor is in the radius */
    }
    float volume = frame->volume_per_mass > 0 ? frame->volume_per_mass * store->mass[i] : frame->volume;
    return volume * factor * factor * factor;
}

/* Whether a chunk may touch rows [begin, end) of the map. */
static bool chunk_in_rows(const struct deposit *d, size_t chunk, int begin, int end)
{
    const struct projection *p = &d->projection;
    const struct particle_store *store = d->particles;
    float low = store->box_min[p->axis_v][chunk], high = store->box_max[p->axis_v][chunk];
    float a = p->shear_v * (store->box_min[p->axis_up][chunk] - p->floor_height);
    float b = p->shear_v * (store->box_max[p->axis_up][chunk] - p->floor_height);
    float first = (low - fmaxf(a, b) - d->min_v) * d->per_metre, last = (high - fminf(a, b) - d->min_v) * d->per_metre;
    return last >= (float)(begin - 1) && first <= (float)end;
}

static void deposit_chunk(const struct deposit *d, size_t chunk, int begin, int end)
{
    const struct projection *p = &d->projection;
    const struct particle_store *store = d->particles;
    const float *pu = axis_of(store, p->axis_u), *pv = axis_of(store, p->axis_v), *up = axis_of(store, p->axis_up);
    size_t last = (chunk + 1) * CHUNK_SIZE < store->count ? (chunk + 1) * CHUNK_SIZE : store->count;
    for (size_t i = chunk * CHUNK_SIZE; i < last; i++) {
        float height = up[i] - p->floor_height;
        float u = (pu[i] - p->shear_u * height - d->min_u) * d->per_metre, v = (pv[i] - p->shear_v * height - d->min_v) * d->per_metre;
        if (!(height >= 0) || !(u >= 0) || !(v >= 0) || !(u < (float)(d->width - 1)) || !(v < (float)(d->height - 1))) {
            continue;
        }
        int column = (int)u, row = (int)v;
        float fu = u - (float)column, fv = v - (float)row, thickness = fminf(volume_of(d->frame, store, i) * d->per_volume, THICKEST);
        for (int power = 0; power < d->moment; power++) {
            thickness *= height;
        }
        float *texel = d->sums + (ptrdiff_t)row * d->width + column;
        if (row >= begin && row < end) {
            texel[0] += (1 - fv) * (1 - fu) * thickness;
            texel[1] += (1 - fv) * fu * thickness;
        }
        if (row + 1 >= begin && row + 1 < end) {
            texel[d->width] += fv * (1 - fu) * thickness;
            texel[d->width + 1] += fv * fu * thickness;
        }
    }
}

static void deposit_band(void *context, int band)
{
    const struct deposit *d = context;
    int begin = band * BAND, end = begin + BAND < d->height ? begin + BAND : d->height;
    memset(d->sums + (ptrdiff_t)begin * d->width, 0, sizeof(float) * (size_t)d->width * (size_t)(end - begin));
    for (size_t chunk = 0; chunk < d->particles->chunk_count; chunk++) {
        if (chunk_in_rows(d, chunk, begin, end)) {
            deposit_chunk(d, chunk, begin, end);
        }
    }
}

static int bands_of(int rows) { return (rows + BAND - 1) / BAND; }

/* A Gaussian along rows, then along columns; nothing lies beyond the map. */
struct blur {
    const float *from;
    float *to;
    int width, height, taps;
    float weights[BLUR_TAPS + 1];
};

static void blur_weights(struct blur *blur, float sigma)
{
    blur->taps = (int)fminf(ceilf(BLUR_CUT * sigma), BLUR_TAPS);
    double sum = 0;
    for (int i = 0; i <= blur->taps; i++) {
        blur->weights[i] = expf(-0.5f * (float)(i * i) / (sigma * sigma));
        sum += (i > 0 ? 2 : 1) * (double)blur->weights[i];
    }
    for (int i = 0; i <= blur->taps; i++) {
        blur->weights[i] = (float)(blur->weights[i] / sum);
    }
}

static void add_row(float *restrict to, const float *restrict from, int count, float weight)
{
    for (int i = 0; i < count; i++) {
        to[i] += weight * from[i];
    }
}

static void blur_row_band(void *context, int band)
{
    const struct blur *blur = context;
    int end = (band + 1) * BAND < blur->height ? (band + 1) * BAND : blur->height, width = blur->width;
    for (int row = band * BAND; row < end; row++) {
        const float *from = blur->from + (ptrdiff_t)row * width;
        float *to = blur->to + (ptrdiff_t)row * width;
        memset(to, 0, sizeof(float) * (size_t)width);
        add_row(to, from, width, blur->weights[0]);
        for (int i = 1; i <= blur->taps && i < width; i++) {
            add_row(to, from + i, width - i, blur->weights[i]);
            add_row(to + i, from, width - i, blur->weights[i]);
        }
    }
}

static void blur_column_band(void *context, int band)
{
    const struct blur *blur = context;
    int end = (band + 1) * BAND < blur->height ? (band + 1) * BAND : blur->height, width = blur->width;
    for (int row = band * BAND; row < end; row++) {
        float *to = blur->to + (ptrdiff_t)row * width;
        memset(to, 0, sizeof(float) * (size_t)width);
        for (int i = -blur->taps; i <= blur->taps; i++) {
            if (row + i >= 0 && row + i < blur->height) {
                add_row(to, blur->from + (ptrdiff_t)(row + i) * width, width, blur->weights[i < 0 ? -i : i]);
            }
        }
    }
}

static void gather(struct backend *cpu, struct deposit *d, float sigma_texels, float *between)
{
    cpu_run(cpu, deposit_band, d, bands_of(d->height));
    struct blur blur = {.from = d->sums, .to = between, .width = d->width, .height = d->height};
    blur_weights(&blur, sigma_texels);
    cpu_run(cpu, blur_row_band, &blur, bands_of(d->height));
    blur.from = between;
    blur.to = d->sums;
    cpu_run(cpu, blur_column_band, &blur, bands_of(d->height));
}

struct compose {
    struct shadow *shadow;
    int sky_width, sky_height;
};

/* Parts of the light that pass the surfaces of so many metres of fluid. */
struct losses {
    float sun, sky;
};

static struct losses losses_of(const struct shadow *shadow, float along, float above)
{
    /* How far the fluid is a body with surfaces: a drop of one particle is an eighth of one. */
    float body = BODY * shadow->key->splat_radius, covered = 1 - expf(-along / body), roofed = 1 - expf(-above / body);
    return (struct losses){1 - shadow->sun_loss * covered, 1 - SKY_LOSS * roofed};
}

/* Bilinear in the thickness upwards. */
static float sky_thickness(const struct compose *c, int column, int row)
{
    int i = column / SKY_REDUCTION, j = row / SKY_REDUCTION;
    float fu = (float)(column % SKY_REDUCTION) / SKY_REDUCTION, fv = (float)(row % SKY_REDUCTION) / SKY_REDUCTION;
    const float *texel = c->shadow->sums[1] + (ptrdiff_t)j * c->sky_width + i, *below = texel + c->sky_width;
    float top = texel[0] + fu * (texel[1] - texel[0]), bottom = below[0] + fu * (below[1] - below[0]);
    return top + fv * (bottom - top);
}

static void compose_band(void *context, int band)
{
    const struct compose *c = context;
    struct shadow *shadow = c->shadow;
    const struct shadow_key *key = shadow->key;
    int end = (band + 1) * BAND < shadow->height ? (band + 1) * BAND : shadow->height;
    for (int row = band * BAND; row < end; row++) {
        for (int column = 0; column < shadow->width; column++) {
            ptrdiff_t at = (ptrdiff_t)row * shadow->width + column;
            float along = shadow->sums[0][at], above = sky_thickness(c, column, row);
            struct losses losses = losses_of(shadow, along, above);
            float *light = shadow->light + 4 * at;
            for (int k = 0; k < 3; k++) {
                light[k] = key->sun_light[k] * expf(-key->absorption[k] * along) * losses.sun +
                           key->sky_light[k] * expf(-key->absorption[k] * above) * losses.sky;
            }
            light[3] = above;
        }
    }
}

/* Bounds along one axis of the map of where the particles' shadows fall, and of the particles themselves. */
static bool span(struct backend *cpu, const struct projection *p, bool along_v, float out[2])
{
    const struct particle_store *store = &cpu->stores[STORE_WATER];
    size_t step = store->count / QUANTILE_SAMPLE + 1, taken = 0;
    float *sample = mns_memory_get(cpu->host.memory, QUANTILE_SAMPLE + 1, sizeof(float));
    if (!sample) {
        return false;
    }
    const float *at = axis_of(store, along_v ? p->axis_v : p->axis_u), *up = axis_of(store, p->axis_up);
    out[0] = INFINITY;
    out[1] = -INFINITY;
    for (int pass = 0; pass < 2; pass++) {
        float shear = pass == 0 ? 0 : along_v ? p->shear_v : p->shear_u;
        taken = 0;
        for (size_t i = 0; i < store->count; i += step) {
            sample[taken++] = at[i] - shear * fmaxf(up[i] - p->floor_height, 0);
        }
        out[0] = fminf(out[0], mns_select(sample, taken, taken / STRAYS));
        out[1] = fmaxf(out[1], mns_select(sample, taken, taken - 1 - taken / STRAYS));
    }
    mns_memory_put(cpu->host.memory, sample, QUANTILE_SAMPLE + 1, sizeof(float));
    return true;
}

/* The exact reflectance of a flat surface of index n under light from an angle of the given cosine. */
static float reflectance(float cosine, float n)
{
    float g = sqrtf(n * n - 1 + cosine * cosine), a = (g - cosine) / (g + cosine);
    float b = (cosine * (g + cosine) - 1) / (cosine * (g - cosine) + 1);
    return 0.5f * a * a * (1 + b * b);
}

static bool reserve(struct backend *cpu, struct shadow *shadow, int sky_width, int sky_height, bool has_moments)
{
    struct memory *memory = cpu->host.memory;
    size_t texels = (size_t)shadow->width * (size_t)shadow->height;
    const size_t counts[] = {texels, (size_t)sky_width * (size_t)sky_height, texels, texels, texels};
    bool done = true;
    for (int i = 0; i < (has_moments ? 5 : 3); i++) {
        shadow->sums[i] = mns_memory_reserve(memory, shadow->sums[i], &shadow->sums_capacity[i], counts[i], sizeof(float));
        done = done && shadow->sums[i];
    }
    shadow->light = mns_memory_reserve(memory, shadow->light, &shadow->light_capacity, 4 * texels, sizeof(float));
    return done && shadow->light;
}

/* The table of what comes through so much fluid: for objects it is asked at every pixel. */
static void tabulate(struct shadow *shadow)
{
    shadow->thickest = 1e-20f;
    for (ptrdiff_t i = 0; i < (ptrdiff_t)shadow->width * shadow->height; i++) {
        shadow->thickest = fmaxf(shadow->thickest, shadow->sums[0][i]);
    }
    for (int step = 0; step < SHADOW_STEPS + 2; step++) {
        float along = shadow->thickest * (float)step / SHADOW_STEPS, passes = losses_of(shadow, along, 0).sun;
        for (int c = 0; c < 3; c++) {
            shadow->through[step][c] = expf(-shadow->key->absorption[c] * along) * passes;
        }
    }
}

/* Fills the map; *shadow->key says from what. */
static bool make(struct backend *cpu, const struct frame *frame, struct shadow *shadow)
{
    const struct scene_look *look = &frame->look;
    float sine = look->sun[look->axis_up], radius = frame->splat_radius;
    struct projection towards_sun = {
        look->axis_u, look->axis_v, look->axis_up, look->floor_height, look->sun[look->axis_u] / sine, look->sun[look->axis_v] / sine};
    float bounds_u[2], bounds_v[2];
    if (!span(cpu, &towards_sun, false, bounds_u) || !span(cpu, &towards_sun, true, bounds_v)) {
        return false;
    }
    float sky_sigma = fmaxf(SKY_SIGMA * frame->fluid_size, 2 * radius), margin = BLUR_CUT * sky_sigma + 2 * radius;
    float extent_u = bounds_u[1] - bounds_u[0] + 2 * margin, extent_v = bounds_v[1] - bounds_v[0] + 2 * margin;
    shadow->texel = fmaxf(radius / TEXELS_PER_RADIUS, fmaxf(extent_u, extent_v) / (SHADOW_SIZE - 2));
    shadow->min_u = bounds_u[0] - margin;
    shadow->min_v = bounds_v[0] - margin;
    shadow->width = (int)(extent_u / shadow->texel) + 2;
    shadow->height = (int)(extent_v / shadow->texel) + 2;
    int sky_width = (shadow->width - 1) / SKY_REDUCTION + 2, sky_height = (shadow->height - 1) / SKY_REDUCTION + 2;
    if (!reserve(cpu, shadow, sky_width, sky_height, shadow->key->has_moments)) {
        return false;
    }
    float per_area = 1 / (shadow->texel * shadow->texel);
    struct deposit deposit = {.particles = &cpu->stores[STORE_WATER],
                              .frame = frame,
                              .projection = towards_sun,
                              .sums = shadow->sums[0],
                              .width = shadow->width,
                              .height = shadow->height,
                              .min_u = shadow->min_u,
                              .min_v = shadow->min_v,
                              .per_metre = 1 / shadow->texel,
                              .per_volume = per_area / sine};
    for (; deposit.moment <= (shadow->key->has_moments ? 2 : 0); deposit.moment++) {
        deposit.sums = shadow->sums[deposit.moment ? 2 + deposit.moment : 0];
        gather(cpu, &deposit, fmaxf(SUN_SIGMA * radius / shadow->texel, 1), shadow->sums[2]);
    }
    deposit.moment = 0;
    deposit.projection.shear_u = deposit.projection.shear_v = 0;
    deposit.sums = shadow->sums[1];
    deposit.width = sky_width;
    deposit.height = sky_height;
    deposit.per_metre /= SKY_REDUCTION;
    deposit.per_volume = per_area / (SKY_REDUCTION * SKY_REDUCTION);
    gather(cpu, &deposit, sky_sigma / (shadow->texel * SKY_REDUCTION), shadow->sums[2]);

    float through = 1 - reflectance(sine, frame->params.refraction_index);
    shadow->sun_loss = 1 - (1 - SUN_ASTRAY) * through * through;
    if (shadow->key->has_moments) {
        tabulate(shadow);
    }
    struct compose compose = {shadow, sky_width, sky_height};
    cpu_run(cpu, compose_band, &compose, bands_of(shadow->height));
    return true;
}

mns_result mns_shadow_update(struct backend *cpu, const struct frame *frame, const float sun_light[3], const float sky_light[3])
{
    struct memory *memory = cpu->host.memory;
    struct shadow *shadow = cpu->scene.shadow;
    if (!shadow) {
        shadow = mns_memory_get(memory, 1, sizeof(*shadow));
        struct shadow_key *key = mns_memory_get(memory, 1, sizeof(*key));
        if (!shadow || !key) {
            mns_memory_put(memory, shadow, 1, sizeof(*shadow));
            mns_memory_put(memory, key, 1, sizeof(*key));
            return cpu_out_of_memory(cpu);
        }
        memset(key, 0, sizeof(*key));
        *shadow = (struct shadow){.key = key};
        cpu->scene.shadow = shadow;
    }
    struct shadow_key key = {.generation = cpu->generation,
                             .axis_up = frame->look.axis_up,
                             .floor_height = frame->look.floor_height,
                             .splat_radius = frame->splat_radius,
                             .volume = frame->volume,
                             .volume_per_mass = frame->volume_per_mass,
                             .volume_per_cube = frame->volume_per_cube,
                             .fluid_size = frame->fluid_size,
                             .refraction_index = frame->params.refraction_index,
                             .has_moments = frame->objects != NULL};
    memcpy(key.sun, frame->look.sun, sizeof(key.sun));
    const float *absorption = frame->absorption, mean = (absorption[0] + absorption[1] + absorption[2]) / 3;
    for (int c = 0; c < 3; c++) { /* of coloured particles the map does not tell which threw the shadow: grey */
        key.absorption[c] = frame->facts->has_color ? mean : mean + SHADOW_HUE * (absorption[c] - mean);
    }
    memcpy(key.sun_light, sun_light, sizeof(key.sun_light));
    memcpy(key.sky_light, sky_light, sizeof(key.sky_light));
    if (!memcmp(&key, shadow->key, sizeof(key))) {
        return MNS_OK;
    }
    double start = mns_clock_ms();
    *shadow->key = key;
    if (!make(cpu, frame, shadow)) {
        memset(shadow->key, 0, sizeof(*shadow->key));
        return cpu_out_of_memory(cpu);
    }
    cpu->stats.shadow_ms = mns_clock_ms() - start;
    return MNS_OK;
}

static float bilinear(const float *map, int width, int column, int row, float fu, float fv)
{
    const float *texel = map + (ptrdiff_t)row * width + column, *below = texel + width;
    float top = texel[0] + fu * (texel[1] - texel[0]), bottom = below[0] + fu * (below[1] - below[0]);
    return top + fv * (bottom - top);
}

void mns_shadow_at(const struct shadow *shadow, float u, float v, float height, float out[3])
{
    out[0] = out[1] = out[2] = 1;
    if (!(u >= 0) || !(v >= 0) || !(u < (float)(shadow->width - 1)) || !(v < (float)(shadow->height - 1))) {
        return;
    }
    const struct shadow_key *key = shadow->key;
    int column = (int)u, row = (int)v;
    float moments[3], radius = key->splat_radius;
    for (int i = 0; i < 3; i++) {
        moments[i] = bilinear(shadow->sums[i ? 2 + i : 0], shadow->width, column, row, u - (float)column, v - (float)row);
    }
    if (!(moments[0] > 0)) {
        return;
    }
    /* A slab of standard deviation s is s sqrt(12) high. One of a single particle is as high as that. */
    float mean = moments[1] / moments[0], variance = fmaxf(moments[2] / moments[0] - mean * mean, radius * radius / 3);
    float half = sqrtf(3 * variance), along = moments[0] * fmaxf(fminf((mean + half - height) / (2 * half), 1), 0);
    float step = fminf(along / shadow->thickest, 1) * SHADOW_STEPS, between = step - floorf(step);
    const float *through = shadow->through[(int)step], *next = shadow->through[(int)step + 1];
    for (int c = 0; c < 3; c++) {
        out[c] = through[c] + between * (next[c] - through[c]);
    }
}

void mns_shadow_sky(const struct shadow *shadow, float above, float out[3])
{
    const struct shadow_key *key = shadow->key;
    float passes = losses_of(shadow, 0, above).sky;
    for (int c = 0; c < 3; c++) {
        out[c] = key->sky_light[c] * expf(-key->absorption[c] * above) * passes;
    }
}

void mns_shadow_destroy(struct backend *cpu)
{
    struct memory *memory = cpu->host.memory;
    struct shadow *shadow = cpu->scene.shadow;
    if (!shadow) {
        return;
    }
    for (int i = 0; i < 5; i++) {
        mns_memory_put(memory, shadow->sums[i], shadow->sums_capacity[i], sizeof(float));
    }
    mns_memory_put(memory, shadow->light, shadow->light_capacity, sizeof(float));
    mns_memory_put(memory, shadow->key, 1, sizeof(*shadow->key));
    mns_memory_put(memory, shadow, 1, sizeof(*shadow));
    cpu->scene.shadow = NULL;
}
