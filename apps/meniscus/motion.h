/* motion.h: particles between two frames. */
#ifndef MENISCUS_MOTION_H
#define MENISCUS_MOTION_H

#include <meniscus/particles.h>

struct motion; /* opaque */

/* NULL: out of memory. */
struct motion *motion_create(void);
void motion_destroy(struct motion *motion); /* NULL is fine */

/* Takes two frames, which must stay as they are until the next call. Particles of one id are one particle; without ids, those of one index are. A
 * particle that jumps (through a periodic boundary, or its id is used anew) counts as two.
 * to NULL: there is no next frame, and particles go on as fast as they are; seconds: from this frame to the next, if there were one.
 * Returns a status; on failure it was told why. */
int motion_between(struct motion *motion, const struct mns_particles *from, const struct mns_particles *to, double seconds);

/* The particles at t, 0 (from itself) to 1 (to). On cubics where there are velocities that fit how the particles move [Hermite], on straight lines
 * elsewhere. What vanishes shrinks, what appears grows (mns_particles.water). Valid until the next call; NULL after telling why. */
const struct mns_particles *motion_at(struct motion *motion, double t);

/* Seconds from frame to frame that the velocities tell; 0: there are none that fit. */
double motion_seconds(const struct motion *motion);

#endif
