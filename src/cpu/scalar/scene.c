/* scene.c: the kernels of stage scene in plain C. */
#include "cpu/scene.h"

#include "cpu/plane.h"
#include "cpu/scalar/sky.h"

static float clamp(float a, float low, float high) { return a < low ? low : a > high ? high : a; }

static float dot(const float a[3], const float b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* One axis of the checker at u, filtered over `width` cells on each side (scene.h). */
static float checker_axis(float u, float width)
{
    float centre = u - 0.5f, away = centre - 2 * rintf(0.5f * centre); /* from the middle of the nearest bright cell */
    float wave = 0.5f - fabsf(away);                                   /* distance to the nearest edge, negative in dark cells */
    float t = clamp(wave / (width > 1e-6f ? width : 1e-6f), -1, 1);
    return t * (2 - fabsf(t)) * clamp((2 - width) * (1 / 1.5f), 0, 1);
}

/* One axis of the tiles at u: how much of `width` cells on each side is no joint (scene.h). */
static float tiles_axis(float u, float width)
{
    float centre = u - rintf(u); /* from the nearest joint's middle */
    width = fmaxf(width, 1e-6f);
    float joint = fminf(centre + width, 0.5f * FLOOR_JOINT) - fmaxf(centre - width, -0.5f * FLOOR_JOINT);
    float mean = 1 - FLOOR_JOINT, near = clamp((0.5f - width) * 4, 0, 1);
    return mean + near * (1 - fmaxf(joint, 0) / (2 * width) - mean);
}

/* -1 where the floor is dark, 1 where it is light. */
static float pattern(const struct backdrop *b, float u, float v, float width_u, float width_v)
{
    switch (b->pattern) {
    case MNS_FLOOR_CHECKER: return checker_axis(u, width_u) * checker_axis(v, width_v);
    case MNS_FLOOR_TILES: return 2 * tiles_axis(u, width_u) * tiles_axis(v, width_v) - 1;
    default: return 1;
    }
}

struct floor_point {
    float depth;            /* metres */
    float along_u, along_v; /* axis . q, metres */
    float width_u, width_v; /* half-widths of the pixel's footprint, cells */
    float haze;
};

/* Where the ray of a pixel meets the floor. false: it does not. d: the ray, x and y per unit of depth (orthographic: the point on the image
 * plane, and the ray runs along z). */
static bool meet_floor(const struct backdrop *b, const float d[3], float length, struct floor_point *out)
{
    const float *up = b->sky.up;
    const float ray[3] = {b->orthographic ? 0 : d[0], b->orthographic ? 0 : d[1], 1};
    float fall = dot(up, ray), sine = -fall / length;
    if (!b->has_floor || !(sine > 0)) {
        return false;
    }
    float gap = b->orthographic ? b->plane - up[0] * d[0] - up[1] * d[1] : b->plane;
    float z = gap / fall;
    if (!(z > (b->orthographic ? b->near_plane : 0)) || !(z < DEPTH_LIMIT)) {
        return false;
    }
    out->depth = z;
    out->haze = mns_floor_haze(sine);
    /* Towards the horizon, where haze is all there is, the floor is looked up as where the ray falls by 1e-4: u stays finite. */
    float fall_near = fminf(fall, -1e-4f * length), z_near = gap / fall_near;
    float scale = (b->orthographic ? 1 : z_near) * b->inv_cell;
    float along[2], width[2];
    for (int i = 0; i < 2; i++) {
        const float *axis = i == 0 ? b->axis_u : b->axis_v;
        float slope = dot(axis, ray) / fall_near; /* how far one goes along the axis while one rises by a metre */
        along[i] = b->orthographic ? axis[0] * d[0] + axis[1] * d[1] + axis[2] * z : z_near * dot(axis, ray);
        float per_x = (axis[0] - slope * up[0]) * b->step_x, per_y = (axis[1] - slope * up[1]) * b->step_y;
        width[i] = sqrtf(per_x * per_x + per_y * per_y) * scale;
    }
    out->along_u = along[0];
    out->along_v = along[1];
    out->width_u = width[0];
    out->width_v = width[1];
    return true;
}

/* Light on the floor: bilinear in the map, open outside. */
static void floor_light(const struct backdrop *b, const struct floor_point *at, float out[3])
{
    float u = at->along_u * b->light_scale + b->light_u, v = at->along_v * b->light_scale + b->light_v;
    bool inside = b->light && u >= 0 && v >= 0 && u < (float)(b->light_width - 1) && v < (float)(b->light_height - 1);
    if (!inside) {
        for (int c = 0; c < 3; c++) {
            out[c] = b->light_open[c];
        }
        return;
    }
    int iu = (int)u, iv = (int)v;
    float fu = u - (float)iu, fv = v - (float)iv;
    const float *texel = b->light + 4 * ((ptrdiff_t)iv * b->light_width + iu), *below = texel + 4 * (ptrdiff_t)b->light_width;
    for (int c = 0; c < 3; c++) {
        float top = texel[c] + fu * (texel[c + 4] - texel[c]), bottom = below[c] + fu * (below[c + 4] - below[c]);
        out[c] = top + fv * (bottom - top);
    }
}

static void backdrop_pixel(const struct backdrop *b, int x, int y, float color[4], float *depth)
{
    const float d[3] = {((float)x + 0.5f - b->cx) * b->step_x, ((float)y + 0.5f - b->cy) * b->step_y, 1};
    float length = b->orthographic ? 1 : sqrtf(d[0] * d[0] + d[1] * d[1] + 1), inv = 1 / length;
    const float direction[3] = {b->orthographic ? 0 : d[0] * inv, b->orthographic ? 0 : d[1] * inv, inv};
    struct floor_point at;
    bool floor_here = meet_floor(b, d, length, &at);
    if (b->has_sky) {
        float h = dot(direction, b->sky.up), q = sky_sun_distance2(&b->sky, direction);
        sky_radiance(&b->sky, floor_here ? 0 : h, q, color);
        float disc = clamp((b->disc_outer - q) / (b->disc_outer - b->disc_inner), 0, 1);
        for (int c = 0; c < 3; c++) {
            color[c] += floor_here ? 0 : disc * b->disc[c];
        }
        color[3] = 1;
    } else {
        for (int c = 0; c < 4; c++) {
            color[c] = b->color[c];
        }
    }
    *depth = DEPTH_EMPTY;
    if (floor_here) {
        float light[3],
            checker = pattern(b, at.along_u * b->inv_cell + b->offset_u, at.along_v * b->inv_cell + b->offset_v, at.width_u, at.width_v);
        floor_light(b, &at, light);
        for (int c = 0; c < 3; c++) {
            float shown = (b->albedo_mean[c] + b->albedo_half[c] * checker) * light[c];
            color[c] = shown + at.haze * (color[c] - shown);
        }
        color[3] = b->fades ? 1 - at.haze : 1;
        *depth = at.depth;
    }
}

static void backdrop(const struct backdrop *b, int x, int y, int count, float *color, float *depth)
{
    for (int i = 0; i < count; i++) {
        backdrop_pixel(b, x + i, y, color + 4 * i, depth + i);
    }
}

const struct scene_kernels mns_scene_kernels_scalar = {.backdrop = backdrop};
