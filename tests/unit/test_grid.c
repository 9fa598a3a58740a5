/* The neighbour grid against all pairs, for sets that fit its memory and sets that do not. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "particles/grid.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

static uint32_t random_state = 1;

static double uniform(void) /* in [0, 1) */
{
    random_state = random_state * 1664525u + 1013904223u;
    return (random_state >> 8) / 16777216.0;
}

static void run_in_turn(void *user, void (*job)(void *context, int index), void *context, int count)
{
    (void)user;
    for (int i = 0; i < count; i++) {
        job(context, i);
    }
}

static void run_backwards(void *user, void (*job)(void *context, int index), void *context, int count)
{
    (void)user;
    for (int i = count - 1; i >= 0; i--) {
        job(context, i);
    }
}

static struct mns_particles view(const double *p, size_t count)
{
    struct mns_particles particles;
    mns_particles_init(&particles);
    particles.count = count;
    particles.position = (struct mns_attr){.data = p, .type = MNS_F64};
    return particles;
}

static bool within(const struct grid *grid, uint32_t a, uint32_t b)
{
    float dx = grid->x[a] - grid->x[b], dy = grid->y[a] - grid->y[b], dz = grid->z[a] - grid->z[b];
    return dx * dx + dy * dy + dz * dz < grid->support * grid->support;
}

/* How many pairs the grid finds, each particle with itself included; fails where a pair comes twice. */
static size_t pairs_by_grid(const struct grid *grid, unsigned char *seen)
{
    size_t pairs = 0;
    for (int part = 0; part < 5; part++) {
        struct grid_run cells = mns_grid_part(grid, part, 5);
        for (uint32_t cell = cells.begin; cell < cells.end; cell++) {
            struct grid_run runs[GRID_RUNS];
            int count = mns_grid_neighbours(grid, cell, runs);
            for (uint32_t i = grid->start[cell]; i < grid->start[cell + 1]; i++) {
                memset(seen, 0, grid->count);
                for (int run = 0; run < count; run++) {
                    assert_true(runs[run].begin < runs[run].end);
                    for (uint32_t j = runs[run].begin; j < runs[run].end; j++) {
                        assert_false(seen[j]);
                        seen[j] = 1;
                        pairs += within(grid, i, j);
                    }
                }
            }
        }
    }
    return pairs;
}

static size_t pairs_by_hand(const struct grid *grid)
{
    size_t pairs = 0;
    for (uint32_t i = 0; i < grid->count; i++) {
        for (uint32_t j = 0; j < grid->count; j++) {
            pairs += within(grid, i, j);
        }
    }
    return pairs;
}

static void check_set(struct grid *grid, struct memory *memory, const double *p, size_t count, double support)
{
    const struct mns_parallel parallel = {.run = run_in_turn};
    struct mns_particles particles = view(p, count);
    assert_int_equal(mns_grid_fill(grid, memory, &parallel, 3, &particles, support, NULL), MNS_OK);
    assert_true(grid->cells <= GRID_CELLS_PER_PARTICLE * count + GRID_CELLS_LEAST);
    for (uint32_t i = 0; i < grid->count; i++) { /* each particle is where it says */
        const double *q = p + 3 * (size_t)grid->index[i];
        assert_true(grid->x[i] == (float)(q[0] - grid->origin[0]) && grid->z[i] == (float)(q[2] - grid->origin[2]));
    }
    unsigned char *seen = malloc(grid->count + 1);
    size_t pairs = pairs_by_grid(grid, seen);
    assert_true(pairs >= grid->count);
    assert_int_equal(pairs, pairs_by_hand(grid));
    free(seen);
}

enum { COUNT = 2500 };

static void test_finds_what_all_pairs_find(void **state)
{
    (void)state;
    struct memory memory;
    mns_memory_init(&memory, NULL);
    struct grid grid = {0};
    double *p = malloc(sizeof(double) * 3 * COUNT);
    for (int set = 0; set < 6; set++) {
        static const double extent[6][3] = {{10, 10, 10}, {400, 3, 2}, {1, 1, 1}, {300, 300, 300}, {0, 0, 0}, {12, 12, 0}};
        for (int i = 0; i < 3 * COUNT; i++) {
            p[i] = extent[set][i % 3] * uniform() + 1e4 * (i % 3);
        }
        check_set(&grid, &memory, p, set == 2 || set == 4 ? 300 : COUNT, 1);
    }
    mns_grid_free(&grid, &memory);
    assert_int_equal(memory.bytes, 0);
    free(p);
}

/* A cell is wider than the support by no more than a rounding: neighbours at just less than it on a lattice of that pitch. */
static void test_finds_neighbours_at_the_edge_of_a_cell(void **state)
{
    (void)state;
    struct memory memory;
    mns_memory_init(&memory, NULL);
    struct grid grid = {0};
    double *p = malloc(sizeof(double) * 3 * COUNT);
    for (int i = 0; i < COUNT; i++) {
        p[3 * i] = 0.1 * (i % 25);
        p[3 * i + 1] = 0.1 * (i / 25 % 10);
        p[3 * i + 2] = 0.1 * (i / 250);
    }
    check_set(&grid, &memory, p, COUNT, 0.1000001);
    assert_true(pairs_by_hand(&grid) > 6 * 8 * 23 * 8);
    mns_grid_free(&grid, &memory);
    free(p);
}

/* Strays a million supports away must neither take memory nor fold the fluid onto itself. */
static void test_strays_cost_nothing(void **state)
{
    (void)state;
    struct memory memory;
    mns_memory_init(&memory, NULL);
    struct grid near = {0}, grid = {0};
    double *p = malloc(sizeof(double) * 3 * COUNT);
    for (int i = 0; i < COUNT; i++) {
        p[3 * i] = 40 * uniform();
        p[3 * i + 1] = 2 * uniform();
        p[3 * i + 2] = 5 * uniform();
    }
    check_set(&near, &memory, p, COUNT, 0.8);
    double without = near.candidates;
    for (int i = 0; i < 4; i++) {
        p[3 * (i * 600 + 7) + i % 3] = i % 2 ? 1e6 : -2e6;
    }
    check_set(&grid, &memory, p, COUNT, 0.8);
    assert_true(grid.candidates < 1.2 * without);
    mns_grid_free(&near, &memory);
    mns_grid_free(&grid, &memory);
    free(p);
}

static void test_same_whatever_the_threads(void **state)
{
    (void)state;
    struct memory memory;
    mns_memory_init(&memory, NULL);
    struct grid one = {0}, seven = {0};
    float *p = malloc(sizeof(float) * 3 * COUNT);
    for (int i = 0; i < 3 * COUNT; i++) {
        p[i] = (float)(10 * uniform());
    }
    struct mns_particles particles;
    mns_particles_init(&particles);
    particles.count = COUNT;
    particles.position = (struct mns_attr){.data = p, .type = MNS_F32};
    const struct mns_parallel in_turn = {.run = run_in_turn}, backwards = {.run = run_backwards};
    assert_int_equal(mns_grid_fill(&one, &memory, &in_turn, 1, &particles, 0.7, NULL), MNS_OK);
    assert_int_equal(mns_grid_fill(&seven, &memory, &backwards, 7, &particles, 0.7, NULL), MNS_OK);
    assert_int_equal(one.cells, seven.cells);
    assert_memory_equal(one.index, seven.index, COUNT * sizeof(*one.index));
    assert_memory_equal(one.start, seven.start, (one.cells + 1) * sizeof(*one.start));
    assert_memory_equal(one.y, seven.y, (COUNT + GRID_PAD) * sizeof(*one.y));
    assert_true(one.candidates == seven.candidates);
    mns_grid_free(&one, &memory);
    mns_grid_free(&seven, &memory);
    free(p);
}

static void test_bad_positions(void **state)
{
    (void)state;
    struct memory memory;
    mns_memory_init(&memory, NULL);
    const struct mns_parallel parallel = {.run = run_in_turn};
    struct grid grid = {0};
    struct mns_message message;
    double p[] = {0, 0, 0, NAN, 0, 0, 0.5, 0, 0, 0, INFINITY, 0};
    struct mns_particles particles = view(p, 4);
    assert_int_equal(mns_grid_fill(&grid, &memory, &parallel, 2, &particles, 1, &message), MNS_OK);
    assert_int_equal(grid.count, 2);
    assert_true(grid.index[0] == 0 && grid.index[1] == 2);
    particles.count = 0;
    assert_int_equal(mns_grid_fill(&grid, &memory, &parallel, 2, &particles, 1, &message), MNS_OK);
    assert_int_equal(grid.count, 0);
    assert_int_equal(mns_grid_part(&grid, 0, 1).end, 0);
    particles.count = 3;
    p[6] = 1e300;
    assert_int_equal(mns_grid_fill(&grid, &memory, &parallel, 2, &particles, 1, &message), MNS_ERR_INVALID_ARGUMENT);
    assert_non_null(strstr(message.text, "along x"));
    particles.position.type = MNS_I32;
    assert_int_equal(mns_grid_fill(&grid, &memory, &parallel, 2, &particles, 1, &message), MNS_ERR_INVALID_ARGUMENT);
    assert_non_null(strstr(message.text, "int32"));
    mns_grid_free(&grid, &memory);
    assert_int_equal(memory.bytes, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_finds_what_all_pairs_find),
        cmocka_unit_test(test_finds_neighbours_at_the_edge_of_a_cell),
        cmocka_unit_test(test_strays_cost_nothing),
        cmocka_unit_test(test_same_whatever_the_threads),
        cmocka_unit_test(test_bad_positions),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
