/* splat.c: stage splat: spheres to depth_raw, thickness_raw and colour sums, tile by tile.
 * In: the particle store, backend->tiles, the scene's depth. Out: backend->depth_raw with its ranges, backend->raw.
 * Based on: van der Laan, Green and Sainz 2009, sections 3.1 and 3.3 ([LGS09]); spheres are exact instead of point sprites. */
#include "cpu/cpu.h"
#include "cpu/tiles.h"

#include <math.h>
#include <string.h>

struct splat {
    struct backend *cpu;
    atomic_size_t next; /* tile to draw */
};

static int least(int a, int b) { return a < b ? a : b; }

static void write_empty(struct backend *cpu, const struct splat_tile *tile)
{
    for (int y = 0; y < tile->pixels.rows; y++) {
        float *row = cpu->depth_raw.plane.data + (tile->y + y) * cpu->depth_raw.plane.stride + tile->x;
        for (int x = 0; x < tile->pixels.columns; x++) {
            row[x] = DEPTH_EMPTY;
        }
    }
    for (int y = 0; y < tile->pixels.rows; y += BLOCK_HEIGHT) {
        for (int x = 0; x < tile->pixels.columns; x += BLOCK_WIDTH) {
            cpu->depth_raw.ranges[(tile->y + y) / BLOCK_HEIGHT * cpu->depth_raw.blocks_x + (tile->x + x) / BLOCK_WIDTH] =
                (struct depth_range){.min = DEPTH_EMPTY, .max = DEPTH_EMPTY};
        }
    }
    struct plane *planes[SUM_COUNT] = {&cpu->raw.thickness, &cpu->raw.color[0], &cpu->raw.color[1], &cpu->raw.color[2]};
    for (int k = 0; k < (cpu->raw.has_color ? SUM_COUNT : 1); k++) {
        for (int y = 0; y < tile->texels.rows; y++) {
            float *row = planes[k]->data + (tile->y / cpu->raw.scale + y) * planes[k]->stride + tile->x / cpu->raw.scale;
            memset(row, 0, (size_t)tile->texels.columns * sizeof(float));
        }
    }
}

/* Those for spheres, or for particles with a shape. */
static struct splat_kernels kernels_of(const struct backend *cpu)
{
    struct splat_kernels table = *cpu->kernels->splat;
    if (cpu->tiles[STORE_WATER].view.particles->shape[0]) {
        table.depth = cpu->kernels->ellipsoid->depth;
        table.thickness = cpu->kernels->ellipsoid->thickness;
    }
    return table;
}

static void draw_tile(struct backend *cpu, struct tile_scratch *scratch, size_t index)
{
    const struct tiles *tiles = &cpu->tiles[STORE_WATER];
    const struct splat_kernels table = kernels_of(cpu), *kernels = &table;
    struct splat_tile *tile = &scratch->tile;
    size_t count = mns_tile_begin(tiles, index, scratch);
    if (count == 0) {
        write_empty(cpu, tile);
        return;
    }
    mns_tile_thickness(tiles, kernels, scratch, count, cpu->scene.has_depth && cpu->scene.cuts_fluid ? &cpu->scene.depth : NULL);
    kernels->resolve_sum(&tiles->view, tile, 0, &cpu->raw.thickness);
    for (int c = 0; c < 3 && cpu->raw.has_color; c++) {
        kernels->resolve_sum(&tiles->view, tile, 1 + c, &cpu->raw.color[c]);
    }
    mns_tile_depth(tiles, kernels, scratch, count);
    scratch->pixels_covered += kernels->resolve_depth(&tiles->view, tile, &cpu->depth_raw);
}

static void tiles_job(void *context, int index)
{
    struct splat *splat = context;
    const struct tiles *tiles = &splat->cpu->tiles[STORE_WATER];
    struct tile_scratch *scratch = &splat->cpu->scratch->threads[index];
    scratch->particles_splatted = scratch->pixels_covered = 0;
    size_t count = (size_t)tiles->columns * (size_t)tiles->rows;
    for (size_t tile = atomic_fetch_add(&splat->next, 1); tile < count; tile = atomic_fetch_add(&splat->next, 1)) {
        draw_tile(splat->cpu, scratch, tile);
    }
}

static bool resize(struct backend *cpu, const struct frame *frame)
{
    struct memory *memory = cpu->host.memory;
    const struct splat_view *view = &cpu->tiles[STORE_WATER].view;
    int width = (view->width + view->scale - 1) / view->scale, height = (view->height + view->scale - 1) / view->scale;
    cpu->raw.scale = view->scale;
    cpu->raw.has_color = view->has_color;
    bool done = mns_depth_plane_resize(&cpu->depth_raw, memory, frame->view.width, frame->view.height) &&
                mns_plane_resize(&cpu->raw.thickness, memory, width, height, PLANE_BORDER);
    for (int c = 0; c < 3; c++) {
        if (view->has_color) {
            done = done && mns_plane_resize(&cpu->raw.color[c], memory, width, height, PLANE_BORDER);
        } else {
            mns_plane_free(&cpu->raw.color[c], memory);
        }
    }
    return done;
}

struct layers {
    const struct backend *cpu;
    const struct mns_image *depth, *thickness;
};

static float *output_row(const struct mns_image *image, int y)
{
    size_t stride = image->stride > 0 ? image->stride : (size_t)image->width * sizeof(float);
    return (float *)(void *)((char *)image->data + (size_t)y * stride);
}

/* One row of the texels, bilinearly between their centres; at one pixel per texel as it is. */
static void write_thickness_row(const struct thickness_image *raw, float *out, int y, int width)
{
    float per = 1.0f / (float)raw->scale, ty = fmaxf(((float)y + 0.5f) * per - 0.5f, 0);
    int y0 = (int)ty, y1 = least(y0 + 1, raw->thickness.height - 1);
    const float *above = raw->thickness.data + y0 * raw->thickness.stride, *below = raw->thickness.data + y1 * raw->thickness.stride;
    float fy = ty - (float)y0;
    for (int x = 0; x < width; x++) {
        float tx = fmaxf(((float)x + 0.5f) * per - 0.5f, 0), fx = tx - floorf(tx);
        int x0 = (int)tx, x1 = least(x0 + 1, raw->thickness.width - 1);
        float top = above[x0] + fx * (above[x1] - above[x0]), bottom = below[x0] + fx * (below[x1] - below[x0]);
        out[x] = top + fy * (bottom - top);
    }
}

static void layers_job(void *context, int y)
{
    const struct layers *layers = context;
    const struct plane *depth = &layers->cpu->depth_raw.plane;
    if (layers->depth) {
        float *out = output_row(layers->depth, y);
        const float *row = depth->data + y * depth->stride;
        for (int x = 0; x < depth->width; x++) {
            out[x] = row[x] < DEPTH_LIMIT ? row[x] : INFINITY;
        }
    }
    if (layers->thickness) {
        write_thickness_row(&layers->cpu->raw, output_row(layers->thickness, y), y, depth->width);
    }
}

mns_result mns_cpu_splat(struct backend *cpu, const struct frame *frame)
{
    const struct tiles *tiles = &cpu->tiles[STORE_WATER];
    int sums = tiles->view.has_color ? SUM_COUNT : 1;
    if (!resize(cpu, frame) || !mns_scratch_reserve(cpu->scratch, tiles, sums, cpu->host.memory, cpu->host.threads)) {
        return cpu_out_of_memory(cpu);
    }
    struct splat splat = {.cpu = cpu};
    cpu_run(cpu, tiles_job, &splat, cpu->host.threads);
    cpu->stats.particles_splatted = cpu->stats.pixels_covered = 0;
    for (int i = 0; i < cpu->host.threads; i++) {
        cpu->stats.particles_splatted += cpu->scratch->threads[i].particles_splatted;
        cpu->stats.pixels_covered += cpu->scratch->threads[i].pixels_covered;
    }
    struct layers layers = {
        .cpu = cpu, .depth = mns_frame_output(frame, MNS_LAYER_DEPTH_RAW), .thickness = mns_frame_output(frame, MNS_LAYER_THICKNESS_RAW)};
    if (layers.depth || layers.thickness) {
        cpu_run(cpu, layers_job, &layers, frame->view.height);
    }
    return MNS_OK;
}
