/* shade.c: the kernels of stage shade over simd.h. */
#include "cpu/shade.h"

#include "cpu/plane.h"
#include "cpu/simd.h"
#include "cpu/simd/sky.h"

#include <string.h>

SIMD vf vf_neg(vf a) { return vf_zero() - a; }

SIMD vf vf_saturate(vf a) { return vf_clamp(a, vf_zero(), vf_set1(1.0f)); }

struct v3 {
    vf x, y, z;
};

SIMD vf v3_dot(struct v3 a, struct v3 b) { return vf_fma(a.x, b.x, vf_fma(a.y, b.y, a.z * b.z)); }

/* a + s b */
SIMD struct v3 v3_fma(vf s, struct v3 b, struct v3 a) { return (struct v3){vf_fma(s, b.x, a.x), vf_fma(s, b.y, a.y), vf_fma(s, b.z, a.z)}; }

SIMD struct v3 v3_scale(vf s, struct v3 a) { return (struct v3){s * a.x, s * a.y, s * a.z}; }

SIMD struct v3 v3_set(const float a[3]) { return (struct v3){vf_set1(a[0]), vf_set1(a[1]), vf_set1(a[2])}; }

/* Pixels x + 0 ... VLEN - 1, from the centre of the picture. */
SIMD vf columns(const struct shade_optics *o, int x) { return vf_iota() + vf_set1((float)x + 0.5f - o->cx); }

SIMD float rows(const struct shade_optics *o, int y) { return (float)y + 0.5f - o->cy; }

SIMD struct v3 rays(const struct shade_optics *o, int x, int y)
{
    if (o->orthographic) {
        return (struct v3){vf_zero(), vf_zero(), vf_set1(1.0f)};
    }
    vf dx = columns(o, x) * vf_set1(o->step_x), dy = vf_set1(rows(o, y) * o->step_y), one = vf_set1(1.0f);
    vf scale = vf_rsqrt(vf_fma(dx, dx, vf_fma(dy, dy, one)));
    return (struct v3){dx * scale, dy * scale, scale};
}

SIMD vm is_fluid(vf depth) { return vm_and(vf_gt(depth, vf_zero()), vf_lt(depth, vf_set1(DEPTH_LIMIT))); }

SIMD vf slope(vf before, vf here, vf after, vf edge, bool one_sided)
{
    vf far = vf_set1(DEPTH_EMPTY), back = vf_select(is_fluid(before), here - before, far),
       ahead = vf_select(is_fluid(after), after - here, far);
    vf back_size = vf_abs(back), ahead_size = vf_abs(ahead);
    vf smaller = vf_select(vf_lt(back_size, ahead_size), back, ahead);
    smaller = vf_keep(vf_le(vf_abs(smaller), edge), smaller);
    return vf_either(one_sided, smaller, vf_select(vf_le(vf_max(back_size, ahead_size), edge), vf_set1(0.5f) * (back + ahead), smaller));
}

static int normals(const struct shade_optics *o, const float *depth, ptrdiff_t stride, const float *scene_depth, int x, int y, int count,
                   float *nx, float *ny, float *nz)
{
    int found = 0;
    vf fx = vf_set1(o->fx), fy = vf_set1(o->fy), edge = vf_set1(o->edge), one = vf_set1(1.0f);
    vf widest_x = vf_set1(SHADE_SLOPE_MAX * o->step_x), widest_y = vf_set1(SHADE_SLOPE_MAX * o->step_y), row = vf_set1(rows(o, y));
    for (int i = 0; i < count; i += VLEN) {
        const float *at = depth + i;
        vf z = vf_loadu(at);
        vm here = vm_and(is_fluid(z), vm_first(count - i));
        if (scene_depth) {
            here = vm_and(here, vf_lt(z, vf_loadu(scene_depth + i)));
        }
        struct v3 n = {vf_zero(), vf_zero(), vf_zero()};
        unsigned bits = vm_bits(here);
        if (bits) {
            found += __builtin_popcount(bits);
            z = vf_select(here, z, one);
            vf per_z = vf_either(o->orthographic, one, z);
            vf zx = slope(vf_loadu(at - 1), z, vf_loadu(at + 1), vf_max(edge, per_z * widest_x), o->one_sided);
            vf zy = slope(vf_loadu(at - stride), z, vf_loadu(at + stride), vf_max(edge, per_z * widest_y), o->one_sided);
            vf depth_part = vf_either(o->orthographic, one, vf_fma(columns(o, x + i), zx, vf_fma(row, zy, z)));
            n = (struct v3){fx * zx, fy * zy, vf_neg(depth_part)};
            vf scale = vf_keep(here, vf_rsqrt(v3_dot(n, n)));
            n = v3_scale(scale, n);
        }
        vf_storeu(nx + i, n.x);
        vf_storeu(ny + i, n.y);
        vf_storeu(nz + i, n.z);
    }
    return found;
}

SIMD vf normal_slope(vf before, vf here, vf after, vm has_before, vm has_after)
{
    vf sum = vf_keep(has_before, here - before) + vf_keep(has_after, after - here);
    return vf_select(vm_and(has_before, has_after), vf_set1(0.5f), vf_set1(1.0f)) * sum;
}

SIMD vm together(vf here, vf other, vf edge) { return vm_and(is_fluid(other), vf_le(vf_abs(other - here), edge)); }

static void curvature(const struct shade_optics *o, const struct shade_normals *normals, const float *depth, ptrdiff_t stride, int x, int y,
                      int count, float *out)
{
    vf edge = vf_set1(o->edge), one = vf_set1(1.0f), ray_y = vf_set1(o->orthographic ? 0 : rows(o, y) * o->step_y);
    for (int i = 0; i < count; i += VLEN) {
        const float *at = depth + i;
        vf z = vf_loadu(at);
        vm here = is_fluid(z);
        z = vf_select(here, z, one);
        vf per_z = vf_either(o->orthographic, one, z);
        vf edge_x = vf_max(edge, per_z * vf_set1(SHADE_SLOPE_MAX * o->step_x)),
           edge_y = vf_max(edge, per_z * vf_set1(SHADE_SLOPE_MAX * o->step_y));
        vm left = together(z, vf_loadu(at - 1), edge_x), right = together(z, vf_loadu(at + 1), edge_x);
        vm above = together(z, vf_loadu(at - stride), edge_y), below = together(z, vf_loadu(at + stride), edge_y);
        vf along_x[3], along_y[3];
        for (int c = 0; c < 3; c++) {
            const float *row = normals->n[1][c] + i;
            vf n = vf_loadu(row);
            along_x[c] = normal_slope(vf_loadu(row - 1), n, vf_loadu(row + 1), left, right);
            along_y[c] = normal_slope(vf_loadu(normals->n[0][c] + i), n, vf_loadu(normals->n[2][c] + i), above, below);
        }
        vf ray_x = vf_either(o->orthographic, vf_zero(), columns(o, x + i) * vf_set1(o->step_x));
        vf sum = vf_fma(vf_set1(o->fx), vf_fnma(ray_x, along_x[2], along_x[0]), vf_set1(o->fy) * vf_fnma(ray_y, along_y[2], along_y[1]));
        vf_storeu(out + i, vf_keep(here, vf_set1(0.5f) * vf_rcp(per_z) * sum));
    }
}

SIMD vf fresnel(const struct shade_optics *o, vf cosine)
{
    vf one = vf_set1(1.0f);
    if (o->schlick) {
        float normal = (o->index - 1) / (o->index + 1) * (o->index - 1) / (o->index + 1);
        vf rest = one - cosine, rest2 = rest * rest;
        return vf_fma(vf_set1(1 - normal) * rest2 * rest2, rest, vf_set1(normal));
    }
    vf g = vf_root(vf_max(vf_fma(cosine, cosine, vf_set1(o->index * o->index - 1)), vf_set1(1e-24f)));
    vf a = (g - cosine) * vf_rcp(vf_max(g + cosine, vf_set1(1e-12f)));
    vf b = vf_fma(cosine, g + cosine, vf_neg(one)) * vf_rcp(vf_fma(cosine, g - cosine, one));
    return vf_set1(0.5f) * a * a * vf_fma(b, b, one);
}

SIMD vf mirror(vf at, float last)
{
    vf end = vf_set1(last);
    at = vf_abs(at);
    return vf_clamp(vf_select(vf_gt(at, end), end + end - at, at), vf_zero(), end);
}

SIMD struct v3 row_normals(const struct shade_row *row, int i)
{
    return (struct v3){vf_loadu(row->nx + i), vf_loadu(row->ny + i), vf_loadu(row->nz + i)};
}

SIMD void look_up(const struct shade_optics *o, struct shade_row *row, int i, struct v3 n, struct v3 v, vf cosine)
{
    float inverse = 1 / o->index;
    vf one = vf_set1(1.0f),
       inside = vf_root(vf_max(vf_fnma(vf_set1(inverse * inverse), vf_fnma(cosine, cosine, one), one), vf_set1(1e-12f)));
    vf z = vf_loadu(row->depth + i), travel = vf_set1(o->refraction) * vf_loadu(row->thickness + i) * cosine * vf_rcp(inside);
    struct v3 ray = v3_fma(vf_fma(vf_set1(inverse), cosine, vf_neg(inside)), n, v3_scale(vf_set1(inverse), v));
    vf per_z = vf_either(o->orthographic, one, z), across = columns(o, row->x + i) * vf_set1(o->step_x) * per_z;
    vf down = vf_set1(rows(o, row->y) * o->step_y) * per_z;
    struct v3 far = v3_fma(travel, ray, (struct v3){across, down, z});
    vf per_far = vf_either(o->orthographic, one, vf_rcp(vf_max(far.z, vf_set1(0.5f) * z)));
    vf look_x = vf_fma(vf_set1(o->fx) * far.x, per_far, vf_set1(o->cx - 0.5f));
    vf look_y = vf_fma(vf_set1(o->fy) * far.y, per_far, vf_set1(o->cy - 0.5f));
    vf_storeu(row->look_x + i, mirror(look_x, (float)(o->width - 1)));
    vf_storeu(row->look_y + i, mirror(look_y, (float)(o->height - 1)));
}

/* e^-(extinction * thickness) */
SIMD vf through_of(vf extinction, vf thickness) { return vf_exp(vf_neg(vf_min(extinction * thickness, vf_set1(80.0f)))); }

SIMD vf absorption_of(const struct shade_optics *o, bool has_color, const struct shade_row *row, int i, int c)
{
    vf absorption = vf_set1(o->absorption[c]);
    if (has_color) {
        vf color = vf_saturate(vf_loadu(row->color[c] + i));
        absorption = vf_set1(o->absorption_mean * SHADE_TINT) * (vf_set1(SHADE_TINT_LEAST + 1) - color);
    }
    return absorption;
}

static void optics(const struct shade_optics *o, bool has_color, struct shade_row *row)
{
    for (int i = 0; i < row->count; i += VLEN) {
        struct v3 n = row_normals(row, i);
        if (!vm_any(vf_lt(vf_zero(), v3_dot(n, n)))) {
            continue;
        }
        struct v3 v = rays(o, row->x + i, row->y);
        vf cosine = vf_saturate(vf_neg(v3_dot(n, v))), thickness = vf_loadu(row->thickness + i);
        vf_storeu(row->fresnel + i, fresnel(o, cosine));
        for (int c = 0; c < 3; c++) {
            vf_storeu(row->transmittance[c] + i, through_of(absorption_of(o, has_color, row, i, c), thickness));
        }
        look_up(o, row, i, n, v, cosine);
    }
}

/* The left one of the texels about `at`, which is within [0, size - 1] or anything where no fluid is. */
SIMD vf first_tap(vf at, int size)
{
    int last = size - 2;
    return vf_clamp(vf_floor(at), vf_zero(), vf_set1((float)(last > 0 ? last : 0)));
}

/* Whether anything at (x, y) stands before depth. */
SIMD bool hidden(const struct shade_optics *o, float x, float y, float depth)
{
    int left = (int)x, top = (int)y, last_left = o->width - 2, last_top = o->height - 2;
    left = left < last_left ? left : last_left > 0 ? last_left : 0;
    top = top < last_top ? top : last_top > 0 ? last_top : 0;
    const float *d = o->scene_depth + top * o->scene_depth_stride + left, *e = d + (o->height > 1) * o->scene_depth_stride;
    ptrdiff_t right = o->width > 1;
    return d[0] < depth || d[right] < depth || e[0] < depth || e[right] < depth;
}

/* Lookups that would see what stands before the fluid go back towards their own pixels. */
static void draw_back(const struct shade_optics *o, struct shade_row *row)
{
    for (int i = 0; i < row->count; i++) {
        float x = (float)(row->x + i), y = (float)row->y;
        for (int tries = 0; row->nz[i] != 0 && tries < 3 && hidden(o, row->look_x[i], row->look_y[i], row->depth[i]); tries++) {
            row->look_x[i] = tries < 2 ? x + 0.5f * (row->look_x[i] - x) : x;
            row->look_y[i] = tries < 2 ? y + 0.5f * (row->look_y[i] - y) : y;
        }
    }
}

SIMD bool is_any_fluid(const struct shade_row *row, int i) { return vm_any(vf_lt(vf_zero(), vf_abs(vf_loadu(row->nz + i)))); }

static void fetch(const struct shade_optics *o, struct shade_row *row)
{
    if (o->scene_depth) {
        draw_back(o, row);
    }
    const ptrdiff_t below = 4 * o->scene_stride;
    int32_t texel[SHADE_SPAN];
    float into_x[SHADE_SPAN], into_y[SHADE_SPAN];
    for (int i = 0; i < row->count; i += VLEN) {
        vf x = vf_loadu(row->look_x + i), y = vf_loadu(row->look_y + i), left = first_tap(x, o->width), top = first_tap(y, o->height);
        vi_storeu(texel + i, vi_add(vi_mul(vf_truncate(top), vi_set1((int)o->scene_stride)), vf_truncate(left)));
        vf_storeu(into_x + i, x - left);
        vf_storeu(into_y + i, y - top);
        for (int k = i; is_any_fluid(row, i) && k < i + VLEN; k++) { /* waves send neighbours anywhere */
            simd_prefetch(o->scene + 4 * (ptrdiff_t)texel[k]);
            simd_prefetch(o->scene + 4 * (ptrdiff_t)texel[k] + below);
        }
    }
    for (int begin = 0; begin < row->count; begin += VLEN) {
        for (int i = begin; is_any_fluid(row, begin) && i < begin + VLEN; i++) {
            const float *first = o->scene + 4 * (ptrdiff_t)texel[i];
            v4_storeu(row->behind + 4 * i, v4_bilinear(first, first + below, into_x[i], into_y[i]));
        }
    }
}

/* Beyond these the highlight is under 1e-7 of the light. */
static const float GLINT_NOTHING = -28.0f;

SIMD vf highlight(const struct shade_optics *o, struct v3 n, struct v3 v, vf cosine)
{
    struct v3 sun = v3_set(o->sky.sun), between = {sun.x - v.x, sun.y - v.y, sun.z - v.z};
    vf one = vf_set1(1.0f), scale = vf_rsqrt(vf_max(v3_dot(between, between), vf_set1(1e-12f)));
    vf half_cosine = vf_saturate(v3_dot(between, n) * scale), towards = v3_dot(sun, n), shininess = vf_set1(o->shininess);
    vm lit = vm_and(vf_gt(towards, vf_zero()), vf_gt(shininess * (half_cosine - one), vf_set1(GLINT_NOTHING))); /* ln c <= c - 1 */
    lit = vm_and(lit, vf_gt(half_cosine, vf_zero()));
    if (!vm_any(lit)) {
        return vf_zero();
    }
    vf power = vf_exp(vf_max(shininess * vf_log(vf_select(lit, half_cosine, one)), vf_set1(-80.0f)));
    vf seen = vf_saturate(towards * vf_set1(SHADE_SUNSET)) * vf_rcp(vf_max(cosine, vf_set1(SHADE_GRAZING)));
    vf reflectance = fresnel(o, vf_saturate(v3_dot(between, sun) * scale));
    return vf_keep(lit, vf_set1(o->specular * 0.125f * (o->shininess + 2)) * power * reflectance * seen);
}

SIMD vf reflected(const struct shade_optics *o, const struct shade_row *row, int i, struct v3 n, struct v3 v, vf cosine, vf out[3])
{
    struct v3 r = v3_fma(cosine + cosine, n, v);
    vf height = vf_dot(o->sky.up, r.x, r.y, r.z);
    if (!o->has_mirrored) {
        sky_radiance(&o->sky, height, sky_sun_distance2(&o->sky, r.x, r.y, r.z), out);
        return height;
    }
    for (int c = 0; c < 3; c++) {
        out[c] = vf_loadu(row->mirrored[c] + i);
    }
    return height;
}

/* Stores out where fluid is and the pixels' own scene elsewhere. */
SIMD void store_over(const struct shade_optics *o, struct shade_row *row, int i, vm fluid, vf out[4])
{
    if (!vm_all(fluid)) {
        vf own[4];
        vf_load_rgba(o->scene + 4 * (row->y * o->scene_stride + row->x + i), own);
        for (int c = 0; c < 4; c++) {
            out[c] = vf_select(fluid, out[c], own[c]);
        }
    }
    for (int c = 0; c < 4; c++) {
        vf_storeu(row->out[c] + i, out[c]);
    }
}

/* Straight colour and alpha of fluid before nothing: covers is what it hides, alpha makes room for what it adds. */
SIMD void over_nothing(vf covers, vf out[4])
{
    vf one = vf_set1(1.0f);
    out[3] = vf_max(covers, vf_min(vf_max(out[0], vf_max(out[1], out[2])), one));
    vf scale = vf_rcp(vf_max(out[3], vf_set1(1e-6f)));
    for (int c = 0; c < 3; c++) {
        out[c] = out[c] * scale;
    }
}

static void veil(const struct shade_optics *o, struct shade_row *row)
{
    for (int i = 0; i < row->count; i += VLEN) {
        vm fluid = vf_lt(vf_zero(), vf_abs(vf_loadu(row->nz + i)));
        vf before = vf_clamp(vf_loadu(row->before + i), vf_zero(), vf_loadu(row->thickness + i));
        vf all = vf_loadu(row->foam + i), front = vf_loadu(row->foam_range + i), rest = vf_max(all - front, vf_zero()), one = vf_set1(1.0f);
        vf veil = through_of(vf_set1(o->foam_extinction), all), hides = one - through_of(vf_set1(o->foam_extinction), front);
        vf thin = hides * through_of(vf_set1(o->foam_range_extinction), front);
        thin = vf_fma(one - veil - hides, through_of(vf_set1(o->foam_range_extinction), rest), thin);
        vf_storeu(row->veil + i, veil);
        vf_storeu(row->thin + i, thin / vf_max(one - veil, vf_set1(1e-6f)));
        vf_storeu(row->before + i, vf_keep(fluid, before));
    }
}

/* b where t is 1. */
SIMD vf mix(vf a, vf b, vf t) { return vf_fma(t, b - a, a); }

SIMD vf foam_radiance(const struct shade_optics *o, const struct shade_row *row, int i, int c)
{
    return vf_fma(vf_set1(o->foam_back[c] - o->foam_front[c]), vf_loadu(row->thin + i), vf_set1(o->foam_front[c]));
}

/* layers_at of the plain C. */
SIMD vf layers_at(const struct shade_optics *o, bool has_color, const struct shade_row *row, int i, int c, vf behind, vf scatter,
                  vf surface, vf enters)
{
    vf absorption = absorption_of(o, has_color, row, i, c), before = vf_loadu(row->before + i), foam = foam_radiance(o, row, i, c);
    vf front = through_of(absorption, before), veil = vf_loadu(row->veil + i), through = vf_loadu(row->transmittance[c] + i);
    vf past = through * (behind - scatter), lit = mix(foam, scatter, veil);
    vf wet = vf_fma(enters, vf_fma(front, lit - scatter, vf_fma(past, veil, scatter)), surface);
    vf dry = mix(foam, vf_fma(enters, scatter + past, surface), veil);
    vf share = (vf_loadu(row->foam_depth + i) - vf_loadu(row->depth + i)) * vf_set1(1 / o->foam_blend) + vf_set1(0.5f);
    return mix(dry, wet, vf_saturate(share));
}

/* Where no water is: foam over the pixels' own scene. */
SIMD void put_foam(const struct shade_optics *o, struct shade_row *row, int i, vm where)
{
    vf veil = vf_loadu(row->veil + i), over = vf_set1(1.0f) - veil, own[4];
    for (int c = 0; c < 4; c++) {
        own[c] = vf_loadu(row->out[c] + i);
    }
    vf through = veil * own[3], alpha = through + over, per_alpha = vf_rcp(vf_max(alpha, vf_set1(1e-20f)));
    for (int c = 0; c < 3; c++) {
        vf color = vf_fma(own[c], through, foam_radiance(o, row, i, c) * over) * per_alpha;
        vf_storeu(row->out[c] + i, vf_select(where, color, own[c]));
    }
    vf_storeu(row->out[3] + i, vf_select(where, alpha, own[3]));
}

SIMD void water_at(const struct shade_optics *o, bool has_color, vm foam, const struct shade_row *row, int i, struct v3 n, vf out[4])
{
    struct v3 v = rays(o, row->x + i, row->y);
    vf one = vf_set1(1.0f), cosine = vf_saturate(vf_neg(v3_dot(n, v))), shine = vf_loadu(row->fresnel + i), enters = one - shine,
       covers = vf_zero();
    vf glint = highlight(o, n, v, cosine), mirrored[3], behind[4] = {vf_zero(), vf_zero(), vf_zero(), vf_zero()};
    vf below = vf_clamp(vf_set1(-SHADE_BELOW) * reflected(o, row, i, n, v, cosine, mirrored), vf_zero(), vf_set1(SHADE_BELOW_MOST));
    shine = shine * vf_set1(o->reflection);
    if (o->transparent) {
        below = vf_zero();
    } else {
        vf_load_rgba(row->behind + 4 * i, behind);
    }
    for (int c = 0; c < 3; c++) {
        vf through = vf_loadu(row->transmittance[c] + i), scatter = vf_set1(o->scatter[c]);
        if (has_color) {
            scatter = vf_set1(o->scatter_light[c]) * vf_saturate(vf_loadu(row->color[c] + i));
        }
        vf body = vf_fma(through, behind[c] - scatter, scatter);
        mirrored[c] = vf_fma(below, vf_min(behind[c] - mirrored[c], vf_zero()), mirrored[c]);
        vf surface = vf_fma(shine, mirrored[c], glint * vf_set1(o->sky.sun_light[c]));
        out[c] = vf_fma(enters, body, surface);
        if (vm_any(foam)) {
            out[c] = vf_select(foam, layers_at(o, has_color, row, i, c, behind[c], scatter, surface, enters), out[c]);
            through = through * vf_select(foam, vf_loadu(row->veil + i), one);
        }
        covers = vf_fma(vf_fnma(enters, through, one), vf_set1(1 / 3.0f), covers);
    }
    out[3] = one;
    if (o->transparent) {
        over_nothing(covers, out);
    }
}

static void split(const float *rgba, int count, float planes[4][SHADE_SPAN])
{
    for (int i = 0; i < count; i += VLEN) {
        vf channels[4];
        vf_load_rgba(rgba + 4 * i, channels);
        for (int c = 0; c < 4; c++) {
            vf_storeu(planes[c] + i, channels[c]);
        }
    }
}

SIMD void shade_water(const struct shade_optics *o, bool has_color, bool has_foam, struct shade_row *row)
{
    for (int i = 0; i < row->count; i += VLEN) {
        struct v3 n = row_normals(row, i);
        vm inside = vm_first(row->count - i), fluid = vm_and(vf_lt(vf_zero(), v3_dot(n, n)), inside), foam = vm_first(0);
        if (has_foam) {
            foam = vm_and(inside, vf_lt(vf_zero(), vf_loadu(row->foam + i)));
        }
        vf out[4] = {vf_zero(), vf_zero(), vf_zero(), vf_zero()};
        if (vm_any(fluid)) {
            water_at(o, has_color, foam, row, i, n, out);
        }
        store_over(o, row, i, fluid, out);
        vm alone = vm_and(foam, vm_not(fluid));
        if (has_foam && vm_any(alone)) {
            put_foam(o, row, i, alone);
        }
    }
}

static void water(const struct shade_optics *o, bool has_color, struct shade_row *row) { shade_water(o, has_color, false, row); }

static void layered(const struct shade_optics *o, bool has_color, struct shade_row *row) { shade_water(o, has_color, true, row); }

/* The light that a white surface scatters back, of the sun and of the sky about it. */
SIMD void white_light(const struct shade_optics *o, struct v3 n, vf out[3])
{
    const struct sky *sky = &o->sky;
    vf half = vf_set1(0.5f), sun = vf_max(v3_dot(n, v3_set(sky->sun)), vf_zero()), up = vf_fma(half, v3_dot(n, v3_set(sky->up)), half);
    for (int c = 0; c < 3; c++) {
        vf below = vf_set1(0.5f * sky->ground[c]), ambient = vf_fma(up, vf_set1(sky->sky_light[c]) - below, below);
        out[c] = vf_fma(sun, vf_set1(sky->sun_light[c]), ambient);
    }
}

static void opaque(const struct shade_optics *o, bool has_color, struct shade_row *row)
{
    for (int i = 0; i < row->count; i += VLEN) {
        struct v3 n = row_normals(row, i), v = rays(o, row->x + i, row->y);
        vm fluid = vm_and(vf_lt(vf_zero(), v3_dot(n, n)), vm_first(row->count - i));
        vf cosine = vf_saturate(vf_neg(v3_dot(n, v))), shine = fresnel(o, cosine) * vf_set1(o->reflection), mirrored[3], light[3], out[4];
        reflected(o, row, i, n, v, cosine, mirrored);
        white_light(o, n, light);
        vf glint = highlight(o, n, v, cosine);
        for (int c = 0; c < 3; c++) {
            vf albedo = vf_set1(o->opaque[c]);
            if (has_color) {
                albedo = vf_saturate(vf_loadu(row->color[c] + i));
            }
            out[c] = vf_fma(albedo, light[c], vf_fma(shine, mirrored[c], glint * vf_set1(o->sky.sun_light[c])));
        }
        out[3] = vf_set1(1.0f);
        store_over(o, row, i, fluid, out);
    }
}

static void grey(const struct shade_optics *o, struct shade_row *row)
{
    for (int i = 0; i < row->count; i += VLEN) {
        struct v3 n = row_normals(row, i);
        vf part = vf_keep(vm_and(vf_lt(vf_zero(), v3_dot(n, n)), vm_first(row->count - i)), vf_loadu(row->grey + i));
        vm some = vf_gt(part, vf_zero());
        if (!vm_any(some)) {
            continue;
        }
        vf rest = (vf_set1(1) - part) * vf_loadu(row->out[3] + i), covers = part + rest;
        vf scale = vf_rcp(vf_select(some, covers, vf_set1(1)));
        for (int c = 0; c < 3; c++) {
            vf out = vf_loadu(row->out[c] + i), mixed = vf_fma(part, vf_set1(o->grey[c]), rest * out) * scale;
            vf_storeu(row->out[c] + i, vf_select(some, mixed, out));
        }
        vf_storeu(row->out[3] + i, covers);
    }
}

/* 1.055 a^(1 / 2.4) - 0.055 for a from the curve's foot to 1, within 4e-6. With t = a^(1/4), a^(1 / 2.4) = t^(5/3) has no sharp bend there: a
 * polynomial of the sixth degree, fitted for the least largest error, is within 1.4e-6. */
SIMD vf srgb_curve(vf a)
{
    vf q = vf_rsqrt_estimate(a * vf_rsqrt_estimate(a)), q2 = q * q; /* a^(-1/4), within 6e-4 */
    q = q * vf_fnma(vf_set1(0.25f) * a * q2, q2, vf_set1(1.25f));   /* one Newton step: 1e-6 */
    vf t = a * q * (q * q), p = vf_set1(0.0682078075f);
    p = vf_fma(p, t, vf_set1(-0.318415362f));
    p = vf_fma(p, t, vf_set1(0.657187365f));
    p = vf_fma(p, t, vf_set1(-0.85295676f));
    p = vf_fma(p, t, vf_set1(1.36592077f));
    p = vf_fma(p, t, vf_set1(0.139604192f));
    return vf_fma(p, t, vf_set1(-0.0595466132f));
}

/* A channel of VLEN pixels as a code from 0 to 1. */
SIMD vf code_of(const float *values, float gain, bool is_color)
{
    vf foot = vf_set1(0.0031308f), value = vf_saturate(vf_loadu(values) * vf_set1(gain));
    if (!is_color) {
        return value;
    }
    return vf_select(vf_le(value, foot), vf_set1(12.92f) * value, vf_min(srgb_curve(vf_max(value, foot)), vf_set1(1.0f)));
}

SIMD void encode_floats(float planes[4][SHADE_SPAN], int count, float gain, int channels, float *out)
{
    for (int i = 0; i < count; i++) {
        for (int c = 0; c < channels; c++) {
            out[channels * i + c] = planes[c][i] * (c < 3 ? gain : 1);
        }
    }
}

/* Four bytes or words a pixel, to count rounded up to VLEN. */
SIMD void encode_codes(float planes[4][SHADE_SPAN], int count, float gain, enum pixel_meaning meaning, uint8_t *bytes, uint16_t *words)
{
    vf top = vf_set1(bytes ? 255.0f : 65535.0f), half = vf_set1(0.5f);
    for (int i = 0; i < count; i += VLEN) {
        vf code[4];
        for (int c = 0; c < 4; c++) {
            code[c] = vf_fma(code_of(planes[c] + i, c < 3 ? gain : 1, c < 3 && meaning == PIXEL_COLOR), top, half);
        }
        if (bytes) {
            vi red_green = vi_or(vf_truncate(code[0]), vi_shl(vf_truncate(code[1]), 8));
            vi blue_alpha = vi_or(vf_truncate(code[2]), vi_shl(vf_truncate(code[3]), 8));
            vi pixels = vi_or(red_green, vi_shl(blue_alpha, 16));
            memcpy(bytes + 4 * i, &pixels, sizeof(pixels));
            continue;
        }
        vf_transpose_4(code);
        vf_lanes_together(code);
        for (int c = 0; c < 4; c++) {
            vi_store_u16(words + 4 * i + c * VLEN, vf_truncate(code[c]));
        }
    }
}

static void encode(float planes[4][SHADE_SPAN], int count, float gain, enum pixel_meaning meaning, enum mns_pixel pixel, int channels,
                   void *out)
{
    uint16_t words[4 * SHADE_SPAN]; /* the caller's row must not be written beyond its end */
    uint8_t bytes[4 * SHADE_SPAN];
    const char *from = (const char *)words;
    size_t size = sizeof(words[0]);
    if (pixel == MNS_PIXEL_F32) {
        encode_floats(planes, count, gain, channels, out);
        return;
    }
    if (pixel == MNS_PIXEL_U8) {
        encode_codes(planes, count, gain, meaning, bytes, NULL);
        from = (const char *)bytes;
        size = sizeof(bytes[0]);
    } else {
        encode_codes(planes, count, gain, meaning, NULL, words);
    }
    if (channels == 4) {
        memcpy(out, from, 4 * size * (size_t)count);
        return;
    }
    for (int i = 0; i < count; i++) {
        memcpy((char *)out + 3 * size * (size_t)i, from + 4 * size * (size_t)i, 3 * size);
    }
}

const struct shade_kernels SIMD_NAME(mns_shade_kernels) = {.normals = normals,
                                                           .curvature = curvature,
                                                           .optics = optics,
                                                           .fetch = fetch,
                                                           .water = water,
                                                           .veil = veil,
                                                           .layered = layered,
                                                           .opaque = opaque,
                                                           .grey = grey,
                                                           .split = split,
                                                           .encode = encode};
