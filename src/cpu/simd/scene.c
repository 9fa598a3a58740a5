/* scene.c: the kernels of stage scene over simd.h: first all that is arithmetic, then the lookups in the light map, then their sum. */
#include "cpu/scene.h"

#include "cpu/plane.h"
#include "cpu/simd.h"
#include "cpu/simd/sky.h"

/* What stands between the loops, per pixel of the span. */
struct span {
    float checker[SCENE_SPAN], haze[SCENE_SPAN], back[3][SCENE_SPAN];
    int32_t texel[SCENE_SPAN];                        /* of the light map, up and left of the point; -1 outside the map */
    float into_u[SCENE_SPAN], into_v[SCENE_SPAN];     /* from that texel on */
    float light[4 * SCENE_SPAN];                      /* [i][4] */
    bool is_floor[SCENE_SPAN], is_inside[SCENE_SPAN]; /* for any pixel of the vector at i */
};

/* The floor under VLEN rays. */
struct floor_hit {
    vm here;
    vf depth, haze;  /* haze 1 where there is no floor: the backdrop alone */
    vf checker;      /* -1 to 1 */
    vf map_u, map_v; /* in the light map, texels */
};

/* Rays of VLEN pixels: x and y per unit of depth, or the point on the image plane. */
struct rays {
    vf dx, dy, inv_length;
};

/* inv_width: 1 / width */
SIMD vf checker_axis(vf u, vf width, vf inv_width)
{
    vf centre = u - vf_set1(0.5f), away = vf_fnma(vf_set1(2.0f), vf_round(centre * vf_set1(0.5f)), centre);
    vf wave = vf_set1(0.5f) - vf_abs(away), one = vf_set1(1.0f);
    vf t = vf_clamp(wave * inv_width, vf_zero() - one, one);
    return t * (vf_set1(2.0f) - vf_abs(t)) * vf_clamp((vf_set1(2.0f) - width) * vf_set1(1 / 1.5f), vf_zero(), one);
}

SIMD vf tiles_axis(vf u, vf width, vf inv_width)
{
    vf centre = u - vf_round(u), half = vf_set1(0.5f * FLOOR_JOINT), mean = vf_set1(1 - FLOOR_JOINT), one = vf_set1(1.0f);
    vf joint = vf_max(vf_min(centre + width, half) - vf_max(centre - width, vf_zero() - half), vf_zero());
    vf near = vf_clamp((vf_set1(0.5f) - width) * vf_set1(4.0f), vf_zero(), one);
    return vf_fma(near, vf_fnma(joint, vf_set1(0.5f) * inv_width, one) - mean, mean);
}

SIMD vf pattern_axis(const struct backdrop *b, vf u, vf width, vf inv_width)
{
    return b->pattern == MNS_FLOOR_TILES ? tiles_axis(u, width, inv_width) : checker_axis(u, width, inv_width);
}

SIMD vf floor_haze(vf sine)
{
    const float s2 = FLOOR_HAZE_SINE * FLOOR_HAZE_SINE;
    vf ratio = vf_set1(s2) * vf_rcp(vf_fma(sine, sine, vf_set1(s2)));
    return vf_max(vf_fma(ratio, ratio, vf_set1(-FLOOR_HAZE_END)), vf_zero()) * vf_set1(1 / (1 - FLOOR_HAZE_END));
}

SIMD vf ray_dot(const struct backdrop *b, const float axis[3], const struct rays *r)
{
    return vf_either(b->orthographic, vf_set1(axis[2]), vf_dot(axis, r->dx, r->dy, vf_set1(1.0f)));
}

SIMD struct floor_hit no_floor(void)
{
    vf zero = vf_zero(), one = vf_set1(1.0f);
    return (struct floor_hit){vf_lt(one, zero), vf_set1(DEPTH_EMPTY), one, zero, zero, zero};
}

SIMD struct floor_hit meet_floor(const struct backdrop *b, const struct rays *r)
{
    const float *up = b->sky.up;
    vf fall = ray_dot(b, up, r), sine = vf_zero() - fall * r->inv_length, gap = vf_set1(b->plane);
    if (b->orthographic) {
        gap = gap - vf_fma(vf_set1(up[0]), r->dx, vf_set1(up[1]) * r->dy);
    }
    struct floor_hit hit = no_floor();
    if (!vm_any(vf_gt(sine, vf_zero()))) {
        return hit;
    }
    vf inv_fall = vf_rcp(fall), z = gap * inv_fall;
    hit.here =
        vm_and(vf_gt(sine, vf_zero()), vm_and(vf_gt(z, vf_set1(b->orthographic ? b->near_plane : 0)), vf_lt(z, vf_set1(DEPTH_LIMIT))));
    hit.depth = vf_select(hit.here, z, hit.depth);
    hit.haze = vf_select(hit.here, floor_haze(sine), hit.haze);
    /* Towards the horizon, where haze is all there is, the floor is looked up as where the ray falls by 1e-4: u stays finite. */
    vf inv_near = vf_max(inv_fall, vf_set1(-1e4f) * r->inv_length), z_near = gap * inv_near;
    vf scale = vf_set1(b->inv_cell), along[2], checker[2];
    if (!b->orthographic) {
        scale = scale * z_near;
    }
    vf inv_scale = vf_rcp(scale);
    for (int k = 0; k < 2; k++) {
        const float *axis = k == 0 ? b->axis_u : b->axis_v;
        vf along_ray = ray_dot(b, axis, r), slope = along_ray * inv_near;
        along[k] = vf_either(b->orthographic, vf_dot(axis, r->dx, r->dy, z), z_near * along_ray);
        vf per_x = vf_fnma(slope, vf_set1(up[0]), vf_set1(axis[0])) * vf_set1(b->step_x);
        vf per_y = vf_fnma(slope, vf_set1(up[1]), vf_set1(axis[1])) * vf_set1(b->step_y);
        vf width2 = vf_max(vf_fma(per_x, per_x, per_y * per_y), vf_set1(1e-36f)), inv_width = vf_rsqrt(width2); /* metres at scale 1 */
        checker[k] = pattern_axis(b, vf_fma(along[k], vf_set1(b->inv_cell), vf_set1(k == 0 ? b->offset_u : b->offset_v)),
                                  width2 * inv_width * scale, inv_width * inv_scale);
    }
    hit.checker = checker[0] * checker[1];
    if (b->pattern != MNS_FLOOR_CHECKER) {
        hit.checker = vf_either(b->pattern == MNS_FLOOR_TILES, hit.checker + hit.checker - vf_set1(1.0f), vf_set1(1.0f));
    }
    hit.map_u = vf_fma(along[0], vf_set1(b->light_scale), vf_set1(b->light_u));
    hit.map_v = vf_fma(along[1], vf_set1(b->light_scale), vf_set1(b->light_v));
    return hit;
}

/* Sky above the horizon, and the haze that the floor fades into. */
SIMD void backdrop_at(const struct backdrop *b, const struct rays *r, const struct floor_hit *hit, vf out[3])
{
    for (int c = 0; c < 3; c++) {
        out[c] = vf_set1(b->color[c]);
    }
    if (!b->has_sky || !vm_any(vf_gt(hit->haze, vf_zero()))) {
        return;
    }
    vf x = vf_either(b->orthographic, vf_zero(), r->dx * r->inv_length), y = vf_either(b->orthographic, vf_zero(), r->dy * r->inv_length);
    vf z = r->inv_length;
    vf h = vf_select(hit->here, vf_zero(), vf_dot(b->sky.up, x, y, z)), q = sky_sun_distance2(&b->sky, x, y, z);
    sky_radiance(&b->sky, h, q, out);
    if (vm_any(vf_lt(q, vf_set1(b->disc_outer)))) {
        vf disc = vf_clamp((vf_set1(b->disc_outer) - q) * vf_set1(1 / (b->disc_outer - b->disc_inner)), vf_zero(), vf_set1(1.0f));
        disc = vf_select(hit->here, vf_zero(), disc);
        for (int c = 0; c < 3; c++) {
            out[c] = vf_fma(disc, vf_set1(b->disc[c]), out[c]);
        }
    }
}

SIMD vm inside_map(const struct backdrop *b, const struct floor_hit *hit)
{
    if (!b->light) {
        return vf_lt(vf_zero(), vf_zero());
    }
    return vm_and(
        vm_and(hit->here, vm_and(vf_ge(hit->map_u, vf_zero()), vf_ge(hit->map_v, vf_zero()))),
        vm_and(vf_lt(hit->map_u, vf_set1((float)(b->light_width - 1))), vf_lt(hit->map_v, vf_set1((float)(b->light_height - 1)))));
}

static void find(const struct backdrop *b, int x, int y, int count, struct span *span, float *depth)
{
    vf step_x = vf_set1(b->step_x), dy = vf_set1(((float)y + 0.5f - b->cy) * b->step_y), one = vf_set1(1.0f);
    for (int i = 0; i < count; i += VLEN) {
        struct rays r = {.dx = (vf_iota() + vf_set1((float)(x + i) + 0.5f - b->cx)) * step_x, .dy = dy, .inv_length = one};
        if (!b->orthographic) {
            r.inv_length = vf_rsqrt(vf_fma(r.dx, r.dx, vf_fma(dy, dy, one)));
        }
        struct floor_hit hit = no_floor();
        if (b->has_floor) {
            hit = meet_floor(b, &r);
        }
        vf back[3];
        backdrop_at(b, &r, &hit, back);
        for (int c = 0; c < 3; c++) {
            vf_storeu(span->back[c] + i, back[c]);
        }
        vf_storeu(depth + i, hit.depth);
        vf_storeu(span->haze + i, hit.haze);
        vf_storeu(span->checker + i, hit.checker);
        span->is_floor[i] = vm_any(hit.here);
        vm inside = inside_map(b, &hit);
        span->is_inside[i] = vm_any(inside);
        if (span->is_inside[i]) {
            vf u = vf_floor(hit.map_u), v = vf_floor(hit.map_v);
            vi texel = vi_add(vi_mul(vf_truncate(v), vi_set1(b->light_width)), vf_truncate(u));
            vi_storeu(span->texel + i, vi_select(inside, texel, vi_set1(-1)));
            vf_storeu(span->into_u + i, hit.map_u - u);
            vf_storeu(span->into_v + i, hit.map_v - v);
        }
    }
}

/* The light on the floor, bilinear in the map. */
static void light(const struct backdrop *b, int count, struct span *span)
{
    const v4 open = {b->light_open[0], b->light_open[1], b->light_open[2], 0};
    const ptrdiff_t row = 4 * (ptrdiff_t)b->light_width;
    for (int begin = 0; begin < count; begin += VLEN) {
        for (int i = begin; span->is_inside[begin] && i < begin + VLEN; i++) {
            v4 here = open;
            if (span->texel[i] >= 0) {
                const float *texel = b->light + 4 * (ptrdiff_t)span->texel[i];
                here = v4_bilinear(texel, texel + row, span->into_u[i], span->into_v[i]);
            }
            v4_storeu(span->light + 4 * i, here);
        }
    }
}

static void sum(const struct backdrop *b, int count, const struct span *span, float *color)
{
    vf one = vf_set1(1.0f), nothing = vf_set1(b->has_sky ? 1.0f : b->color[3]);
    for (int i = 0; i < count; i += VLEN) {
        vf haze = vf_loadu(span->haze + i), checker = vf_loadu(span->checker + i), out[3];
        vf lit[4] = {vf_set1(b->light_open[0]), vf_set1(b->light_open[1]), vf_set1(b->light_open[2]), one};
        if (span->is_inside[i]) {
            vf_load_rgba(span->light + 4 * i, lit);
        }
        for (int c = 0; c < 3; c++) {
            out[c] = vf_loadu(span->back[c] + i);
            if (span->is_floor[i]) {
                vf shown = vf_fma(vf_set1(b->albedo_half[c]), checker, vf_set1(b->albedo_mean[c])) * lit[c];
                out[c] = vf_fma(haze, out[c] - shown, shown);
            }
        }
        vf_store_rgba(color + 4 * i, out[0], out[1], out[2], vf_select(vf_lt(haze, one), vf_either(b->fades, one - haze, one), nothing));
    }
}

static void backdrop(const struct backdrop *b, int x, int y, int count, float *color, float *depth)
{
    struct span span;
    find(b, x, y, count, &span, depth);
    light(b, count, &span);
    sum(b, count, &span, color);
}

const struct scene_kernels SIMD_NAME(mns_scene_kernels) = {.backdrop = backdrop};
