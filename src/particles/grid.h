/* grid.h: a uniform grid over particles: who lies within a support radius of whom.
 *
 * Cells are as wide as the support radius and lie in rows along x, so that the neighbours of a cell's particles are in the cell itself and
 * the 26 around it: nine rows of three cells, each one run of the sorted arrays. The grid is a torus: a set too spread out for its
 * memory (GRID_CELLS_PER_PARTICLE) comes round to cells in use, which costs tests of distance and changes no result. */
#ifndef MNS_PARTICLES_GRID_H
#define MNS_PARTICLES_GRID_H

#include "core/memory.h"

#include <meniscus/particles.h>

/* GRID_PAD: floats behind x, y and z that may be loaded; they are +inf, within reach of nothing. */
enum { GRID_RUNS = 18, GRID_PAD = 16, GRID_CELLS_PER_PARTICLE = 2, GRID_CELLS_LEAST = 4096 };

/* Zero before the first fill. Particle i of the sorted arrays is particle index[i] of the caller; those of one cell stand in the caller's
 * order. */
struct grid {
    size_t count; /* of particles with a finite position */
    double origin[3];
    float support;     /* metres */
    float *x, *y, *z;  /* [count + GRID_PAD] metres, relative to origin */
    uint32_t *index;   /* [count] */
    uint32_t *start;   /* [cells + 1] cell c holds sorted particles [start[c], start[c + 1]) */
    uint32_t cells;    /* size[0] * size[1] * size[2] */
    uint32_t size[3];  /* cells along each axis, at least 3 */
    double candidates; /* mean number of particles in the 27 cells around a particle: what a visit of all neighbours costs */
    struct grid_work *work;
};

/* Sorts a set. support: metres, > 0, at which a neighbour is just out of reach. slices: parts that the work is cut into, as there are threads;
 * changes nothing in the result. Errors: positions that are neither float32 nor float64, too many, spread too far; out of memory. Then the grid is
 * empty. */
mns_result mns_grid_fill(struct grid *grid, struct memory *memory, const struct mns_parallel *parallel, int slices,
                         const struct mns_particles *particles, double support, struct mns_message *message);
void mns_grid_free(struct grid *grid, struct memory *memory);

/* Sorted particles [begin, end). */
struct grid_run {
    uint32_t begin, end;
};

/* The runs that hold every particle within the support of any particle of the cell, itself included, each particle once; and others that lie
 * farther away. Returns how many of runs[GRID_RUNS] there are, in a fixed order; none is empty. */
int mns_grid_neighbours(const struct grid *grid, uint32_t cell, struct grid_run runs[GRID_RUNS]);

/* Cells [begin, end) are part `part` of `parts` that hold about as many particles each: for jobs over cells. */
struct grid_run mns_grid_part(const struct grid *grid, int part, int parts);

#endif
