/* run.h: draws a scene with a filter through the public library, and measures the result. */
#ifndef MENISCUS_LAB_RUN_H
#define MENISCUS_LAB_RUN_H

#include "measure.h"

/* Frames of a scene: where it stands, and moved right and down for the flicker. */
enum { LAB_FRAMES = 3 };

struct lab_settings {
    int width, height;        /* pixels */
    struct mns_params params; /* what is not the lab's own: the radius is 1/2, nothing stands around the fluid */
    enum mns_isa isa;
    int threads; /* 0: all */
    int repeat;  /* draws of which the fastest counts */

    /* Called before each run; false stops the lab, which then fails. NULL: never. */
    bool (*proceed)(void *user);
    void *user;
};

/* A scene under measurement. */
struct lab {
    struct lab_settings settings;
    struct lab_view view[LAB_FRAMES];
    mns_renderer *renderer;
    mns_anisotropy *anisotropy; /* NULL: spheres */
    int scene;                                  /* -1: none yet */
    int frames;                                 /* of the scene: 1, or LAB_FRAMES where flicker is told */
    struct lab_reference reference[LAB_FRAMES]; /* [frames] */
    float *raw[LAB_FRAMES];                     /* [frames]: depth_raw as drawn */
    float *depth, *normal;                      /* of the last draw: [height][width], [height][width][3] */
    struct mns_stats stats;                     /* the same */
    struct lab_values unsmoothed;               /* what depth_raw measures in this scene; no flicker */
    struct mns_message message;                 /* why a call failed */
};

/* Every function returns what became of it, and leaves the reason in lab->message. lab_destroy may always be called. */
mns_result lab_create(struct lab *lab, const struct lab_settings *settings);
void lab_destroy(struct lab *lab);

/* Makes a scene the one that is measured: its particles are prepared and its true surface is known. The same again costs nothing. */
mns_result lab_enter(struct lab *lab, int scene);

/* Draws a frame of the scene into lab->depth and lab->normal, `repeat` times at most. ms (may be NULL): of the fastest stage smooth. */
mns_result lab_draw(struct lab *lab, const struct mns_params *params, int frame, int repeat, double *ms);

/* Draws the scene and measures it; LAB_DISTANCE needs two scenes and is left out. */
mns_result lab_run(struct lab *lab, const struct mns_params *params, struct lab_values *out);

/* Notes a failure of one's own. Returns result. */
mns_result lab_fail(struct lab *lab, mns_result result);

/* The settings' parameters with another filter. */
struct mns_params lab_params(const struct lab *lab, int filter);

/* R in the middle of a scene at the usual distance, pixels. */
double lab_radius_pixels(const struct lab *lab);

/* Filters by their numbers in enum mns_filter. */
int lab_filter_count(void);
const char *lab_filter_name(int filter);
int lab_filter_find(const char *name); /* -1: none */

#endif
