/* params.c: the one table of parameters. Validation, command line, look files and docs/options.md are made from it. */
#include <meniscus/params.h>

#include "core/message.h"
#include "core/names.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const filters[] = {"none",
                                      "narrow-range",
                                      "narrow-range-1d",
                                      "narrow-range-1d-cleanup",
                                      "gaussian",
                                      "bilateral",
                                      "bilateral-1d",
                                      "curvature-flow",
                                      "adaptive-curvature-flow",
                                      "implicit-curvature-flow",
                                      "plane-fit",
                                      "smoothing-spline",
                                      NULL};
static const char *const displays[] = {"beauty", "opaque", "spheres", "normal", "depth", "thickness", "curvature", "color", NULL};
static const char *const thickness_modes[] = {"volume", "chord", NULL};
static const char *const thickness_scales[] = {"auto", "1", "2", "", "4", NULL}; /* index = value; "" is no choice */
static const char *const smooth_scales[] = {"", "1", "2", "", "4", NULL};
static const char *const fresnels[] = {"exact", "schlick", NULL};
static const char *const floor_patterns[] = {"checker", "tiles", "plain", NULL};
static const char *const backgrounds[] = {"sky", "color", "transparent", NULL};
static const char *const foams[] = {"none", "noise", "layered", NULL};
static const char *const tone_maps[] = {"none", "filmic", "reinhard", NULL};
static const char *const axes[] = {"x", "y", "z", NULL};

#define AT(field) .name = #field, .offset = offsetof(struct mns_params, field)
#define FLOAT(field, low, high, value)                                                                                                     \
    AT(field), .type = MNS_PARAM_FLOAT, .components = 1, .minimum = low, .maximum = high, .defaults = {value}
#define FLOAT3(field, low, high, a, b, c)                                                                                                  \
    AT(field), .type = MNS_PARAM_FLOAT, .components = 3, .minimum = low, .maximum = high, .defaults = {a, b, c}
#define INT(field, low, high, value) AT(field), .type = MNS_PARAM_INT, .components = 1, .minimum = low, .maximum = high, .defaults = {value}
#define BOOL(field, value)           AT(field), .type = MNS_PARAM_BOOL, .components = 1, .minimum = 0, .maximum = 1, .defaults = {value}
#define ENUM(field, list, value)                                                                                                           \
    AT(field), .type = MNS_PARAM_ENUM, .components = 1, .minimum = 0, .maximum = sizeof(list) / sizeof(*list) - 2, .choices = list,        \
               .defaults = {value}
#define AUTO .has_auto = 1

static const struct mns_param table[] = {
    {FLOAT(radius, 1e-12, 1e12, 0), AUTO, .unit = "m", .group = "particles",
     .help = "particle radius, half the rest spacing; auto: from the file, else estimated"},
    {FLOAT(radius_scale, 0.1, 10, 1.2), .unit = "", .group = "particles", .help = "splat radius R over particle radius"},
    {FLOAT(particle_volume, 1e-36, 1e36, 0), AUTO, .unit = "m^3", .group = "particles",
     .help = "rest volume of a particle; auto: mass / rest_density, else the estimated spacing cubed, else (2 radius)^3"},
    {FLOAT(rest_density, 1e-12, 1e12, 0), AUTO, .unit = "kg/m^3", .group = "particles",
     .help = "density of the fluid at rest, for particles with a mass; auto: unknown"},
    {FLOAT(fluid_size, 1e-12, 1e15, 0), AUTO, .unit = "m", .group = "particles",
     .help = "L, the cube root of the fluid's rest volume; auto: of the particles drawn"},

    {ENUM(thickness_mode, thickness_modes, MNS_THICKNESS_VOLUME), .unit = "", .group = "thickness",
     .help = "volume: a block 1 m deep is 1 m thick; chord: the papers' sum of chords, which grows with overlap"},
    {AT(thickness_scale), .type = MNS_PARAM_ENUM, .components = 1, .minimum = 0, .maximum = 4, .choices = thickness_scales, .defaults = {0},
     .unit = "px", .group = "thickness", .help = "pixels per thickness texel; auto: so that the error stays under 1 %"},
    {FLOAT(thickness_blur, 0, 20, 1.5), .unit = "r", .group = "thickness",
     .help = "sigma of the Gaussian that smooths thickness and colour; 0: off"},

    {ENUM(filter, filters, MNS_FILTER_SMOOTHING_SPLINE), .unit = "", .group = "smoothing", .help = "how the depth is smoothed"},
    {AT(smooth_scale), .type = MNS_PARAM_ENUM, .components = 1, .minimum = 1, .maximum = 4, .choices = smooth_scales, .defaults = {1},
     .unit = "px", .group = "smoothing",
     .help = "1, 2, 4: the depth is smoothed at full, half or quarter size; silhouettes stay those of the full size"},
    {INT(iterations, 1, 1000, 0), AUTO, .unit = "", .group = "smoothing",
     .help = "N times rows and columns, N passes of a 2-D filter, or N steps of a flow; auto: 3, of curvature-flow 100, of "
             "adaptive-curvature-flow at most 256, of implicit-curvature-flow and smoothing-spline 4"},
    {FLOAT(sigma, 0.01, 20, 0.9), .unit = "r", .group = "smoothing",
     .help = "sigma of the kernel in world space ([TY18] eq. 5); cut at 2 sigma, 0.9 has the standard deviation of an uncut 0.7"},
    {FLOAT(flow_sigma, 0.01, 20, 1.2), .unit = "r", .group = "smoothing",
     .help = "standard deviation of all that adaptive-curvature-flow and implicit-curvature-flow smooth, at every distance"},
    {FLOAT(spline_sigma, 0.01, 20, 1.3), .unit = "r", .group = "smoothing",
     .help = "width of smoothing-spline: a wave of length 2 pi sigma keeps half its height, one twice as long 16/17"},
    {FLOAT(flow_step, 0.01, 0.5, 0.5), .unit = "", .group = "smoothing",
     .help = "step of curvature-flow and adaptive-curvature-flow; 0.5: the largest that is stable at the depth of the fluid's middle"},
    {FLOAT(delta, 0.1, 1000, 10), .unit = "r", .group = "smoothing", .help = "depth range that is smoothed together ([TY18] eq. 2 and 6)"},
    {FLOAT(mu, 0, 1000, 1), .unit = "r", .group = "smoothing",
     .help = "how far behind a pixel what lies beyond delta counts, which rounds the rim ([TY18] eq. 2); at most delta"},
    {FLOAT(kernel_cut, 1, 4, 2), .unit = "sigma", .group = "smoothing", .help = "where the kernel ends"},
    {BOOL(bias_correction, 1), .unit = "", .group = "smoothing", .help = "drop a sample with its mirror ([TY18] eq. 6)"},
    {BOOL(dynamic_range, 1), .unit = "", .group = "smoothing", .help = "let the range follow a slanted surface ([TY18] eq. 7 to 9)"},
    {FLOAT(edge_threshold, 0.1, 1000, 10), .unit = "r", .group = "smoothing", .help = "neighbours whose depths differ by more are apart"},

    {BOOL(anisotropy, 0), .unit = "", .group = "anisotropy",
     .help = "ellipsoids that follow the surface in place of spheres (Yu and Turk 2013); docs/filters.md tells where it wins"},
    {FLOAT(anisotropy_reach, 1, 20, 4), .unit = "r", .group = "anisotropy",
     .help = "how far neighbours count; 4 are 2.4 spacings"},
    {FLOAT(anisotropy_ratio, 1, 16, 4), .unit = "", .group = "anisotropy", .help = "of the longest to the shortest semi-axis, at most"},
    {FLOAT(anisotropy_smoothing, 0, 1, 0.5), .unit = "", .group = "anisotropy",
     .help = "0: centres stay; 1: they move to the mean of their neighbours"},
    {FLOAT(anisotropy_neighbors, 0.01, 0.5, 0.05), .unit = "", .group = "anisotropy",
     .help = "part of a full neighbourhood with which a particle is on its own; from twice that on it is not"},
    {FLOAT(anisotropy_isolated, 0.1, 1, 0.75), .unit = "r", .group = "anisotropy", .help = "radius of a particle on its own"},

    {ENUM(display, displays, MNS_DISPLAY_BEAUTY), .unit = "", .group = "water", .help = "what the picture shows"},
    {FLOAT3(absorption, 0, 1e12, -1, -1, -1), AUTO, .unit = "1/m", .group = "water",
     .help = "absorption per channel; auto: absorption_relative / L"},
    {FLOAT3(absorption_relative, 0, 1e6, 2.2, 0.66, 0.3), .unit = "1/L", .group = "water",
     .help = "absorption per channel where absorption is auto"},
    {FLOAT3(fluid_color, 0, 100, 0.006, 0.055, 0.085), .unit = "", .group = "water",
     .help = "linear colour that deep fluid scatters back, times the sky's light"},
    {FLOAT(refraction_index, 1, 4, 1.333), .unit = "", .group = "water", .help = "refractive index of the fluid"},
    {FLOAT(refraction_strength, 0, 10, 1), .unit = "", .group = "water",
     .help = "how far the refracted ray goes before it leaves, in thicknesses of a slab across the surface; 0: straight through"},
    {ENUM(fresnel, fresnels, MNS_FRESNEL_EXACT), .unit = "", .group = "water", .help = "how the reflected part is computed"},
    {FLOAT(reflection, 0, 10, 1), .unit = "", .group = "water", .help = "scales the reflection"},
    {FLOAT(specular, 0, 100, 1), .unit = "", .group = "water", .help = "scales the sun's highlight"},
    {FLOAT(shininess, 1, 1e5, 2000), .unit = "", .group = "water", .help = "exponent of the sun's highlight ([LGS09] eq. 13)"},
    {FLOAT3(opaque_color, 0, 1, 0.05, 0.25, 0.6), .unit = "", .group = "water",
     .help = "linear colour of the surface in display opaque and spheres"},

    {ENUM(background, backgrounds, MNS_BACKGROUND_SKY), .unit = "", .group = "scene", .help = "what stands behind the fluid"},
    {FLOAT3(background_color, 0, 100, 0.6, 0.66, 0.75), .unit = "", .group = "scene", .help = "linear colour of background color"},
    {ENUM(up_axis, axes, MNS_AXIS_Y), .unit = "", .group = "scene", .help = "the world axis that points up"},
    {BOOL(floor, 1), .unit = "", .group = "scene", .help = "draw a floor"},
    {FLOAT(floor_height, -1e15, 1e15, -INFINITY), AUTO, .unit = "m", .group = "scene",
     .help = "coordinate of the floor along the up axis; auto: under the lowest particle"},
    {FLOAT(floor_cell, 1e-12, 1e15, 0), AUTO, .unit = "m", .group = "scene", .help = "size of a cell of the floor's checker; auto: from L"},
    {FLOAT3(floor_light, 0, 1, 0.43, 0.40, 0.355), .unit = "", .group = "scene", .help = "linear colour of the bright cells"},
    {FLOAT3(floor_dark, 0, 1, 0.31, 0.29, 0.26), .unit = "", .group = "scene", .help = "linear colour of the dark cells"},
    {ENUM(floor_pattern, floor_patterns, MNS_FLOOR_CHECKER), .unit = "", .group = "scene",
     .help = "checker, tiles of floor_light with joints of floor_dark, or plain floor_light"},
    {BOOL(shadow, 1), .unit = "", .group = "scene", .help = "the fluid's shadow on the floor"},
    {FLOAT(sun_azimuth, -360, 360, 145), .unit = "deg", .group = "scene", .help = "where the sun stands about the up axis"},
    {FLOAT(sun_elevation, 1, 90, 48), .unit = "deg", .group = "scene", .help = "height of the sun above the horizon"},
    {FLOAT(sun_intensity, 0, 100, 1), .unit = "", .group = "scene", .help = "scales the sun's light"},
    {FLOAT(environment_rotation, -360, 360, 0), .unit = "deg", .group = "scene", .help = "turns the environment about the up axis"},
    {FLOAT(environment_intensity, 0, 1000, 1), .unit = "", .group = "scene", .help = "scales the environment's light"},
    {FLOAT(exposure, -20, 20, 0), .unit = "EV", .group = "scene", .help = "the picture's light times 2^exposure"},
    {FLOAT(motion_time, 0, 1e12, 1.0 / 24), .unit = "s", .group = "scene", .help = "the time in which the layer motion moves: one frame's"},
    {ENUM(tone_map, tone_maps, MNS_TONE_MAP_NONE), .unit = "", .group = "scene",
     .help = "how light beyond white becomes a colour, in 8- and 16-bit pictures; float32 stays linear"},
    {BOOL(antialias, 0), .unit = "", .group = "scene", .help = "blend silhouettes of the fluid in shaded colour"},

    {ENUM(foam, foams, MNS_FOAM_NONE), .unit = "", .group = "foam",
     .help = "noise: a moving pattern of small waves and grey foam ([LGS09] 3.4); layered: foam before, in and behind the water ([BSW10])"},
    {FLOAT(gravity, 1e-9, 1e9, 9.81), .unit = "m/s^2", .group = "foam",
     .help = "of the scene, in its own unit of length; V = sqrt(gravity L) is the fluid's own speed, V / gravity its own time"},
    {FLOAT(surface_tension, 1e-12, 1e12, 0), AUTO, .unit = "N/m", .group = "foam",
     .help = "sigma of the Weber number ([BSW10] eq. 5); auto: such that it is 1 at the speed V, whatever the size of scene and particles"},
    {FLOAT(foam_weber_low, 0, 1e12, 0.6), .unit = "", .group = "foam", .help = "Weber number from which on there is some foam"},
    {FLOAT(foam_weber_high, 0, 1e12, 1.5), .unit = "", .group = "foam",
     .help = "Weber number from which on a particle is foam and no water; at least foam_weber_low"},
    {FLOAT(foam_air, 0, 1, 0.1), .unit = "", .group = "foam",
     .help =
         "part of a particle's surroundings that must be air (by its density) for it to foam in full, a fifth for it to foam at all; 0: "
         "anywhere, as in [BSW10]"},
    {FLOAT(foam_lifetime, 0, 1e9, -1), AUTO, .unit = "s", .group = "foam",
     .help = "how long foam lasts after its cause, its fading included; auto: 3 V / gravity, times foam_persistence"},
    {FLOAT(foam_persistence, 0.001, 1000, 1), .unit = "", .group = "foam",
     .help = "factor on foam_lifetime, foam_fade_out and noise_cooldown where they are auto"},
    {FLOAT(foam_fade_in, 0, 1e9, -1), AUTO, .unit = "s", .group = "foam",
     .help = "in which foam grows from a point; auto: V / gravity / 2"},
    {FLOAT(foam_fade_out, 0, 1e9, -1), AUTO, .unit = "s", .group = "foam",
     .help = "in which foam shrinks at the end of its life; auto: 1.5 V / gravity, times foam_persistence"},
    {FLOAT(spray_low, 0, 10, 0.3), .unit = "", .group = "foam",
     .help = "density, over that of the fluid at rest, up to which a particle is spray and no water; one alone has about 0.25"},
    {FLOAT(spray_high, 0, 10, 0.5), .unit = "", .group = "foam",
     .help = "the same from which on it is no spray; a sheet of one layer has about 0.55; at least spray_low"},
    {FLOAT(noise_tau, 0, 1e9, -1), AUTO, .unit = "m/s", .group = "foam",
     .help =
         "change of velocity from frame to frame that makes a particle noisy ([LGS09] eq. 12); auto: 0.15 V and what a free fall gains"},
    {FLOAT(noise_cooldown, 0, 1e9, -1), AUTO, .unit = "s", .group = "foam",
     .help = "until such noise is gone; auto: 2 V / gravity, times foam_persistence"},
    {FLOAT(noise_calm, 0, 1, 0.3), .unit = "", .group = "foam",
     .help = "noise without such a change, of particles with the Weber number foam_weber_low or more; less where they are slower"},

    {FLOAT(foam_radius, 0.05, 10, 1.4), .unit = "r", .group = "foam",
     .help = "layered: splat radius of a foam particle full-grown; its volume is that of its water"},
    {FLOAT(foam_extinction, 0, 1000, 0.6), .unit = "1/r", .group = "foam",
     .help = "layered: how fast foam hides what is behind it ([BSW10] eq. 8)"},
    {FLOAT(foam_range, 0, 1000, 6), .unit = "r", .group = "foam",
     .help = "layered: delta_foam, how far behind its first sphere foam counts as front foam ([BSW10] 5.3)"},
    {FLOAT(foam_range_extinction, 0, 1000, 0.6), .unit = "1/r", .group = "foam",
     .help = "layered: how fast the thickness of front foam turns the back colour into the front colour"},
    {FLOAT3(foam_front_color, 0, 1, 0.58, 0.6, 0.61), .unit = "", .group = "foam",
     .help = "layered: linear colour of thick front foam in white light, c_ff of [BSW10]"},
    {FLOAT3(foam_back_color, 0, 1, 0.3, 0.35, 0.38), .unit = "", .group = "foam",
     .help = "layered: linear colour of thin front foam, c_fb"},
    {FLOAT(foam_detail, 0, 10, 1.5), .unit = "", .group = "foam",
     .help = "layered: strength of the noise on the foam's thickness, which varies with its age; 0: smooth spheres"},

    {FLOAT(noise_height, 0, 10, 0.12), .unit = "r", .group = "noise",
     .help = "height of the waves that foam noise makes of the surface, where the noise is 1"},
    {FLOAT(noise_scale, 0.05, 20, 1), .unit = "r", .group = "noise", .help = "size of the cells of the coarsest octave"},
    {FLOAT(noise_radius, 1.1, 10, 2), .unit = "r", .group = "noise",
     .help = "radius of a particle's splat ([LGS09] eq. 10); particles that deep below the surface add nothing"},
    {INT(noise_octaves, 1, 6, 3), .unit = "", .group = "noise", .help = "octaves of Perlin's noise, each with cells of half the size"},
    {FLOAT(noise_gain, 0, 1, 0.5), .unit = "", .group = "noise",
     .help = "amplitude of an octave over that of the one before ([P430] eq. 14)"},
    {FLOAT(noise_foam, 0, 100, 1), .unit = "", .group = "noise", .help = "how much of the grey foam there is where the noise is 1"},
    {FLOAT(noise_threshold, 0, 10, 0.12), .unit = "", .group = "noise", .help = "noise from which on there is grey foam"},
    {FLOAT3(noise_color, 0, 1, 0.6, 0.63, 0.65), .unit = "", .group = "noise", .help = "linear colour of the grey foam in white light"},

    {FLOAT(spray_radius, 0.01, 10, 0.5), .unit = "r", .group = "spray", .help = "radius of a soft drop of spray ([LGS09] 3.1)"},
    {FLOAT(spray_depth, 0, 100, 1.2), .unit = "", .group = "spray", .help = "optical depth in the middle of a drop whose opacity is 1"},
    {FLOAT(spray_shutter, 0, 1e9, 0.008), .unit = "s", .group = "spray",
     .help = "how long a drop moves while it is seen, which stretches it; half of 1/60: a film's shutter"},
    {FLOAT3(spray_color, 0, 1, 0.85, 0.88, 0.9), .unit = "", .group = "spray", .help = "linear colour of spray in white light"},
};

enum { ROWS = sizeof(table) / sizeof(table[0]) };

size_t mns_param_count(void) { return ROWS; }

const struct mns_param *mns_param_info(size_t index) { return index < ROWS ? &table[index] : NULL; }

const struct mns_param *mns_param_find(const char *name)
{
    for (size_t i = 0; i < ROWS; i++) {
        if (!strcmp(table[i].name, name)) {
            return &table[i];
        }
    }
    return NULL;
}

static const float *floats_of(const struct mns_params *params, const struct mns_param *row)
{
    return (const float *)(const void *)((const char *)params + row->offset);
}

static int int_of(const struct mns_params *params, const struct mns_param *row)
{
    return *(const int *)(const void *)((const char *)params + row->offset);
}

static void store(struct mns_params *params, const struct mns_param *row, const double values[3])
{
    void *field = (char *)params + row->offset;
    if (row->type == MNS_PARAM_FLOAT) {
        for (int i = 0; i < row->components; i++) {
            ((float *)field)[i] = (float)values[i];
        }
    } else {
        *(int *)field = (int)values[0];
    }
}

void mns_params_init_sized(struct mns_params *params, size_t size)
{
    struct mns_params defaults;
    memset(&defaults, 0, sizeof(defaults));
    for (size_t i = 0; i < ROWS; i++) {
        store(&defaults, &table[i], table[i].defaults);
    }
    memset(params, 0, size);
    memcpy(params, &defaults, size < sizeof(defaults) ? size : sizeof(defaults));
    params->struct_size = size;
}

static mns_result fail_name(struct mns_message *message, const char *name)
{
    const struct mns_param *nearest = NULL;
    int best = 0;
    for (size_t i = 0; i < ROWS; i++) {
        int edits = mns_name_distance(name, table[i].name);
        if (!nearest || edits < best) {
            best = edits;
            nearest = &table[i];
        }
    }
    return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "there is no parameter '%s'; did you mean '%s'?", name, nearest->name);
}

static mns_result fail_choice(struct mns_message *message, const struct mns_param *row, const char *value)
{
    char list[256];
    size_t used = 0;
    list[0] = '\0';
    for (int i = 0; row->choices[i]; i++) {
        if (*row->choices[i] && used < sizeof(list)) {
            int written = snprintf(list + used, sizeof(list) - used, "%s%s", used ? ", " : "", row->choices[i]);
            used += written > 0 ? (size_t)written : 0;
        }
    }
    return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "%s is '%s'; it must be one of %s", row->name, value, list);
}

static mns_result fail_range(struct mns_message *message, const struct mns_param *row, const char *value)
{
    const char *space = *row->unit ? " " : "";
    return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "%s is %s; it must be %s%s from %g to %g%s%s%s", row->name, value,
                    row->components == 3         ? "three numbers R,G,B"
                    : row->type == MNS_PARAM_INT ? "a whole number"
                                                 : "a number",
                    row->components == 3 ? " each" : "", row->minimum, row->maximum, space, row->unit, row->has_auto ? ", or auto" : "");
}

/* sRGB code, 0 to 1, to linear. */
static double linear_from_srgb(double code) { return code <= 0.04045 ? code / 12.92 : pow((code + 0.055) / 1.055, 2.4); }

static bool parse_hex_color(const char *text, double out[3])
{
    if (*text == '#') {
        text++;
    }
    if (strlen(text) != 6 || strspn(text, "0123456789abcdefABCDEF") != 6) {
        return false;
    }
    unsigned long code = strtoul(text, NULL, 16);
    for (int i = 0; i < 3; i++) {
        out[i] = linear_from_srgb((double)(code >> (16 - 8 * i) & 255) / 255);
    }
    return true;
}

/* The C library writes and reads numbers by the program's locale; parameters have a point whatever that says. */
struct decimal_point {
    char text[8];
    size_t length;
};

static struct decimal_point decimal_point(void)
{
    struct decimal_point point = {".", 1};
    char half[16];
    int written = snprintf(half, sizeof(half), "%.1f", 0.5);
    if (written > 2 && (size_t)written - 2 < sizeof(point.text)) { /* what stands between 0 and 5 */
        point.length = (size_t)written - 2;
        memcpy(point.text, half + 1, point.length);
        point.text[point.length] = '\0';
    }
    return point;
}

/* A number at the beginning of text, in *out. Returns what follows it; NULL: none. */
static const char *parse_number(const char *text, double *out)
{
    struct decimal_point point = decimal_point();
    char copy[64], *end;
    size_t used = 0;
    text += strspn(text, " ");
    size_t length = strspn(text, "+-.0123456789abcdefinptxyABCDEFINPTXY");
    if (length == 0 || length + sizeof(point.text) >= sizeof(copy)) {
        return NULL;
    }
    bool has_point = false;
    for (size_t i = 0; i < length; i++) {
        if (text[i] == '.' && !has_point) {
            memcpy(copy + used, point.text, point.length);
            used += point.length;
            has_point = true;
        } else {
            copy[used++] = text[i];
        }
    }
    copy[used] = '\0';
    *out = strtod(copy, &end);
    return end == copy + used ? text + length : NULL;
}

/* One number for each component, commas between; false: anything else. */
static bool parse_numbers(const char *text, int count, double out[3])
{
    for (int i = 0; i < count; i++) {
        text = parse_number(text, &out[i]);
        if (!text || *text != (i + 1 < count ? ',' : '\0')) {
            return false;
        }
        text++;
    }
    return true;
}

static bool in_range(const struct mns_param *row, double value) { return value >= row->minimum && value <= row->maximum; }

mns_result mns_params_set(struct mns_params *params, const char *name, const char *value, struct mns_message *message)
{
    const struct mns_param *row = mns_param_find(name);
    if (!row) {
        return fail_name(message, name);
    }
    double values[3] = {0};
    if (row->has_auto && !strcmp(value, "auto")) {
        memcpy(values, row->defaults, sizeof(values));
    } else if (row->type == MNS_PARAM_ENUM) {
        int choice = 0;
        while (row->choices[choice] && (!*value || strcmp(row->choices[choice], value))) {
            choice++;
        }
        if (!row->choices[choice]) {
            return fail_choice(message, row, value);
        }
        values[0] = choice;
    } else if (row->type == MNS_PARAM_BOOL) {
        bool on = !strcmp(value, "on") || !strcmp(value, "1") || !strcmp(value, "true");
        if (!on && strcmp(value, "off") && strcmp(value, "0") && strcmp(value, "false")) {
            return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "%s is '%s'; it must be on or off", row->name, value);
        }
        values[0] = on;
    } else {
        if (!(row->components == 3 && parse_hex_color(value, values)) && !parse_numbers(value, row->components, values)) {
            return fail_range(message, row, *value ? value : "empty");
        }
        for (int i = 0; i < row->components; i++) {
            if (!in_range(row, values[i]) || (row->type == MNS_PARAM_INT && values[i] != floor(values[i]))) {
                return fail_range(message, row, value);
            }
        }
    }
    store(params, row, values);
    return MNS_OK;
}

/* Whether a row's value is the table's auto. */
static bool is_auto(const struct mns_params *params, const struct mns_param *row)
{
    bool is_default =
        row->type == MNS_PARAM_FLOAT ? floats_of(params, row)[0] == (float)row->defaults[0] : int_of(params, row) == (int)row->defaults[0];
    return row->has_auto && is_default;
}

/* The shortest decimal that reads back as the same float. text: [32] */
static const char *shortest(float value, char *text)
{
    int digits = 6;
    do {
        snprintf(text, 32, "%.*g", digits, (double)value);
    } while (digits++ < 9 && strtof(text, NULL) != value);
    struct decimal_point point = decimal_point();
    char *at = strstr(text, point.text);
    if (at) {
        *at = '.';
        memmove(at + 1, at + point.length, strlen(at + point.length) + 1);
    }
    return text;
}

int mns_params_get(const struct mns_params *params, const char *name, char *text, size_t size)
{
    const struct mns_param *row = mns_param_find(name);
    if (!row) {
        return -1;
    }
    if (is_auto(params, row)) {
        return snprintf(text, size, "auto");
    }
    if (row->type == MNS_PARAM_FLOAT) {
        const float *v = floats_of(params, row);
        char a[32], b[32], c[32];
        return row->components == 3 ? snprintf(text, size, "%s,%s,%s", shortest(v[0], a), shortest(v[1], b), shortest(v[2], c))
                                    : snprintf(text, size, "%s", shortest(v[0], a));
    }
    int v = int_of(params, row);
    if (row->type == MNS_PARAM_BOOL) {
        return snprintf(text, size, "%s", v ? "on" : "off");
    }
    if (row->type == MNS_PARAM_ENUM && v >= 0 && v <= (int)row->maximum) {
        return snprintf(text, size, "%s", row->choices[v]);
    }
    return snprintf(text, size, "%d", v);
}

mns_result mns_params_check(const struct mns_params *params, struct mns_message *message)
{
    for (size_t i = 0; i < ROWS; i++) {
        const struct mns_param *row = &table[i];
        char text[96];
        mns_params_get(params, row->name, text, sizeof(text));
        if (is_auto(params, row)) {
            continue;
        }
        if (row->type == MNS_PARAM_FLOAT) {
            const float *v = floats_of(params, row);
            for (int k = 0; k < row->components; k++) {
                /* the bounds as floats: 0.1 must be allowed where the table says 0.1 */
                if (!(v[k] >= (float)row->minimum && v[k] <= (float)row->maximum)) {
                    return fail_range(message, row, text);
                }
            }
        } else {
            int v = int_of(params, row);
            bool allowed = v >= (int)row->minimum && v <= (int)row->maximum;
            if (row->type == MNS_PARAM_ENUM && (!allowed || !*row->choices[v])) {
                return fail_choice(message, row, text);
            }
            if (!allowed) {
                return fail_range(message, row, text);
            }
        }
    }
    if (params->mu > params->delta) {
        return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "mu is %g and delta %g; mu must be at most delta", (double)params->mu,
                        (double)params->delta);
    }
    if (params->foam_weber_low > params->foam_weber_high) {
        return mns_fail(message, MNS_ERR_INVALID_ARGUMENT,
                        "foam_weber_low is %g and foam_weber_high %g; the low one must be at most the high one",
                        (double)params->foam_weber_low, (double)params->foam_weber_high);
    }
    if (params->spray_low > params->spray_high) {
        return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "spray_low is %g and spray_high %g; the low one must be at most the high one",
                        (double)params->spray_low, (double)params->spray_high);
    }
    return MNS_OK;
}
