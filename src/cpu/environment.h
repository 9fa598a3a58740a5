/* environment.h: lookups in the frame's environment. */
#ifndef MNS_CPU_ENVIRONMENT_H
#define MNS_CPU_ENVIRONMENT_H

#include "core/environment.h"
#include "cpu/scene.h"
#include "cpu/shade.h"

/* The environment about one picture. */
struct surroundings {
    const struct mns_environment *environment; /* NULL: the sky stands there */
    float right[3], away[3], up[3];            /* image space, unit: of the middle column's viewer; away: where he looks */
    float turn;                                /* columns' part by which it is turned */
    float intensity;
    float texel;     /* radians */
    float step;      /* radians from pixel to pixel in the middle of the picture */
    bool has_ground; /* below the horizon, mirrors show the floor's mean */
};

void mns_surroundings_resolve(struct surroundings *out, const struct frame *frame);

/* Adds what stands behind sky and haze to the pixels x to x + count - 1 of row y of the backdrop [count][4], as far as their alpha leaves it, which becomes 1. */
void mns_surroundings_behind(const struct surroundings *s, const struct backdrop *backdrop, int x, int y, int count, float *color);

/* Fills row->mirrored where fluid is. */
void mns_surroundings_mirror(const struct surroundings *s, const struct shade_optics *optics, struct shade_row *row);

#endif
