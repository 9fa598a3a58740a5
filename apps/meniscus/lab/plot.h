/* plot.h: error against time, as a picture. */
#ifndef MENISCUS_LAB_PLOT_H
#define MENISCUS_LAB_PLOT_H

#include "report.h"

#include <stdio.h>

/* An SVG of the report's points: milliseconds across, error of the normal up, both by powers of ten; a curve per filter through its best
 * settings. */
void lab_write_plot(FILE *out, const struct lab_report *report);

#endif
