/* noise.c: stage noise: the pattern that the particles carry, summed on the smoothed surface.
 * In: the particle store, backend->smoothed. Out: backend->noise, when the parameter foam is noise.
 * Based on: van der Laan, Green and Sainz 2009, section 3.4 ([LGS09]); US 8,947,430, eq. 14 to 16 ([P430]). */
#include "cpu/noise.h"

#include "cpu/cpu.h"
#include "cpu/tiles.h"
#include "util/prefetch.h"

#include <math.h>
#include <string.h>

struct noise_run {
    struct backend *cpu;
    struct noise_view noise;
    atomic_size_t next; /* tile to draw */
};

/* Gradients of unit length in 2^16 directions, by a hash of their place. */
static bool make_lattice(struct backend *cpu)
{
    if (cpu->noise_lattice) {
        return true;
    }
    float *lattice = cpu->noise_lattice = mns_memory_get(cpu->host.memory, 2 * (size_t)NOISE_LATTICE_FLOATS, sizeof(float));
    for (int i = 0; lattice && i < NOISE_LATTICE_FLOATS; i++) {
        int row = i / NOISE_LATTICE_STRIDE, column = i % NOISE_LATTICE_STRIDE % NOISE_LATTICE;
        float turn, unused;
        noise_window((float)(row * NOISE_LATTICE + column), 0, &turn, &unused);
        double angle = (double)turn * (2 * 3.14159265358979323846 / 64);
        lattice[i] = (float)cos(angle);
        lattice[NOISE_LATTICE_FLOATS + i] = (float)sin(angle);
    }
    return lattice != NULL;
}

static float nearer(float a, float b) { return a < b ? a : b; }
static float farther(float a, float b) { return a > b ? a : b; }

/* The surface's ranges in the tile's blocks. Returns the range of all: none where there is no surface. */
static struct depth_range measure(const struct splat_tile *tile, const struct plane *depth, struct noise_ranges *out)
{
    enum { AHEAD = 8 }; /* rows, from anywhere in memory */
    struct depth_range all = {.min = DEPTH_EMPTY, .max = 0};
    const float *corner = depth->data + tile->y * depth->stride + tile->x;
    for (int by = 0; by < NOISE_BLOCKS; by++) {
        float near[TILE_SIZE], far[TILE_SIZE];
        for (int x = 0; x < TILE_SIZE; x++) {
            near[x] = DEPTH_EMPTY;
            far[x] = 0;
        }
        for (int y = by << NOISE_BLOCK_SHIFT; y < tile->pixels.rows && y < (by + 1) << NOISE_BLOCK_SHIFT; y++) {
            const float *row = corner + y * depth->stride;
            for (int x = 0; x < tile->pixels.columns && y + AHEAD < tile->pixels.rows; x += 16) {
                mns_prefetch(row + AHEAD * depth->stride + x);
            }
            for (int x = 0; x < tile->pixels.columns; x++) {
                near[x] = nearer(near[x], row[x]);
                far[x] = farther(far[x], row[x] < DEPTH_LIMIT ? row[x] : 0);
            }
        }
        for (int bx = 0; bx < NOISE_BLOCKS; bx++) {
            const int x = bx << NOISE_BLOCK_SHIFT;
            out->near[bx][by] = nearer(nearer(near[x], near[x + 1]), nearer(near[x + 2], near[x + 3]));
            out->far[bx][by] = farther(farther(far[x], far[x + 1]), farther(far[x + 2], far[x + 3]));
            all.min = nearer(all.min, out->near[bx][by]);
            all.max = farther(all.max, out->far[bx][by]);
        }
    }
    return all;
}

/* Takes the ranges of the blocks that stand so far from those of column x in. */
static void take_in(struct noise_ranges *ranges, const struct noise_ranges *from, int x, int across, int down)
{
    if (x + across < 0 || x + across >= NOISE_BLOCKS) {
        return;
    }
    int begin = down < 0 ? -down : 0, end = down > 0 ? NOISE_BLOCKS - down : NOISE_BLOCKS;
    for (int y = begin; y < end; y++) {
        ranges->near[x][y] = nearer(ranges->near[x][y], from->near[x + across][y + down]);
        ranges->far[x][y] = farther(ranges->far[x][y], from->far[x + across][y + down]);
    }
}

/* Each block's range becomes that over all up to `reach` blocks from it, across or down. */
static void look_around(struct noise_ranges *ranges, int reach, bool down)
{
    for (int done = 0; done < reach;) {
        int step = 2 * done + 1 < reach - done ? 2 * done + 1 : reach - done; /* no gap between what each has seen */
        struct noise_ranges from = *ranges;
        for (int x = 0; x < NOISE_BLOCKS; x++) {
            take_in(ranges, &from, x, down ? 0 : -step, down ? -step : 0);
            take_in(ranges, &from, x, down ? 0 : step, down ? step : 0);
        }
        done += step;
    }
}

/* Blocks that the largest of the tile's splats may reach beyond that of its centre. */
static int reach_of(const struct tile_entry *list, size_t count)
{
    float largest = 0;
    for (size_t i = 0; i < count; i++) {
        largest = fmaxf(largest, list[i].chunk.sprite);
    }
    float blocks = ceilf(largest / (1 << NOISE_BLOCK_SHIFT));
    return blocks < NOISE_BLOCKS ? (int)blocks : NOISE_BLOCKS;
}

static void write_tile(const struct splat_tile *tile, const float *sums, struct plane *out)
{
    for (int y = 0; y < tile->pixels.rows; y++) {
        memcpy(out->data + (tile->y + y) * out->stride + tile->x, sums + y * TILE_STRIDE, (size_t)tile->pixels.columns * sizeof(float));
    }
}

/* Asks for a chunk's positions. */
static void prefetch_chunk(const struct particle_store *particles, size_t chunk)
{
    for (size_t i = chunk * CHUNK_SIZE; i < (chunk + 1) * CHUNK_SIZE; i += 16) {
        mns_prefetch(particles->x + i);
        mns_prefetch(particles->y + i);
        mns_prefetch(particles->z + i);
    }
}

static void draw_tile(struct noise_run *run, struct tile_scratch *scratch, size_t index)
{
    enum { AHEAD = 4 }; /* chunks */
    struct backend *cpu = run->cpu;
    const struct plane *depth = &cpu->smoothed->plane;
    struct splat_tile *tile = &scratch->tile;
    size_t count = mns_tile_begin(&cpu->tiles[STORE_WATER], index, scratch);
    struct noise_tile out;
    out.pixels = tile->pixels;
    out.depth = depth->data + tile->y * depth->stride + tile->x;
    out.stride = depth->stride;
    out.sums = tile->sums[0];
    memset(out.sums, 0, TILE_SIZE * TILE_STRIDE * sizeof(float));
    struct depth_range range = measure(tile, depth, &out.beside);
    if (range.max > 0) {
        int reach = reach_of(scratch->list, count);
        look_around(&out.beside, reach, false);
        out.around = out.beside;
        look_around(&out.around, reach, true);
        for (size_t i = 0; i < count; i++) {
            if (i + AHEAD < count) {
                prefetch_chunk(run->noise.view->particles, scratch->list[i + AHEAD].id);
            }
            if (scratch->list[i].chunk.near_depth < range.max && scratch->list[i].chunk.far_depth > range.min) {
                cpu->kernels->noise->splat(&run->noise, &out, scratch->list[i].id);
            }
        }
    }
    write_tile(tile, out.sums, &cpu->noise);
}

static void tiles_job(void *context, int index)
{
    struct noise_run *run = context;
    const struct tiles *tiles = &run->cpu->tiles[STORE_WATER];
    size_t count = (size_t)tiles->columns * (size_t)tiles->rows;
    for (size_t tile = atomic_fetch_add(&run->next, 1); tile < count; tile = atomic_fetch_add(&run->next, 1)) {
        draw_tile(run, &run->cpu->scratch->threads[index], tile);
    }
}

mns_result mns_cpu_noise(struct backend *cpu, const struct frame *frame)
{
    const struct mns_params *params = &frame->params;
    if (params->foam != MNS_FOAM_NOISE) {
        return MNS_OK;
    }
    struct memory *memory = cpu->host.memory;
    struct tiles *tiles = &cpu->tiles[STORE_WATER];
    tiles->view.radius *= params->noise_radius; /* from here on its spheres are the balls, whatever shape the water's splats have */
    tiles->view.radius_scale *= params->noise_radius;
    tiles->view.box_stretch = NULL;
    tiles->view.sum_stretch = 0;
    mns_result result = mns_cpu_bin_view(cpu, tiles);
    if (result != MNS_OK) {
        return result;
    }
    if (!mns_scratch_reserve(cpu->scratch, tiles, 1, memory, cpu->host.threads) || !make_lattice(cpu) ||
        !mns_plane_resize(&cpu->noise, memory, frame->view.width, frame->view.height, SHADE_MARGIN)) {
        return cpu_out_of_memory(cpu);
    }
    float at_surface = 1 - 1 / (params->noise_radius * params->noise_radius);
    struct noise_run run = {.cpu = cpu,
                            .noise = {.view = &tiles->view,
                                      .lattice = {cpu->noise_lattice, cpu->noise_lattice + NOISE_LATTICE_FLOATS},
                                      .per_weight = 1 / (at_surface * at_surface * at_surface),
                                      .cell = params->noise_scale / params->noise_radius,
                                      .gain = params->noise_gain,
                                      .octaves = params->noise_octaves}};
    cpu_run(cpu, tiles_job, &run, cpu->host.threads);
    return MNS_OK;
}

void mns_noise_destroy(struct backend *cpu)
{
    struct memory *memory = cpu->host.memory;
    mns_plane_free(&cpu->noise, memory);
    mns_memory_put(memory, cpu->noise_lattice, cpu->noise_lattice ? 2 * (size_t)NOISE_LATTICE_FLOATS : 0, sizeof(float));
}
