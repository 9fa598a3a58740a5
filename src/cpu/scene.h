/* scene.h: what stands behind the fluid, and the kernels that draw it. */
#ifndef MNS_CPU_SCENE_H
#define MNS_CPU_SCENE_H

#include "cpu/sky.h"

#include <stdbool.h>
#include <stddef.h>

/* Pixels that a kernel draws at a time, at most: what it needs in between stays in the first cache. */
enum { SCENE_SPAN = 256 };

/* Sky and floor of one picture, in image space (core/frame.h: struct view). */
struct backdrop {
    struct sky sky;
    bool has_sky;   /* false: color everywhere, into which the floor fades as well */
    bool has_floor; /* and the eye is above it */
    bool fades;     /* the fourth channel is 1 - haze on the floor: something else stands behind it */
    bool orthographic;
    int pattern; /* enum mns_floor_pattern */
    float color[4];
    float step_x, step_y; /* 1 / fx, 1 / fy */
    float cx, cy, near_plane;
    float disc_inner, disc_outer; /* q of the sky's formula between which the sun's disc ends */
    float disc[3];                /* its radiance */

    float plane;                /* up . q of the points q on the floor; negative for a perspective eye above it */
    float axis_u[3], axis_v[3]; /* (axis_u . q) * inv_cell + offset_u: cells along the floor */
    float offset_u, offset_v, inv_cell;
    float albedo_mean[3], albedo_half[3]; /* of the floor: mean + half * checker, checker in [-1, 1] */
    float light_open[3];                  /* on the floor outside the map */
    const float *light;                   /* [light_height][light_width][4] on the floor, the fluid's shadow in it; NULL: open everywhere */
    int light_width, light_height;
    float light_u, light_v, light_scale; /* (axis_u . q) * light_scale + light_u: texel centres at whole numbers */
};

/* The floor fades into the horizon's colour with the sine of the angle below the horizon, so no length sets the haze:
 * (s^2 / (s^2 + sine^2))^2, less FLOOR_HAZE_END so that most of the picture needs no sky. */
#define FLOOR_HAZE_SINE 0.05f
#define FLOOR_HAZE_END  0.001f

/* 1 at the horizon, a quarter at FLOOR_HAZE_SINE below it, none from 14 degrees on. */
static inline float mns_floor_haze(float sine)
{
    float ratio = FLOOR_HAZE_SINE * FLOOR_HAZE_SINE / (FLOOR_HAZE_SINE * FLOOR_HAZE_SINE + sine * sine),
          above = ratio * ratio - FLOOR_HAZE_END;
    return (above > 0 ? above : 0) * (1 / (1 - FLOOR_HAZE_END));
}

/* The checker is filtered by a tent of one pixel's footprint on each side, along each axis of the floor in turn: t (2 - |t|) of
 * t = distance to the nearest edge / width, clamped to [-1, 1]. From half a cell on the next edges come in: (2 - width) / 1.5 stands for
 * them, within 0.07 of the tent's integral, and from two cells on nothing is left, where the tent leaves 0.05 at most. */

/* A row of tiles across one axis: 1 on them, 0 in the joints, the mean over the pixel's footprint; to the mean of all where that nears half a cell. */

struct scene_kernels {
    /* Pixels x to x + count - 1 of row y: color [count][4], linear; depth [count], metres, DEPTH_EMPTY in the sky. Both may be written up
     * to count rounded up to 16. count <= SCENE_SPAN. Against plain C: 6e-4 in colour, since a rounding of
     * the depth moves an edge of the checker; 4e-6 relative of the depth, times 1 + depth over the eye's height; pixels at the horizon may fall on
     * either side of it. */
    void (*backdrop)(const struct backdrop *backdrop, int x, int y, int count, float *color, float *depth);
};

extern const struct scene_kernels mns_scene_kernels_scalar, mns_scene_kernels_sse2, mns_scene_kernels_avx2, mns_scene_kernels_avx512,
    mns_scene_kernels_neon;

#endif
