/* sample.h: the parts of a set, and a few of its particles in place of all. */
#ifndef MNS_PARTICLES_SAMPLE_H
#define MNS_PARTICLES_SAMPLE_H

#include <stddef.h>
#include <stdint.h>

/* Where part `part` of `count` things in `parts` parts begins. */
static inline size_t mns_part_begin(size_t count, int part, int parts)
{
    size_t i = (size_t)part, n = (size_t)parts;
    return count / n * i + count % n * i / n;
}

/* One particle of each run of `step`, at a place in it that no order of the particles follows: every step-th would meet the same few columns of a
 * set that is written row by row. */
static inline size_t mns_sample_index(size_t run, size_t step)
{
    uint32_t hash = (uint32_t)run * 2654435761u;
    hash = (hash ^ hash >> 15) * 2246822519u;
    return run * step + (hash ^ hash >> 13) % step;
}

#endif
