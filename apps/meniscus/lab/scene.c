/* scene.c: the scenes, and rays against them. */
#include "scene.h"

#include "vector.h"

#include <string.h>

static const double FIELD_OF_VIEW = 30; /* degrees */

/* Everything that parts drop, step and ground lies farther apart than any filter's range of depths: 10 R is 6 spacings. */
static const double DROP_BEFORE = 16, DROP_RADIUS = 5, STEP_HEIGHT = 12;
static const double SPHERE_PART = 0.8; /* of half the picture's height that the large sphere fills */
static const double WAVES_TILT = 30;   /* degrees */

struct lab_view lab_view_make(int width, int height)
{
    double focal = 0.5 * height / tan(0.5 * radians(FIELD_OF_VIEW));
    return (struct lab_view){.width = width, .height = height, .focal = focal, .cx = 0.5 * width, .cy = 0.5 * height};
}

struct lab_view lab_view_shift(const struct lab_view *view, double right, double down)
{
    struct lab_view shifted = *view;
    shifted.cx += right;
    shifted.cy += down;
    return shifted;
}

mns_result lab_view_camera(const struct lab_view *view, struct mns_camera *out)
{
    static const double near_plane = 0.1, far_plane = 1e5;
    double scale = near_plane / view->focal;
    mns_camera_init(out, view->width, view->height);
    return mns_camera_frustum(out, -view->cx * scale, (view->width - view->cx) * scale, (view->cy - view->height) * scale, view->cy * scale,
                              near_plane, far_plane);
}

void lab_view_ray(const struct lab_view *view, int x, int y, double out[3])
{
    out[0] = (x + 0.5 - view->cx) / view->focal;
    out[1] = (view->cy - y - 0.5) / view->focal;
    out[2] = -1;
}

/* ---- the scenes ---- */

/* A plane, block or waves through (0, 0, -depth), tilted so that its top leans away. */
static struct lab_body flat_body(enum lab_shape shape, double depth, double tilt)
{
    double c = cos(radians(tilt)), s = sin(radians(tilt));
    return (struct lab_body){.shape = shape, .origin = {0, 0, -depth}, .u = {1, 0, 0}, .v = {0, c, -s}, .w = {0, s, c}};
}

static struct lab_body sphere_body(double depth, double radius)
{
    struct lab_body body = flat_body(LAB_SPHERE, depth, 0);
    body.radius = radius;
    return body;
}

static void make_plane(struct lab_scene *scene, double tilt) { scene->body[0] = flat_body(LAB_PLANE, scene->distance, tilt); }

static void make_sphere(struct lab_scene *scene, double across)
{
    double sine = sin(atan(SPHERE_PART * across)); /* of the angle under which the radius is seen */
    scene->body[0] = sphere_body(scene->distance, scene->distance * sine);
}

static void make_step(struct lab_scene *scene, double unused)
{
    (void)unused;
    scene->body[0] = flat_body(LAB_PLANE, scene->distance, 0);
    scene->body[1] = flat_body(LAB_BLOCK, scene->distance - STEP_HEIGHT, 0);
    scene->bodies = 2;
}

static void make_drop(struct lab_scene *scene, double tilt)
{
    scene->body[0] = flat_body(LAB_PLANE, scene->distance, tilt);
    scene->body[1] = sphere_body(scene->distance - DROP_BEFORE, DROP_RADIUS);
    scene->bodies = 2;
}

static void make_waves(struct lab_scene *scene, double factor)
{
    scene->distance *= factor;
    scene->body[0] = flat_body(LAB_WAVES, scene->distance, WAVES_TILT);
}

static const struct {
    const char *name, *text;
    unsigned tells;
    void (*make)(struct lab_scene *scene, double argument);
    double argument;
} scenes[] = {
    {"plane-0", "a plane across the view axis", LAB_TELLS_BUMPS, make_plane, 0},
    {"plane-45", "a plane tilted by 45 degrees", LAB_TELLS_BUMPS | LAB_TELLS_FLICKER, make_plane, 45},
    {"plane-70", "a plane tilted by 70 degrees", LAB_TELLS_BUMPS, make_plane, 70},
    {"plane-80", "a plane tilted by 80 degrees", LAB_TELLS_BUMPS | LAB_TELLS_FLICKER, make_plane, 80},
    {"sphere", "a large sphere before nothing", LAB_TELLS_BUMPS | LAB_TELLS_EDGE | LAB_TELLS_RIM, make_sphere, 0},
    {"step", "a plane that ends before another", LAB_TELLS_EDGE | LAB_TELLS_BESIDE, make_step, 0},
    {"drop-0", "a drop before a plane across the view axis", LAB_TELLS_EDGE | LAB_TELLS_BESIDE | LAB_TELLS_RIM, make_drop, 0},
    {"drop-45", "a drop before a plane tilted by 45 degrees", LAB_TELLS_EDGE | LAB_TELLS_BESIDE | LAB_TELLS_RIM | LAB_TELLS_FLICKER,
     make_drop, 45},
    {"waves-near", "a sum of sines, at half the distance", LAB_TELLS_BUMPS, make_waves, 0.5},
    {"waves", "a sum of sines", LAB_TELLS_BUMPS | LAB_TELLS_FLICKER, make_waves, 1},
    {"waves-far", "a sum of sines, at twice the distance", LAB_TELLS_BUMPS, make_waves, 2},
};

enum { SCENES = sizeof(scenes) / sizeof(scenes[0]) };

int lab_scene_count(void) { return SCENES; }

const char *lab_scene_name(int index) { return index >= 0 && index < SCENES ? scenes[index].name : NULL; }

const char *lab_scene_text(int index) { return index >= 0 && index < SCENES ? scenes[index].text : NULL; }

int lab_scene_find(const char *name)
{
    for (int i = 0; i < SCENES; i++) {
        if (!strcmp(name, scenes[i].name)) {
            return i;
        }
    }
    return -1;
}

void lab_scene_make(struct lab_scene *out, int index, const struct lab_view *view)
{
    double across = 0.5 * view->height / view->focal;
    *out = (struct lab_scene){.name = scenes[index].name,
                              .text = scenes[index].text,
                              .tells = scenes[index].tells,
                              .bodies = 1,
                              .distance = view->focal / LAB_SPACING_PIXELS};
    scenes[index].make(out, scenes[index].make == make_sphere ? across : scenes[index].argument);
    out->depths[0] = 0.5 * out->distance; /* a plane tilted by 80 degrees reaches the horizon */
    out->depths[1] = 2 * out->distance;
}

/* ---- rays ---- */

static const struct lab_hit NOWHERE = {.body = -1, .depth = INFINITY};

static struct lab_hit hit_at(double depth, const double normal[3], const double ray[3])
{
    return (struct lab_hit){.body = 0, .depth = depth, .normal = {normal[0], normal[1], normal[2]}, .cosine = -dot(normal, ray)};
}

static struct lab_hit hit_plane(const struct lab_body *body, const double ray[3], double offset)
{
    double facing = dot(body->w, ray), depth = (dot(body->w, body->origin) + offset) / facing;
    if (facing >= 0 || depth <= 0) {
        return NOWHERE;
    }
    double point[3] = {depth * ray[0], depth * ray[1], depth * ray[2]};
    add_scaled(point, point, -1, body->origin);
    bool beyond = body->shape == LAB_BLOCK && dot(point, body->u) > offset; /* its side lies along the view axis and is never seen */
    return beyond ? NOWHERE : hit_at(depth, body->w, ray);
}

static struct lab_hit hit_sphere(const struct lab_body *body, const double ray[3], double offset)
{
    double radius = body->radius + offset, a = dot(ray, ray), b = dot(ray, body->origin), c = dot(body->origin, body->origin);
    double inside = b * b - a * (c - radius * radius);
    if (inside <= 0) {
        return NOWHERE;
    }
    double depth = (b - sqrt(inside)) / a, normal[3];
    for (int k = 0; k < 3; k++) {
        normal[k] = (depth * ray[k] - body->origin[k]) / radius;
    }
    return hit_at(depth, normal, ray);
}

/* Waves of 26 to 11 spacings, no steeper than 20 degrees: water, of which a filter of a few spacings should leave most. */
static const struct {
    double u, v, phase, height; /* radians per spacing; radians; spacings */
} sines[] = {
    {0.20, 0.14, 0.3, 0.55},
    {-0.19, 0.31, 1.9, 0.30},
    {0.51, 0.24, 4.1, 0.13},
};

enum { SINES = sizeof(sines) / sizeof(sines[0]) };

void lab_waves(double u, double v, double out[3])
{
    out[0] = out[1] = out[2] = 0;
    for (int i = 0; i < SINES; i++) {
        double angle = sines[i].u * u + sines[i].v * v + sines[i].phase, slope = sines[i].height * cos(angle);
        out[0] += sines[i].height * sin(angle);
        out[1] += sines[i].u * slope;
        out[2] += sines[i].v * slope;
    }
}

/* A point of the waves moved by offset along its normal is S = (u, v, h) + offset n. Newton's method along the ray, with the plane that
 * touches at S; then (u, v) is moved to where S would be on the ray. */
static struct lab_hit hit_waves(const struct lab_body *body, const double ray[3], double offset)
{
    enum { STEPS_MAX = 50 };
    static const double enough = 1e-10; /* spacings */
    struct lab_hit base = hit_plane(body, ray, offset);
    if (base.body < 0) {
        return NOWHERE;
    }
    double depth = base.depth, u = 0, v = 0, away = INFINITY, moved = INFINITY, normal[3] = {0};
    for (int i = 0; i < STEPS_MAX && (fabs(away) > enough || moved > enough); i++) {
        double point[3] = {depth * ray[0], depth * ray[1], depth * ray[2]}, wave[3];
        add_scaled(point, point, -1, body->origin);
        double next_u = dot(point, body->u) - offset * dot(normal, body->u), next_v = dot(point, body->v) - offset * dot(normal, body->v);
        moved = fabs(next_u - u) + fabs(next_v - v);
        u = next_u;
        v = next_v;
        lab_waves(u, v, wave);
        for (int k = 0; k < 3; k++) {
            normal[k] = body->w[k] - wave[1] * body->u[k] - wave[2] * body->v[k];
        }
        normalise(normal);
        double surface[3];
        add_scaled(surface, body->origin, u, body->u);
        add_scaled(surface, surface, v, body->v);
        add_scaled(surface, surface, wave[0], body->w);
        away = dot(normal, surface) + offset - depth * dot(normal, ray);
        depth += away / dot(normal, ray);
    }
    return hit_at(depth, normal, ray);
}

struct lab_hit lab_body_hit(const struct lab_body *body, const double ray[3], double offset)
{
    return body->shape == LAB_SPHERE  ? hit_sphere(body, ray, offset)
           : body->shape == LAB_WAVES ? hit_waves(body, ray, offset)
                                      : hit_plane(body, ray, offset);
}

struct lab_hit lab_scene_hit(const struct lab_scene *scene, const double ray[3], const struct lab_offsets *offsets)
{
    struct lab_hit nearest = NOWHERE;
    for (int i = 0; i < scene->bodies; i++) {
        struct lab_hit hit = lab_body_hit(&scene->body[i], ray, offsets->body[i]);
        if (hit.depth < nearest.depth) {
            nearest = hit;
            nearest.body = i;
        }
    }
    return nearest;
}

double lab_scene_silhouette(const struct lab_scene *scene, const struct lab_view *view, int x, int y, const struct lab_offsets *offsets)
{
    int front = scene->bodies - 1;
    const struct lab_body *body = &scene->body[front];
    double ray[3], offset = offsets->body[front];
    lab_view_ray(view, x, y, ray);
    if (body->shape == LAB_BLOCK) { /* its edge stands at u = offset, upright */
        double depth = -body->origin[2] - offset;
        return view->focal * (offset / depth - ray[0]);
    }
    if (body->shape != LAB_SPHERE) {
        return INFINITY;
    }
    double away = length(body->origin), angle = acos(fmin(dot(ray, body->origin) / (length(ray) * away), 1));
    return view->focal * (tan(asin((body->radius + offset) / away)) - tan(angle)); /* spheres stand in the middle of the picture */
}
