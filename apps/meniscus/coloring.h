/* coloring.h: colours of particles by a number that each has, as --color-by asks. */
#ifndef MENISCUS_COLORING_H
#define MENISCUS_COLORING_H

#include "options.h"

struct survey;

struct coloring {
    const struct color_options *options;
    struct mns_colormap map;
    bool fixed; /* low and high are the whole sequence's; else each frame has its own */
    double low, high;
};

/* Colours of one set. */
struct painted {
    float *colors;    /* [count][3] linear; NULL: none */
    double low, high; /* what the ends of the map stand for */
};

/* Finds the colour map. Returns a status; on failure it was told why. */
int coloring_begin(struct coloring *coloring, const struct options *options);

/* Takes the range that the options leave open from the survey of a sequence (NULL: one frame). */
void coloring_survey(struct coloring *coloring, const struct survey *survey);

/* Colours a set, of the file name. The colours go to particles->color and live in painted, which painted_free frees. */
mns_result coloring_paint(const struct coloring *coloring, const mns_particle_set *set, const char *name, struct painted *painted,
                          struct mns_particles *particles, struct mns_message *message);
void painted_free(struct painted *painted);

/* The values of a set without the outermost half percent on each side, from a fixed sample; low > high where there are none. */
mns_result coloring_range(const char *expression, const mns_particle_set *set, const char *name, double *low, double *high,
                          struct mns_message *message);

/* "m/s" for the velocity, ...; "" where the unit is not known. */
const char *coloring_unit(const struct color_options *options);

#endif
