/* measure.h: what is measured on a smoothed surface, each with its definition.
 *
 * Depth errors are measured across the surface: the error of the depth times the cosine of the angle under which the surface is seen, so that
 * they mean the same at every tilt. Lengths are in r, multiples of the splat radius R. */
#ifndef MENISCUS_LAB_MEASURE_H
#define MENISCUS_LAB_MEASURE_H

#include "reference.h"

enum lab_measure {
    LAB_DRIFT,         /* mean depth error: positive away from the eye */
    LAB_DEPTH_RMS,     /* root of the mean square of the depth error */
    LAB_DEPTH_WORST,   /* largest depth error, either way */
    LAB_NORMAL_MEDIAN, /* angle between the normal and the true one: the median over the pixels */
    LAB_NORMAL_95,     /* the same: 95 % of the pixels are better */
    LAB_BUMPS,   /* root mean square of the normal's deviation that is left when what is smooth over 1.5 spacings (a sigma) is taken out */
    LAB_STREAKS, /* the same deviation's directions: 1 all along the picture's axes, 0 no direction preferred, -1 along the diagonals */
    LAB_EDGE,    /* pixels that the silhouette moved: those that are on another side of it than in depth_raw, over its length */
    LAB_BESIDE_DEPTH,   /* root mean square of the depth error of the surface within 3 sigma, at sigma 0.7 r, beside the silhouette */
    LAB_BESIDE_NORMAL,  /* the median error of the normal there */
    LAB_RIM,            /* curvature of the sphere within 3 sigma of its rim, times its radius: 1 is right, 0 flat */
    LAB_BORDER,         /* error of the normal within 3.6 r of the picture's edge, which all other measures leave out: 95 % are better */
    LAB_DISTANCE,       /* part of the bumps that is left at half the distance over the part that is left at twice the distance */
    LAB_FLICKER_DEPTH,  /* root mean square change of the depth error when everything moves by a third of a pixel, moved back */
    LAB_FLICKER_NORMAL, /* the same of the normal */
    LAB_MS,             /* milliseconds of stage smooth: the least of some draws */
    LAB_MEASURES
};

struct lab_measure_info {
    const char *name; /* as in JSON and CSV */
    const char *head; /* of a column */
    const char *unit;
    const char *help;
};
extern const struct lab_measure_info lab_measures[LAB_MEASURES];

/* A value for each measure; NAN: means nothing in the scene. */
struct lab_values {
    double of[LAB_MEASURES];
};
struct lab_values lab_values_none(void);

/* How a picture's surface deviates from the true one. Planes of [height][width]; 0 where reference->body is -1. */
struct lab_residual {
    const struct lab_reference *reference; /* borrowed */
    float *error;                          /* r, across the surface; positive away from the eye */
    float *turn[3];                        /* the normal less the true one */
};

/* depth [height][width], normal [height][width][3]: layers as drawn. false: out of memory. lab_residual_free may always be called. */
bool lab_residual_make(struct lab_residual *out, const struct lab_reference *reference, const float *depth, const float *normal);
void lab_residual_free(struct lab_residual *residual);

/* Sets the measures that one picture gives and its scene tells. raw, depth: layers as drawn. false: out of memory. */
bool lab_measure(const struct lab_residual *residual, const float *raw, const float *depth, struct lab_values *out);

/* Sets the flicker between two pictures of which `to` is moved by so many pixels to the right and down. */
void lab_measure_flicker(const struct lab_residual *from, const struct lab_residual *to, double right, double down, struct lab_values *out);

#endif
