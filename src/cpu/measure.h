/* measure.h: order statistics and the rest spacing of an ordered set. */
#ifndef MNS_CPU_MEASURE_H
#define MNS_CPU_MEASURE_H

#include "cpu/particles.h"

/* The value that stands at place `rank` (0 to count - 1) in order; reorders the values. */
float mns_select(float *values, size_t count, size_t rank);

/* Samples that quantiles are taken from, at most: every (count / QUANTILE_SAMPLE)-th particle. */
enum { QUANTILE_SAMPLE = 65536 };

/* The rest spacing as mns_particles_measure tells it; 0 when it cannot be told. The store's positions and boxes must be filled.
 * false: out of memory. */
bool mns_measure_spacing(const struct particle_store *store, struct memory *memory, const struct mns_parallel *parallel, double *spacing);

#endif
