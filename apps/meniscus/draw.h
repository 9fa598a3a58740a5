/* draw.h: one picture from particles. */
#ifndef MENISCUS_DRAW_H
#define MENISCUS_DRAW_H

#include "diffuse.h"
#include "options.h"
#include "scenery.h"
#include "survey.h"

struct fluids;

/* What all pictures of a run share. */
struct drawing {
    const struct options *options;
    const struct survey *survey; /* of the sequence; NULL: each picture's own */
    mns_renderer *renderer;
    mns_anisotropy *anisotropy; /* NULL: spheres */
    struct scenery *scenery;    /* NULL: none */
    struct diffuse *diffuse;    /* NULL: none */
    struct fluids *fluids;      /* NULL: one */
};

/* Which picture it is. */
struct moment {
    double index;     /* of the frame in the whole input: orbit */
    double number;    /* of the frame: keys of the camera */
    const char *name; /* of the frame, for messages */
};

/* The camera of a picture, once its particles are prepared, of which stats tells. Returns a status; on failure it was told why. */
int draw_camera(const struct drawing *drawing, const struct mns_stats *stats, const struct moment *moment, struct mns_camera *camera);

/* Draws into images, which the particles' frame fills. Returns a status; on failure it was told why. */
int draw_picture(const struct drawing *drawing, const struct mns_particles *particles, const struct moment *moment,
                 const struct mns_output *images, size_t image_count, struct mns_stats *stats);

/* Warns of a picture, by its stats, that shows no fluid. */
void draw_warn_if_empty(const struct drawing *drawing, const char *name, const struct mns_stats *stats);

#endif
