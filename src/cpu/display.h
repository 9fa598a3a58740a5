/* display.h: diagrams in place of the picture: normal, depth, thickness, curvature. */
#ifndef MNS_CPU_DISPLAY_H
#define MNS_CPU_DISPLAY_H

#include "cpu/cpu.h"

/* What the picture shows of a quantity, over which the diagram's colours run. */
struct display_range {
    float low, high;
};

bool mns_display_is_diagram(int display);

/* The range of the depth or of the thickness where fluid shows; unused by the other modes. */
struct display_range mns_display_measure(const struct backend *cpu, const struct frame *frame);

/* The particles' colours, or the opaque one, over the scene, to row->out (linear). */
void mns_display_color(const struct shade_optics *optics, bool has_color, struct shade_row *row);

/* The values as they are shown, to row->out. */
void mns_display_row(const struct frame *frame, const struct display_range *range, struct shade_row *row, const float *curvature);

#endif
