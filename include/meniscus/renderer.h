/* meniscus/renderer.h: from particles to layers.
 *
 *     mns_renderer_create -> mns_renderer_prepare (once per particle set) -> mns_renderer_draw (once per view) -> ... -> destroy
 *
 * The same input gives the same bytes on every run and for every number of threads. Across instruction sets, orders of the
 * particles and backends, layers agree within the tolerances stated in docs/pipeline.md. */
#ifndef MENISCUS_RENDERER_H
#define MENISCUS_RENDERER_H

#include <meniscus/camera.h>
#include <meniscus/common.h>
#include <meniscus/environment.h>
#include <meniscus/params.h>
#include <meniscus/particles.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct mns_renderer mns_renderer; /* opaque; one thread at a time */

enum mns_backend { MNS_BACKEND_AUTO = 0, MNS_BACKEND_CPU = 1 };

/* Instruction sets of the CPU backend. */
enum mns_isa {
    MNS_ISA_AUTO = 0,
    MNS_ISA_SCALAR = 1, /* plain C: the definition of every kernel */
    MNS_ISA_SSE2 = 2,
    MNS_ISA_AVX2 = 3,   /* with FMA */
    MNS_ISA_AVX512 = 4, /* F, BW, DQ, VL */
    MNS_ISA_NEON = 5
};

/* "scalar", "sse2", ...; NULL for an unknown value. */
MNS_API const char *mns_isa_name(enum mns_isa isa);

/* 1 when this build has the instruction set and this processor runs it. */
MNS_API int mns_isa_available(enum mns_isa isa);

struct mns_renderer_params {
    size_t struct_size;             /* set by mns_renderer_params_init */
    enum mns_backend backend;       /* default: auto */
    enum mns_isa isa;               /* default: auto, the best there is */
    int threads;                    /* 1 to 1024; 0 (default): as many as this process may use */
    struct mns_allocator allocator; /* default: the C library's; kept until destroy */
    struct mns_log log;             /* default: none; kept until destroy */
    struct mns_parallel parallel;   /* default: the renderer's own threads; kept until destroy */
    int passes;                     /* 1: prepare keeps velocities and ids, for the layers velocity, motion and id. Default 0 */
};

MNS_API void mns_renderer_params_init_sized(struct mns_renderer_params *params, size_t size);
static inline void mns_renderer_params_init(struct mns_renderer_params *params) { mns_renderer_params_init_sized(params, sizeof(*params)); }

/* params NULL: all defaults. On success the caller owns *out; on failure *out is NULL and message (may be NULL) says why. */
MNS_API mns_result mns_renderer_create(mns_renderer **out, const struct mns_renderer_params *params, struct mns_message *message);
MNS_API void mns_renderer_destroy(mns_renderer **renderer); /* sets *renderer to NULL; NULL is fine */

/* Takes a new set of particles in: copies what it needs, in spatial order. The caller's arrays are free again afterwards.
 * On failure the renderer holds no particles. */
MNS_API mns_result mns_renderer_prepare(mns_renderer *renderer, const struct mns_particles *particles);

/* Takes the diffuse particles of a simulator in beside the prepared ones: foam and bubbles are drawn with the foam, spray with the spray. After
 * prepare, which drops those of the set before; a second call replaces the first; NULL: none. Attributes read: position, radius (metres; absent:
 * half of the fluid's), foam and spray (absent: 1), foam_age, velocity, kind. Without a fluid, positions are kept as float32.
 * On failure there are none, and the prepared particles stay. */
MNS_API mns_result mns_renderer_prepare_diffuse(mns_renderer *renderer, const struct mns_particles *particles);

/* The images that a draw can produce. */
enum mns_layer {
    MNS_LAYER_BEAUTY = 0,          /* [h][w][4] colour, straight alpha: the picture, or what `display` asks for */
    MNS_LAYER_DEPTH_RAW = 1,       /* [h][w] metres: nearest sphere; +inf where there is none */
    MNS_LAYER_DEPTH = 2,           /* [h][w] metres: smoothed; +inf where no fluid shows */
    MNS_LAYER_THICKNESS_RAW = 3,   /* [h][w] metres along the pixel's ray */
    MNS_LAYER_THICKNESS = 4,       /* [h][w] metres: blurred */
    MNS_LAYER_NORMAL = 5,          /* [h][w][3] view space, unit length; 0 where no fluid shows */
    MNS_LAYER_CURVATURE = 6,       /* [h][w] 1/metre: mean curvature, positive where the surface bulges towards the eye; 0 outside */
    MNS_LAYER_COLOR = 7,           /* [h][w][3] linear RGB: thickness-weighted mean colour of the particles, blurred; 0 outside */
    MNS_LAYER_TRANSMITTANCE = 8,   /* [h][w][3] part of the light from behind that comes through; 1 outside */
    MNS_LAYER_ALPHA = 9,           /* [h][w] 1 - mean transmittance; 0 outside */
    MNS_LAYER_SCENE_COLOR = 10,    /* [h][w][3] colour: what is behind the fluid */
    MNS_LAYER_SCENE_DEPTH = 11,    /* [h][w] metres: opaque things; +inf for the sky */
    MNS_LAYER_NOISE = 12,          /* [h][w] what the particles' patterns sum to, about -1 to 1; 0 outside, and unless foam is noise */
    MNS_LAYER_FOAM_DEPTH = 13,     /* [h][w] metres: nearest foam that shows; +inf where none does, and unless foam is layered */
    MNS_LAYER_FOAM_THICKNESS = 14, /* [h][w] metres along the ray, with its detail: T_f of [BSW10] */
    MNS_LAYER_FOAM_FRONT_THICKNESS = 15, /* [h][w] metres: of the foam within foam_range of its depth: T_ff */
    MNS_LAYER_THICKNESS_FRONT = 16,      /* [h][w] metres: of the water before the foam, T_wf; 0 where there is no foam */
    MNS_LAYER_THICKNESS_BACK = 17,       /* [h][w] metres: of the water behind it, T_wb; thickness_front + thickness_back = thickness */
    MNS_LAYER_VELOCITY =
        18, /* [h][w][3] m/s, world space: of the particle that the pixel's ray meets first; 0 outside, and where there are none */
    MNS_LAYER_MOTION =
        19, /* [h][w][2] pixels, right and down, that it moves in params.motion_time before a camera that stands still; 0 outside */
    MNS_LAYER_ID = 20,       /* [h][w] its id, else its index, as a float32: exact up to 2^24; -1 outside */
    MNS_LAYER_POSITION = 21, /* [h][w][3] metres, world space: of the smoothed surface; 0 outside */
    MNS_LAYER_COUNT = 22
};

MNS_API const char *mns_layer_name(enum mns_layer layer);                 /* "depth_raw"; NULL for an unknown value */
MNS_API int mns_layer_channels(enum mns_layer layer);                     /* 1 to 4; 0 for an unknown value */
MNS_API mns_result mns_layer_find(const char *name, enum mns_layer *out); /* by name */

/* A layer and where it goes. Beauty and scene_color take every pixel type; beauty takes 3 channels too (alpha dropped); the rest
 * float32 with the layer's own channels. */
struct mns_output {
    enum mns_layer layer;
    struct mns_image image; /* of the camera's size */
};

/* What the fluid stands before, rendered by the caller with the same camera. */
struct mns_scene {
    struct mns_image color; /* 3 or 4 channels (the fourth is not read), float32 linear or U8/U16 sRGB, of the camera's size */
    struct mns_image depth; /* 1 channel, float32, metres along the view axis, +inf for nothing; data NULL: all +inf */
};

/* One pixel of opaque things that stand under the renderer's own sky and on its floor. What hits nothing has zeros, depths of +inf, and 1 for the floor. */
struct mns_object_pixel {
    float color
        [4]; /* linear light of what the pixel's samples hit, without the sun's, times the part of the pixel that is hit; that part, 0 to 1 */
    float sunlit[3];            /* the sun's light alone, times that part, as if there were no fluid: the fluid's shadow falls on it */
    float depth;                /* metres along the view axis at the pixel's centre; +inf where its ray hits nothing */
    float reach;                /* metres: where the sun's light is dimmed by the fluid; the mean depth of what the samples hit */
    float floor_sun, floor_sky; /* parts of the sun's and of the sky's light that reach the floor seen at the pixel, 0 to 1 */
};

/* A picture of such things, by the same camera. Whoever draws them asks mns_renderer_light for the light. */
struct mns_objects {
    const struct mns_object_pixel *pixels; /* [height][width], row 0 at the top */
    int width, height;                     /* the camera's */
    const int *spans;                      /* [height][2]: first pixel that is not empty, and the one behind the last; NULL: whole rows */
};

/* One picture to draw. */
struct mns_frame {
    size_t struct_size;               /* set by mns_frame_init */
    const struct mns_camera *camera;  /* required */
    const struct mns_params *params;  /* NULL: defaults */
    const struct mns_scene *scene;    /* NULL: sky and floor as params say */
    const struct mns_output *outputs; /* [output_count]; each layer at most once */
    size_t output_count;
    const mns_environment *environment; /* takes the sky's place, where background is sky; NULL: none */
    const struct mns_objects *objects;  /* things in our own sky and on our own floor; NULL: none. Not with scene */
};
MNS_API void mns_frame_init_sized(struct mns_frame *frame, size_t size);
static inline void mns_frame_init(struct mns_frame *frame) { mns_frame_init_sized(frame, sizeof(*frame)); }

/* Draws the prepared particles. The outputs are written when it returns MNS_OK; otherwise what they hold is undefined.
 * No visible particle is no error: the picture is the background. */
MNS_API mns_result mns_renderer_draw(mns_renderer *renderer, const struct mns_frame *frame);

/* The light in which a frame's scene stands: linear RGB, world space. */
struct mns_light {
    size_t struct_size;    /* set by mns_light_init */
    double up[3], sun[3];  /* unit; towards the sun */
    float sun_light[3];    /* on a white surface that faces the sun */
    float sky_light[3];    /* on a white surface that faces up, by the sky alone */
    float ground_light[3]; /* on a white surface that faces down */
    float side_light[3];   /* on a white vertical surface, by sky and ground */
    int has_floor;         /* 0 or 1 */
    double floor_height;   /* coordinate along up, metres */
};
MNS_API void mns_light_init_sized(struct mns_light *light, size_t size);
static inline void mns_light_init(struct mns_light *light) { mns_light_init_sized(light, sizeof(*light)); }

/* The light of a frame with the prepared particles. *out: from mns_light_init. */
MNS_API mns_result mns_renderer_light(mns_renderer *renderer, const struct mns_frame *frame, struct mns_light *out);

/* What went wrong in the last call on this renderer, in words; "" when nothing did. Valid until the next call. */
MNS_API const char *mns_renderer_message(const mns_renderer *renderer);

enum { MNS_STAGE_MAX = 16 };

/* What the last prepare and draw did. */
struct mns_stats {
    size_t struct_size;  /* set by mns_stats_init */
    const char *backend; /* "cpu" */
    const char *isa;     /* "avx2" */
    int threads;
    struct mns_measure measure; /* of the prepared set */
    double splat_radius;        /* R, metres, as drawn */
    double fluid_size;          /* L, metres, as drawn */
    size_t particles_visible;   /* in the view's frustum, by chunks */
    size_t particles_splatted;  /* that survived culling of the hidden ones */
    size_t pixels_covered;      /* with fluid in depth_raw */
    double prepare_ms;          /* the last prepare, with the shadow of a new set once it is drawn */
    double draw_ms;             /* the last draw */
    int stage_count;            /* stages of the last draw, in order */
    const char *stage_name[MNS_STAGE_MAX];
    double stage_ms[MNS_STAGE_MAX];
    size_t bytes, peak_bytes; /* memory held by the renderer now, and at most */
};
MNS_API void mns_stats_init_sized(struct mns_stats *stats, size_t size);
static inline void mns_stats_init(struct mns_stats *stats) { mns_stats_init_sized(stats, sizeof(*stats)); }
MNS_API void mns_renderer_stats(const mns_renderer *renderer, struct mns_stats *out);

#ifdef __cplusplus
}
#endif

#endif
