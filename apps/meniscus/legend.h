/* legend.h: the colour bar of --legend, drawn into pictures. */
#ifndef MENISCUS_LEGEND_H
#define MENISCUS_LEGEND_H

#include "coloring.h"

/* Draws the bar, its ticks and what it stands for at the right of the beauty image among images, as large as suits the picture. Returns a
 * status. */
int legend_draw(const struct coloring *coloring, const struct painted *painted, const struct mns_output *images, size_t count);

#endif
