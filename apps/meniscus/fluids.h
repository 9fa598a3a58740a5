/* fluids.h: several fluids in one picture: each with its files, parameters and renderer; composited per pixel in the order of their depths. */
#ifndef MENISCUS_FLUIDS_H
#define MENISCUS_FLUIDS_H

#include "draw.h"
#include "outputs.h"
#include "source.h"

/* Finds the files of options->fluids, surveys them, and widens *survey, the first fluid's, to all. *out NULL where there is but the first. Returns a
 * status; fluids_end may always be called. */
int fluids_begin(struct fluids **out, const struct options *options, const struct inputs *inputs, const struct outputs *outputs,
                 struct survey *survey);
void fluids_end(struct fluids *fluids); /* NULL is fine, here and below */

/* Starts to read the wanted frames, as source_start does for the first fluid. Returns a status; fluids_stop may always be called. */
int fluids_start(struct fluids *fluids, const bool *wanted, const struct coloring *coloring);
void fluids_stop(struct fluids *fluids);

/* Goes to the next wanted frame, and tells its news. Returns the frame that cannot be read, or NULL. */
const struct source_frame *fluids_next(struct fluids *fluids);

/* As draw_picture, of all fluids; particles: of the first. */
int fluids_draw(const struct drawing *drawing, const struct mns_particles *particles, const struct moment *moment,
                const struct mns_output *images, size_t image_count, struct mns_stats *stats);

#endif
