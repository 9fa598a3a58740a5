/* Smoothing at half and quarter size, through the whole stage. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "../smooth_test.h"

/* Not a multiple of 4, of 16, of 8. */
enum { WIDTH = 131, HEIGHT = 118 };

static const int scales[] = {2, 4};

static struct fixture *fixture_at(int scale, int threads)
{
    struct fixture *fixture = fixture_create(WIDTH, HEIGHT, mns_isa_best(), threads);
    fixture->frame.params.filter = MNS_FILTER_SMOOTHING_SPLINE;
    fixture->frame.params.smooth_scale = scale;
    return fixture;
}

/* A picture's last texels are not whole where its size is no multiple of 4: their middle is up to 1.5 pixels away, 0.13 R at 45 degrees. The rest of the
 * plane is exact. */
static void test_planes_stay(void **state)
{
    (void)state;
    for (int i = 0; i < 8; i++) {
        struct fixture *fixture = fixture_at(scales[i & 1], 2);
        slope_of_tilt = i & 2 ? 1.0f : 0.0f;
        if (i & 4) {
            use_orthographic(fixture);
        }
        fill(fixture, tilted);
        const struct depth_plane *result = run(fixture);
        for (int y = 0; y < HEIGHT; y++) {
            for (int x = 0; x < WIDTH; x++) {
                bool inside = y < HEIGHT - 24 && x < WIDTH - 24;
                assert_near(*pixel(result, x, y), tilted(fixture, x, y), (inside ? 4e-3 : 0.2) * R);
            }
        }
        fixture_destroy(fixture);
    }
}

/* Whatever the filter: fluid is where it was, and no depth is a mean of two surfaces: each is near what was drawn there. */
static void test_silhouettes_stay(void **state)
{
    (void)state;
    slope_of_tilt = 0.5f;
    for (size_t i = 0; i < 2 * FILTERS; i++) {
        struct fixture *fixture = fixture_at(scales[i % 2], 2);
        fixture->frame.params.filter = (int)all_filters[i / 2];
        for (int kind = 0; kind < 2; kind++) {
            fill(fixture, kind ? drop_before_plane : splashes);
            const struct depth_plane *result = run(fixture), *raw = &fixture->cpu.depth_raw;
            for (int y = 0; y < HEIGHT; y++) {
                for (int x = 0; x < WIDTH; x++) {
                    float before = *pixel(raw, x, y), after = *pixel(result, x, y);
                    assert_int_equal(before < DEPTH_LIMIT, after < DEPTH_LIMIT);
                    assert_true(before >= DEPTH_LIMIT || fabsf(after - before) <= 10 * R); /* what edge_threshold lets through */
                    bool glues = all_filters[i / 2] == MNS_FILTER_GAUSSIAN;                /* near and far, at any size */
                    assert_true(kind == 0 || glues || fabsf(after - before) <= 4 * R);
                }
            }
            for (int block = 0; block < result->blocks_x * result->blocks_y; block++) {
                struct depth_range range = range_of(result, block % result->blocks_x, block / result->blocks_x);
                assert_true(range.min == result->ranges[block].min && range.max == result->ranges[block].max);
            }
        }
        fixture_destroy(fixture);
    }
}

static float bumps(const struct fixture *fixture, int x, int y)
{
    float u = (float)x / 20, v = (float)y / 20; /* a sphere each 2 R */
    float du = u - floorf(u) - 0.5f, dv = v - floorf(v) - 0.5f;
    return slanted(fixture, y, slope_of_tilt) - R * sqrtf(fmaxf(0, 1 - 2 * (du * du + dv * dv)));
}

/* How far depth bends over half a sphere, in the middle of the picture: root mean square. */
static double roughness(const struct depth_plane *plane)
{
    double sum = 0;
    int count = 0;
    for (int y = 20; y < HEIGHT - 20; y++) {
        for (int x = 20; x < WIDTH - 20; x++, count++) {
            double bend = (double)*pixel(plane, x - 5, y) - 2 * (double)*pixel(plane, x, y) + (double)*pixel(plane, x + 5, y);
            sum += bend * bend;
        }
    }
    return sqrt(sum / count);
}

/* The way down and back adds no bumps of its own: what is left of the spheres is what the full size leaves. */
static void test_as_smooth_as_the_full_size(void **state)
{
    (void)state;
    slope_of_tilt = 0.5f;
    double left[3];
    for (int i = 0; i < 3; i++) {
        struct fixture *fixture = fixture_at(i == 0 ? 1 : scales[i - 1], 2);
        fill(fixture, bumps);
        left[i] = roughness(run(fixture));
        fixture_destroy(fixture);
    }
    assert_true(left[1] < 1.3 * left[0] && left[2] < 1.3 * left[0]);
}

static void test_same_bytes(void **state)
{
    (void)state;
    struct fixture *one = fixture_at(4, 1), *many = fixture_at(4, 7);
    fill(one, splashes);
    fill(many, splashes);
    run(many); /* planes that are in use already */
    assert_int_equal(pixels_apart(run(one), run(many), 0), 0);
    fixture_destroy(one);
    fixture_destroy(many);
}

static void test_nothing_and_odd_depths(void **state)
{
    (void)state;
    static const float odd[] = {1e-38f, 1e-3f, 2, 1e36f, DEPTH_EMPTY, INFINITY, NAN};
    for (int i = 0; i < 4; i++) {
        struct fixture *fixture = fixture_at(scales[i & 1], 2);
        if (i & 2) {
            use_orthographic(fixture);
        }
        struct depth_plane *raw = &fixture->cpu.depth_raw;
        for (int y = 0; y < HEIGHT; y++) {
            for (int x = 0; x < WIDTH; x++) {
                *pixel(raw, x, y) = y < 16 ? DEPTH_EMPTY : odd[(x * 7 + y * 3 + x * y) % 7];
            }
        }
        for (int block = 0; block < raw->blocks_x * raw->blocks_y; block++) {
            raw->ranges[block] =
                block < 2 * raw->blocks_x ? (struct depth_range){DEPTH_EMPTY, DEPTH_EMPTY} : (struct depth_range){0, INFINITY};
        }
        const struct depth_plane *result = run(fixture);
        for (int y = 0; y < HEIGHT; y++) {
            for (int x = 0; x < WIDTH; x++) {
                float before = *pixel(raw, x, y), after = *pixel(result, x, y);
                bool fluid = before > 0 && before < DEPTH_LIMIT;
                assert_true(fluid ? after > 0 && after < DEPTH_LIMIT : after == before || (isnan(after) && isnan(before)));
            }
        }
        fixture_destroy(fixture);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_planes_stay),
        cmocka_unit_test(test_silhouettes_stay),
        cmocka_unit_test(test_as_smooth_as_the_full_size),
        cmocka_unit_test(test_same_bytes),
        cmocka_unit_test(test_nothing_and_odd_depths),
    };
    return cmocka_run_group_tests_name("smooth_scale", tests, NULL, NULL);
}
