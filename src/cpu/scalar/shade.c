/* shade.c: the kernels of stage shade in plain C. */
#include "cpu/shade.h"

#include "cpu/plane.h"
#include "cpu/scalar/sky.h"

#include <string.h>

static float clamp(float a, float low, float high) { return a > low ? a < high ? a : high : low; }

static float dot(const float a[3], const float b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* Unit direction of the ray through a pixel. */
static void ray_of(const struct shade_optics *o, int x, int y, float out[3])
{
    if (o->orthographic) {
        out[0] = out[1] = 0;
        out[2] = 1;
        return;
    }
    float dx = ((float)x + 0.5f - o->cx) * o->step_x, dy = ((float)y + 0.5f - o->cy) * o->step_y;
    float scale = 1 / sqrtf(dx * dx + dy * dy + 1);
    out[0] = dx * scale;
    out[1] = dy * scale;
    out[2] = scale;
}

static bool is_fluid(float depth) { return depth > 0 && depth < DEPTH_LIMIT; }

/* Difference of depth per pixel; edge: the largest between neighbours that belong together. */
static float slope(float before, float here, float after, float edge, bool one_sided)
{
    bool has_before = is_fluid(before), has_after = is_fluid(after);
    float back = has_before ? here - before : INFINITY, ahead = has_after ? after - here : INFINITY;
    if (!one_sided && fabsf(back) <= edge && fabsf(ahead) <= edge) {
        return 0.5f * (back + ahead);
    }
    float smaller = fabsf(back) < fabsf(ahead) ? back : ahead;
    return fabsf(smaller) <= edge ? smaller : 0; /* neither neighbour belongs here: facing the eye */
}

static int normals(const struct shade_optics *o, const float *depth, ptrdiff_t stride, const float *scene_depth, int x, int y, int count,
                   float *nx, float *ny, float *nz)
{
    int found = 0;
    for (int i = 0; i < count; i++) {
        float z = depth[i];
        nx[i] = ny[i] = nz[i] = 0;
        if (!is_fluid(z) || (scene_depth && !(z < scene_depth[i]))) {
            continue;
        }
        found++;
        float per_z = o->orthographic ? 1 : z, footprint = per_z * SHADE_SLOPE_MAX;
        float zx = slope(depth[i - 1], z, depth[i + 1], fmaxf(o->edge, footprint * o->step_x), o->one_sided);
        float zy = slope(depth[i - stride], z, depth[i + stride], fmaxf(o->edge, footprint * o->step_y), o->one_sided);
        /* With P = z (X / fx, Y / fy, 1), dP/dx x dP/dy ~ (-fx zx, -fy zy, z + X zx + Y zy): [LGS09] eq. 4 with the terms it drops. */
        float across = o->orthographic ? 0 : ((float)(x + i) + 0.5f - o->cx) * zx + ((float)y + 0.5f - o->cy) * zy;
        float n[3] = {o->fx * zx, o->fy * zy, -(per_z + across)};
        float scale = 1 / sqrtf(dot(n, n));
        nx[i] = n[0] * scale;
        ny[i] = n[1] * scale;
        nz[i] = n[2] * scale;
    }
    return found;
}

/* Difference of one component of the normal per pixel, over the neighbours that belong together. */
static float normal_slope(float before, float here, float after, bool has_before, bool has_after)
{
    float back = has_before ? here - before : 0, ahead = has_after ? after - here : 0;
    return has_before && has_after ? 0.5f * (back + ahead) : back + ahead;
}

static void curvature(const struct shade_optics *o, const struct shade_normals *normals, const float *depth, ptrdiff_t stride, int x, int y,
                      int count, float *out)
{
    for (int i = 0; i < count; i++) {
        float z = depth[i];
        out[i] = 0;
        if (!is_fluid(z)) {
            continue;
        }
        float per_z = o->orthographic ? 1 : z, footprint = per_z * SHADE_SLOPE_MAX;
        float edge_x = fmaxf(o->edge, footprint * o->step_x), edge_y = fmaxf(o->edge, footprint * o->step_y);
        bool left = is_fluid(depth[i - 1]) && fabsf(z - depth[i - 1]) <= edge_x,
             right = is_fluid(depth[i + 1]) && fabsf(depth[i + 1] - z) <= edge_x;
        bool above = is_fluid(depth[i - stride]) && fabsf(z - depth[i - stride]) <= edge_y;
        bool below = is_fluid(depth[i + stride]) && fabsf(depth[i + stride] - z) <= edge_y;
        float along_x[3], along_y[3];
        for (int c = 0; c < 3; c++) {
            const float *above_row = normals->n[0][c], *here = normals->n[1][c], *below_row = normals->n[2][c];
            along_x[c] = normal_slope(here[i - 1], here[i], here[i + 1], left, right);
            along_y[c] = normal_slope(above_row[i], here[i], below_row[i], above, below);
        }
        /* 2 H = div n, with n carried along the rays: a pixel is fx X / Z, so d/dX = fx / z d/dx and d/dZ = -(X / z) d/dX - (Y / z) d/dY. */
        float ray_x = o->orthographic ? 0 : ((float)(x + i) + 0.5f - o->cx) * o->step_x;
        float ray_y = o->orthographic ? 0 : ((float)y + 0.5f - o->cy) * o->step_y;
        out[i] = 0.5f / per_z * (o->fx * (along_x[0] - ray_x * along_x[2]) + o->fy * (along_y[1] - ray_y * along_y[2]));
    }
}

/* Part of unpolarised light that a surface of index n reflects. */
static float fresnel_exact(float cosine, float n)
{
    float g = sqrtf(fmaxf(n * n - 1 + cosine * cosine, 0)), a = (g - cosine) / fmaxf(g + cosine, 1e-12f);
    float b = (cosine * (g + cosine) - 1) / (cosine * (g - cosine) + 1);
    return 0.5f * a * a * (1 + b * b);
}

static float fresnel(const struct shade_optics *o, float cosine)
{
    if (!o->schlick) {
        return fresnel_exact(cosine, o->index);
    }
    float normal = (o->index - 1) / (o->index + 1), rest = 1 - cosine;
    normal *= normal;
    return normal + (1 - normal) * (rest * rest) * (rest * rest) * rest;
}

/* A lookup beyond the picture's edge is mirrored into it. */
static float mirror(float at, float last)
{
    at = fabsf(at);
    return clamp(at > last ? 2 * last - at : at, 0, last);
}

/* Where the refracted ray leaves the fluid: it crosses a slab as thick as the fluid is there, across the surface. */
static void look_up(const struct shade_optics *o, struct shade_row *row, int i, const float v[3], float cosine)
{
    const float n[3] = {row->nx[i], row->ny[i], row->nz[i]};
    float inverse = 1 / o->index, inside = sqrtf(1 - inverse * inverse * (1 - cosine * cosine));
    float z = row->depth[i], travel = o->refraction * row->thickness[i] * cosine / inside;
    float bend = inverse * cosine - inside, far[3];
    float ray_z = o->orthographic ? 1 : v[2];
    float at_x = (float)(row->x + i), at_y = (float)row->y;
    const float hit[3] = {o->orthographic ? (at_x + 0.5f - o->cx) * o->step_x : v[0] / ray_z * z,
                          o->orthographic ? (at_y + 0.5f - o->cy) * o->step_y : v[1] / ray_z * z, z};
    for (int c = 0; c < 3; c++) {
        far[c] = hit[c] + travel * (inverse * v[c] + bend * n[c]);
    }
    float per_z = o->orthographic ? 1 : 1 / fmaxf(far[2], 0.5f * z);
    row->look_x[i] = mirror(o->cx + o->fx * far[0] * per_z - 0.5f, (float)(o->width - 1));
    row->look_y[i] = mirror(o->cy + o->fy * far[1] * per_z - 0.5f, (float)(o->height - 1));
}

static void optics(const struct shade_optics *o, bool has_color, struct shade_row *row)
{
    for (int i = 0; i < row->count; i++) {
        if (row->nz[i] == 0) {
            continue;
        }
        const float n[3] = {row->nx[i], row->ny[i], row->nz[i]};
        float v[3];
        ray_of(o, row->x + i, row->y, v);
        float cosine = clamp(-dot(n, v), 0, 1);
        row->fresnel[i] = fresnel(o, cosine);
        for (int c = 0; c < 3; c++) {
            float absorption =
                has_color ? o->absorption_mean * SHADE_TINT * (SHADE_TINT_LEAST + 1 - clamp(row->color[c][i], 0, 1)) : o->absorption[c];
            row->transmittance[c][i] = expf(-fminf(absorption * row->thickness[i], 80));
        }
        look_up(o, row, i, v, cosine);
    }
}

/* Bilinear at (x, y); false, and nothing said, when anything there stands before depth. */
static bool scene_at(const struct shade_optics *o, float x, float y, float depth, float out[4])
{
    int left = (int)x, top = (int)y;
    left = left < o->width - 2 ? left : o->width - 2 > 0 ? o->width - 2 : 0;
    top = top < o->height - 2 ? top : o->height - 2 > 0 ? o->height - 2 : 0;
    float fx = x - (float)left, fy = y - (float)top;
    ptrdiff_t right = o->width > 1, below = o->height > 1;
    if (o->scene_depth) {
        const float *d = o->scene_depth + top * o->scene_depth_stride + left;
        const float *e = d + below * o->scene_depth_stride;
        if (d[0] < depth || d[right] < depth || e[0] < depth || e[right] < depth) {
            return false;
        }
    }
    const float *a = o->scene + 4 * (top * o->scene_stride + left), *b = a + 4 * below * o->scene_stride;
    for (int c = 0; c < 4; c++) {
        float upper = a[c] + fx * (a[4 * right + c] - a[c]), lower = b[c] + fx * (b[4 * right + c] - b[c]);
        out[c] = upper + fy * (lower - upper);
    }
    return true;
}

static void fetch(const struct shade_optics *o, struct shade_row *row)
{
    for (int i = 0; i < row->count; i++) {
        float x = (float)(row->x + i), y = (float)row->y, *out = row->behind + 4 * i;
        bool found = row->nz[i] == 0;
        for (float part = 1; !found && part > 0.2f; part *= 0.5f) { /* three tries towards the pixel */
            found = scene_at(o, x + part * (row->look_x[i] - x), y + part * (row->look_y[i] - y), row->depth[i], out);
        }
        for (int c = 0; c < 4 && !found; c++) {
            out[c] = o->scene[4 * (row->y * o->scene_stride + row->x + i) + c];
        }
    }
}

/* The sun in the surface: a normalised power of the half-vector's cosine ([LGS09] eq. 13), with the reflectance at that half-vector. */
static float highlight(const struct shade_optics *o, const float n[3], const float v[3], float cosine)
{
    const float *sun = o->sky.sun;
    const float between[3] = {sun[0] - v[0], sun[1] - v[1], sun[2] - v[2]};
    float scale = 1 / sqrtf(fmaxf(dot(between, between), 1e-12f)), towards = dot(sun, n);
    float half_cosine = clamp(dot(between, n) * scale, 0, 1), sun_cosine = clamp(dot(between, sun) * scale, 0, 1);
    if (!(towards > 0) || !(half_cosine > 0)) {
        return 0;
    }
    float power = expf(fmaxf(o->shininess * logf(half_cosine), -80));
    float seen = clamp(towards * SHADE_SUNSET, 0, 1) / fmaxf(cosine, SHADE_GRAZING);
    return o->specular * 0.125f * (o->shininess + 2) * power * fresnel(o, sun_cosine) * seen;
}

/* The sky, or the ground, in the direction that the surface reflects. Returns that direction's height. */
static float reflected(const struct shade_optics *o, const struct shade_row *row, int i, const float n[3], const float v[3], float cosine,
                       float out[3])
{
    const float r[3] = {v[0] + 2 * cosine * n[0], v[1] + 2 * cosine * n[1], v[2] + 2 * cosine * n[2]};
    float height = dot(r, o->sky.up);
    if (!o->has_mirrored) {
        sky_radiance(&o->sky, height, sky_sun_distance2(&o->sky, r), out);
    }
    for (int c = 0; c < 3 && o->has_mirrored; c++) {
        out[c] = row->mirrored[c][i];
    }
    return height;
}

static void put(struct shade_row *row, int i, const float color[4])
{
    for (int c = 0; c < 4; c++) {
        row->out[c][i] = color[c];
    }
}

/* What the surface does at a pixel, whatever is below it. */
struct surface {
    float n[3], cosine;        /* towards the eye, and of the angle to it */
    float mirrored[3], height; /* radiance that is reflected, and the height of the direction it comes from */
    float glint;
};

/* false: no fluid is there, and the pixel shows its own scene. */
static bool meet_surface(const struct shade_optics *o, struct shade_row *row, int i, struct surface *out)
{
    if (row->nz[i] == 0) {
        put(row, i, o->scene + 4 * (row->y * o->scene_stride + row->x + i));
        return false;
    }
    const float n[3] = {row->nx[i], row->ny[i], row->nz[i]};
    float v[3];
    ray_of(o, row->x + i, row->y, v);
    memcpy(out->n, n, sizeof(n));
    out->cosine = clamp(-dot(n, v), 0, 1);
    out->height = reflected(o, row, i, n, v, out->cosine, out->mirrored);
    out->glint = highlight(o, n, v, out->cosine);
    return true;
}

static void veil(const struct shade_optics *o, struct shade_row *row)
{
    for (int i = 0; i < row->count; i++) {
        float front = row->foam_range[i], rest = fmaxf(row->foam[i] - front, 0), hides[2], thin[2];
        row->veil[i] = expf(-fminf(o->foam_extinction * row->foam[i], 80));
        hides[0] = 1 - expf(-fminf(o->foam_extinction * front, 80));
        hides[1] = 1 - row->veil[i] - hides[0];
        thin[0] = expf(-fminf(o->foam_range_extinction * front, 80));
        thin[1] = expf(-fminf(o->foam_range_extinction * rest, 80));
        row->thin[i] = (hides[0] * thin[0] + hides[1] * thin[1]) / fmaxf(1 - row->veil[i], 1e-6f);
        row->before[i] = row->nz[i] != 0 ? clamp(row->before[i], 0, row->thickness[i]) : 0;
    }
}

/* What the foam itself adds where it hides everything, of one channel. Thick front foam shows the front colour: the lerp printed in [BSW10] 5.3 is the other
 * way round. */
static float foam_radiance(const struct shade_optics *o, const struct shade_row *row, int i, int c)
{
    return o->foam_front[c] + (o->foam_back[c] - o->foam_front[c]) * row->thin[i];
}

/* Foam alone, over the pixel's own scene. */
static void put_foam(const struct shade_optics *o, struct shade_row *row, int i)
{
    const float *scene = o->scene + 4 * (row->y * o->scene_stride + row->x + i);
    float through = row->veil[i] * scene[3], alpha = through + 1 - row->veil[i], out[4] = {0, 0, 0, alpha};
    for (int c = 0; c < 3 && alpha > 0; c++) {
        out[c] = (scene[c] * through + foam_radiance(o, row, i, c) * (1 - row->veil[i])) / alpha;
    }
    put(row, i, out);
}

/* Light that comes to the eye through the water and its foam, and what the surface at the pixel adds; in *covers what is hidden of the scene. */
static float layers_at(const struct shade_optics *o, bool has_color, const struct shade_row *row, int i, int c, float behind, float scatter,
                       float surface, float *covers)
{
    float through = row->transmittance[c][i], enters = 1 - row->fresnel[i], veil = row->veil[i], foam = foam_radiance(o, row, i, c);
    float absorption =
        has_color ? o->absorption_mean * SHADE_TINT * (SHADE_TINT_LEAST + 1 - clamp(row->color[c][i], 0, 1)) : o->absorption[c];
    /* [BSW10] eq. 7 to 9 written out: what is behind comes through both waters and the foam, and exp(-T_wf) exp(-T_wb) is that of all water. */
    float front = expf(-fminf(absorption * row->before[i], 80)), lit = foam + (scatter - foam) * veil;
    float wet = enters * (scatter + (lit - scatter) * front + (behind - scatter) * through * veil) + surface; /* eq. 10 */
    float dry = (enters * (scatter + (behind - scatter) * through) + surface) * veil + foam * (1 - veil); /* the foam before the water */
    float share = clamp(0.5f + (row->foam_depth[i] - row->depth[i]) / o->foam_blend, 0, 1);
    *covers = 1 - enters * through * veil;
    return dry + share * (wet - dry);
}

static void shade_water(const struct shade_optics *o, bool has_color, bool has_foam, struct shade_row *row)
{
    for (int i = 0; i < row->count; i++) {
        struct surface at;
        if (!meet_surface(o, row, i, &at)) {
            if (has_foam && row->foam[i] > 0) {
                put_foam(o, row, i);
            }
            continue;
        }
        float out[4], enters = 1 - row->fresnel[i], covers = 0, largest = 0;
        float below = clamp(-SHADE_BELOW * at.height, 0, SHADE_BELOW_MOST);
        for (int c = 0; c < 3; c++) {
            float through = row->transmittance[c][i], behind = o->transparent ? 0 : row->behind[4 * i + c];
            float mirrored = at.mirrored[c] + (o->transparent ? 0 : below * fminf(behind - at.mirrored[c], 0));
            float scatter = has_color ? o->scatter_light[c] * clamp(row->color[c][i], 0, 1) : o->scatter[c];
            /* [LGS09] eq. 14 with a coefficient per channel, then eq. 13. */
            float body = behind * through + scatter * (1 - through), hidden = 1 - enters * through;
            out[c] = enters * body + o->reflection * row->fresnel[i] * mirrored + at.glint * o->sky.sun_light[c];
            if (has_foam && row->foam[i] > 0) {
                float surface = o->reflection * row->fresnel[i] * mirrored + at.glint * o->sky.sun_light[c];
                out[c] = layers_at(o, has_color, row, i, c, behind, scatter, surface, &hidden);
            }
            covers += hidden * (1 / 3.0f);
            largest = fmaxf(largest, out[c]);
        }
        /* Without a background what the fluid adds is all there is; alpha makes room for it, so that no colour is above 1 that need not be. */
        float alpha = o->transparent ? fmaxf(covers, fminf(largest, 1)) : 1;
        for (int c = 0; c < 3 && o->transparent; c++) {
            out[c] /= fmaxf(alpha, 1e-6f);
        }
        out[3] = alpha;
        put(row, i, out);
    }
}

static void water(const struct shade_optics *o, bool has_color, struct shade_row *row) { shade_water(o, has_color, false, row); }

static void layered(const struct shade_optics *o, bool has_color, struct shade_row *row) { shade_water(o, has_color, true, row); }

/* The light that a white surface scatters back, of the sun and of the sky about it. */
static void white_light(const struct shade_optics *o, const float n[3], float out[3])
{
    float sun = fmaxf(dot(n, o->sky.sun), 0), up = 0.5f + 0.5f * dot(n, o->sky.up);
    for (int c = 0; c < 3; c++) {
        out[c] = sun * o->sky.sun_light[c] + o->sky.ground[c] * 0.5f + up * (o->sky.sky_light[c] - o->sky.ground[c] * 0.5f);
    }
}

static void opaque(const struct shade_optics *o, bool has_color, struct shade_row *row)
{
    for (int i = 0; i < row->count; i++) {
        struct surface at;
        if (!meet_surface(o, row, i, &at)) {
            continue;
        }
        float out[4], light[3], shine = fresnel(o, at.cosine) * o->reflection;
        white_light(o, at.n, light);
        for (int c = 0; c < 3; c++) {
            float albedo = has_color ? clamp(row->color[c][i], 0, 1) : o->opaque[c];
            out[c] = albedo * light[c] + shine * at.mirrored[c] + at.glint * o->sky.sun_light[c];
        }
        out[3] = 1;
        put(row, i, out);
    }
}

static void grey(const struct shade_optics *o, struct shade_row *row)
{
    for (int i = 0; i < row->count; i++) {
        float part = row->nz[i] != 0 ? row->grey[i] : 0, rest = (1 - part) * row->out[3][i];
        if (!(part > 0)) {
            continue;
        }
        for (int c = 0; c < 3; c++) {
            row->out[c][i] = (part * o->grey[c] + rest * row->out[c][i]) / (part + rest);
        }
        row->out[3][i] = part + rest;
    }
}

/* Linear to sRGB, 0 to 1. */
static float srgb(float linear) { return linear <= 0.0031308f ? 12.92f * linear : 1.055f * powf(linear, 1 / 2.4f) - 0.055f; }

static void split(const float *rgba, int count, float planes[4][SHADE_SPAN])
{
    for (int i = 0; i < 4 * count; i++) {
        planes[i % 4][i / 4] = rgba[i];
    }
}

static void encode(float planes[4][SHADE_SPAN], int count, float gain, enum pixel_meaning meaning, enum mns_pixel pixel, int channels,
                   void *out)
{
    for (int i = 0; i < count; i++) {
        for (int c = 0; c < channels; c++) {
            int at = channels * i + c;
            float value = planes[c][i] * (c < 3 ? gain : 1);
            if (pixel == MNS_PIXEL_F32) {
                ((float *)out)[at] = value;
                continue;
            }
            float code = clamp(value, 0, 1);
            code = c < 3 && meaning == PIXEL_COLOR ? srgb(code) : code;
            if (pixel == MNS_PIXEL_U8) {
                ((uint8_t *)out)[at] = (uint8_t)(code * 255 + 0.5f);
            } else {
                ((uint16_t *)out)[at] = (uint16_t)(code * 65535 + 0.5f);
            }
        }
    }
}

const struct shade_kernels mns_shade_kernels_scalar = {.normals = normals,
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
