/* splat_bench.h: chunks of balls and one tile, twice, for the kernels that draw into it. */
#ifndef MNS_TESTS_KERNELS_SPLAT_BENCH_H
#define MNS_TESTS_KERNELS_SPLAT_BENCH_H

#include "splat_test.h"

#include "cpu/ellipsoid.h"
#include "cpu/sprite.h"
#include "cpu/tiles.h"

enum { CHUNKS = 24, COUNT = CHUNKS * CHUNK_SIZE - 11 };

/* Chunks of balls, and the tile that they are drawn in: twice the same, for two tables of kernels. */
struct bench {
    struct memory memory;
    struct particle_store store;
    struct splat_view view;
    struct tiles tiles;
    struct tiles_scratch scratch;
    struct splat_tile *tile[2];
};

enum kind { PERSPECTIVE, OFF_CENTER, ORTHOGRAPHIC, OWN_RADII, SHAPES, SHAPES_ORTHOGRAPHIC, SHAPES_OWN_RADII, KINDS };

/* Symmetric, each row's off-diagonal terms under half of the diagonal one: semi-axes from 0.3 to 2.5. */
static inline void random_shapes(struct bench *b, uint64_t *seed)
{
    for (int k = 0; k < 6; k++) {
        b->store.shape[k] = mns_memory_get(&b->memory, CHUNKS * CHUNK_SIZE, sizeof(float));
        for (size_t i = 0; i < CHUNKS * CHUNK_SIZE; i++) {
            double u = random_unit(seed);
            b->store.shape[k][i] = (float)(k < 3 ? 0.6 + u : 0.25 * u - 0.15);
        }
    }
}

static inline void open_bench(struct bench *b, enum kind kind, int scale, float pixels)
{
    memset(b, 0, sizeof(*b));
    mns_memory_init(&b->memory, NULL);
    b->store = (struct particle_store){.count = COUNT, .chunk_count = CHUNKS};
    float **arrays[] = {&b->store.x,        &b->store.y,        &b->store.z,        &b->store.radius, &b->store.mass,
                        &b->store.color[0], &b->store.color[1], &b->store.color[2], &b->store.age,    &b->store.seed};
    uint64_t seed = 77 + (uint64_t)kind;
    for (int k = 0; k < 10; k++) {
        *arrays[k] = mns_memory_get(&b->memory, CHUNKS * CHUNK_SIZE, sizeof(float));
        for (size_t i = 0; i < CHUNKS * CHUNK_SIZE; i++) {
            double u = random_unit(&seed);
            (*arrays[k])[i] = (float)(k < 2 ? 3 * u - 1.5 : k == 2 ? 2 * u - 1 : k < 8 ? 0.2 + u : k == 8 ? u : floor(0x1p24 * u));
        }
    }
    for (int k = 0; k < 3; k++) {
        float *from = *arrays[k];
        b->store.box_min[k] = mns_memory_get(&b->memory, 32, sizeof(float));
        b->store.box_max[k] = mns_memory_get(&b->memory, 32, sizeof(float));
        for (size_t chunk = 0; chunk < CHUNKS; chunk++) {
            b->store.box_min[k][chunk] = b->store.box_max[k][chunk] = from[chunk * CHUNK_SIZE];
            for (size_t i = chunk * CHUNK_SIZE; i < (chunk + 1) * CHUNK_SIZE; i++) {
                b->store.box_min[k][chunk] = fminf(b->store.box_min[k][chunk], from[i]);
                b->store.box_max[k][chunk] = fmaxf(b->store.box_max[k][chunk], from[i]);
            }
        }
    }
    b->store.box_radius = mns_memory_get(&b->memory, 32, sizeof(float));
    b->store.box_stretch = mns_memory_get(&b->memory, 32, sizeof(float));
    for (size_t chunk = 0; chunk < CHUNKS; chunk++) {
        b->store.box_radius[chunk] = 1.2f;
        b->store.box_stretch[chunk] = 2.5f;
    }
    if (kind >= SHAPES) {
        random_shapes(b, &seed);
    }
    bool orthographic = kind == ORTHOGRAPHIC || kind == SHAPES_ORTHOGRAPHIC;
    float f = orthographic ? 70 : 260, c = 0.8f, s = 0.6f;
    b->view = (struct splat_view){.particles = &b->store,
                                  .orthographic = orthographic,
                                  .rotation = {c, 0, s, 0, 1, 0, -s, 0, c},
                                  .translation = {0.1f, -0.2f, 4},
                                  .fx = f,
                                  .fy = 1.1f * f,
                                  .cx = kind == OFF_CENTER ? -300.0f : 90.0f,
                                  .cy = 70,
                                  .width = 211,
                                  .height = 150,
                                  .near_plane = 0.1f,
                                  .far_plane = 100,
                                  .radius = pixels * (orthographic ? 1 : 4) / f,
                                  .weight = 0.7f,
                                  .has_color = true,
                                  .scale = scale,
                                  .slack = 1e-5f};
    if (kind == OFF_CENTER) {
        b->view.translation[0] = 5;
    }
    if (kind == OWN_RADII || kind == SHAPES_OWN_RADII) {
        b->view.radius_scale = b->view.radius;
        b->view.radii = b->store.radius;
        b->view.box_radii = b->store.box_radius;
        b->view.per_mass = b->view.per_cube = true;
        b->view.factors = b->store.color[2]; /* 0.2 to 1.2 will do */
        b->view.per_shape = kind == SHAPES_OWN_RADII;
        b->view.weight *= b->view.radius * b->view.radius * b->view.radius;
    }
    if (kind >= SHAPES) {
        b->view.box_stretch = b->store.box_stretch;
        b->view.sum_stretch = scale > 1 ? SMOOTH_STRETCH : 0;
    }
    b->tiles.view = b->view;
    assert_true(mns_scratch_reserve(&b->scratch, &b->tiles, SUM_COUNT, &b->memory, 2));
    for (int i = 0; i < 2; i++) {
        b->tile[i] = &b->scratch.threads[i].tile;
        b->tile[i]->pixels = (struct splat_grid){b->view.fx, b->view.fy, b->view.cx, b->view.cy, 128, 121};
        b->tile[i]->texels = (struct splat_grid){
            b->view.fx / (float)scale, b->view.fy / (float)scale, b->view.cx / (float)scale, b->view.cy / (float)scale, 128 / scale,
            (121 + scale - 1) / scale};
        b->tile[i]->shift_x = b->tile[i]->shift_y = 6;
        for (int y = 0; y < TILE_SIZE; y++) {
            for (int x = 0; x < TILE_STRIDE; x++) {
                b->tile[i]->nearest[y * TILE_STRIDE + x] = y < 121 && x < 128 ? DEPTH_EMPTY : 0;
                for (int k = 0; k < SUM_COUNT; k++) {
                    b->tile[i]->sums[k][y * TILE_STRIDE + x] = 0;
                }
            }
        }
        for (int k = 0; k < SUM_COUNT; k++) {
            memset(b->tile[i]->cells[k], 0, (TILE_SIZE / 2 + 1) * CELL_STRIDE * sizeof(float));
        }
        for (int block = 0; block < TILE_BLOCKS; block++) {
            b->tile[i]->farthest[block] = DEPTH_EMPTY;
            b->tile[i]->per_nearest[block] = 1;
        }
    }
}

static inline void close_bench(struct bench *b)
{
    mns_scratch_free(&b->scratch, &b->memory);
    float *arrays[] = {b->store.x,        b->store.y,        b->store.z,        b->store.radius,   b->store.mass,     b->store.color[0],
                       b->store.color[1], b->store.color[2], b->store.shape[0], b->store.shape[1], b->store.shape[2], b->store.shape[3],
                       b->store.shape[4], b->store.shape[5], b->store.age,      b->store.seed};
    for (int k = 0; k < 16; k++) {
        mns_memory_put(&b->memory, arrays[k], CHUNKS * CHUNK_SIZE, sizeof(float));
    }
    for (int k = 0; k < 3; k++) {
        mns_memory_put(&b->memory, b->store.box_min[k], 32, sizeof(float));
        mns_memory_put(&b->memory, b->store.box_max[k], 32, sizeof(float));
    }
    mns_memory_put(&b->memory, b->store.box_radius, 32, sizeof(float));
    mns_memory_put(&b->memory, b->store.box_stretch, 32, sizeof(float));
    assert_int_equal(b->memory.bytes, 0);
}

#endif
