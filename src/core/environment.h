/* environment.h: an equirectangular picture with mip levels, and what it sheds. */
#ifndef MNS_CORE_ENVIRONMENT_H
#define MNS_CORE_ENVIRONMENT_H

#include <meniscus/environment.h>

enum { ENVIRONMENT_LEVELS = 16 };

struct mns_environment {
    float *levels[ENVIRONMENT_LEVELS]; /* [height][width][3] linear radiance; each half the size of the one before */
    int width[ENVIRONMENT_LEVELS], height[ENVIRONMENT_LEVELS], count;
    float sky_light[3];    /* on a white surface that faces up, divided by pi, as all light here */
    float ground_light[3]; /* on one that faces down */
    float horizon[3];      /* mean of the rows about the horizon */
};

#endif
