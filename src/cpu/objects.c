/* objects.c: the caller's opaque things in our own sky and on our own floor. */
#include "cpu/objects.h"

#include "cpu/shadow.h"

#include <math.h>

/* Part of the sun's light that comes into an object's shadow by way of the floor about it and of the object: about the product of their
 * reflectances. Without it shadows are as blue as the sky. */
static const float BOUNCE = 0.15f;

/* A point that a pixel's ray meets, in the terms of the light map. */
struct place {
    float u, v, height; /* texels; metres over the floor */
};

/* What is no number counts as none. */
static float number(float value) { return value > -1e15f && value < 1e15f ? value : 0; }

static float dot(const float a[3], const float b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* How pixels become places, told once per row. u = offset_u + per_u . q, likewise v. */
struct placing {
    const struct backdrop *b;
    const struct shadow *shadow; /* NULL: u and v are not asked for */
    float per_u[3], per_v[3], offset_u, offset_v, dy;
};

static struct placing placing_of(const struct backdrop *b, const struct shadow *shadow, const struct frame *frame, int y)
{
    const struct scene_look *look = &frame->look;
    const float *translation = frame->view.translation, *sun = look->sun;
    struct placing out = {.b = b, .shadow = shadow, .dy = ((float)y + 0.5f - b->cy) * b->step_y};
    if (shadow) {
        float per_metre = 1 / shadow->texel, lean_u = sun[look->axis_u] / sun[look->axis_up],
              lean_v = sun[look->axis_v] / sun[look->axis_up];
        for (int c = 0; c < 3; c++) {
            out.per_u[c] = (b->axis_u[c] - lean_u * b->sky.up[c]) * per_metre;
            out.per_v[c] = (b->axis_v[c] - lean_v * b->sky.up[c]) * per_metre;
        }
        out.offset_u = (lean_u * b->plane - dot(b->axis_u, translation) - shadow->min_u) * per_metre;
        out.offset_v = (lean_v * b->plane - dot(b->axis_v, translation) - shadow->min_v) * per_metre;
    }
    return out;
}

static struct place place_of(const struct placing *p, int x, float depth)
{
    float per_depth = p->b->orthographic ? 1 : depth, dx = ((float)x + 0.5f - p->b->cx) * p->b->step_x;
    const float q[3] = {dx * per_depth, p->dy * per_depth, depth};
    return (struct place){dot(p->per_u, q) + p->offset_u, dot(p->per_v, q) + p->offset_v, dot(p->b->sky.up, q) - p->b->plane};
}

/* Sine of the angle below the horizon at which a pixel's ray comes. */
static float fall_of(const struct placing *p, int x)
{
    float dx = ((float)x + 0.5f - p->b->cx) * p->b->step_x;
    const float ray[3] = {p->b->orthographic ? 0 : dx, p->b->orthographic ? 0 : p->dy, 1};
    return -dot(p->b->sky.up, ray) / sqrtf(dot(ray, ray));
}

/* Takes from the floor's colour what the objects keep away of the sun's and the sky's light. */
static void shade_floor(const struct placing *p, const struct place *at, float fall, const struct mns_object_pixel *object, float color[3])
{
    const struct backdrop *b = p->b;
    const struct shadow *shadow = p->shadow;
    float light[4] = {b->light_open[0], b->light_open[1], b->light_open[2], 0},
          sky[3] = {b->sky.sky_light[0], b->sky.sky_light[1], b->sky.sky_light[2]};
    if (shadow && at->u >= 0 && at->v >= 0 && at->u < (float)(shadow->width - 1) && at->v < (float)(shadow->height - 1)) {
        int column = (int)at->u, row = (int)at->v;
        float fu = at->u - (float)column, fv = at->v - (float)row;
        const float *texel = shadow->light + 4 * ((ptrdiff_t)row * shadow->width + column), *below = texel + 4 * (ptrdiff_t)shadow->width;
        for (int c = 0; c < 4; c++) {
            float top = texel[c] + fu * (texel[c + 4] - texel[c]), bottom = below[c] + fu * (below[c + 4] - below[c]);
            light[c] = top + fv * (bottom - top);
        }
        if (light[3] > 0) {
            mns_shadow_sky(shadow, light[3], sky);
        }
    }
    float clear = 1 - mns_floor_haze(fall);
    for (int c = 0; c < 3; c++) {
        float kept =
            (1 - object->floor_sun) * (1 - BOUNCE * object->floor_sky) * fmaxf(light[c] - sky[c], 0) + (1 - object->floor_sky) * sky[c];
        color[c] *= 1 - clear * fminf(kept / fmaxf(light[c], 1e-20f), 1);
    }
}

static void put(struct scene_image *scene, const struct placing *p, const struct mns_object_pixel *object, int x, int y)
{
    float *color = scene->color + 4 * (y * scene->stride + x), *depth = scene->depth.data + y * scene->depth.stride + x;
    if (*depth < DEPTH_LIMIT && (object->floor_sun < 1 || object->floor_sky < 1)) {
        struct place at = place_of(p, x, *depth);
        shade_floor(p, &at, fall_of(p, x), object, color);
    }
    if (object->color[3] > 0) {
        float sun[3] = {1, 1, 1}, covered = fminf(object->color[3], 1);
        bool sunlit = object->sunlit[0] + object->sunlit[1] + object->sunlit[2] > 0;
        if (p->shadow && sunlit && object->reach < DEPTH_LIMIT) {
            struct place at = place_of(p, x, object->reach);
            mns_shadow_at(p->shadow, at.u, at.v, at.height, sun);
        }
        for (int c = 0; c < 3; c++) {
            color[c] = (1 - covered) * color[c] + number(object->color[c]) + sun[c] * number(object->sunlit[c]);
        }
        color[3] = covered + (1 - covered) * color[3];
    }
    if (object->depth > 0 && object->depth < *depth) {
        *depth = object->depth;
    }
}

void mns_objects_row(struct backend *cpu, const struct frame *frame, const struct backdrop *backdrop, int y)
{
    const struct mns_objects *objects = frame->objects;
    const struct mns_object_pixel *row = objects->pixels + (ptrdiff_t)y * objects->width;
    const struct shadow *shadow = frame->params.shadow && cpu->stores[STORE_WATER].count > 0 ? cpu->scene.shadow : NULL;
    int begin = objects->spans ? objects->spans[2 * y] : 0, end = objects->spans ? objects->spans[2 * y + 1] : objects->width;
    const struct placing placing = placing_of(backdrop, shadow, frame, y);
    for (int x = begin; x < end; x++) {
        put(&cpu->scene, &placing, row + x, x, y);
    }
}
