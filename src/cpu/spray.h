/* spray.h: what stage spray leaves for stage shade.
 *
 * A particle of the spray is a soft drop, stretched along the way that it goes while the shutter is open: at the distance s from that way, in radii of the
 * drop, it has the optical depth t (1 - s^2)^2. t is in proportion to the drop's area over that of its image, so that a streak is as much as its drop, and
 * so is a drop that is smaller than a pixel, whose image is not. Sums of optical depths need no order.
 *
 * The part of a drop that stands before the surface at a pixel goes to front, the rest to behind, where the water hides as much of it as of the scene. */
#ifndef MNS_CPU_SPRAY_H
#define MNS_CPU_SPRAY_H

#include "cpu/plane.h"

#include <stdint.h>

/* Radius of the smallest image, pixels: sampled at the pixels' centres its sum is within 2 % wherever it lies. */
#define SPRAY_LEAST 1.5f

/* Longest half of a streak over the drop's radius: beyond it a velocity is in the wrong unit, or the drop could not be seen any more. */
#define SPRAY_STREAK_MAX 64.0f

/* One drop in the picture, pixels. */
struct spray_drop {
    float x, y, dx, dy; /* middle, and from there to the end of the way of its centre */
    float radius;       /* of its image */
    float depth, half;  /* of its centre, and how far before and behind that it reaches, metres */
    float amount;       /* optical depth in the middle; 0: it does not show */
};

struct spray {
    bool shows;                 /* whether there was any in the last picture */
    struct plane front, behind; /* optical depths */
    struct spray_drop *drops;   /* [count] of the store */
    uint32_t *entries;          /* drops of tile 0, in order, then of tile 1, ... */
    size_t *begin;              /* [tiles + 1] */
    size_t drop_capacity, entry_capacity, begin_capacity;
    int columns, rows; /* of tiles */
};

#endif
