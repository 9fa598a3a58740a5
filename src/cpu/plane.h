/* plane.h: float images with a border. */
#ifndef MNS_CPU_PLANE_H
#define MNS_CPU_PLANE_H

#include "core/memory.h"

#include <stdbool.h>

/* Pixels that every depth plane has on each side beyond the picture, so that filter taps need no test: no kernel reaches further.
 * Border pixels hold 0, nearer than anything: the filters drop such a tap with its mirror, as SPEC asks outside the image. */
enum { PLANE_BORDER = 128 };

/* Depth planes come with the range of each block of 16 x 8 pixels. */
enum { BLOCK_WIDTH = 16, BLOCK_HEIGHT = 8 };

/* What an empty pixel of a depth plane holds inside the pipeline: finite, so that sums with weight 0 stay 0. Layers show +inf. */
#define DEPTH_EMPTY 3.0e38f
/* Depths from here on are empty. */
#define DEPTH_LIMIT 1.0e37f

/* data: pixel (x, y) at data[y * stride + x], for x and y from -border to size + border - 1, and a whole block beyond the right
 * and lower edges: rows of width rounded up to 16 may be read and written. Rows are 64-byte aligned; the stride is an odd
 * number of cache lines, since powers of two slow columns down. Pixels past the edge inside the last block: as the border. */
struct plane {
    float *data;
    ptrdiff_t stride; /* floats */
    int width, height, border;
    float *block;  /* the allocation */
    size_t floats; /* its size */
};

/* Gives the plane its size; contents become undefined when it changes, the border 0. false: out of memory (plane empty). */
bool mns_plane_resize(struct plane *plane, struct memory *memory, int width, int height, int border);
void mns_plane_free(struct plane *plane, struct memory *memory);

/* Range of the depths of one block of a depth plane, empty pixels included (as DEPTH_EMPTY), border pixels not. */
struct depth_range {
    float min, max;
};

/* A depth plane with its ranges: block (bx, by) at ranges[by * blocks_x + bx]. */
struct depth_plane {
    struct plane plane;
    struct depth_range *ranges;
    int blocks_x, blocks_y;
    size_t capacity; /* of ranges */
};

bool mns_depth_plane_resize(struct depth_plane *plane, struct memory *memory, int width, int height);
void mns_depth_plane_free(struct depth_plane *plane, struct memory *memory);

#endif
