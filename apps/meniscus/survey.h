/* survey.h: what is the same for all frames of a sequence: where the fluid is, how large it and its particles are. */
#ifndef MENISCUS_SURVEY_H
#define MENISCUS_SURVEY_H

#include "inputs.h"
#include "options.h"

struct survey {
    double bounds_min[3], bounds_max[3]; /* metres: of all particles */
    double inner_min[3], inner_max[3];   /* metres: without the outermost 0.1 % on each side */
    double radius;                       /* metres: median over the frames; 0: unknown */
    double spacing;                      /* metres: the same */
    double value_low, value_high;        /* of --color-by; low > high: unknown */
    size_t count;                        /* particles of the largest frame */
};

/* From one set. */
void survey_from_measure(struct survey *survey, const struct mns_measure *measure);

/* Reads the first, middle and last of the inputs, leaving out what cannot be read: drawing tells of it. Where none can, the status is
 * STATUS_FAILED after telling why. */
int survey_inputs(struct survey *survey, const struct inputs *inputs, const struct options *options);

/* Sets what params leaves to be found out per frame, so that frames, and parts of the sequence drawn by other machines, agree. */
void survey_fix_params(const struct survey *survey, bool own_radii, bool own_volumes, struct mns_params *params);

#endif
