/* reference.c: the true surface of a scene at every pixel. */
#include "reference.h"

#include "vector.h"

#include <stdlib.h>
#include <string.h>

static const double BORDER = 3 * 1.2; /* r */
static const double APART = 6;        /* spacings: bodies are farther apart along their silhouettes (scene.c) */

static size_t pixel_count(const struct lab_view *view) { return (size_t)view->width * (size_t)view->height; }

/* The depth that parts the foremost body from what is behind it along a ray; 0 where that is no farther, as a tilted plane is below a
 * drop. */
static double split_of(const struct lab_scene *scene, const double ray[3], const struct lab_offsets *offsets)
{
    if (scene->bodies < 2) {
        return INFINITY;
    }
    double behind = lab_body_hit(&scene->body[0], ray, offsets->body[0]).depth;
    double before = -scene->body[1].origin[2];
    return behind - before > APART ? 0.5 * (behind + before) : 0;
}

/* What is measured at a pixel where depth_raw is `raw`; body -1: nothing. */
static struct lab_hit measured_hit(const struct lab_scene *scene, const double ray[3], double raw, double split,
                                   const struct lab_offsets *offsets)
{
    struct lab_hit hit = lab_scene_hit(scene, ray, offsets);
    bool inside = hit.depth > scene->depths[0] && hit.depth < scene->depths[1] && isfinite(raw);
    bool agree = scene->bodies < 2 || (raw < split) == (hit.body == 1);
    hit.body = inside && agree ? hit.body : -1;
    return hit;
}

/* One step towards the offsets: what depth_raw is away from the surface now, by bodies, on every fourth pixel both ways. */
static void improve_offsets(struct lab_offsets *offsets, const struct lab_scene *scene, const struct lab_view *view, const float *raw,
                            double radius)
{
    enum { STEP = 4 };
    double sum[LAB_BODIES] = {0}, count[LAB_BODIES] = {0};
    for (int y = 0; y < view->height; y += STEP) {
        for (int x = 0; x < view->width; x += STEP) {
            double ray[3], depth = (double)raw[(size_t)y * (size_t)view->width + (size_t)x];
            lab_view_ray(view, x, y, ray);
            struct lab_hit hit = measured_hit(scene, ray, depth, split_of(scene, ray, offsets), offsets);
            bool front = hit.body == scene->bodies - 1;
            if (hit.body < 0 || (front && lab_scene_silhouette(scene, view, x, y, offsets) < radius * view->focal / hit.depth)) {
                continue;
            }
            sum[hit.body] += (hit.depth - depth) * hit.cosine;
            count[hit.body]++;
        }
    }
    for (int i = 0; i < scene->bodies; i++) {
        offsets->body[i] += count[i] > 0 ? sum[i] / count[i] : 0;
    }
}

static bool allocate(struct lab_reference *out, size_t pixels)
{
    out->body = malloc(pixels * sizeof(*out->body));
    out->depth = malloc(pixels * sizeof(*out->depth));
    out->normal = malloc(pixels * sizeof(*out->normal));
    out->cosine = malloc(pixels * sizeof(*out->cosine));
    out->silhouette = malloc(pixels * sizeof(*out->silhouette));
    out->split = malloc(pixels * sizeof(*out->split));
    return out->body && out->depth && out->normal && out->cosine && out->silhouette && out->split;
}

static void fill_pixel(struct lab_reference *out, int x, int y, double raw)
{
    size_t i = (size_t)y * (size_t)out->view.width + (size_t)x;
    double ray[3];
    lab_view_ray(&out->view, x, y, ray);
    double split = split_of(&out->scene, ray, &out->offsets);
    struct lab_hit hit = measured_hit(&out->scene, ray, raw, split, &out->offsets);
    out->body[i] = (int8_t)hit.body;
    out->depth[i] = (float)hit.depth;
    out->cosine[i] = (float)hit.cosine;
    out->silhouette[i] = (float)lab_scene_silhouette(&out->scene, &out->view, x, y, &out->offsets);
    out->split[i] = (float)split;
    for (int k = 0; k < 3; k++) {
        out->normal[i][k] = (float)hit.normal[k];
    }
}

bool lab_reference_fill(struct lab_reference *out, const struct lab_scene *scene, const struct lab_view *view, const float *raw,
                        double radius, const struct lab_offsets *offsets)
{
    *out = (struct lab_reference){.scene = *scene, .view = *view, .offsets = *offsets, .radius = radius};
    if (!allocate(out, pixel_count(view))) {
        return false;
    }
    for (int y = 0; y < view->height; y++) {
        for (int x = 0; x < view->width; x++) {
            fill_pixel(out, x, y, (double)raw[(size_t)y * (size_t)view->width + (size_t)x]);
        }
    }
    return true;
}

bool lab_reference_make(struct lab_reference *out, const struct lab_scene *scene, const struct lab_view *view, const float *raw,
                        double radius)
{
    enum { ROUNDS = 4 }; /* each leaves a tenth of what was wrong, or less */
    struct lab_offsets offsets;
    for (int i = 0; i < LAB_BODIES; i++) {
        offsets.body[i] = 0.5 * radius;
    }
    for (int i = 0; i < ROUNDS; i++) {
        improve_offsets(&offsets, scene, view, raw, radius);
    }
    return lab_reference_fill(out, scene, view, raw, radius, &offsets);
}

void lab_reference_free(struct lab_reference *reference)
{
    free(reference->body);
    free(reference->depth);
    free(reference->normal);
    free(reference->cosine);
    free(reference->silhouette);
    free(reference->split);
    memset(reference, 0, sizeof(*reference));
}

bool lab_reference_is_told(const struct lab_reference *reference, size_t pixel)
{
    if (reference->body[pixel] < 0) {
        return false;
    }
    return !lab_reference_is_front(reference, pixel) ||
           (double)reference->silhouette[pixel] >= lab_reference_pixels(reference, pixel, reference->radius);
}

bool lab_reference_at_border(const struct lab_reference *reference, size_t pixel)
{
    size_t width = (size_t)reference->view.width, height = (size_t)reference->view.height, x = pixel % width, y = pixel / width;
    size_t across = x < width - 1 - x ? x : width - 1 - x, down = y < height - 1 - y ? y : height - 1 - y;
    return (double)(across < down ? across : down) < lab_reference_pixels(reference, pixel, BORDER * reference->radius);
}

bool lab_reference_counts(const struct lab_reference *reference, size_t pixel)
{
    return lab_reference_is_told(reference, pixel) && !lab_reference_at_border(reference, pixel);
}

double lab_reference_silhouette_length(const struct lab_reference *reference)
{
    const struct lab_body *front = &reference->scene.body[reference->scene.bodies - 1];
    double offset = reference->offsets.body[reference->scene.bodies - 1];
    if (front->shape == LAB_SPHERE) {
        return 2 * LAB_PI * reference->view.focal * tan(asin((front->radius + offset) / length(front->origin)));
    }
    return reference->view.height; /* the edge of a block stands upright */
}
