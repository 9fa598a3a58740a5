/* scene.c: the kernels of stage scene over simd.h: first all that is arithmetic, then the lookups in the light map, then their sum. */
#include "cpu/scene.h"

#include "cpu/plane.h"
#include "cpu/simd.h"
#include "cpu/simd/sky.h"

enum { FLOATS = SCENE_SPAN + 16 }; /* a whole vector beyond the span */

/* What stands between the loops, per pixel. */
struct span {
    float checker[FLOATS], haze[FLOATS]; /* haze 1 where there is no floor: the backdrop alone */
    float back[3][FLOATS];               /* sky, haze or colour */
    float map_u[FLOATS], map_v[FLOATS];  /* in the light map, texels; -1 outside */
    float light[4 * FLOATS];             /* [i][4] */
    int inside;                          /* pixels in the light map */
};

/* Rays of VLEN pixels: x and y per unit of depth, or the point on the image plane. */
struct rays {
    vf dx, dy, length, inv_length;
};

SIMD vf checker_axis(vf u, vf width)
{
    vf centre = u - vf_set1(0.5f), away = vf_fnma(vf_set1(2.0f), vf_round(centre * vf_set1(0.5f)), centre);
    vf wave = vf_set1(0.5f) - vf_abs(away), one = vf_set1(1.0f);
    vf t = vf_clamp(wave * vf_rcp(vf_max(width, vf_set1(1e-6f))), vf_zero() - one, one);
    return t * (vf_set1(2.0f) - vf_abs(t)) * vf_clamp((vf_set1(2.0f) - width) * vf_set1(1 / 1.5f), vf_zero(), one);
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

/* Floor under VLEN rays: fills checker, haze and map of the span at i; returns where there is floor, and its depth. */
SIMD vm floor_at(const struct backdrop *b, const struct rays *r, struct span *span, int i, vf *depth)
{
    const float *up = b->sky.up;
    vf fall = ray_dot(b, up, r), sine = vf_zero() - fall * r->inv_length;
    vf gap = vf_set1(b->plane);
    if (b->orthographic) {
        gap = gap - vf_fma(vf_set1(up[0]), r->dx, vf_set1(up[1]) * r->dy);
    }
    vf inv_fall = vf_rcp(fall), z = gap * inv_fall;
    vm here =
        vm_and(vf_gt(sine, vf_zero()), vm_and(vf_gt(z, vf_set1(b->orthographic ? b->near_plane : 0)), vf_lt(z, vf_set1(DEPTH_LIMIT))));
    *depth = vf_select(here, z, vf_set1(DEPTH_EMPTY));
    vf_storeu(span->haze + i, vf_select(here, floor_haze(sine), vf_set1(1.0f)));
    vf inv_near = vf_rcp(vf_min(fall, vf_set1(-1e-4f) * r->length)), z_near = gap * inv_near;
    vf scale = vf_set1(b->inv_cell), checker = vf_set1(1.0f), map[2];
    if (!b->orthographic) {
        scale = scale * z_near;
    }
    for (int k = 0; k < 2; k++) {
        const float *axis = k == 0 ? b->axis_u : b->axis_v;
        vf along_ray = ray_dot(b, axis, r), slope = along_ray * inv_near;
        vf along = vf_either(b->orthographic, vf_dot(axis, r->dx, r->dy, z), z_near * along_ray);
        vf per_x = vf_fnma(slope, vf_set1(up[0]), vf_set1(axis[0])) * vf_set1(b->step_x);
        vf per_y = vf_fnma(slope, vf_set1(up[1]), vf_set1(axis[1])) * vf_set1(b->step_y);
        vf width = vf_root(vf_max(vf_fma(per_x, per_x, per_y * per_y), vf_set1(1e-36f))) * scale;
        checker = checker * checker_axis(vf_fma(along, vf_set1(b->inv_cell), vf_set1(k == 0 ? b->offset_u : b->offset_v)), width);
        map[k] = vf_fma(along, vf_set1(b->light_scale), vf_set1(k == 0 ? b->light_u : b->light_v));
    }
    vf_storeu(span->checker + i, vf_select(here, checker, vf_zero()));
    if (!b->light) {
        return here;
    }
    vm inside = vm_and(vm_and(here, vm_and(vf_ge(map[0], vf_zero()), vf_ge(map[1], vf_zero()))),
                       vm_and(vf_lt(map[0], vf_set1((float)(b->light_width - 1))), vf_lt(map[1], vf_set1((float)(b->light_height - 1)))));
    vf_storeu(span->map_u + i, vf_select(inside, map[0], vf_set1(-1.0f)));
    vf_storeu(span->map_v + i, vf_select(inside, map[1], vf_set1(-1.0f)));
    span->inside += vm_any(inside);
    return here;
}

/* Sky above the horizon, and the haze that the floor fades into. */
SIMD void backdrop_at(const struct backdrop *b, const struct rays *r, vm is_floor, struct span *span, int i)
{
    vf out[3] = {vf_set1(b->color[0]), vf_set1(b->color[1]), vf_set1(b->color[2])};
    int needed = vm_any(vf_gt(vf_loadu(span->haze + i), vf_zero()));
    if (b->has_sky && needed) {
        vf x = vf_either(b->orthographic, vf_zero(), r->dx * r->inv_length),
           y = vf_either(b->orthographic, vf_zero(), r->dy * r->inv_length);
        vf z = r->inv_length;
        vf h = vf_select(is_floor, vf_zero(), vf_dot(b->sky.up, x, y, z)), q = sky_sun_distance2(&b->sky, x, y, z);
        sky_radiance(&b->sky, h, q, out);
        if (vm_any(vf_lt(q, vf_set1(b->disc_outer)))) {
            vf disc = vf_clamp((vf_set1(b->disc_outer) - q) * vf_set1(1 / (b->disc_outer - b->disc_inner)), vf_zero(), vf_set1(1.0f));
            disc = vf_select(is_floor, vf_zero(), disc);
            for (int c = 0; c < 3; c++) {
                out[c] = vf_fma(disc, vf_set1(b->disc[c]), out[c]);
            }
        }
    }
    for (int c = 0; c < 3; c++) {
        vf_storeu(span->back[c] + i, out[c]);
    }
}

static void find(const struct backdrop *b, int x, int y, int count, struct span *span, float *depth)
{
    vf step_x = vf_set1(b->step_x), dy = vf_set1(((float)y + 0.5f - b->cy) * b->step_y), one = vf_set1(1.0f);
    for (int i = 0; i < count; i += VLEN) {
        struct rays r = {.dx = (vf_iota() + vf_set1((float)(x + i) + 0.5f - b->cx)) * step_x, .dy = dy, .length = one, .inv_length = one};
        if (!b->orthographic) {
            vf length2 = vf_fma(r.dx, r.dx, vf_fma(dy, dy, one));
            r.inv_length = vf_rsqrt(length2);
            r.length = length2 * r.inv_length;
        }
        vm is_floor = vf_lt(one, vf_zero());
        if (b->has_floor) {
            vf z;
            is_floor = floor_at(b, &r, span, i, &z);
            vf_storeu(depth + i, z);
        } else {
            vf_storeu(span->haze + i, one);
            vf_storeu(span->checker + i, vf_zero());
            vf_storeu(depth + i, vf_set1(DEPTH_EMPTY));
        }
        backdrop_at(b, &r, is_floor, span, i);
    }
}

/* The light on the floor, bilinear in the map. */
static void light(const struct backdrop *b, int count, struct span *span)
{
    const v4 open = {b->light_open[0], b->light_open[1], b->light_open[2], 0};
    const ptrdiff_t row = 4 * (ptrdiff_t)b->light_width;
    for (int i = 0; i < count; i++) {
        v4 here = open;
        if (span->map_u[i] >= 0) {
            int u = (int)span->map_u[i], v = (int)span->map_v[i];
            float fu = span->map_u[i] - (float)u, fv = span->map_v[i] - (float)v;
            const float *texel = b->light + v * row + 4 * (ptrdiff_t)u;
            v4 a = v4_loadu(texel), c = v4_loadu(texel + row);
            a += fu * (v4_loadu(texel + 4) - a);
            c += fu * (v4_loadu(texel + row + 4) - c);
            here = a + fv * (c - a);
        }
        v4_storeu(span->light + 4 * i, here);
    }
}

static void sum(const struct backdrop *b, int count, const struct span *span, float *color)
{
    for (int i = 0; i < count; i += VLEN) {
        vf out[4], lit[4] = {vf_set1(b->light_open[0]), vf_set1(b->light_open[1]), vf_set1(b->light_open[2]), vf_zero()};
        vf haze = vf_loadu(span->haze + i), checker = vf_loadu(span->checker + i);
        if (span->inside) {
            vf_load_rgba(span->light + 4 * i, lit);
        }
        for (int c = 0; c < 3; c++) {
            vf shown = vf_fma(vf_set1(b->albedo_half[c]), checker, vf_set1(b->albedo_mean[c])) * lit[c];
            out[c] = vf_fma(haze, vf_loadu(span->back[c] + i) - shown, shown);
        }
        out[3] = vf_select(vf_lt(haze, vf_set1(1.0f)), vf_set1(1.0f), vf_set1(b->has_sky ? 1.0f : b->color[3]));
        vf_store_rgba(color + 4 * i, out[0], out[1], out[2], out[3]);
    }
}

static void backdrop(const struct backdrop *b, int x, int y, int count, float *color, float *depth)
{
    struct span span;
    span.inside = 0;
    find(b, x, y, count, &span, depth);
    if (span.inside) {
        light(b, count, &span);
    }
    sum(b, count, &span, color);
}

const struct scene_kernels SIMD_NAME(mns_scene_kernels) = {.backdrop = backdrop};
