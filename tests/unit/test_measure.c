/* Preparing and measuring particle sets: bounds, quantiles, dropped particles, the estimated radius, the chunks. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "cpu/particles.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static uint32_t random_state = 1;

static double uniform(void) /* in [0, 1) */
{
    random_state = random_state * 1664525u + 1013904223u;
    return (random_state >> 8) / 16777216.0;
}

/* A jittered lattice of n^3 particles. */
static double *lattice(int n, double spacing, double jitter, const double at[3])
{
    double *p = malloc(sizeof(double) * 3 * (size_t)n * (size_t)n * (size_t)n), *q = p;
    for (int i = 0; i < n * n * n; i++) {
        const int cell[3] = {i % n, i / n % n, i / n / n};
        for (int k = 0; k < 3; k++) {
            *q++ = at[k] + spacing * (cell[k] + jitter * (uniform() - 0.5));
        }
    }
    return p;
}

static struct mns_particles view(const double *p, size_t count)
{
    struct mns_particles particles;
    mns_particles_init(&particles);
    particles.count = count;
    particles.position = (struct mns_attr){.data = p, .type = MNS_F64};
    return particles;
}

static void test_radius_is_half_the_spacing_at_any_scale(void **state)
{
    (void)state;
    static const double spacings[] = {1e-4, 0.02, 1, 3000};
    for (size_t i = 0; i < 4; i++) {
        const double at[3] = {50 * spacings[i], -2000 * spacings[i], 7};
        double *p = lattice(20, spacings[i], 0.3, at);
        struct mns_particles particles = view(p, 8000);
        struct mns_measure measure;
        assert_int_equal(mns_particles_measure(&particles, NULL, &measure, NULL), MNS_OK);
        assert_true(fabs(measure.radius / (0.5 * spacings[i]) - 1) < 0.05);
        assert_true(measure.count == 8000 && measure.dropped == 0);
        free(p);
    }
}

static void test_bounds_dropped_and_strays(void **state)
{
    (void)state;
    const double at[3] = {0, 0, 0};
    double *p = lattice(20, 1, 0, at);
    p[0] = NAN;
    p[3 * 77 + 1] = INFINITY;
    p[3 * 100] = 1e6; /* a stray */
    struct mns_particles particles = view(p, 8000);
    struct mns_measure measure;
    assert_int_equal(mns_particles_measure(&particles, NULL, &measure, NULL), MNS_OK);
    assert_true(measure.count == 7998 && measure.dropped == 2);
    assert_true(measure.bounds_max[0] == 1e6 && measure.bounds_max[1] == 19 && measure.bounds_min[2] == 0);
    assert_true(measure.inner_max[0] <= 19.01 && measure.inner_min[0] >= -0.01);
    assert_true(fabs(measure.spacing - 1) < 0.1);
    free(p);
}

/* Written row by row, eight to a row, and more than the sample holds: the sample must not stand in one column. */
static void test_quantiles_see_every_column_of_a_set_in_rows(void **state)
{
    (void)state;
    enum { ROW = 8, ROWS = 60000 };
    double *p = malloc(sizeof(double) * 3 * ROW * ROWS);
    for (int i = 0; i < ROW * ROWS; i++) {
        p[3 * i] = i % ROW;
        p[3 * i + 1] = i / ROW % 200;
        p[3 * i + 2] = i / ROW / 200;
    }
    struct mns_particles particles = view(p, ROW * ROWS);
    struct mns_measure measure;
    assert_int_equal(mns_particles_measure(&particles, NULL, &measure, NULL), MNS_OK);
    assert_true(measure.inner_min[0] == 0 && measure.inner_max[0] == ROW - 1);
    assert_true(measure.inner_min[1] <= 1 && measure.inner_max[1] >= 198 && measure.inner_max[2] >= 298);
    free(p);
}

static void run_backwards(void *user, void (*job)(void *context, int index), void *context, int count)
{
    (void)user;
    for (int i = count - 1; i >= 0; i--) {
        job(context, i);
    }
}

static void test_store_keeps_every_particle_in_tight_chunks_whatever_the_threads(void **state)
{
    (void)state;
    const double at[3] = {3, -4, 5};
    enum { COUNT = 30 * 30 * 30 };
    double *p = lattice(30, 0.1, 0.5, at);
    struct mns_particles particles = view(p, COUNT);
    struct memory memory;
    mns_memory_init(&memory, NULL);
    const struct mns_parallel parallel = {.run = run_backwards};
    struct particle_store stores[2][STORE_KINDS] = {{{0}}};
    struct mns_measure measure;
    assert_int_equal(mns_particle_stores_fill(stores[0], &memory, &parallel, 1, &particles, false, &measure, NULL), MNS_OK);
    assert_int_equal(mns_particle_stores_fill(stores[1], &memory, &parallel, 7, &particles, false, &measure, NULL), MNS_OK);
    struct particle_store one = stores[0][STORE_WATER], seven = stores[1][STORE_WATER];
    assert_int_equal(one.count, COUNT);
    assert_memory_equal(one.x, seven.x, COUNT * sizeof(float));
    assert_memory_equal(one.y, seven.y, COUNT * sizeof(float));
    assert_memory_equal(one.z, seven.z, COUNT * sizeof(float));

    double sum_in = 0, sum_store = 0, extent = 0;
    for (size_t i = 0; i < COUNT; i++) {
        sum_in += p[3 * i] * (p[3 * i + 1] + 2 * p[3 * i + 2]);
        double x = (double)one.x[i] + one.facts.origin[0], y = (double)one.y[i] + one.facts.origin[1],
               z = (double)one.z[i] + one.facts.origin[2];
        sum_store += x * (y + 2 * z);
        size_t chunk = i / CHUNK_SIZE;
        assert_true(one.x[i] >= one.box_min[0][chunk] && one.x[i] <= one.box_max[0][chunk]);
    }
    assert_true(fabs(sum_in / sum_store - 1) < 1e-6);
    for (size_t chunk = 0; chunk < one.chunk_count; chunk++) {
        extent += (double)(one.box_max[0][chunk] - one.box_min[0][chunk]) / (double)one.chunk_count;
    }
    assert_true(extent < 1.0); /* 64 particles 0.1 apart: 0.4 wide when ideal, 3 when not ordered at all */
    mns_particle_store_free(&one, &memory);
    mns_particle_store_free(&seven, &memory);
    assert_int_equal(memory.bytes, 0);
    free(p);
}

static void test_small_and_bad_sets(void **state)
{
    (void)state;
    const double p[6] = {1, 2, 3, 1, 2, 3.5};
    float radius[2] = {0.1f, 0};
    struct mns_measure measure;
    struct mns_message message;
    struct mns_particles particles = view(p, 0);
    assert_int_equal(mns_particles_measure(&particles, NULL, &measure, NULL), MNS_OK);
    assert_true(measure.count == 0 && measure.radius == 0);
    particles.count = 1;
    assert_int_equal(mns_particles_measure(&particles, NULL, &measure, NULL), MNS_OK);
    assert_true(measure.radius == 0 && measure.bounds_max[2] == 3);
    particles.count = 2;
    assert_int_equal(mns_particles_measure(&particles, NULL, &measure, NULL), MNS_OK);
    assert_true(measure.radius > 0.1 && measure.radius < 0.6);
    particles.radius.data = radius;
    assert_int_equal(mns_particles_measure(&particles, NULL, &measure, &message), MNS_ERR_INVALID_ARGUMENT);
    assert_non_null(strstr(message.text, "particle 1"));
    radius[1] = 2e12f;
    assert_int_equal(mns_particles_measure(&particles, NULL, &measure, &message), MNS_ERR_INVALID_ARGUMENT);
    const double far_apart[6] = {0, 0, 0, 2e12, 0, 0};
    particles.radius.data = NULL;
    particles.position.data = far_apart;
    assert_int_equal(mns_particles_measure(&particles, NULL, &measure, &message), MNS_ERR_INVALID_ARGUMENT);
    assert_non_null(strstr(message.text, "span"));
    particles.radius.data = NULL;
    particles.position.data = NULL;
    assert_int_equal(mns_particles_measure(&particles, NULL, &measure, &message), MNS_ERR_INVALID_ARGUMENT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_radius_is_half_the_spacing_at_any_scale),
        cmocka_unit_test(test_bounds_dropped_and_strays),
        cmocka_unit_test(test_quantiles_see_every_column_of_a_set_in_rows),
        cmocka_unit_test(test_store_keeps_every_particle_in_tight_chunks_whatever_the_threads),
        cmocka_unit_test(test_small_and_bad_sets),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
