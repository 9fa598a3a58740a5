/* objects.h: the caller's opaque things in our own sky and on our own floor. */
#ifndef MNS_CPU_OBJECTS_H
#define MNS_CPU_OBJECTS_H

#include "cpu/cpu.h"
#include "cpu/scene.h"

/* Puts row y of the frame's objects into the scene image, where sky and floor are drawn already: their shadow on the floor, themselves in the light that
 * the fluid lets through, and their depth where it is nearer. */
void mns_objects_row(struct backend *cpu, const struct frame *frame, const struct backdrop *backdrop, int y);

#endif
