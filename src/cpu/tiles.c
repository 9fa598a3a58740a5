/* tiles.c: memory of the tiles. */
#include "cpu/tiles.h"

/* Floats of one thread's buffers. */
enum { NEAREST_FLOATS = TILE_SIZE * TILE_STRIDE, SUM_FLOATS = TILE_SIZE * TILE_STRIDE, CELL_FLOATS = (TILE_SIZE / 2 + 1) * CELL_STRIDE };

void mns_scratch_free(struct tiles_scratch *all, struct memory *memory)
{
    for (int i = 0; i < all->count; i++) {
        struct tile_scratch *scratch = &all->threads[i];
        mns_memory_put(memory, scratch->tile.nearest, NEAREST_FLOATS, sizeof(float));
        for (int k = 0; k < SUM_COUNT; k++) {
            mns_memory_put(memory, scratch->tile.sums[k], SUM_FLOATS, sizeof(float));
            mns_memory_put(memory, scratch->tile.cells[k], CELL_FLOATS, sizeof(float));
        }
        mns_memory_put(memory, scratch->list, scratch->list_capacity, sizeof(*scratch->list));
        mns_memory_put(memory, scratch->order, scratch->order_capacity, sizeof(*scratch->order));
    }
    mns_memory_put(memory, all->threads, (size_t)all->count, sizeof(*all->threads));
    *all = (struct tiles_scratch){0};
}

static bool reserve_tile(struct splat_tile *tile, struct memory *memory, int sums)
{
    tile->nearest = tile->nearest ? tile->nearest : mns_memory_get(memory, NEAREST_FLOATS, sizeof(float));
    bool done = tile->nearest != NULL;
    for (int k = 0; k < sums; k++) {
        tile->sums[k] = tile->sums[k] ? tile->sums[k] : mns_memory_get(memory, SUM_FLOATS, sizeof(float));
        tile->cells[k] = tile->cells[k] ? tile->cells[k] : mns_memory_get(memory, CELL_FLOATS, sizeof(float));
        done = done && tile->sums[k] && tile->cells[k];
    }
    return done;
}

bool mns_scratch_reserve(struct tiles_scratch *all, const struct tiles *tiles, int sums, struct memory *memory, int threads)
{
    if (all->count != threads) {
        mns_scratch_free(all, memory);
        all->threads = mns_memory_get(memory, (size_t)threads, sizeof(*all->threads));
        if (!all->threads) {
            return false;
        }
        all->count = threads;
        for (int i = 0; i < threads; i++) {
            all->threads[i] = (struct tile_scratch){0};
        }
    }
    bool done = true;
    for (int i = 0; i < threads && done; i++) {
        struct tile_scratch *scratch = &all->threads[i];
        scratch->list = mns_memory_reserve(memory, scratch->list, &scratch->list_capacity, tiles->largest, sizeof(*scratch->list));
        scratch->order = mns_memory_reserve(memory, scratch->order, &scratch->order_capacity, tiles->largest, sizeof(*scratch->order));
        done = reserve_tile(&scratch->tile, memory, sums) && scratch->list && scratch->order;
    }
    return done;
}

void mns_tiles_free(struct tiles *tiles, struct memory *memory)
{
    mns_memory_put(memory, tiles->chunks, tiles->chunk_capacity, sizeof(*tiles->chunks));
    mns_memory_put(memory, tiles->begin, tiles->begin_capacity, sizeof(*tiles->begin));
    mns_memory_put(memory, tiles->entries, tiles->entry_capacity, sizeof(*tiles->entries));
    mns_memory_put(memory, tiles->counts, tiles->count_capacity, sizeof(*tiles->counts));
    *tiles = (struct tiles){0};
}
