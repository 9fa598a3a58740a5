/* The kernel of stage noise: every instruction set against plain C, and plain C against values worked by hand. */
#include "kernels/kernel_test.h"

#include "cpu/noise.h"

enum { CHUNKS = 6, COUNT = CHUNKS * CHUNK_SIZE - 9, PADDED = CHUNKS * CHUNK_SIZE, ROW = TILE_SIZE + 32 };

static _Alignas(64) float positions[3][PADDED], seeds[PADDED], amplitudes[PADDED], radii[PADDED], lattice[2][NOISE_LATTICE_FLOATS];
static float depth[TILE_SIZE][ROW], expected[TILE_SIZE * TILE_STRIDE], got[TILE_SIZE * TILE_STRIDE];

static struct particle_store store = {
    .count = COUNT, .chunk_count = CHUNKS, .x = positions[0], .y = positions[1], .z = positions[2], .seed = seeds, .radius = radii};

/* No block says that nothing is near: the ranges only save work. */
static void open_ranges(struct noise_ranges *ranges)
{
    for (int i = 0; i < NOISE_BLOCKS; i++) {
        for (int k = 0; k < NOISE_BLOCK_STRIDE; k++) {
            ranges->near[i][k] = 0;
            ranges->far[i][k] = DEPTH_EMPTY;
        }
    }
}

static void draw(const struct noise_kernels *kernels, const struct noise_view *noise, float *sums)
{
    static struct noise_tile tile;
    const struct splat_view *view = noise->view;
    tile.pixels = (struct splat_grid){view->fx, view->fy, view->cx, view->cy, 128, 119};
    tile.depth = depth[0];
    tile.stride = ROW;
    tile.sums = sums;
    open_ranges(&tile.beside);
    open_ranges(&tile.around);
    memset(sums, 0, TILE_SIZE * TILE_STRIDE * sizeof(float));
    for (size_t chunk = 0; chunk < store.chunk_count; chunk++) {
        kernels->splat(noise, &tile, chunk);
    }
}

static struct splat_view view_of(bool orthographic)
{
    return (struct splat_view){.particles = &store,
                               .orthographic = orthographic,
                               .rotation = {0.8f, 0, 0.6f, 0, 1, 0, -0.6f, 0, 0.8f},
                               .translation = {0.1f, -0.2f, 5},
                               .fx = orthographic ? 60 : 260,
                               .fy = orthographic ? 66 : 286,
                               .cx = 70,
                               .cy = 50,
                               .width = 400,
                               .height = 300,
                               .near_plane = 0.1f,
                               .far_plane = 100,
                               .radii = radii};
}

static void test_instruction_sets(void **state)
{
    (void)state;
    for (int i = 0; i < PADDED; i++) {
        for (int k = 0; k < 3; k++) {
            positions[k][i] = uniform(-1.2f, 1.2f);
        }
        seeds[i] = floorf(uniform(0, 16777215));
        amplitudes[i] = uniform(0, 1) < 0.2f ? 0 : uniform(0, 1);
        radii[i] = uniform(0.2f, 1.3f);
    }
    for (int y = 0; y < TILE_SIZE; y++) {
        for (int x = 0; x < ROW; x++) {
            depth[y][x] = x >= 128 ? 0 : (x + y) % 31 == 0 ? DEPTH_EMPTY : 4.4f + 0.01f * (float)x + 0.3f * sinf(0.1f * (float)y);
        }
    }
    for (int i = 0; i < NOISE_LATTICE_FLOATS; i++) {
        float angle = uniform(0, 6.2831853f);
        bool again = i % NOISE_LATTICE_STRIDE >= NOISE_LATTICE; /* the first columns of the row */
        lattice[0][i] = again ? lattice[0][i - NOISE_LATTICE] : cosf(angle);
        lattice[1][i] = again ? lattice[1][i - NOISE_LATTICE] : sinf(angle);
    }
    for (int kind = 0; kind < 24; kind++) {
        static const float reaches[] = {0.1f, 0.3f, 0.9f};
        struct splat_view view = view_of(kind % 2 == 1);
        float reach = reaches[kind / 2 % 3];
        view.radius = reach;
        view.radius_scale = kind / 6 % 2 ? reach : 0;
        store.noise = kind / 12 ? amplitudes : NULL;
        struct noise_view noise = {.view = &view,
                                   .lattice = {lattice[0], lattice[1]},
                                   .per_weight = 2,
                                   .cell = 0.6f,
                                   .gain = 0.6f,
                                   .octaves = kind % 3 == 0 ? 6 : 2};
        draw(mns_kernels_get(MNS_ISA_SCALAR)->noise, &noise, expected);
        float largest = 0;
        for (int i = 0; i < TILE_SIZE * TILE_STRIDE; i++) {
            largest = fmaxf(largest, fabsf(expected[i]));
        }
        assert_true(largest > 0.1f);
        const struct kernels *vector;
        for (int index = 0; (vector = vector_kernels(&index));) {
            draw(vector->noise, &noise, got);
            for (int y = 0; y < 119; y++) { /* what a splat displaced by 1e-4 pixels makes: an octave is no finer than 2 pixels a cell */
                assert_near(got + y * TILE_STRIDE, expected + y * TILE_STRIDE, 128, 1e-4f * fmaxf(largest, 2));
            }
        }
    }
    store.noise = NULL;
}

/* One particle at depth 4, 16 pixels across a metre there; the lattice's gradients all point along x. */
static void test_by_hand(void **state)
{
    (void)state;
    positions[0][0] = positions[1][0] = positions[2][0] = 0;
    seeds[0] = 12345;
    struct particle_store one = {.count = 1, .chunk_count = 1, .x = positions[0], .y = positions[1], .z = positions[2], .seed = seeds};
    struct splat_view view = {.particles = &one,
                              .orthographic = true,
                              .rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1},
                              .translation = {0, 0, 4},
                              .fx = 16,
                              .fy = 16,
                              .radius = 2};
    for (int i = 0; i < NOISE_LATTICE_FLOATS; i++) {
        lattice[0][i] = 1;
        lattice[1][i] = 0;
    }
    for (int y = 0; y < TILE_SIZE; y++) {
        for (int x = 0; x < ROW; x++) {
            depth[y][x] = 3; /* the surface is a metre before it: half of B */
        }
    }
    /* Cells of half of B, 16 pixels. The centre is moved so that pixel 40, 33 has the lattice place (whole + 1/4, anything). */
    float window_x, window_y;
    noise_window(seeds[0], 0, &window_x, &window_y);
    float u = window_x - floorf(window_x);
    view.cx = 40.5f - 16 * (0.25f - u);
    view.cy = 33.5f;
    const struct noise_view noise = {
        .view = &view, .lattice = {lattice[0], lattice[1]}, .per_weight = 1, .cell = 0.5f, .gain = 0.5f, .octaves = 1};
    store = one;
    draw(mns_kernels_get(MNS_ISA_SCALAR)->noise, &noise, expected);
    /* 6 t^5 - 15 t^4 + 10 t^3 = 0.103515625 at 1/4, so Perlin's noise is 0.896484375 * 0.25 - 0.103515625 * 0.75 = 0.146484375, over its peak
     * sqrt(1/2). The surface point is gx = (0.25 - u) / 2 to the side and 1/2 before the centre: w = 1 - 1/4 - gx^2. */
    float gx = 0.5f * (0.25f - u), w = 0.75f - gx * gx;
    assert_true(fabsf(expected[33 * TILE_STRIDE + 40] - w * w * w * 0.146484375f * 1.41421356f) < 2e-6f);
    /* 12 pixels to the right it is at a point of the lattice, where Perlin's noise is 0. */
    assert_true(fabsf(expected[33 * TILE_STRIDE + 52]) < 1e-6f);
    /* Half way before that the planes are blended alike: 1/2 * 1/2 - 1/2 * 1/2. */
    assert_true(fabsf(expected[33 * TILE_STRIDE + 44]) < 1e-6f);
    /* Where the surface is farther than B nothing is added: sqrt(2^2 - 1) metres are 27.7 pixels. */
    assert_true(expected[33 * TILE_STRIDE + 8] == 0 && expected[33 * TILE_STRIDE + 100] == 0 && expected[66 * TILE_STRIDE + 40] == 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_instruction_sets), cmocka_unit_test(test_by_hand)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
