/* reference.h: the true surface of a scene at every pixel.
 *
 * A set of spheres has its surface an offset above the centres of its outermost particles, which no closed form knows. So the closed form is moved
 * outwards, along its normal, by the scene's own mean offset of depth_raw; one offset for each body. Drift is then what a filter moves the
 * surface, and deviation is measured apart from it. */
#ifndef MENISCUS_LAB_REFERENCE_H
#define MENISCUS_LAB_REFERENCE_H

#include "scene.h"

#include <stdint.h>

/* Planes of [height][width]. */
struct lab_reference {
    struct lab_scene scene;
    struct lab_view view;
    struct lab_offsets offsets;
    double radius; /* R, spacings */
    int8_t *body;  /* that is seen there, by closed form and depth_raw alike; -1: they differ, or nothing is measured there */
    float *depth;  /* spacings */
    float (*normal)[3];
    float *cosine;     /* of the angle between the ray, of unit depth, and the surface's normal */
    float *silhouette; /* pixels inside the foremost body's silhouette; negative: outside; INFINITY: the scene has none */
    float *split;      /* what is nearer belongs to the foremost body */
};

/* Estimates the offsets, and fills the planes. raw: depth_raw as drawn. false: out of memory. lab_reference_free may always be called. */
bool lab_reference_make(struct lab_reference *out, const struct lab_scene *scene, const struct lab_view *view, const float *raw,
                        double radius);

/* The same with known offsets. */
bool lab_reference_fill(struct lab_reference *out, const struct lab_scene *scene, const struct lab_view *view, const float *raw,
                        double radius, const struct lab_offsets *offsets);
void lab_reference_free(struct lab_reference *reference);

/* Whether a pixel is near the picture's edge, where filters do without half of the surface: within 3 sigma of a flow of 1.2 r. */
bool lab_reference_at_border(const struct lab_reference *reference, size_t pixel);

/* Whether a pixel's surface can be told from the closed form: on the foremost body from R inside its silhouette on, nearer to which even exact
 * spheres turn away from it. */
bool lab_reference_is_told(const struct lab_reference *reference, size_t pixel);

/* Whether errors are measured at a pixel: told, and not at the border, which has a measure of its own. */
bool lab_reference_counts(const struct lab_reference *reference, size_t pixel);

/* Whether the body that parts a silhouette is the one at a pixel. */
static inline bool lab_reference_is_front(const struct lab_reference *reference, size_t pixel)
{
    return reference->body[pixel] == reference->scene.bodies - 1;
}

/* Pixels that a length spans at a pixel's own depth. */
static inline double lab_reference_pixels(const struct lab_reference *reference, size_t pixel, double spacings)
{
    return spacings * reference->view.focal / (double)reference->depth[pixel];
}

/* Length of the silhouette that parts two bodies, or a body and nothing, in pixels. */
double lab_reference_silhouette_length(const struct lab_reference *reference);

#endif
