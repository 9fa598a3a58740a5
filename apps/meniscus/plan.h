/* plan.h: which pictures are drawn, and which inputs they need. */
#ifndef MENISCUS_PLAN_H
#define MENISCUS_PLAN_H

#include "outputs.h"

/* One picture. */
struct shot {
    size_t input;     /* its index in the inputs */
    double fraction;  /* how far it is on the way to the next input, 0 to 1 */
    double step;      /* what the next picture is further on */
    long long number; /* of the picture */
};

struct plan {
    struct shot *shots; /* [count], by rising input and fraction */
    size_t count;
    size_t skipped; /* shots left out by plan_resume */
    bool *needed;   /* [inputs.count]: must be read */
};

/* What --frames chooses. Returns a status; plan_free may always be called. */
int plan_make(struct plan *plan, const struct inputs *inputs, const struct options *options);

/* Leaves out the pictures whose files are there. */
void plan_resume(struct plan *plan, const struct outputs *outputs);

/* Whether a shot is not of its input as it is, and so needs the next one too, if there is one. */
bool shot_moves(const struct shot *shot, const struct options *options);

/* Fills plan->needed for the shots that are left. */
void plan_needs(struct plan *plan, const struct inputs *inputs, const struct options *options);

/* Adds the `depth` inputs before each that is needed. */
void plan_reach_back(struct plan *plan, const struct inputs *inputs, size_t depth);

void plan_free(struct plan *plan);

#endif
