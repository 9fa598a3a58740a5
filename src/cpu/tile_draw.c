/* tile_draw.c: one tile's chunks drawn: their depth and their thickness.
 *
 * A tile takes its chunks twice: in the order of the store for thickness, so that each sum has one order of terms, and front to back for
 * depth, where a hierarchical depth tells what can still show. */
#include "cpu/tiles.h"

#include "util/prefetch.h"

#include <math.h>
#include <string.h>

enum { DEPTH_BUCKETS = 256, PREFETCH = 4 /* chunks ahead */ };

static int least(int a, int b) { return a < b ? a : b; }

static struct splat_grid grid_of(const struct splat_view *view, int x, int y, int scale)
{
    float per = 1.0f / (float)scale;
    int columns = (view->width - x + scale - 1) / scale, rows = (view->height - y + scale - 1) / scale;
    return (struct splat_grid){.fx = view->fx * per,
                               .fy = view->fy * per,
                               .cx = (view->cx - (float)x) * per,
                               .cy = (view->cy - (float)y) * per,
                               .columns = least(columns, TILE_SIZE / scale),
                               .rows = least(rows, TILE_SIZE / scale)};
}

/* The least |v|^2 over pixels [first, first + count) of one axis, without the 1. */
static float least_square(int first, int count, float center, float focal)
{
    float low = (float)first + 0.5f - center, high = low + (float)(count - 1);
    float off = low > 0 ? low : high < 0 ? -high : 0;
    return off / focal * (off / focal);
}

/* Asks for a chunk's positions. */
static void prefetch_chunk(const struct particle_store *particles, size_t chunk)
{
    enum { LINE_FLOATS = 16 };
    for (size_t i = chunk * CHUNK_SIZE; i < (chunk + 1) * CHUNK_SIZE; i += LINE_FLOATS) {
        mns_prefetch(particles->x + i);
        mns_prefetch(particles->y + i);
        mns_prefetch(particles->z + i);
    }
}

/* The tile's chunks side by side, with their ids. Chunks far apart in memory are asked for ahead of time. */
static void gather_list(const struct tiles *tiles, const uint32_t *entries, size_t count, struct tile_entry *list)
{
    enum { AHEAD = 16 };
    for (size_t i = 0; i < count; i++) {
        if (i + AHEAD < count) {
            mns_prefetch(&tiles->chunks[entries[i + AHEAD]]);
        }
        list[i] = (struct tile_entry){.chunk = tiles->chunks[entries[i]], .id = entries[i]};
    }
}

/* Blocks that hold the largest sprite of the tile, so that it touches at most two each way. */
static void choose_blocks(struct splat_tile *tile, const struct tile_entry *list, size_t count)
{
    float largest = 0;
    for (size_t i = 0; i < count; i++) {
        float sprite = list[i].chunk.sprite;
        largest = sprite > largest && sprite < DEPTH_LIMIT ? sprite : largest;
    }
    tile->shift_x = BLOCK_SHIFT_X;
    tile->shift_y = BLOCK_SHIFT_Y;
    while (1 << tile->shift_x < TILE_SIZE && 2 * largest + 1 > (float)(1 << tile->shift_x)) {
        tile->shift_x++;
    }
    while (1 << tile->shift_y < TILE_SIZE && 2 * largest + 1 > (float)(1 << tile->shift_y)) {
        tile->shift_y++;
    }
}

static void clear_depth(const struct splat_view *view, struct splat_tile *tile)
{
    for (int y = 0; y < TILE_SIZE; y++) {
        float *row = tile->nearest + y * TILE_STRIDE;
        int inside = y < tile->pixels.rows ? tile->pixels.columns : 0;
        for (int x = 0; x < inside; x++) {
            row[x] = DEPTH_EMPTY;
        }
        memset(row + inside, 0, (size_t)(TILE_STRIDE - inside) * sizeof(float));
    }
    int columns = TILE_SIZE >> tile->shift_x, rows = TILE_SIZE >> tile->shift_y;
    for (int by = 0; by < rows; by++) {
        for (int bx = 0; bx < columns; bx++) {
            int x = bx << tile->shift_x, y = by << tile->shift_y, block = by * columns + bx;
            float square = 1;
            if (!view->orthographic) {
                square += least_square(x, 1 << tile->shift_x, tile->pixels.cx, tile->pixels.fx) +
                          least_square(y, 1 << tile->shift_y, tile->pixels.cy, tile->pixels.fy);
            }
            tile->farthest[block] = x < tile->pixels.columns && y < tile->pixels.rows ? DEPTH_EMPTY : 0;
            tile->per_nearest[block] = 1 / square;
        }
    }
}

void mns_tile_clear(const struct splat_view *view, struct splat_tile *tile, int sums)
{
    int rows = TILE_SIZE / view->scale;
    for (int k = 0; k < sums; k++) {
        for (int y = 0; y < rows; y++) {
            memset(tile->sums[k] + y * TILE_STRIDE, 0, (size_t)(rows + 16) * sizeof(float)); /* and what a vector may touch */
        }
        for (int y = 0; y <= rows && view->scale > 1; y++) {
            memset(tile->cells[k] + y * CELL_STRIDE, 0, 4 * (size_t)(rows + 1) * sizeof(float));
        }
    }
    tile->deposited = false;
}

/* Ranges of the scene's depth in the tile's smallest blocks: down the columns of a row of blocks first, since that runs in vectors. */
void mns_tile_measure(const struct splat_tile *tile, const struct plane *depth, struct cut_scene *scene)
{
    enum { COLUMNS = TILE_SIZE >> BLOCK_SHIFT_X, WIDTH = 1 << BLOCK_SHIFT_X, HEIGHT = 1 << BLOCK_SHIFT_Y };
    scene->depth = depth;
    for (int y0 = 0; y0 < TILE_SIZE; y0 += HEIGHT) {
        float low[TILE_SIZE], high[TILE_SIZE];
        for (int x = 0; x < TILE_SIZE; x++) {
            low[x] = DEPTH_EMPTY;
            high[x] = 0;
        }
        for (int y = y0; y < least(y0 + HEIGHT, tile->pixels.rows); y++) {
            const float *row = depth->data + (tile->y + y) * depth->stride + tile->x;
            for (int x = 0; x < tile->pixels.columns; x++) {
                low[x] = row[x] < low[x] ? row[x] : low[x];
                high[x] = row[x] > high[x] ? row[x] : high[x];
            }
        }
        for (int x = 0; x < TILE_SIZE; x++) {
            struct depth_range *range = &scene->ranges[y0 / HEIGHT * COLUMNS + x / WIDTH];
            bool first = x % WIDTH == 0;
            range->min = first || low[x] < range->min ? low[x] : range->min;
            range->max = first || high[x] > range->max ? high[x] : range->max;
        }
    }
}

/* Of one chunk. scene: NULL where nothing can cut fluid. */
static void draw_chunk_thickness(const struct splat_view *view, const struct splat_kernels *kernels, struct splat_tile *tile,
                                 const struct tile_entry *entry, const struct cut_scene *scene)
{
    const struct tile_chunk *chunk = &entry->chunk;
    float end = DEPTH_EMPTY;
    if (scene) {
        struct depth_range range =
            mns_cut_range(scene, chunk->x_min - tile->x, chunk->x_max - tile->x, chunk->y_min - tile->y, chunk->y_max - tile->y);
        if (chunk->near_depth >= range.max) {
            return; /* wholly behind */
        }
        end = chunk->far_depth > range.min ? range.min : DEPTH_EMPTY;
    }
    uint64_t which = UINT64_MAX;
    if (!tile_chunk_is_cut(view, chunk)) {
        which = kernels->thickness(view, tile, entry->id, end);
    }
    if (which != 0) {
        mns_cut_thickness(view, tile, entry->id, which, end < DEPTH_EMPTY ? scene : NULL);
    }
}

void mns_tile_thickness(const struct tiles *tiles, const struct splat_kernels *kernels, struct tile_scratch *scratch, size_t count,
                        const struct plane *end)
{
    const struct splat_view *view = &tiles->view;
    const struct cut_scene *scene = NULL;
    mns_tile_clear(view, &scratch->tile, view->has_color ? SUM_COUNT : 1);
    if (end) {
        mns_tile_measure(&scratch->tile, end, &scratch->scene);
        scene = &scratch->scene;
    }
    for (size_t i = 0; i < count; i++) {
        if (i + PREFETCH < count) {
            prefetch_chunk(view->particles, scratch->list[i + PREFETCH].id);
        }
        draw_chunk_thickness(view, kernels, &scratch->tile, &scratch->list[i], scene);
    }
}

/* Front to back, by the bucket of the near depth; within a bucket in the order of the list. Returns a bucket's depth. */
static float sort_list(const struct tile_entry *list, size_t count, uint32_t *order)
{
    float low = DEPTH_EMPTY, high = -DEPTH_EMPTY;
    for (size_t i = 0; i < count; i++) {
        low = fminf(low, list[i].chunk.near_depth);
        high = fmaxf(high, list[i].chunk.near_depth);
    }
    uint32_t places[DEPTH_BUCKETS + 1] = {0};
    float scale = high > low ? (float)(DEPTH_BUCKETS - 1) / (high - low) : 0;
    for (size_t i = 0; i < count; i++) {
        places[(int)((list[i].chunk.near_depth - low) * scale) + 1]++;
    }
    for (int i = 0; i < DEPTH_BUCKETS; i++) {
        places[i + 1] += places[i];
    }
    for (size_t i = 0; i < count; i++) {
        order[places[(int)((list[i].chunk.near_depth - low) * scale)]++] = (uint32_t)i;
    }
    return 1.01f * (high - low) / (float)(DEPTH_BUCKETS - 1);
}

/* Nothing of the chunk at this depth or beyond can show in the tile. */
static float hidden_from(const struct splat_tile *tile, const struct tile_chunk *chunk)
{
    int x0 = chunk->x_min - tile->x, x1 = chunk->x_max - tile->x, y0 = chunk->y_min - tile->y, y1 = chunk->y_max - tile->y;
    x0 = x0 > 0 ? x0 >> tile->shift_x : 0;
    y0 = y0 > 0 ? y0 >> tile->shift_y : 0;
    x1 = least(x1, TILE_SIZE - 1) >> tile->shift_x;
    y1 = least(y1, TILE_SIZE - 1) >> tile->shift_y;
    int columns = TILE_SIZE >> tile->shift_x;
    float farthest = 0;
    for (int y = y0; y <= y1; y++) {
        for (int x = x0; x <= x1; x++) {
            float here = tile->farthest[y * columns + x];
            farthest = here > farthest ? here : farthest;
        }
    }
    return farthest;
}

static float tile_farthest(const struct splat_tile *tile)
{
    float farthest = 0;
    for (int i = 0; i < TILE_SIZE * TILE_SIZE >> (tile->shift_x + tile->shift_y); i++) {
        farthest = tile->farthest[i] > farthest ? tile->farthest[i] : farthest;
    }
    return farthest;
}

void mns_tile_depth(const struct tiles *tiles, const struct splat_kernels *kernels, struct tile_scratch *scratch, size_t count)
{
    enum { END_TEST = 8 }; /* chunks drawn between looks at the whole tile */
    const struct splat_view *view = &tiles->view;
    struct splat_tile *tile = &scratch->tile;
    choose_blocks(tile, scratch->list, count);
    clear_depth(view, tile);
    float bucket = sort_list(scratch->list, count, scratch->order), end = DEPTH_EMPTY;
    for (size_t i = 0, drawn = 0; i < count; i++) {
        const struct tile_entry *entry = &scratch->list[scratch->order[i]];
        const struct tile_chunk *chunk = &entry->chunk;
        if (chunk->near_depth - bucket >= end) {
            break; /* and all that follow are no nearer than this less a bucket */
        }
        float limit = hidden_from(tile, chunk);
        if (fmaxf(chunk->near_depth, view->near_plane - view->slack) >= limit) {
            continue;
        }
        if (tile_chunk_is_cut(view, chunk)) {
            scratch->particles_splatted += mns_cut_depth(view, tile, entry->id, limit);
        } else {
            scratch->particles_splatted += kernels->depth(view, tile, entry->id, limit);
        }
        if (++drawn % END_TEST == 0) {
            end = tile_farthest(tile);
        }
    }
}

size_t mns_tile_begin(const struct tiles *tiles, size_t index, struct tile_scratch *scratch)
{
    struct splat_tile *tile = &scratch->tile;
    tile->x = (int)(index % (size_t)tiles->columns) * TILE_SIZE;
    tile->y = (int)(index / (size_t)tiles->columns) * TILE_SIZE;
    tile->pixels = grid_of(&tiles->view, tile->x, tile->y, 1);
    tile->texels = grid_of(&tiles->view, tile->x, tile->y, tiles->view.scale);
    size_t count = tiles->begin[index + 1] - tiles->begin[index];
    gather_list(tiles, tiles->entries + tiles->begin[index], count, scratch->list);
    return count;
}
