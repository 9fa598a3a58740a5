/* meniscus/params.h: every parameter of a picture, as a plain struct and as a table.
 *
 * The table (mns_param_info) holds name, range, default, unit and help of each; docs/options.md is made from it.
 * Lengths marked r are multiples of R = radius * radius_scale, lengths marked L multiples of the fluid's own size
 * L = (rest volume of all particles)^(1/3): a scene that is 100 times larger needs no other values. */
#ifndef MENISCUS_PARAMS_H
#define MENISCUS_PARAMS_H

#include <meniscus/common.h>

#ifdef __cplusplus
extern "C" {
#endif

enum mns_filter {
    MNS_FILTER_NONE = 0,
    MNS_FILTER_NARROW_RANGE = 1,            /* [TY18] 2-D */
    MNS_FILTER_NARROW_RANGE_1D = 2,         /* [TY18] rows and columns in turn */
    MNS_FILTER_NARROW_RANGE_1D_CLEANUP = 3, /* the same, then one 5x5 pass */
    MNS_FILTER_GAUSSIAN = 4,                /* rows and columns in turn, across edges too */
    MNS_FILTER_BILATERAL = 5,               /* 2-D */
    MNS_FILTER_BILATERAL_1D = 6,            /* [LGS09] table 2: rows and columns in turn */
    MNS_FILTER_CURVATURE_FLOW = 7,          /* [LGS09] 3.2 */
    MNS_FILTER_ADAPTIVE_CURVATURE_FLOW = 8, /* [BSW10] 4 */
    MNS_FILTER_IMPLICIT_CURVATURE_FLOW = 9, /* semi-implicit, in few steps */
    MNS_FILTER_PLANE_FIT = 10,              /* Imai and others 2016, as compared in [TY18] */
    MNS_FILTER_SMOOTHING_SPLINE = 11        /* cubic smoothing splines in inverse depth, along rows and columns */
};

enum mns_display {
    MNS_DISPLAY_BEAUTY = 0,    /* the fluid */
    MNS_DISPLAY_OPAQUE = 1,    /* a lit opaque surface */
    MNS_DISPLAY_SPHERES = 2,   /* the splats, unsmoothed, lit */
    MNS_DISPLAY_NORMAL = 3,    /* view-space normal as 0.5 n + 0.5 */
    MNS_DISPLAY_DEPTH = 4,     /* near white, far dark, over the picture's own range */
    MNS_DISPLAY_THICKNESS = 5, /* dark none, bright thick, over the picture's own range */
    MNS_DISPLAY_CURVATURE = 6, /* [LGS09] fig. 8: green positive, red negative */
    MNS_DISPLAY_COLOR = 7      /* the particles' colours as they are, darker where the surface turns away: to be compared with a legend */
};

enum mns_thickness_mode {
    MNS_THICKNESS_VOLUME = 0, /* chord * V / (4/3 pi R^3): a block 1 m deep is 1 m thick */
    MNS_THICKNESS_CHORD = 1   /* [LGS09] eq. 9: the sum of chords, which grows with overlap */
};

enum mns_fresnel { MNS_FRESNEL_EXACT = 0, MNS_FRESNEL_SCHLICK = 1 };

enum mns_background {
    MNS_BACKGROUND_SKY = 0,        /* a procedural sky */
    MNS_BACKGROUND_COLOR = 1,      /* background_color */
    MNS_BACKGROUND_TRANSPARENT = 2 /* nothing: RGBA with alpha = 1 - mean transmittance */
};

enum mns_foam {
    MNS_FOAM_NONE = 0,
    MNS_FOAM_NOISE = 1,  /* [LGS09] 3.4: noise on the surface, and grey foam where it is large */
    MNS_FOAM_LAYERED = 2 /* [BSW10] 5: foam before, in and behind the water */
};

enum mns_tone_map {
    MNS_TONE_MAP_NONE = 0,    /* what is above 1 is clipped */
    MNS_TONE_MAP_FILMIC = 1,  /* a film's curve: more contrast, and light that fades to white */
    MNS_TONE_MAP_REINHARD = 2 /* Reinhard and others 2002, eq. 4, per channel; 4 becomes white */
};

enum mns_floor_pattern {
    MNS_FLOOR_CHECKER = 0,
    MNS_FLOOR_TILES = 1, /* floor_light, with joints of floor_dark */
    MNS_FLOOR_PLAIN = 2  /* floor_light */
};

enum mns_axis { MNS_AXIS_X = 0, MNS_AXIS_Y = 1, MNS_AXIS_Z = 2 };

/* All parameters. Plain values: copy freely. The table tells each one's range, default and meaning at length. */
struct mns_params {
    size_t struct_size; /* set by mns_params_init */

    /* Particles. */
    float radius;          /* metres; 0 (auto): the particles' own, else estimated */
    float radius_scale;    /* splat radius R over particle radius */
    float particle_volume; /* m^3; 0 (auto): mass / rest_density, else estimated spacing^3, else (2 radius)^3 */
    float rest_density;    /* kg/m^3; 0 (auto): unknown */
    float fluid_size;      /* L, metres; 0 (auto): from this particle set */

    /* Thickness. */
    int thickness_mode;   /* enum mns_thickness_mode */
    int thickness_scale;  /* 1, 2 or 4: pixels per thickness texel; 0 (auto): by the splats' size in pixels */
    float thickness_blur; /* r: sigma of the Gaussian that smooths thickness and colour; 0: off */

    /* Smoothing. */
    int filter;           /* enum mns_filter */
    int smooth_scale;     /* 1, 2 or 4: pixels per texel along each axis in which the depth is smoothed ([LGS09] 3.5.1) */
    int iterations;       /* N: N times rows + columns, N 2-D passes, or N steps of a flow; 0 (auto): by the filter */
    float sigma;          /* r: [TY18] eq. 5 */
    float flow_sigma;     /* r: standard deviation of all that adaptive and implicit flow smooth, at every distance */
    float spline_sigma;   /* r: a wave of length 2 pi spline_sigma keeps half its height */
    float flow_step;      /* step of the explicit flows; 0.5: the largest that is stable at the fluid's middle */
    float delta;          /* r: [TY18] eq. 2, 6 */
    float mu;             /* r: [TY18] eq. 2; at most delta */
    float kernel_cut;     /* sigmas at which the kernel ends, its weight there subtracted */
    int bias_correction;  /* 0 or 1: [TY18] eq. 6 */
    int dynamic_range;    /* 0 or 1: [TY18] eq. 7-9 */
    float edge_threshold; /* r: neighbours whose depths differ by more are apart, for normals */

    /* Anisotropy (meniscus/anisotropy.h). */
    int anisotropy;             /* 0 or 1: whether programs use it; the renderer draws what shapes particles bring */
    float anisotropy_reach;     /* r: how far neighbours count */
    float anisotropy_ratio;     /* of the longest to the shortest semi-axis, at most */
    float anisotropy_smoothing; /* lambda: 0, centres stay; 1, they move to the mean of their neighbours */
    float anisotropy_neighbors; /* part of a full neighbourhood with which a particle is on its own; from twice that on it is not */
    float anisotropy_isolated;  /* r: radius of a particle on its own */

    /* Water. */
    int display;                  /* enum mns_display */
    float absorption[3];          /* 1/metre per channel; -1 (auto): absorption_relative / L */
    float absorption_relative[3]; /* 1/L per channel */
    float fluid_color[3];         /* linear RGB of light scattered back by deep fluid, times the sky's light */
    float refraction_index;       /* of the fluid */
    float refraction_strength;    /* 1: the refracted ray crosses the full thickness; 0: straight through */
    int fresnel;                  /* enum mns_fresnel */
    float reflection;             /* scales the reflection; 1: physical */
    float specular;               /* scales the sun's highlight; 1: physical for the sun's size below */
    float shininess;              /* exponent of the highlight ([LGS09] eq. 13) */
    float opaque_color[3];        /* linear RGB of the surface in display opaque and spheres */

    /* Scene drawn by us, when the caller gives none. */
    int background;              /* enum mns_background */
    float background_color[3];   /* linear RGB */
    int up_axis;                 /* enum mns_axis */
    int floor;                   /* 0 or 1 */
    float floor_height;          /* coordinate along up_axis, metres; -inf (auto): under the lowest particle */
    float floor_cell;            /* metres per checker cell; 0 (auto): from L */
    float floor_light[3];        /* linear RGB of the bright cells */
    float floor_dark[3];         /* linear RGB of the dark cells */
    int floor_pattern;           /* enum mns_floor_pattern */
    int shadow;                  /* 0 or 1: the fluid's own shadow on the floor */
    float sun_azimuth;           /* degrees about the up axis */
    float sun_elevation;         /* degrees above the horizon */
    float sun_intensity;         /* times the default sun */
    float environment_rotation;  /* degrees about the up axis */
    float environment_intensity; /* times the environment's light */
    float exposure;              /* EV: the picture times 2^exposure */
    float motion_time;           /* s: what layer motion shows the way of */
    int tone_map;                /* enum mns_tone_map: of 8- and 16-bit pictures; float32 stays linear */
    int antialias;               /* 0 or 1: silhouettes are blended in shaded colour, never in depth or normals */

    /* Foam. */
    int foam; /* enum mns_foam */

    /* Which particles are foam, spray or noisy (meniscus/classify.h). V = sqrt(gravity L) and V / gravity are the fluid's own speed and time. */
    float gravity;          /* m/s^2 */
    float surface_tension;  /* N/m: sigma of [BSW10] eq. 5; 0 (auto): such that We = 1 at the speed V */
    float foam_weber_low;   /* We from which on there is some foam */
    float foam_weber_high;  /* We from which on a particle is foam alone */
    float foam_air;         /* part of a particle's surroundings that must be air for it to foam in full; 0: foam anywhere */
    float foam_lifetime;    /* s that foam lasts after its cause, its fading included; -1 (auto): by L and gravity */
    float foam_persistence; /* factor on foam_lifetime, foam_fade_out and noise_cooldown where they are auto */
    float foam_fade_in;     /* s in which it grows from a point; -1 (auto) */
    float foam_fade_out;    /* s in which it shrinks at the end; -1 (auto) */
    float spray_low;        /* density over that of the fluid at rest up to which a particle is spray alone */
    float spray_high;       /* the same, from which on it is no spray */
    float noise_tau;        /* m/s: change of velocity between frames that makes noise, [LGS09] eq. 12; -1 (auto) */
    float noise_cooldown;   /* s until that noise is gone; -1 (auto) */
    float noise_calm;       /* noise of particles as fast as foam_weber_low says, with no such change */

    /* Layered foam: [BSW10] 5.2 and 5.3. */
    float foam_radius;           /* r: splat radius of foam full-grown; its volume is that of the particle's water */
    float foam_extinction;       /* 1/r: how fast T_f hides what is behind */
    float foam_range;            /* r: delta_foam, behind the foam's depth: what T_ff is gathered in */
    float foam_range_extinction; /* 1/r: how fast T_ff turns the colour of back foam into that of front foam */
    float foam_front_color[3];   /* linear RGB albedo of thick front foam: c_ff */
    float foam_back_color[3];    /* of thin front foam: c_fb */
    float foam_detail;           /* strength of the noise on the foam's thickness; 0: smooth spheres */

    /* Noise, where foam is noise: [LGS09] 3.4, [P430] eq. 14 to 16. */
    float noise_height;    /* r: height of the waves that it makes of the surface, where noise is 1 */
    float noise_scale;     /* r: size of the cells of the coarsest octave */
    float noise_radius;    /* r: radius of a particle's splat; what is as deep below the surface adds nothing */
    int noise_octaves;     /* of Perlin's noise, each with cells of half the size */
    float noise_gain;      /* amplitude of an octave over that of the one before: alpha of [P430] eq. 14 */
    float noise_foam;      /* how much of the grey foam there is where noise is 1 */
    float noise_threshold; /* noise from which on there is grey foam */
    float noise_color[3];  /* linear RGB of the grey foam in white light */

    /* Spray, where foam is noise or layered. */
    float spray_radius;   /* r: radius of a soft drop */
    float spray_depth;    /* optical depth in its middle, where its opacity is 1 */
    float spray_shutter;  /* s: how long a drop moves while it is seen */
    float spray_color[3]; /* linear RGB of spray in white light */
};

/* All defaults. size: sizeof(struct mns_params) as the caller knows it. */
MNS_API void mns_params_init_sized(struct mns_params *params, size_t size);
static inline void mns_params_init(struct mns_params *params) { mns_params_init_sized(params, sizeof(*params)); }

enum mns_param_type {
    MNS_PARAM_FLOAT = 0, /* float[components] */
    MNS_PARAM_INT = 1,   /* int */
    MNS_PARAM_BOOL = 2,  /* int, 0 or 1: "off" or "on" */
    MNS_PARAM_ENUM = 3   /* int: index into choices */
};

/* One row of the table. All strings are static. */
struct mns_param {
    const char *name;  /* the field's name, as in --set NAME=VALUE */
    const char *group; /* "particles", "thickness", "smoothing", "anisotropy", "water", "scene", "foam", "noise", "spray" */
    enum mns_param_type type;
    int components;          /* 1, or 3 for colours */
    size_t offset;           /* in struct mns_params */
    double minimum, maximum; /* inclusive */
    double defaults[3];
    int has_auto;               /* 1: the default is `auto`, outside the range, and may be written so */
    const char *unit;           /* "m", "r", "L", "deg", ...; "" for none */
    const char *const *choices; /* NULL-ended, for an enum; else NULL */
    const char *help;           /* one sentence */
};

/* The rows in the order of the struct. index out of range: NULL. */
MNS_API size_t mns_param_count(void);
MNS_API const struct mns_param *mns_param_info(size_t index);
MNS_API const struct mns_param *mns_param_find(const char *name); /* NULL when there is none */

/* Sets one parameter from text: a number, "auto", "on" or "off", a choice's name, three numbers "R,G,B", or a colour "RRGGBB" in
 * sRGB. Numbers have a decimal point, whatever the program's locale. On failure nothing is changed and message (may be NULL) names the
 * allowed values, or the nearest name. */
MNS_API mns_result mns_params_set(struct mns_params *params, const char *name, const char *value, struct mns_message *message);

/* Writes a parameter's value as mns_params_set reads it. Returns the length that was needed, as snprintf; -1 for an unknown name. */
MNS_API int mns_params_get(const struct mns_params *params, const char *name, char *text, size_t size);

/* Checks every value against the table. message may be NULL. */
MNS_API mns_result mns_params_check(const struct mns_params *params, struct mns_message *message);

#ifdef __cplusplus
}
#endif

#endif
