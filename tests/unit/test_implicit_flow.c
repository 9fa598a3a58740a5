/* The filter implicit-curvature-flow on depth images known in closed form: how much it smooths, and what it must leave alone. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "smooth_test.h"

static const double PI = 3.14159265358979323846;

/* flow_sigma is 1.2: 12 pixels at MIDDLE. */
static struct fixture *flow_create(int width, int height, enum mns_isa isa, int threads, int steps)
{
    struct fixture *fixture = fixture_create(width, height, isa, threads);
    fixture->frame.params.filter = MNS_FILTER_IMPLICIT_CURVATURE_FLOW;
    fixture->frame.params.flow_sigma = 1.2f;
    fixture->frame.params.iterations = steps;
    return fixture;
}

static float wave_distance, wave_down; /* of the depth function below */

/* Four radii from crest to crest: a whole number of half waves between the picture's edges, across which nothing flows. */
static float wave(const struct fixture *fixture, int x, int y)
{
    (void)fixture;
    double length = 4 * R * FOCAL / wave_distance;
    return wave_distance * (float)(1 + 5e-2 * cos(2 * PI * ((wave_down != 0 ? y : x) + 0.5) / length) * R);
}

/* A wave falls by exp(-k^2 sigma^2 / 2) at every distance; N implicit steps make (1 + k^2 sigma^2 / 2N)^-N of it. Differences of
 * pixels measure k as 2 sin(k / 2). */
static void test_waves_decay_alike_at_every_distance(void **state)
{
    (void)state;
    for (int i = 0; i < 12; i++) {
        int steps = i % 2 ? 100 : 4;
        struct fixture *fixture = flow_create(160, 160, mns_isa_best(), 2, steps);
        wave_distance = 1.0f * (float)(1 << i / 2 % 3);
        wave_down = i >= 6;
        fill(fixture, wave);
        const struct depth_plane *result = run(fixture);
        double k = 2 * sin(PI * wave_distance / (4 * R * FOCAL)), sigma = 1.2 * R * FOCAL / wave_distance;
        double square = 0.5 * k * k * sigma * sigma, falls = pow(1 + square / steps, -steps), sum = 0, squares = 0;
        for (int j = 0; j < 160 * 160; j++) {
            double was = *pixel(&fixture->cpu.depth_raw, j % 160, j / 160) - wave_distance;
            sum += was * (*pixel(result, j % 160, j / 160) - wave_distance);
            squares += was * was;
        }
        assert_near(sum / squares, falls, 0.01 * falls); /* what is less than half a digit of the depth is lost in each step */
        assert_true(steps == 4 || fabs(sum / squares / exp(-square) - 1) < 0.03);
        fixture_destroy(fixture);
    }
}

enum { SIZE = 120 };

static float bump(const struct fixture *fixture, int x, int y)
{
    (void)fixture;
    float dx = (float)x - 59.5f, dy = (float)y - 59.5f;
    return MIDDLE - R * expf(-(dx * dx + dy * dy) / (2 * 15 * 15));
}

/* The same flow in many explicit steps, in double precision: the largest height of the bump. */
static double explicit_height(void)
{
    static double depth[2][SIZE][SIZE];
    enum { STEPS = 400 };
    double all = 0.5 * pow(1.2 * R * FOCAL, 2); /* of edges, times the depths on both sides */
    for (int i = 0; i < SIZE * SIZE; i++) {
        depth[0][i / SIZE][i % SIZE] = bump(NULL, i % SIZE, i / SIZE);
    }
    double height = 0;
    for (int step = 0; step < STEPS; step++) {
        double(*in)[SIZE] = depth[step & 1], (*out)[SIZE] = depth[1 - (step & 1)];
        height = 0;
        for (int y = 0; y < SIZE; y++) {
            for (int x = 0; x < SIZE; x++) {
                const int beside[4][2] = {{x - 1, y}, {x + 1, y}, {x, y - 1}, {x, y + 1}};
                double z = in[y][x], flow = 0;
                for (int i = 0; i < 4; i++) {
                    bool inside = beside[i][0] >= 0 && beside[i][0] < SIZE && beside[i][1] >= 0 && beside[i][1] < SIZE;
                    double other = inside ? in[beside[i][1]][beside[i][0]] : z;
                    flow += all / STEPS / (z * other) * (other - z);
                }
                out[y][x] = z + flow;
                height = fmax(height, MIDDLE - out[y][x]);
            }
        }
    }
    return height;
}

static double implicit_height(int steps)
{
    struct fixture *fixture = flow_create(SIZE, SIZE, mns_isa_best(), 1, steps);
    fill(fixture, bump);
    const struct depth_plane *result = run(fixture);
    double height = 0;
    for (int i = 0; i < SIZE * SIZE; i++) {
        height = fmax(height, MIDDLE - *pixel(result, i % SIZE, i / SIZE));
    }
    fixture_destroy(fixture);
    return height;
}

static void test_a_bump_shrinks_as_in_explicit_steps(void **state)
{
    (void)state;
    double expected = explicit_height();
    assert_near(expected, R * 225 / (225 + 144), 0.02 * R); /* a Gaussian of 15 pixels by one of 12 */
    static const int steps[] = {1, 4, 16, 64};
    static const double tolerance[] = {0.15, 0.05, 0.015, 0.005};
    double worst = 1;
    for (int i = 0; i < 4; i++) {
        double off = fabs(implicit_height(steps[i]) / expected - 1);
        assert_true(off < tolerance[i] && off < worst);
        worst = off;
    }
}

/* In perspective too, since the flux of a plane is the same everywhere; at the picture's edge, where none passes, it bends. */
static void test_planes_stay(void **state)
{
    (void)state;
    static const double degrees[] = {0, 45, 70, 80};
    for (int i = 0; i < 8; i++) {
        struct fixture *fixture = flow_create(64, 240, mns_isa_best(), 2, 4);
        slope_of_tilt = (float)tan(degrees[i % 4] * PI / 180);
        if (i >= 4) {
            use_orthographic(fixture);
        }
        fill(fixture, tilted);
        const struct depth_plane *result = run(fixture);
        for (int y = 0; y < 240; y++) {
            double depth = *pixel(&fixture->cpu.depth_raw, 30, y), bend = 0;
            if (y < 100 || y >= 140) { /* by what the plane rises over the mean distance of a Gaussian's samples */
                int mean = (int)ceil(sqrt(2 / PI) * 1.2 * R * FOCAL / (i < 4 ? depth : MIDDLE));
                bend =
                    fmax(fabs(slanted(fixture, y + mean, slope_of_tilt) - depth), fabs(slanted(fixture, y - mean, slope_of_tilt) - depth));
            }
            assert_near(*pixel(result, 30, y), depth, bend + 3e-6 * depth);
        }
        fixture_destroy(fixture);
    }
}

static void test_nothing_crosses_a_step(void **state)
{
    (void)state;
    for (int isa = MNS_ISA_SCALAR; isa <= MNS_ISA_NEON; isa++) {
        if (!mns_kernels_get((enum mns_isa)isa)) {
            continue;
        }
        struct fixture *fixture = flow_create(100, 64, (enum mns_isa)isa, 1, 4);
        fill(fixture, step);
        const struct depth_plane *result = run(fixture);
        for (int y = 0; y < 64; y++) {
            for (int x = 0; x < 100; x++) {
                assert_near(*pixel(result, x, y), x < 50 ? MIDDLE : MIDDLE + 50 * R, 1e-6);
            }
        }
        fixture_destroy(fixture);
    }
}

static bool is_fluid(float depth) { return depth > 0 && depth < DEPTH_LIMIT; }

/* What is nearer is no nearer than the nearest there was, what is farther no farther than the farthest; what is not fluid stays as it is. */
static void check_bounds(const struct depth_plane *raw, const struct depth_plane *result)
{
    float least = DEPTH_EMPTY, most = 0;
    for (int i = 0; i < raw->plane.width * raw->plane.height; i++) {
        float depth = *pixel(raw, i % raw->plane.width, i / raw->plane.width);
        least = is_fluid(depth) ? fminf(least, depth) : least;
        most = is_fluid(depth) ? fmaxf(most, depth) : most;
    }
    for (int i = 0; i < raw->plane.width * raw->plane.height; i++) {
        int x = i % raw->plane.width, y = i / raw->plane.width;
        if (is_fluid(*pixel(raw, x, y))) {
            double rounding = 1e-6 * (double)most;
            assert_true(*pixel(result, x, y) >= least - rounding && *pixel(result, x, y) <= most + rounding);
        } else {
            assert_memory_equal(pixel(result, x, y), pixel(raw, x, y), sizeof(float));
        }
    }
}

static void test_depths_stay_in_range_and_none_is_lost(void **state)
{
    (void)state;
    for (int steps = 1; steps < 6; steps++) {
        struct fixture *fixture = flow_create(203, 121, mns_isa_best(), 2, steps);
        fill(fixture, splashes);
        const struct depth_plane *result = run(fixture);
        check_bounds(&fixture->cpu.depth_raw, result);
        double change = 0, moved = 0;
        for (int i = 0; i < 203 * 121; i++) {
            float was = *pixel(&fixture->cpu.depth_raw, i % 203, i / 203);
            change += is_fluid(was) ? (double)*pixel(result, i % 203, i / 203) - was : 0;
            moved += is_fluid(was) ? fabs((double)*pixel(result, i % 203, i / 203) - was) : 0;
        }
        assert_true(moved > 203 * 121 * 0.1 * R);
        assert_near(change, 0, 1e-4 * moved);
        fixture_destroy(fixture);
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
    static depth_function *const depths[] = {hostile, nothing, at_the_lens};
    static const float sigmas[] = {0.01f, 1.2f, 20};
    for (int isa = MNS_ISA_SCALAR; isa <= MNS_ISA_NEON; isa++) {
        for (int i = 0; mns_kernels_get((enum mns_isa)isa) && i < 9; i++) {
            struct fixture *fixture = flow_create(90, 100, (enum mns_isa)isa, 1, 4);
            fixture->frame.params.flow_sigma = sigmas[i / 3];
            fill(fixture, depths[i % 3]);
            check_bounds(&fixture->cpu.depth_raw, run(fixture));
            fixture_destroy(fixture);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_waves_decay_alike_at_every_distance),
        cmocka_unit_test(test_a_bump_shrinks_as_in_explicit_steps),
        cmocka_unit_test(test_planes_stay),
        cmocka_unit_test(test_nothing_crosses_a_step),
        cmocka_unit_test(test_depths_stay_in_range_and_none_is_lost),
        cmocka_unit_test(test_no_depth_does_harm),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
