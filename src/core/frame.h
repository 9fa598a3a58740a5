/* frame.h: one picture to draw, checked and resolved: what the stages read. */
#ifndef MNS_CORE_FRAME_H
#define MNS_CORE_FRAME_H

#include <meniscus/renderer.h>

#include <stdbool.h>

/* The camera in image space: x right, y down, z forward (depth), relative to the particle set's origin so that float is enough.
 * A point p of the set (relative to its origin) is at q = rotation * p + translation; its pixel position is
 *   perspective:  (cx + fx * q.x / q.z, cy + fy * q.y / q.z)        orthographic:  (cx + fx * q.x, cy + fy * q.y)
 * where pixel i covers [i, i + 1). View space is (q.x, -q.y, -q.z). */
struct view {
    int width, height;
    bool orthographic;
    float rotation[9]; /* row-major */
    float translation[3];
    float fx, fy, cx, cy; /* pixels (perspective) or pixels per metre (orthographic) */
    float near_plane, far_plane;
};

/* Sums over the prepared set that defaults depend on. */
struct particle_facts {
    double origin[3];                   /* of the stored coordinates, world space */
    float bounds_min[3], bounds_max[3]; /* relative to origin */
    size_t count;
    bool has_radius, has_mass, has_color, keeps_passes;
    double spacing, radius;  /* estimated spacing; median or estimated radius; metres */
    double radius_cubed_sum; /* of given radii */
    double mass_sum;
};

/* Sun and sky, floor: all resolved. Directions and heights in the set's coordinates. */
struct scene_look {
    float up[3];                 /* unit */
    float sun[3];                /* unit, towards the sun */
    float sun_color[3];          /* linear RGB: the light on a white surface that faces the sun, divided by pi */
    float floor_height;          /* along up, relative to the origin */
    float floor_cell;            /* metres */
    float floor_phase[2];        /* origin of the checker so that world coordinates decide it, metres */
    int axis_u, axis_v, axis_up; /* coordinate axes */
    bool has_floor;
};

struct frame {
    struct view view;
    struct mns_params params; /* checked; iterations is never auto */
    const struct particle_facts *facts;
    const struct mns_scene *scene;             /* the caller's, or NULL */
    const struct mns_environment *environment; /* the caller's, or NULL */
    const struct mns_objects *objects;         /* the caller's, or NULL */
    struct scene_look look;
    const struct mns_output *outputs;
    size_t output_count;
    unsigned wanted; /* bit 1 << layer for each output */

    float depth_reference; /* depth of the middle of the particles' bounds, metres, > 0: where explicit flows measure their step */
    float splat_radius;    /* R, metres: the splat radius, and the unit of the filters' lengths; of the median particle */
    float splat_scale;     /* R_i = splat_scale * radius_i; 0: every particle has splat_radius */
    float volume;          /* V, m^3: the rest volume of every particle, unless one of the next two is not 0 */
    float volume_per_mass; /* V_i = volume_per_mass * mass_i */
    float volume_per_cube; /* V_i = volume_per_cube * radius_i^3 */
    float fluid_size;      /* L, metres */
    float absorption[3];   /* 1/metre */
};

/* The caller's parameters checked, with defaults for what an older caller does not know and where in is NULL. */
mns_result mns_params_resolve(struct mns_params *out, const struct mns_params *in, struct mns_message *message);

/* Radii, rest volumes, and what follows from the fluid's size: from params and facts, which must be set. */
void mns_frame_resolve_sizes(struct frame *frame);

/* Checks the caller's frame and resolves it against the prepared particles. */
mns_result mns_frame_resolve(struct frame *out, const struct mns_frame *in, const struct particle_facts *facts,
                             struct mns_message *message);

/* The output of a layer, or NULL. */
const struct mns_image *mns_frame_output(const struct frame *frame, enum mns_layer layer);

#endif
