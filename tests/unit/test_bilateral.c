/* The Gaussian and the bilateral filters on depth images known in closed form: against their definition, and what they do and do not promise. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "smooth_test.h"

enum { WIDTH = 96, HEIGHT = 80 };

/* The weight of a tap whose place has `weight` and whose depth differs by dz (infinite where it is empty). */
static double tap_weight(const struct mns_params *params, double weight, double dz)
{
    double cut = params->kernel_cut, delta = params->delta * R, sigma_z = delta / 3;
    weight = fmax(0, weight - exp(-cut * cut / 2));
    if (params->filter == MNS_FILTER_GAUSSIAN) {
        return dz < DEPTH_LIMIT ? weight : 0;
    }
    return fabs(dz) < delta ? weight * (exp(-dz * dz / (2 * sigma_z * sigma_z)) - exp(-4.5)) : 0;
}

/* One pixel in double precision, from the definition: the mean over the taps within reach_x and reach_y. Outside the picture a tap drops out with its
 * mirror. */
static double defined(const struct mns_params *params, double depth[HEIGHT][WIDTH], int x, int y, bool along_x, bool along_y)
{
    double own = depth[y][x], sigma = (double)params->sigma * R * FOCAL / own, sum = 0, weights = 0;
    int reach = (int)(params->kernel_cut * sigma) + 1, reach_x = along_x ? reach : 0, reach_y = along_y ? reach : 0;
    for (int dy = -reach_y; dy <= reach_y; dy++) {
        for (int dx = -reach_x; dx <= reach_x; dx++) {
            if (x - abs(dx) >= 0 && x + abs(dx) < WIDTH && y - abs(dy) >= 0 && y + abs(dy) < HEIGHT) {
                double dz = depth[y + dy][x + dx] - own, weight = exp(-(dx * dx + dy * dy) / (2 * sigma * sigma));
                weight = tap_weight(params, weight, dz);
                sum += dz < DEPTH_LIMIT ? weight * dz : 0;
                weights += weight;
            }
        }
    }
    return own + sum / weights;
}

static void define_all(const struct mns_params *params, double in[HEIGHT][WIDTH], double out[HEIGHT][WIDTH], bool along_x, bool along_y)
{
    for (int y = 0; y < HEIGHT; y++) {
        for (int x = 0; x < WIDTH; x++) {
            out[y][x] = in[y][x] < DEPTH_LIMIT ? defined(params, in, x, y, along_x, along_y) : in[y][x];
        }
    }
}

static void test_they_follow_their_definition(void **state)
{
    (void)state;
    static double raw[HEIGHT][WIDTH], rows[HEIGHT][WIDTH], expected[HEIGHT][WIDTH];
    for (int filter = MNS_FILTER_GAUSSIAN; filter <= MNS_FILTER_BILATERAL_1D; filter++) {
        for (int best = 0; best < 2; best++) {
            struct fixture *fixture = fixture_create(WIDTH, HEIGHT, best ? mns_isa_best() : MNS_ISA_SCALAR, 1);
            struct mns_params *params = &fixture->frame.params;
            params->filter = filter;
            params->iterations = 1;
            fill(fixture, splashes);
            for (int i = 0; i < WIDTH * HEIGHT; i++) {
                raw[i / WIDTH][i % WIDTH] = *pixel(&fixture->cpu.depth_raw, i % WIDTH, i / WIDTH);
            }
            if (filter == MNS_FILTER_BILATERAL) {
                define_all(params, raw, expected, true, true);
            } else {
                define_all(params, raw, rows, true, false);
                define_all(params, rows, expected, false, true);
            }
            const struct depth_plane *result = run(fixture);
            for (int i = 0; i < WIDTH * HEIGHT; i++) {
                assert_near(*pixel(result, i % WIDTH, i / WIDTH), expected[i / WIDTH][i % WIDTH], 1e-4 * R);
            }
            fixture_destroy(fixture);
        }
    }
}

/* A plane stays where it is, up to the picture's edge. In a parallel view, where its depths are linear in the pixels. */
static void test_planes_stay(void **state)
{
    (void)state;
    static const double degrees[] = {0, 45, 70, 80};
    for (size_t i = 0; i < 12; i++) {
        struct fixture *fixture = fixture_create(112, 100, mns_isa_best(), 2);
        fixture->frame.params.filter = MNS_FILTER_GAUSSIAN + (int)(i % 3);
        use_orthographic(fixture);
        slope_of_tilt = (float)tan(degrees[i / 3] * acos(-1) / 180);
        fill(fixture, tilted);
        const struct depth_plane *result = run(fixture);
        for (int y = 0; y < 100; y++) {
            for (int x = 0; x < 112; x++) {
                assert_near(*pixel(result, x, y), *pixel(&fixture->cpu.depth_raw, x, y), 2e-6 * MIDDLE);
            }
        }
        fixture_destroy(fixture);
    }
}

/* How far from its depth a pixel beside a step of 50 R is drawn, in R. */
static double leak(enum mns_filter filter)
{
    struct fixture *fixture = fixture_create(100, 64, mns_isa_best(), 1);
    fixture->frame.params.filter = (int)filter;
    fill(fixture, step);
    const struct depth_plane *result = run(fixture);
    double worst = 0;
    for (int y = 0; y < 64; y++) {
        for (int x = 0; x < 100; x++) {
            worst = fmax(worst, fabs(*pixel(result, x, y) - *pixel(&fixture->cpu.depth_raw, x, y)));
        }
    }
    fixture_destroy(fixture);
    return worst / R;
}

static void test_only_the_gaussian_leaks_across_a_step(void **state)
{
    (void)state;
    assert_near(leak(MNS_FILTER_BILATERAL), 0, 1e-4);
    assert_near(leak(MNS_FILTER_BILATERAL_1D), 0, 1e-4);
    assert_true(leak(MNS_FILTER_GAUSSIAN) > 10);
}

/* How much nearer than it was the rim of a round drop is drawn, in R, on its row through the middle. */
static double rim_pulled(enum mns_filter filter)
{
    struct fixture *fixture = fixture_create(128, 128, mns_isa_best(), 1);
    use_orthographic(fixture);
    fixture->frame.params.filter = (int)filter;
    slope_of_tilt = 0;
    fill(fixture, drop_before_plane);
    const struct depth_plane *result = run(fixture);
    int x = 0;
    while (*pixel(&fixture->cpu.depth_raw, x, 63) > MIDDLE - 40 * R) {
        x++;
    }
    double pulled = *pixel(&fixture->cpu.depth_raw, x, 63) - *pixel(result, x, 63);
    fixture_destroy(fixture);
    return pulled / R;
}

/* [TY18] fig. 8: the mean of what is on the drop only is nearer than its rim, which turns away from the eye. */
static void test_the_bilateral_flattens_the_rim_of_a_drop(void **state)
{
    (void)state;
    double kept = rim_pulled(MNS_FILTER_NARROW_RANGE);
    assert_true(rim_pulled(MNS_FILTER_BILATERAL) > 0.8);
    assert_true(rim_pulled(MNS_FILTER_BILATERAL_1D) > 0.8);
    assert_true(kept < 0.3);
}

static float calm_and_splashes(const struct fixture *fixture, int x, int y)
{
    return x < 150 ? slanted(fixture, y, 0.5f) + 0.2f * R * uniform() : splashes(fixture, x, y);
}

static struct bilateral_kernels counted;
static int plain_runs;

static struct depth_range count_line(const struct window_filter *filter, const struct depth_block *block, int axis)
{
    plain_runs++;
    return counted.line_plain(filter, block, axis);
}

static struct depth_range count_disc(const struct window_filter *filter, const struct depth_block *block, int axis)
{
    plain_runs++;
    return counted.disc_plain(filter, block, axis);
}

static void test_plain_blocks_are_what_the_others_would_be(void **state)
{
    (void)state;
    for (int filter = MNS_FILTER_BILATERAL; filter <= MNS_FILTER_BILATERAL_1D; filter++) {
        struct fixture *a = fixture_create(240, 120, mns_isa_best(), 1), *b = fixture_create(240, 120, mns_isa_best(), 1);
        a->frame.params.filter = b->frame.params.filter = filter;
        counted = *a->smooth.bilateral;
        struct bilateral_kernels counting = {counted.line, count_line, counted.disc, count_disc};
        struct bilateral_kernels whole_only = {counted.line, counted.line, counted.disc, counted.disc};
        plain_runs = 0;
        a->smooth.bilateral = &counting;
        b->smooth.bilateral = &whole_only;
        fill(a, calm_and_splashes);
        fill(b, calm_and_splashes);
        const struct depth_plane *plain = run(a), *whole = run(b);
        assert_int_equal(pixels_apart(plain, whole, 1e-4), 0);
        assert_true(plain_runs > 10);
        fixture_destroy(a);
        fixture_destroy(b);
    }
}

static float at_the_lens(const struct fixture *fixture, int x, int y)
{
    (void)fixture;
    switch ((x * 7 + y * 3) % 23) {
    case 0: return INFINITY;
    case 1: return DEPTH_EMPTY;
    case 2: return 1e-42f;
    case 3: return 1e36f;
    default: return 3 * R + 0.01f * R * (float)((x + y) % 2);
    }
}

/* Depths nearer than delta, kernels wider than a plane's border, denormal and huge depths, empty pixels that are infinite: fluid stays fluid, and the
 * bilateral filters keep it between what it was. */
static void test_no_depth_is_too_bad(void **state)
{
    (void)state;
    for (int isa = MNS_ISA_SCALAR; isa <= MNS_ISA_NEON; isa++) {
        for (int filter = MNS_FILTER_GAUSSIAN; mns_kernels_get((enum mns_isa)isa) && filter <= MNS_FILTER_BILATERAL_1D; filter++) {
            struct fixture *fixture = fixture_create(90, 60, (enum mns_isa)isa, 1);
            fixture->frame.params.filter = filter;
            fixture->frame.params.sigma = 20;
            fill(fixture, at_the_lens);
            const struct depth_plane *result = run(fixture);
            for (int i = 0; i < 90 * 60; i++) {
                float before = *pixel(&fixture->cpu.depth_raw, i % 90, i / 90), after = *pixel(result, i % 90, i / 90);
                assert_true(before < DEPTH_LIMIT ? after > 0 && after < DEPTH_LIMIT : after == before);
                assert_true(filter == MNS_FILTER_GAUSSIAN || !(before > R && before < 1) || (after > 0 && after < 3.02f * R));
            }
            fixture_destroy(fixture);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_they_follow_their_definition),
        cmocka_unit_test(test_planes_stay),
        cmocka_unit_test(test_only_the_gaussian_leaks_across_a_step),
        cmocka_unit_test(test_the_bilateral_flattens_the_rim_of_a_drop),
        cmocka_unit_test(test_plain_blocks_are_what_the_others_would_be),
        cmocka_unit_test(test_no_depth_is_too_bad),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
