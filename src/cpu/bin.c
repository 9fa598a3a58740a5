/* bin.c: stage bin: which chunks of particles may show in which tile of the picture.
 * In: the particle store. Out: backend->tiles. Each tile's chunks stand in the order of the store, whatever the number of threads. */
#include "cpu/cpu.h"
#include "cpu/ellipsoid.h"
#include "cpu/tiles.h"

#include <math.h>
#include <string.h>

/* Parts that the chunks are counted and scattered in, at most: each holds a count per tile. */
enum { SLICES_MAX = 16 };

/* The blur must span this many texels (sigma) for a texel to be let grow to 2 or 4 pixels. Measured on a pool with a splash of 100 thousand
 * to 10 million particles: the blurred thickness is then within 0.4 % (RMS) of the blurred exact chords, 0.1 % at twice the sigma. */
static const float BLUR_TEXELS = 0.625f;

static float largest_of(const float *values, int count)
{
    float largest = 0;
    for (int i = 0; i < count; i++) {
        largest = fmaxf(largest, fabsf(values[i]));
    }
    return largest;
}

/* Pixels per texel, by the blur's sigma at the depth of the fluid's middle: one value per frame. */
static int texel_scale(const struct frame *frame)
{
    if (frame->params.thickness_scale > 0) {
        return frame->params.thickness_scale;
    }
    const struct view *view = &frame->view;
    float sigma = frame->params.thickness_blur * frame->splat_radius * view->fx;
    if (!view->orthographic) {
        float depth = view->translation[2];
        for (int k = 0; k < 3; k++) {
            depth += view->rotation[6 + k] * 0.5f * (frame->facts->bounds_min[k] + frame->facts->bounds_max[k]);
        }
        sigma /= fmaxf(depth, view->near_plane);
    }
    return sigma >= 4 * BLUR_TEXELS ? 4 : sigma >= 2 * BLUR_TEXELS ? 2 : 1;
}

/* V / (4/3 pi R^3), of particles that have their factor 1: with another both go with the cube. */
static void resolve_weight(struct splat_view *out, const struct frame *frame)
{
    const double ball = 4.18879020478639; /* volume of a sphere of radius 1 */
    double cube = frame->splat_scale > 0 ? 1 : pow((double)out->radius, 3);
    out->per_cube = frame->splat_scale > 0;
    out->weight = (float)((double)frame->volume / (ball * cube));
    if (frame->params.thickness_mode == MNS_THICKNESS_CHORD) {
        out->weight = 1;
        out->per_cube = false;
    } else if (frame->volume_per_mass > 0) {
        out->weight = (float)((double)frame->volume_per_mass / (ball * cube));
        out->per_mass = true;
    } else if (frame->volume_per_cube > 0) {
        out->weight = (float)((double)frame->volume_per_cube / (ball * pow((double)out->radius_scale, 3)));
        out->per_cube = false;
    }
}

/* larger: times as large as the water's. */
static void resolve_view(struct splat_view *out, const struct particle_store *particles, const struct frame *frame, float larger)
{
    const struct view *view = &frame->view;
    *out = (struct splat_view){.particles = particles,
                               .orthographic = view->orthographic,
                               .fx = view->fx,
                               .fy = view->fy,
                               .cx = view->cx,
                               .cy = view->cy,
                               .width = view->width,
                               .height = view->height,
                               .near_plane = view->near_plane,
                               .far_plane = view->far_plane,
                               .radius = frame->splat_radius * larger,
                               .radius_scale = frame->splat_scale * larger,
                               .radii = particles->radius,
                               .box_radii = particles->box_radius,
                               .has_color = particles->color[0] != NULL,
                               .scale = texel_scale(frame)};
    if (particles->shape[0]) {
        out->per_shape = frame->params.thickness_mode == MNS_THICKNESS_VOLUME;
        out->box_stretch = particles->box_stretch;
        out->sum_stretch = out->scale > 1 ? SMOOTH_STRETCH : 0;
    }
    memcpy(out->rotation, view->rotation, sizeof(out->rotation));
    memcpy(out->translation, view->translation, sizeof(out->translation));
    const struct particle_facts *facts = &particles->facts;
    float reach = largest_of(view->translation, 3) + 3 * fmaxf(largest_of(facts->bounds_min, 3), largest_of(facts->bounds_max, 3));
    out->slack = 1e-6f * reach; /* some 16 roundings of float, of the largest number in the projection */

    resolve_weight(out, frame);
    if (!particles->factor) {
        return;
    }
    if (out->per_cube) {
        out->factors = particles->factor;
    }
    if (frame->splat_scale <= 0) { /* one radius times the factors */
        out->radius_scale = out->radius;
        out->radii = particles->factor;
        out->box_radii = particles->box_factor;
    }
}

struct bin {
    struct tiles *tiles;
    const struct splat_kernels *kernels;
    int slices;
    size_t visible[SLICES_MAX]; /* particles */
};

/* Slices are whole batches of chunks. */
static size_t slice_begin(const struct bin *bin, int slice)
{
    size_t batches = (bin->tiles->view.particles->chunk_count + BOUNDS_BATCH - 1) / BOUNDS_BATCH, n = (size_t)bin->slices,
           i = (size_t)slice;
    return (batches / n * i + batches % n * i / n) * BOUNDS_BATCH;
}

static size_t slice_end(const struct bin *bin, int slice)
{
    size_t end = slice_begin(bin, slice + 1), count = bin->tiles->view.particles->chunk_count;
    return end < count ? end : count;
}

static size_t tile_count(const struct tiles *tiles) { return (size_t)tiles->columns * (size_t)tiles->rows; }

/* Pixel of a bound, moved into [-1, count]: what is left of the picture ends at -1, what is right of it begins at count. */
static int pixel_of(float x, int count) { return (int)floorf(fminf(fmaxf(x, -1), (float)count)); }

static struct tile_chunk chunk_of(const struct splat_view *view, const struct splat_bounds *bounds, size_t i)
{
    const float room = 0.05f; /* pixels: more than projecting can be off by rounding in the largest picture */
    int scale = view->scale, width = (view->width + scale - 1) / scale * scale, height = (view->height + scale - 1) / scale * scale;
    int x_min = pixel_of(bounds->x_min[i] - room, width), x_max = pixel_of(bounds->x_max[i] + room, width);
    int y_min = pixel_of(bounds->y_min[i] - room, height), y_max = pixel_of(bounds->y_max[i] + room, height);
    bool finite = bounds->near_depth[i] > -DEPTH_LIMIT && bounds->far_depth[i] < DEPTH_LIMIT;
    bool seen = finite && bounds->x_min[i] <= bounds->x_max[i] && x_max >= 0 && y_max >= 0 && x_min < width && y_min < height;
    if (!seen) {
        return (struct tile_chunk){.x_min = 1};
    }
    return (struct tile_chunk){.near_depth = bounds->near_depth[i],
                               .far_depth = bounds->far_depth[i],
                               .sprite = bounds->sprite[i],
                               .x_min = (uint16_t)(x_min > 0 ? x_min : 0),
                               .x_max = (uint16_t)(x_max < width ? x_max : width - 1),
                               .y_min = (uint16_t)(y_min > 0 ? y_min : 0),
                               .y_max = (uint16_t)(y_max < height ? y_max : height - 1)};
}

static void bounds_job(void *context, int slice)
{
    struct bin *bin = context;
    struct tiles *tiles = bin->tiles;
    size_t *counts = tiles->counts + (size_t)slice * tile_count(tiles), visible = 0;
    memset(counts, 0, tile_count(tiles) * sizeof(*counts));
    for (size_t first = slice_begin(bin, slice); first < slice_end(bin, slice); first += BOUNDS_BATCH) {
        struct splat_bounds bounds;
        bin->kernels->bounds(&tiles->view, first, &bounds);
        for (size_t i = 0; i < BOUNDS_BATCH && first + i < tiles->view.particles->chunk_count; i++) {
            struct tile_chunk chunk = tiles->chunks[first + i] = chunk_of(&tiles->view, &bounds, i);
            if (chunk.x_min > chunk.x_max) {
                continue;
            }
            visible++;
            for (int ty = chunk.y_min / TILE_SIZE; ty <= chunk.y_max / TILE_SIZE; ty++) {
                for (int tx = chunk.x_min / TILE_SIZE; tx <= chunk.x_max / TILE_SIZE; tx++) {
                    counts[ty * tiles->columns + tx]++;
                }
            }
        }
    }
    bin->visible[slice] = visible * CHUNK_SIZE;
}

static void scatter_job(void *context, int slice)
{
    struct bin *bin = context;
    struct tiles *tiles = bin->tiles;
    size_t *places = tiles->counts + (size_t)slice * tile_count(tiles);
    for (size_t i = slice_begin(bin, slice); i < slice_end(bin, slice); i++) {
        struct tile_chunk chunk = tiles->chunks[i];
        for (int ty = chunk.y_min / TILE_SIZE; chunk.x_min <= chunk.x_max && ty <= chunk.y_max / TILE_SIZE; ty++) {
            for (int tx = chunk.x_min / TILE_SIZE; tx <= chunk.x_max / TILE_SIZE; tx++) {
                tiles->entries[places[ty * tiles->columns + tx]++] = (uint32_t)i;
            }
        }
    }
}

/* Counts become places. */
static void sum_counts(struct bin *bin)
{
    struct tiles *tiles = bin->tiles;
    size_t place = 0, count = tile_count(tiles);
    tiles->largest = 0;
    for (size_t tile = 0; tile < count; tile++) {
        tiles->begin[tile] = place;
        for (int slice = 0; slice < bin->slices; slice++) {
            size_t *at = &tiles->counts[(size_t)slice * count + tile], chunks = *at;
            *at = place;
            place += chunks;
        }
        size_t here = place - tiles->begin[tile];
        tiles->largest = here > tiles->largest ? here : tiles->largest;
    }
    tiles->begin[count] = place;
}

static bool create(struct backend *cpu)
{
    struct memory *memory = cpu->host.memory;
    if (!cpu->tiles) {
        cpu->tiles = mns_memory_get(memory, STORE_KINDS, sizeof(*cpu->tiles));
        for (int kind = 0; cpu->tiles && kind < STORE_KINDS; kind++) {
            cpu->tiles[kind] = (struct tiles){0};
        }
    }
    if (!cpu->scratch) {
        cpu->scratch = mns_memory_get(memory, 1, sizeof(*cpu->scratch));
        if (cpu->scratch) {
            *cpu->scratch = (struct tiles_scratch){0};
        }
    }
    return cpu->tiles && cpu->scratch;
}

mns_result mns_cpu_bin_view(struct backend *cpu, struct tiles *tiles)
{
    struct memory *memory = cpu->host.memory;
    const struct particle_store *particles = tiles->view.particles;
    tiles->columns = (tiles->view.width + TILE_SIZE - 1) / TILE_SIZE;
    tiles->rows = (tiles->view.height + TILE_SIZE - 1) / TILE_SIZE;
    struct bin bin = {.tiles = tiles, .kernels = cpu->kernels->splat};
    bin.slices = cpu->host.threads < SLICES_MAX ? cpu->host.threads : SLICES_MAX;

    size_t count = tile_count(tiles);
    tiles->chunks = mns_memory_reserve(memory, tiles->chunks, &tiles->chunk_capacity, particles->chunk_count, sizeof(*tiles->chunks));
    tiles->begin = mns_memory_reserve(memory, tiles->begin, &tiles->begin_capacity, count + 1, sizeof(*tiles->begin));
    tiles->counts = mns_memory_reserve(memory, tiles->counts, &tiles->count_capacity, count * (size_t)bin.slices, sizeof(*tiles->counts));
    if (!tiles->chunks || !tiles->begin || !tiles->counts) {
        return cpu_out_of_memory(cpu);
    }
    cpu_run(cpu, bounds_job, &bin, bin.slices);
    sum_counts(&bin);
    tiles->entries = mns_memory_reserve(memory, tiles->entries, &tiles->entry_capacity, tiles->begin[count], sizeof(*tiles->entries));
    if (!tiles->entries) {
        return cpu_out_of_memory(cpu);
    }
    cpu_run(cpu, scatter_job, &bin, bin.slices);

    size_t visible = 0;
    for (int slice = 0; slice < bin.slices; slice++) {
        visible += bin.visible[slice];
    }
    tiles->particles_visible = visible < particles->count ? visible : particles->count;
    return MNS_OK;
}

mns_result mns_cpu_bin_store(struct backend *cpu, const struct frame *frame, enum store_kind kind, float larger)
{
    resolve_view(&cpu->tiles[kind].view, &cpu->stores[kind], frame, larger);
    return mns_cpu_bin_view(cpu, &cpu->tiles[kind]);
}

mns_result mns_cpu_bin(struct backend *cpu, const struct frame *frame)
{
    if (!create(cpu)) {
        return cpu_out_of_memory(cpu);
    }
    mns_result result = mns_cpu_bin_store(cpu, frame, STORE_WATER, 1);
    cpu->stats.particles_visible = cpu->tiles[STORE_WATER].particles_visible;
    return result;
}

void mns_bin_destroy(struct backend *cpu)
{
    struct memory *memory = cpu->host.memory;
    for (int kind = 0; cpu->tiles && kind < STORE_KINDS; kind++) {
        mns_tiles_free(&cpu->tiles[kind], memory);
    }
    mns_memory_put(memory, cpu->tiles, STORE_KINDS, sizeof(*cpu->tiles));
    cpu->tiles = NULL;
    if (cpu->scratch) {
        mns_scratch_free(cpu->scratch, memory);
        mns_memory_put(memory, cpu->scratch, 1, sizeof(*cpu->scratch));
        cpu->scratch = NULL;
    }
}
