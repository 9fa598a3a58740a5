/* lines.h: what the filters share that solve whole rows and columns: strips of lines side by side, one to a lane, and passes over the picture.
 *
 * A line falls apart where there is no fluid. That is told from tiles of LINES x LINES pixels without fluid, the same ones along rows and columns:
 * what a pass finds in a tile every pass before it has written. */
#ifndef MNS_CPU_SMOOTH_LINES_H
#define MNS_CPU_SMOOTH_LINES_H

#include "cpu/plane.h"

enum { LINES = 32 }; /* two vectors of the widest instruction set, since each pixel waits for the one before */

/* Part of a strip: LINES rows (or columns) of pixels from begin to end - 1 along x (or y), whole blocks. */
struct line_run {
    int axis;         /* AXIS_X: rows */
    int first;        /* row (or column) of the first line */
    int across;       /* lines that are in the picture's blocks: a multiple of a block's size, at most LINES */
    int begin, end;   /* pixels along the lines */
    bool opens, ends; /* whether begin or end is the picture's edge; else there is no fluid beyond */
};

/* scratch: as many arrays of LINES floats per pixel as were reserved, 64-byte aligned. */
typedef void line_function(void *context, const struct line_run *run, float *scratch);

/* Rows that lie in a plane become lines side by side, pixel i of line l at lines[i * LINES + l], and back. count: pixels, a multiple of 16.
 * scatter writes the first `across` rows only. */
struct line_kernels {
    void (*gather)(const float *rows, ptrdiff_t stride, int count, float *lines);
    void (*scatter)(const float *lines, int count, int across, float *rows, ptrdiff_t stride);
};

struct backend;

/* Memory for passes with so many arrays. false: out of memory. */
bool mns_lines_reserve(struct backend *cpu, int arrays);

/* Runs function over all fluid of the picture, told by the ranges of a plane. Which thread takes which strip makes no difference. */
void mns_lines_pass(struct backend *cpu, const struct depth_plane *fluid, int axis, int arrays, line_function *function, void *context);

extern const struct line_kernels mns_line_kernels_scalar, mns_line_kernels_sse2, mns_line_kernels_avx2, mns_line_kernels_avx512,
    mns_line_kernels_neon;

#endif
