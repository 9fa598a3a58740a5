/* foam.c: stage foam: the foam's depth and thicknesses, and the water's thickness before it.
 * In: the foam store, the water's tiles, the scene's depth, backend->raw, the blur's widths. Out: backend->foam.
 * Based on: Bagar, Scherzer and Wimmer 2010, section 5.2 ([BSW10]); what is gathered, and how: foam.h.
 *
 * Tiles without foam cost nothing. In the others water that lies wholly behind the foam is passed over by whole chunks, and what lies wholly
 * before it goes through the kernel of stage splat; only chunks that the foam's depth may cut are looked at more closely. */
#include "cpu/foam.h"

#include "cpu/cpu.h"
#include "cpu/tiles.h"

#include <math.h>
#include <string.h>

struct foam_run {
    struct backend *cpu;
    const struct frame *frame;
    struct splat_view water; /* without colours: they have no part in this */
    const struct plane *scene;
    float delta;
    atomic_size_t next;
    atomic_bool shows;
};

static int least(int a, int b) { return a < b ? a : b; }

/* Of chunks that the near or far plane cuts, or around the eye. Their spheres have no detail. */
static void add_cut_foam(const struct foam_run *run, struct tile_scratch *scratch, size_t count)
{
    const struct tiles *tiles = &run->cpu->tiles[STORE_FOAM];
    struct splat_tile *tile = &scratch->tile;
    struct plane *ends = &run->cpu->foam->ends;
    const struct plane *depth = &run->cpu->foam->depth.plane;
    bool filled = false;
    for (size_t i = 0; i < count; i++) {
        const struct tile_entry *entry = &scratch->list[i];
        if (!tile_chunk_is_cut(&tiles->view, &entry->chunk)) {
            continue;
        }
        for (int y = tile->y; !filled && y < tile->y + tile->pixels.rows; y++) {
            for (int x = tile->x; x < tile->x + tile->pixels.columns; x++) {
                float z = depth->data[y * depth->stride + x];
                float end = run->scene ? run->scene->data[y * run->scene->stride + x] : DEPTH_EMPTY;
                ends->data[y * ends->stride + x] = z < DEPTH_LIMIT ? fminf(z + run->delta, end) : 0;
            }
        }
        filled = true;
        mns_tile_measure(tile, run->scene ? run->scene : ends, &scratch->scene);
        mns_cut_thickness(&tiles->view, tile, entry->id, UINT64_MAX, run->scene ? &scratch->scene : NULL);
        float *all = tile->sums[0];
        tile->sums[0] = tile->sums[1];
        mns_tile_measure(tile, ends, &scratch->scene);
        mns_cut_thickness(&tiles->view, tile, entry->id, UINT64_MAX, &scratch->scene);
        tile->sums[1] = tile->sums[0];
        tile->sums[0] = all;
    }
}

/* T_f and T_ff of a tile with `count` chunks of foam in the list. */
static void draw_foam(const struct foam_run *run, struct tile_scratch *scratch, const struct foam_scratch *own, size_t count)
{
    struct backend *cpu = run->cpu;
    const struct splat_view *view = &cpu->tiles[STORE_FOAM].view;
    mns_tile_clear(view, &scratch->tile, 2);
    for (size_t i = 0; i < count; i++) {
        if (!tile_chunk_is_cut(view, &scratch->list[i].chunk)) {
            cpu->kernels->foam->thickness(view, &scratch->tile, scratch->list[i].id, &own->ends, run->frame->params.foam_detail);
        }
    }
    if (cpu->foam->ends.data) {
        add_cut_foam(run, scratch, count);
    }
    cpu->kernels->splat->resolve_sum(view, &scratch->tile, 0, &cpu->foam->thickness);
    cpu->kernels->splat->resolve_sum(view, &scratch->tile, 1, &cpu->foam->front);
}

/* Ranges of the foam's depth in the blocks of the tile. Returns the farthest. */
static float measure_limits(const struct splat_view *view, const float *limits, struct depth_range ranges[TILE_BLOCKS])
{
    float farthest = 0;
    enum { COLUMNS = TILE_SIZE >> BLOCK_SHIFT_X };
    for (int i = 0; i < TILE_BLOCKS; i++) {
        ranges[i] = (struct depth_range){.min = DEPTH_EMPTY, .max = 0};
    }
    for (int y = 0; y < TILE_SIZE / view->scale; y++) {
        const float *row = limits + (y + 1) * TILE_STRIDE + 1;
        for (int x = 0; x < TILE_SIZE / view->scale; x++) {
            struct depth_range *range = &ranges[(y * view->scale >> BLOCK_SHIFT_Y) * COLUMNS + (x * view->scale >> BLOCK_SHIFT_X)];
            range->min = row[x] > 0 && row[x] < range->min ? row[x] : range->min;
            range->max = row[x] > range->max ? row[x] : range->max;
            farthest = row[x] > farthest ? row[x] : farthest;
        }
    }
    return farthest;
}

static void add_water(const struct foam_run *run, struct tile_scratch *scratch, const struct foam_scratch *own,
                      const struct tile_entry *entry, float farthest)
{
    const struct kernels *kernels = run->cpu->kernels;
    const struct tile_chunk *chunk = &entry->chunk;
    struct splat_tile *tile = &scratch->tile;
    if (chunk->near_depth >= farthest) {
        return;
    }
    int reach = (int)ceilf(SUM_REACH * (float)run->water.scale); /* a texel beyond the foam's own pixels may hold some of it */
    struct depth_range range = mns_cut_range(&scratch->scene, chunk->x_min - tile->x - reach, chunk->x_max - tile->x + reach,
                                             chunk->y_min - tile->y - reach, chunk->y_max - tile->y + reach);
    if (chunk->near_depth >= range.max) {
        return;
    }
    bool shaped = run->water.particles->shape[0] != NULL, cut = chunk->far_depth > range.min;
    if (tile_chunk_is_cut(&run->water, chunk) || (shaped && cut)) {
        scratch->scene.depth = &run->cpu->foam->depth.plane;
        mns_cut_thickness(&run->water, tile, entry->id, UINT64_MAX, &scratch->scene);
    } else if (shaped) {
        kernels->ellipsoid->thickness(&run->water, tile, entry->id, DEPTH_EMPTY);
    } else if (!cut) {
        kernels->splat->thickness(&run->water, tile, entry->id, DEPTH_EMPTY);
    } else {
        kernels->foam->front(&run->water, tile, entry->id, own->limits, range.max);
    }
}

/* T_wf and the thickness in the tile's texels with foam; nothing in the others. */
static void write_water(const struct foam_run *run, const struct splat_tile *tile, const float *limits)
{
    struct foam *foam = run->cpu->foam;
    const struct plane *all = &run->cpu->raw.thickness;
    int left = tile->x / run->water.scale, top = tile->y / run->water.scale;
    for (int y = 0; y < tile->texels.rows; y++) {
        float *before = foam->sums[0].data + (top + y) * foam->sums[0].stride + left;
        float *both = foam->sums[1].data + (top + y) * foam->sums[1].stride + left;
        const float *from = all->data + (top + y) * all->stride + left, *limit = limits + (y + 1) * TILE_STRIDE + 1;
        for (int x = 0; x < tile->texels.columns; x++) {
            both[x] = limit[x] > 0 ? from[x] : 0;
            before[x] = before[x] < both[x] ? before[x] : both[x];
        }
    }
}

static void draw_water(const struct foam_run *run, struct tile_scratch *scratch, const struct foam_scratch *own, size_t index)
{
    const struct tiles *tiles = &run->cpu->tiles[STORE_WATER];
    struct foam *foam = run->cpu->foam;
    size_t count = mns_tile_begin(tiles, index, scratch);
    run->cpu->kernels->foam->limits(&run->water, &scratch->tile, &foam->depth.plane, own->limits);
    float farthest = measure_limits(&run->water, own->limits, scratch->scene.ranges);
    mns_tile_clear(&run->water, &scratch->tile, 1);
    for (size_t i = 0; i < count; i++) {
        add_water(run, scratch, own, &scratch->list[i], farthest);
    }
    run->cpu->kernels->splat->resolve_sum(&run->water, &scratch->tile, 0, &foam->sums[0]);
    write_water(run, &scratch->tile, own->limits);
}

/* No foam in the tile's texels. */
static void write_nothing(const struct foam_run *run, int x, int y)
{
    int scale = run->water.scale, columns = least(TILE_SIZE, run->water.width - x), rows = least(TILE_SIZE, run->water.height - y);
    for (int k = 0; k < 2; k++) {
        struct plane *sums = &run->cpu->foam->sums[k];
        for (int row = y / scale; row * scale < y + rows; row++) {
            memset(sums->data + row * sums->stride + x / scale, 0, sizeof(float) * (size_t)((columns + scale - 1) / scale));
        }
    }
}

static bool draw_tile(const struct foam_run *run, struct tile_scratch *scratch, const struct foam_scratch *own, size_t index)
{
    struct backend *cpu = run->cpu;
    const struct tiles *tiles = &cpu->tiles[STORE_FOAM];
    size_t count = mns_tile_begin(tiles, index, scratch);
    struct splat_tile *tile = &scratch->tile;
    if (count > 0) {
        mns_tile_depth(tiles, cpu->kernels->splat, scratch, count);
        count = cpu->kernels->splat->resolve_depth(&tiles->view, tile, &cpu->foam->depth) > 0 ? count : 0;
    }
    struct foam_ends ends = own->ends;
    if (count == 0 || cpu->kernels->foam->ends(&tiles->view, tile, run->delta, run->scene, &cpu->foam->depth.plane, &ends) == 0) {
        write_nothing(run, tile->x, tile->y);
        return false;
    }
    draw_foam(run, scratch, own, count);
    draw_water(run, scratch, own, index);
    return true;
}

static void tiles_job(void *context, int index)
{
    struct foam_run *run = context;
    struct foam *foam = run->cpu->foam;
    const struct tiles *tiles = &run->cpu->tiles[STORE_FOAM];
    size_t count = (size_t)tiles->columns * (size_t)tiles->rows;
    for (size_t tile = atomic_fetch_add(&run->next, 1); tile < count; tile = atomic_fetch_add(&run->next, 1)) {
        foam->tiles[tile] = draw_tile(run, &run->cpu->scratch->threads[index], &foam->scratch[index], tile);
        if (foam->tiles[tile]) {
            atomic_store(&run->shows, true);
        }
    }
}

/* Blurred T_wf over the blurred thickness of the same texels, the repeated edges too. */
static void divide(struct backend *cpu)
{
    struct foam *foam = cpu->foam;
    for (int y = -1; y <= foam->before.height; y++) {
        float *before = foam->before.data + y * foam->before.stride;
        const float *both = foam->blurred.data + y * foam->blurred.stride;
        for (int x = -1; x <= foam->before.width; x++) {
            before[x] = both[x] > 0 && before[x] > 0 ? fminf(before[x] / both[x], 1) : 0;
        }
    }
}

static void free_scratch(struct foam *foam, struct memory *memory)
{
    for (int i = 0; i < foam->scratch_count; i++) {
        mns_memory_put(memory, foam->scratch[i].ends.all, TILE_SIZE * TILE_STRIDE, sizeof(float));
        mns_memory_put(memory, foam->scratch[i].ends.front, TILE_SIZE * TILE_STRIDE, sizeof(float));
        mns_memory_put(memory, foam->scratch[i].limits, LIMIT_FLOATS, sizeof(float));
    }
    mns_memory_put(memory, foam->scratch, (size_t)foam->scratch_count, sizeof(*foam->scratch));
    foam->scratch = NULL;
    foam->scratch_count = 0;
}

static float *get_floats(struct memory *memory, size_t count)
{
    float *floats = mns_memory_get(memory, count, sizeof(float));
    if (floats) {
        memset(floats, 0, count * sizeof(float)); /* what is beside the picture is read, and not used */
    }
    return floats;
}

static bool reserve_scratch(struct foam *foam, struct memory *memory, int threads)
{
    if (foam->scratch_count == threads) {
        return true;
    }
    free_scratch(foam, memory);
    foam->scratch = mns_memory_get(memory, (size_t)threads, sizeof(*foam->scratch));
    bool done = foam->scratch != NULL;
    foam->scratch_count = done ? threads : 0;
    for (int i = 0; i < foam->scratch_count; i++) {
        foam->scratch[i] = (struct foam_scratch){
            .ends = {.all = get_floats(memory, TILE_SIZE * TILE_STRIDE), .front = get_floats(memory, TILE_SIZE * TILE_STRIDE)},
            .limits = get_floats(memory, LIMIT_FLOATS)};
        done = done && foam->scratch[i].ends.all && foam->scratch[i].ends.front && foam->scratch[i].limits;
    }
    if (!done) {
        free_scratch(foam, memory);
    }
    return done;
}

static bool is_any_cut(const struct tiles *tiles)
{
    for (size_t i = 0; i < tiles->view.particles->chunk_count; i++) {
        if (tiles->chunks[i].x_min <= tiles->chunks[i].x_max && tile_chunk_is_cut(&tiles->view, &tiles->chunks[i])) {
            return true;
        }
    }
    return false;
}

static bool reserve(struct backend *cpu, const struct frame *frame)
{
    struct memory *memory = cpu->host.memory;
    struct foam *foam = cpu->foam;
    const struct tiles *tiles = &cpu->tiles[STORE_FOAM], *water = &cpu->tiles[STORE_WATER];
    int width = frame->view.width, height = frame->view.height;
    const struct plane *texels = &cpu->raw.thickness;
    size_t count = (size_t)tiles->columns * (size_t)tiles->rows;
    foam->columns = tiles->columns;
    foam->tiles = mns_memory_reserve(memory, foam->tiles, &foam->tile_capacity, count, sizeof(*foam->tiles));
    bool done = foam->tiles && reserve_scratch(foam, memory, cpu->host.threads) &&
                mns_depth_plane_resize(&foam->depth, memory, width, height) &&
                mns_plane_resize(&foam->thickness, memory, width, height, 0) && mns_plane_resize(&foam->front, memory, width, height, 0) &&
                mns_plane_resize(&foam->before, memory, texels->width, texels->height, 1) &&
                mns_plane_resize(&foam->blurred, memory, texels->width, texels->height, 1);
    for (int k = 0; k < 2; k++) {
        done = done && mns_plane_resize(&foam->sums[k], memory, texels->width, texels->height, PLANE_BORDER);
    }
    if (done && is_any_cut(tiles)) {
        done = mns_plane_resize(&foam->ends, memory, width, height, 0);
    } else {
        mns_plane_free(&foam->ends, memory);
    }
    const struct tiles *fullest = tiles->largest > water->largest ? tiles : water;
    return done && mns_scratch_reserve(cpu->scratch, fullest, 2, memory, cpu->host.threads);
}

mns_result mns_cpu_foam(struct backend *cpu, const struct frame *frame)
{
    if (cpu->foam) {
        cpu->foam->shows = false;
    }
    if (frame->params.foam != MNS_FOAM_LAYERED || cpu->stores[STORE_FOAM].count == 0) {
        return MNS_OK;
    }
    if (!cpu->foam) {
        cpu->foam = mns_memory_get(cpu->host.memory, 1, sizeof(*cpu->foam));
        if (!cpu->foam) {
            return cpu_out_of_memory(cpu);
        }
        *cpu->foam = (struct foam){0};
    }
    mns_result result = mns_cpu_bin_store(cpu, frame, STORE_FOAM, frame->params.foam_radius);
    if (result != MNS_OK) {
        return result;
    }
    cpu->tiles[STORE_FOAM].view.scale = 1; /* detail is as fine as the picture */
    if (!reserve(cpu, frame)) {
        return cpu_out_of_memory(cpu);
    }
    struct foam_run run = {.cpu = cpu, .frame = frame, .delta = frame->params.foam_range * frame->splat_radius};
    run.water = cpu->tiles[STORE_WATER].view;
    run.water.has_color = false;
    run.scene = cpu->scene.has_depth ? &cpu->scene.depth : NULL;
    cpu_run(cpu, tiles_job, &run, cpu->host.threads);
    cpu->foam->shows = atomic_load(&run.shows);
    if (cpu->foam->shows) {
        mns_cpu_blur_plane(cpu, frame, &cpu->foam->sums[0], &cpu->foam->before);
        mns_cpu_blur_plane(cpu, frame, &cpu->foam->sums[1], &cpu->foam->blurred);
        divide(cpu);
    }
    return MNS_OK;
}

void mns_foam_destroy(struct backend *cpu)
{
    struct memory *memory = cpu->host.memory;
    struct foam *foam = cpu->foam;
    if (!foam) {
        return;
    }
    free_scratch(foam, memory);
    mns_memory_put(memory, foam->tiles, foam->tile_capacity, sizeof(*foam->tiles));
    mns_depth_plane_free(&foam->depth, memory);
    struct plane *planes[] = {&foam->thickness, &foam->front, &foam->before, &foam->sums[0], &foam->sums[1], &foam->blurred, &foam->ends};
    for (size_t i = 0; i < sizeof(planes) / sizeof(planes[0]); i++) {
        mns_plane_free(planes[i], memory);
    }
    mns_memory_put(memory, foam, 1, sizeof(*foam));
    cpu->foam = NULL;
}
