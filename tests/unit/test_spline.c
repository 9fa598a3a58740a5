/* The filter smoothing-spline on depth images known in closed form: how much it smooths, and what it must leave alone. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "smooth_test.h"

static const double PI = 3.14159265358979323846;

/* spline_sigma is 1.3: 13 pixels at MIDDLE. */
static struct fixture *spline_create(int width, int height, enum mns_isa isa, int threads, int iterations)
{
    struct fixture *fixture = fixture_create(width, height, isa, threads);
    fixture->frame.params.filter = MNS_FILTER_SMOOTHING_SPLINE;
    fixture->frame.params.spline_sigma = 1.3f;
    fixture->frame.params.iterations = iterations;
    return fixture;
}

static float wave_distance, wave_down, wave_length; /* of the depth function below; wave_length in R */

/* Small waves, straight in inverse depth but for their height. */
static float wave(const struct fixture *fixture, int x, int y)
{
    (void)fixture;
    double pixels = (double)wave_length * R * FOCAL / wave_distance;
    return wave_distance / (float)(1 - 1e-2 * cos(2 * PI * ((wave_down != 0 ? y : x) + 0.5) / pixels) * R);
}

/* Iteration i leaves 1 / (1 + (k sigma / 2^i)^4) of a wave, at every distance; differences of pixels measure k as 2 sin(k / 2). */
static void test_waves_decay_alike_at_every_distance(void **state)
{
    (void)state;
    static const float lengths[] = {4, 8, 16};
    for (int i = 0; i < 36; i++) {
        int iterations = i % 2 ? 4 : 1;
        struct fixture *fixture = spline_create(480, 480, mns_isa_best(), 2, iterations);
        wave_distance = 1.0f * (float)(1 << i / 2 % 3);
        wave_length = lengths[i / 6 % 3];
        wave_down = i >= 18;
        fill(fixture, wave);
        const struct depth_plane *result = run(fixture);
        double k = 2 * sin(PI * wave_distance / ((double)wave_length * R * FOCAL)), falls = 1, sum = 0, squares = 0;
        for (int step = 0; step < iterations; step++) {
            falls /= 1 + pow(k * ldexp(1.3, -step) * R * FOCAL / wave_distance, 4);
        }
        for (int y = 160; y < 320; y++) { /* a wave's natural end bends what is within some sigma */
            for (int x = 160; x < 320; x++) {
                double was = *pixel(&fixture->cpu.depth_raw, x, y) - wave_distance;
                sum += was * (*pixel(result, x, y) - wave_distance);
                squares += was * was;
            }
        }
        assert_near(sum / squares, falls, 0.005 + 0.01 * falls);
        fixture_destroy(fixture);
    }
}

/* However they are seen, and wherever they end. */
static void test_planes_stay(void **state)
{
    (void)state;
    static const double degrees[] = {0, 45, 70, 80};
    for (int i = 0; i < 8; i++) {
        struct fixture *fixture = spline_create(112, 200, mns_isa_best(), 2, 4);
        slope_of_tilt = (float)tan(degrees[i % 4] * PI / 180);
        if (i >= 4) {
            use_orthographic(fixture);
        }
        fill(fixture, tilted);
        const struct depth_plane *result = run(fixture);
        for (int y = 0; y < 200; y++) {
            for (int x = 0; x < 112; x++) {
                double depth = *pixel(&fixture->cpu.depth_raw, x, y);
                assert_near(*pixel(result, x, y), depth, 1e-6 * depth);
            }
        }
        fixture_destroy(fixture);
    }
}

/* [TY18] fig. 4: the plane beside a drop, right up to the drop and to the picture's edge. */
static void test_the_plane_beside_a_drop_keeps_its_depth(void **state)
{
    (void)state;
    static const double degrees[] = {0, 45, 80};
    for (int i = 0; i < 6; i++) {
        struct fixture *fixture = spline_create(128, 128, mns_isa_best(), 2, 4);
        slope_of_tilt = (float)tan(degrees[i % 3] * PI / 180);
        if (i >= 3) {
            use_orthographic(fixture);
        }
        fill(fixture, drop_before_plane);
        const struct depth_plane *result = run(fixture);
        for (int y = 0; y < 128; y++) {
            for (int x = 0; x < 128; x++) {
                float dx = (float)x - 63.5f, dy = (float)y - 63.5f;
                if (dx * dx + dy * dy >= 30 * 30) {
                    double depth = *pixel(&fixture->cpu.depth_raw, x, y);
                    assert_near(*pixel(result, x, y), depth, 2e-6 * depth);
                }
            }
        }
        fixture_destroy(fixture);
    }
}

/* What is farther stays; the front bends back at its rim, by about mu an iteration, and only there. */
static void test_nothing_leaks_across_a_step(void **state)
{
    (void)state;
    for (int isa = MNS_ISA_SCALAR; isa <= MNS_ISA_NEON; isa++) {
        for (int mu = 0; mns_kernels_get((enum mns_isa)isa) && mu <= 2; mu++) {
            struct fixture *fixture = spline_create(200, 64, (enum mns_isa)isa, 1, 1);
            fixture->frame.params.mu = (float)mu;
            fill(fixture, step);
            const struct depth_plane *result = run(fixture);
            for (int y = 0; y < 64; y++) {
                for (int x = 50; x < 200; x++) {
                    assert_near(*pixel(result, x, y), MIDDLE + 50 * R, 1e-5 * R);
                }
                assert_near((*pixel(result, 49, y) - MIDDLE) / R, 0.88 * mu, 0.05 * mu + 1e-5);
                assert_near(*pixel(result, 0, y), MIDDLE, 0.15 * mu * R + 1e-5 * R);
            }
            fixture_destroy(fixture);
        }
    }
}

static float rough(const struct fixture *fixture, int x, int y)
{
    float u = (float)(x % 10) / 10 - 0.45f, v = (float)(y % 9) / 9 - 0.45f;
    return slanted(fixture, y, 1) - R * (1 - 2 * u * u - 2 * v * v) + 0.3f * R * uniform();
}

/* Mean square of the differences down from pixel to pixel, beyond the plane's own, in a frame along the picture's edge. */
static double roughness_at_the_edge(enum mns_filter filter)
{
    struct fixture *fixture = spline_create(160, 160, mns_isa_best(), 1, filter == MNS_FILTER_SMOOTHING_SPLINE ? 4 : 3);
    fixture->frame.params.filter = (int)filter;
    fixture->frame.params.sigma = 0.9f;
    use_orthographic(fixture);
    fill(fixture, rough);
    const struct depth_plane *result = run(fixture);
    double squares = 0, n = 0;
    for (int y = 0; y < 159; y++) {
        for (int x = 0; x < 160; x++) {
            if (x < 8 || x >= 152 || y < 8 || y >= 151) {
                double slope = *pixel(result, x, y + 1) - *pixel(result, x, y) - MIDDLE / FOCAL;
                squares += slope * slope;
                n++;
            }
        }
    }
    fixture_destroy(fixture);
    return sqrt(squares / n) * FOCAL / MIDDLE;
}

/* A kernel that drops samples with their mirror beyond the edge hardly smooths there; a spline goes on. */
static void test_the_picture_edge_is_smooth(void **state)
{
    (void)state;
    assert_true(roughness_at_the_edge(MNS_FILTER_SMOOTHING_SPLINE) < 0.5 * roughness_at_the_edge(MNS_FILTER_NARROW_RANGE_1D_CLEANUP));
}

static bool with_holes; /* in the depth function below */

static float pierced(const struct fixture *fixture, int x, int y)
{
    float depth = rough(fixture, x, y);
    return with_holes && x % 40 == 20 && y % 40 == 20 ? DEPTH_EMPTY : depth;
}

/* A pixel that opens between particles leaves no streaks: along its row and column the result is what it would be without. */
static void test_a_hole_leaves_no_streak(void **state)
{
    (void)state;
    struct fixture *a = spline_create(160, 160, mns_isa_best(), 1, 4), *b = spline_create(160, 160, mns_isa_best(), 1, 4);
    with_holes = false;
    fill(a, pierced);
    with_holes = true;
    fill(b, pierced);
    const struct depth_plane *whole = run(a), *result = run(b);
    for (int i = 0; i < 160 * 160; i++) {
        if (*pixel(result, i % 160, i / 160) < DEPTH_LIMIT) {
            assert_near(*pixel(result, i % 160, i / 160), *pixel(whole, i % 160, i / 160), 0.02 * R);
        }
    }
    fixture_destroy(a);
    fixture_destroy(b);
}

static bool is_fluid(float depth) { return depth > 0 && depth < DEPTH_LIMIT; }

static void check_fluid(const struct depth_plane *raw, const struct depth_plane *result)
{
    for (int i = 0; i < raw->plane.width * raw->plane.height; i++) {
        int x = i % raw->plane.width, y = i / raw->plane.width;
        if (is_fluid(*pixel(raw, x, y))) {
            assert_true(is_fluid(*pixel(result, x, y)));
        } else {
            assert_memory_equal(pixel(result, x, y), pixel(raw, x, y), sizeof(float));
        }
    }
}

static float hostile(const struct fixture *fixture, int x, int y)
{
    (void)fixture;
    static const float values[] = {NAN, INFINITY, 1e-40f, 1e-38f, 9e36f, 1e30f, 0, -1, 2, 2.01f, 0.01f, DEPTH_EMPTY};
    return (x / 40 + y / 40) % 2 ? values[(int)(uniform() * 12)] : MIDDLE + R * uniform();
}

static float nothing(const struct fixture *fixture, int x, int y)
{
    (void)fixture;
    (void)x;
    (void)y;
    return DEPTH_EMPTY;
}

static float at_the_lens(const struct fixture *fixture, int x, int y)
{
    (void)fixture;
    return 1e-3f * R * (1 + 0.1f * (float)((x + y) % 2));
}

static void test_no_depth_does_harm(void **state)
{
    (void)state;
    static depth_function *const depths[] = {hostile, nothing, at_the_lens, splashes};
    static const float sigmas[] = {0.01f, 1.2f, 20};
    for (int isa = MNS_ISA_SCALAR; isa <= MNS_ISA_NEON; isa++) {
        for (int i = 0; mns_kernels_get((enum mns_isa)isa) && i < 24; i++) {
            struct fixture *fixture = spline_create(90, 100, (enum mns_isa)isa, 1, i % 5 ? 4 : 1000);
            fixture->frame.params.spline_sigma = sigmas[i / 4 % 3];
            fixture->frame.params.mu = i % 2 ? 1 : 1000;
            fixture->frame.params.edge_threshold = i % 3 ? 10 : 1000;
            if (i >= 12) {
                use_orthographic(fixture);
            }
            fill(fixture, depths[i % 4]);
            check_fluid(&fixture->cpu.depth_raw, run(fixture));
            fixture_destroy(fixture);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_waves_decay_alike_at_every_distance),
        cmocka_unit_test(test_planes_stay),
        cmocka_unit_test(test_the_plane_beside_a_drop_keeps_its_depth),
        cmocka_unit_test(test_nothing_leaks_across_a_step),
        cmocka_unit_test(test_the_picture_edge_is_smooth),
        cmocka_unit_test(test_a_hole_leaves_no_streak),
        cmocka_unit_test(test_no_depth_does_harm),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
