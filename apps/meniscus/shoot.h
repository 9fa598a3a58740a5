/* shoot.h: one picture of a sequence: its particles at its moment, or, where a shutter stands open, at several. */
#ifndef MENISCUS_SHOOT_H
#define MENISCUS_SHOOT_H

#include "draw.h"
#include "motion.h"
#include "plan.h"
#include "shutter.h"
#include "sink.h"

struct shooting {
    const struct drawing *drawing;
    const struct inputs *inputs;
    struct motion *motion;   /* NULL: none is needed yet */
    struct shutter *shutter; /* NULL: likewise */
};

/* Draws a shot into picture->images, [count]. from: its frame; to: the next one, NULL: there is none. fresh: they are not those of the call
 * before. Returns a status; on failure it was told why. */
int shoot(struct shooting *shooting, const struct shot *shot, const struct mns_particles *from, const struct mns_particles *to, bool fresh,
          struct picture *picture, size_t count);

void shoot_end(struct shooting *shooting);

#endif
