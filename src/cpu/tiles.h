/* tiles.h: which chunks of a store each tile of the picture has to draw, and drawing them. */
#ifndef MNS_CPU_TILES_H
#define MNS_CPU_TILES_H

#include "cpu/splat_cut.h"

#include <stdint.h>

/* A chunk as seen from the eye. */
struct tile_chunk {
    float near_depth, far_depth;         /* metres; nothing of it is outside */
    float sprite;                        /* pixels: largest half-extent of a sphere; DEPTH_EMPTY: close to the eye */
    uint16_t x_min, x_max, y_min, y_max; /* pixels that it may touch, inclusive; x_min > x_max: none */
};

/* A chunk in the list of the tile in hand. */
struct tile_entry {
    struct tile_chunk chunk;
    uint32_t id;
};

/* One thread's buffers. */
struct tile_scratch {
    struct splat_tile tile;
    struct tile_entry *list; /* the tile's chunks in the order of the store */
    uint32_t *order;         /* their places in the list, front to back */
    size_t list_capacity, order_capacity;
    struct cut_scene scene; /* where it can cut fluid */
    size_t particles_splatted, pixels_covered;
};

struct tiles {
    struct splat_view view;
    int columns, rows;
    struct tile_chunk *chunks; /* [chunk_count] */
    size_t *begin;             /* [columns * rows + 1] of each tile in entries */
    uint32_t *entries;         /* chunks of tile 0, in order, then of tile 1, ... */
    size_t *counts;            /* [slices][columns * rows] */
    size_t largest;            /* most chunks in one tile */
    size_t particles_visible;  /* in the frustum, by chunks */
    size_t chunk_capacity, begin_capacity, entry_capacity, count_capacity;
};

/* What all stores' tiles are drawn in, in turn. */
struct tiles_scratch {
    struct tile_scratch *threads; /* [count] */
    int count;
};

void mns_tiles_free(struct tiles *tiles, struct memory *memory);

/* One piece of scratch per thread, each with room for the fullest tile and so many sums. false: out of memory. */
bool mns_scratch_reserve(struct tiles_scratch *scratch, const struct tiles *tiles, int sums, struct memory *memory, int threads);
void mns_scratch_free(struct tiles_scratch *scratch, struct memory *memory);

/* Takes a tile's chunks up; what follows draws them. Returns how many there are. */
size_t mns_tile_begin(const struct tiles *tiles, size_t index, struct tile_scratch *scratch);

/* Ranges of depths of the picture in the tile. */
void mns_tile_measure(const struct splat_tile *tile, const struct plane *depth, struct cut_scene *scene);

/* Whether the eye is close to a chunk, or a plane cuts it. */
static inline bool tile_chunk_is_cut(const struct splat_view *view, const struct tile_chunk *chunk)
{
    return chunk->sprite > DEPTH_LIMIT || chunk->near_depth < view->near_plane || chunk->far_depth > view->far_plane;
}

/* Empties tile.sums and tile.cells. */
void mns_tile_clear(const struct splat_view *view, struct splat_tile *tile, int sums);

/* tile.sums and tile.cells: the thickness of the tile's chunks, before depth `end` (NULL: none) where that may cut them. */
void mns_tile_thickness(const struct tiles *tiles, const struct splat_kernels *kernels, struct tile_scratch *scratch, size_t count,
                        const struct plane *end);

/* tile.nearest: the nearest of the tile's chunks. Counts the particles drawn in scratch. */
void mns_tile_depth(const struct tiles *tiles, const struct splat_kernels *kernels, struct tile_scratch *scratch, size_t count);

#endif
