/* The curvature flows on depth images known in closed form: against the paper's own form, and what they do at every distance. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "smooth_test.h"

static struct fixture *flow_create(enum mns_filter filter, int width, int height, enum mns_isa isa, int threads)
{
    struct fixture *fixture = fixture_create(width, height, isa, threads);
    fixture->frame.params.filter = (int)filter;
    fixture->frame.params.iterations = filter == MNS_FILTER_CURVATURE_FLOW ? 10 : 256;
    return fixture;
}

static float distance_of = 2; /* of the depth functions below, metres */

static float bump(const struct fixture *fixture, int x, int y)
{
    float dx = (float)x + 0.5f - 0.5f * (float)fixture->frame.view.width, dy = (float)y + 0.5f - 0.5f * (float)fixture->frame.view.height;
    return distance_of - R * expf(-(dx * dx + dy * dy) / (2 * 12 * 12));
}

static double sum_of(const struct depth_plane *plane)
{
    double sum = 0;
    for (int y = 0; y < plane->plane.height; y++) {
        for (int x = 0; x < plane->plane.width; x++) {
            sum += *pixel(plane, x, y);
        }
    }
    return sum;
}

static void test_a_bump_shrinks_and_nothing_is_lost(void **state)
{
    (void)state;
    struct fixture *fixture = flow_create(MNS_FILTER_CURVATURE_FLOW, 96, 80, mns_isa_best(), 2);
    fill(fixture, bump);
    const struct depth_plane *raw = &fixture->cpu.depth_raw, *result = run(fixture);
    double before = distance_of - *pixel(raw, 48, 40), after = distance_of - *pixel(result, 48, 40);
    assert_true(after < 0.98 * before && after > 0.5 * before);
    assert_near(sum_of(result), sum_of(raw), 96 * 80 * 1e-7); /* of float sums of depths near 2 */
    fixture_destroy(fixture);
}

/* [LGS09] eq. 4 to 8 as printed, in double, with central differences; C = 1 / f. The step that smooths is z <- z - dt H (depth grows into the
 * screen). */
static double paper_step(double (*z)(const struct fixture *fixture, double x, double y), const struct fixture *fixture, double x, double y,
                         double dt)
{
    const double h = 0.5, cx = 1 / (double)FOCAL, cy = cx;
    double a = z(fixture, x, y), l = z(fixture, x - h, y), r = z(fixture, x + h, y), u = z(fixture, x, y - h), d = z(fixture, x, y + h);
    double zx = (r - l) / (2 * h), zy = (d - u) / (2 * h), zxx = (l - 2 * a + r) / (h * h), zyy = (u - 2 * a + d) / (h * h);
    double zxy = (z(fixture, x + h, y + h) - z(fixture, x - h, y + h) - z(fixture, x + h, y - h) + z(fixture, x - h, y - h)) / (4 * h * h);
    double D = cy * cy * zx * zx + cx * cx * zy * zy + cx * cx * cy * cy * a * a;
    double Dx = 2 * (cy * cy * zx * zxx + cx * cx * zy * zxy + cx * cx * cy * cy * a * zx);
    double Dy = 2 * (cy * cy * zx * zxy + cx * cx * zy * zyy + cx * cx * cy * cy * a * zy);
    double Ex = 0.5 * zx * Dx - zxx * D, Ey = 0.5 * zy * Dy - zyy * D;
    return a - dt * (cy * Ex + cx * Ey) / (2 * pow(D, 1.5));
}

static double smooth_surface(const struct fixture *fixture, double x, double y)
{
    (void)fixture;
    return 2 + 0.08 * sin(x / 17) + 0.06 * cos(y / 13 + x / 40) + 0.0008 * x;
}

static float smooth_surface_at(const struct fixture *fixture, int x, int y) { return (float)smooth_surface(fixture, x, y); }

/* Both forms are one flow: a step's changes agree within 3 % of the largest, which is what differences over a pixel leave of waves 80 pixels long
 * and float of changes this small. */
static void test_fluxes_are_the_papers_flow(void **state)
{
    (void)state;
    struct fixture *fixture = flow_create(MNS_FILTER_CURVATURE_FLOW, 120, 100, MNS_ISA_SCALAR, 1);
    fixture->frame.params.iterations = 1;
    fixture->frame.params.flow_step = 0.4f; /* so that no coefficient meets its limit */
    fill(fixture, smooth_surface_at);
    const struct depth_plane *result = run(fixture);
    double dt = 0.4 * MIDDLE / FOCAL, largest = 0, worst = 0;
    for (int y = 2; y < 98; y++) {
        for (int x = 2; x < 118; x++) {
            double expected = paper_step(smooth_surface, fixture, x, y, dt) - smooth_surface(fixture, x, y);
            double got = (double)*pixel(result, x, y) - (double)*pixel(&fixture->cpu.depth_raw, x, y);
            largest = fmax(largest, fabs(expected));
            worst = fmax(worst, fabs(got - expected));
        }
    }
    assert_true(largest > 1e-5);
    assert_near(worst, 0, 0.03 * largest);
    fixture_destroy(fixture);
}

static const float WAVE = 0.12f; /* metres from crest to crest */

static float wave(const struct fixture *fixture, int x, int y)
{
    (void)y;
    float metres = ((float)x + 0.5f) / fixture->frame.view.fx * distance_of;
    return distance_of + 0.1f * R * cosf(2 * (float)acos(-1) * metres / WAVE);
}

/* The standard deviation in metres of the Gaussian that has damped the wave as much. */
static double sigma_of_wave(enum mns_filter filter, float distance)
{
    struct fixture *fixture = flow_create(filter, 400, 32, mns_isa_best(), 2);
    fixture->frame.params.flow_sigma = 0.6f;
    fixture->frame.params.flow_step = 0.1f;
    fixture->frame.params.iterations = filter == MNS_FILTER_CURVATURE_FLOW ? 10 : 1000; /* more than the nearest takes */
    distance_of = distance;
    fill(fixture, wave);
    const struct depth_plane *result = run(fixture);
    double before = 0, after = 0, k = 2 * acos(-1) / WAVE;
    for (int x = 100; x < 300; x++) {
        double phase = cos(k * (x + 0.5) / FOCAL * distance);
        before += phase * ((double)*pixel(&fixture->cpu.depth_raw, x, 16) - distance);
        after += phase * ((double)*pixel(result, x, 16) - distance);
    }
    distance_of = 2;
    fixture_destroy(fixture);
    return sqrt(-2 * log(after / before)) / k;
}

static void test_adaptive_flow_smooths_alike_at_every_distance(void **state)
{
    (void)state;
    double sigma = 0.6 * R;
    assert_near(sigma_of_wave(MNS_FILTER_ADAPTIVE_CURVATURE_FLOW, 1), sigma, 0.03 * sigma);
    assert_near(sigma_of_wave(MNS_FILTER_ADAPTIVE_CURVATURE_FLOW, 2), sigma, 0.03 * sigma);
    assert_near(sigma_of_wave(MNS_FILTER_ADAPTIVE_CURVATURE_FLOW, 4), sigma, 0.06 * sigma); /* 3 pixels: their own width counts */
}

/* T = N dt = sigma^2 f / z: sigma grows with the root of the distance. */
static void test_plain_flow_smooths_what_is_far_more(void **state)
{
    (void)state;
    for (float distance = 1; distance <= 4; distance *= 2) {
        double time = 10 * 0.1 * MIDDLE / FOCAL, sigma = sqrt(time * (double)distance / FOCAL);
        assert_near(sigma_of_wave(MNS_FILTER_CURVATURE_FLOW, distance), sigma, 0.05 * sigma);
    }
}

static float step_edge(const struct fixture *fixture, int x, int y)
{
    (void)fixture;
    (void)y;
    return x < 50 ? MIDDLE : MIDDLE + 50 * R;
}

static float facing(const struct fixture *fixture, int x, int y)
{
    (void)x;
    (void)y;
    (void)fixture;
    return MIDDLE;
}

static void test_steps_and_planes_that_face_the_eye_stay(void **state)
{
    (void)state;
    for (int filter = MNS_FILTER_CURVATURE_FLOW; filter <= MNS_FILTER_ADAPTIVE_CURVATURE_FLOW; filter++) {
        static depth_function *const scenes[] = {step_edge, facing};
        for (int i = 0; i < 2; i++) {
            struct fixture *fixture = flow_create((enum mns_filter)filter, 100, 64, mns_isa_best(), 1);
            fill(fixture, scenes[i]);
            const struct depth_plane *result = run(fixture);
            for (int y = 0; y < 64; y++) {
                assert_memory_equal(pixel(result, 0, y), pixel(&fixture->cpu.depth_raw, 0, y), 100 * sizeof(float));
            }
            fixture_destroy(fixture);
        }
    }
}

/* Depths at the ends of float, none, not a number, and at the lens. */
static float broken(const struct fixture *fixture, int x, int y)
{
    (void)fixture;
    switch ((x * 7 + y * 13) % 11) {
    case 0: return NAN;
    case 1: return INFINITY;
    case 2: return 1e-42f;
    case 3: return DEPTH_EMPTY;
    case 4: return 9e36f;
    case 5: return 1e-20f;
    case 6: return 3 * R;
    default: return MIDDLE + R * uniform();
    }
}

static float at_the_lens(const struct fixture *fixture, int x, int y)
{
    (void)fixture;
    return (x + y) % 3 ? 3 * R : 3.5f * R;
}

static float empty(const struct fixture *fixture, int x, int y)
{
    (void)fixture;
    (void)x;
    (void)y;
    return DEPTH_EMPTY;
}

static void test_no_depth_and_no_step_leaves_the_range(void **state)
{
    (void)state;
    static depth_function *const scenes[] = {broken, at_the_lens, empty, splashes};
    for (int i = 0; i < 64; i++) {
        enum mns_isa isa = (enum mns_isa)(MNS_ISA_SCALAR + i / 4 % 5);
        if (!mns_kernels_get(isa)) {
            continue;
        }
        struct fixture *fixture = flow_create(i & 1 ? MNS_FILTER_CURVATURE_FLOW : MNS_FILTER_ADAPTIVE_CURVATURE_FLOW, 70, 45, isa, 1);
        fixture->frame.params.flow_step = i & 2 ? 0.5f : 0.01f;
        fixture->frame.params.flow_sigma = i & 8 ? 20 : 0.01f;
        fixture->frame.depth_reference = i & 16 ? 1e15f : 1e-12f;
        fixture->frame.params.iterations = 40;
        if (i & 32) {
            use_orthographic(fixture);
        }
        fill(fixture, scenes[i % 4]);
        const struct depth_plane *raw = &fixture->cpu.depth_raw, *result = run(fixture);
        for (int y = 0; y < 45; y++) {
            for (int x = 0; x < 70; x++) {
                float before = *pixel(raw, x, y), after = *pixel(result, x, y);
                bool fluid = before > 0 && before < DEPTH_LIMIT;
                assert_true(fluid ? after > 0 && after < DEPTH_LIMIT : memcmp(&before, &after, sizeof(before)) == 0);
                assert_true(scenes[i % 4] != at_the_lens || (after >= 2.9999f * R && after <= 3.5001f * R));
            }
        }
        fixture_destroy(fixture);
    }
}

/* More pictures than one patch in each direction, and steps that are no multiple of those of a pass. */
static void test_patches_and_threads_do_not_show(void **state)
{
    (void)state;
    for (int filter = MNS_FILTER_CURVATURE_FLOW; filter <= MNS_FILTER_ADAPTIVE_CURVATURE_FLOW; filter++) {
        struct fixture *one = flow_create((enum mns_filter)filter, 1200, 300, mns_isa_best(), 1);
        struct fixture *many = flow_create((enum mns_filter)filter, 1200, 300, mns_isa_best(), 7);
        one->frame.params.iterations = many->frame.params.iterations = 7;
        fill(one, splashes);
        fill(many, splashes);
        const struct depth_plane *a = run(one), *b = run(many);
        assert_memory_equal(a->plane.block, b->plane.block, a->plane.floats * sizeof(float));
        /* a picture cut at a patch's border, around what lies there: the same far enough from the cut */
        struct fixture *part = flow_create((enum mns_filter)filter, 1200, 300, mns_isa_best(), 1);
        part->frame.params.iterations = 7;
        fill(part, splashes);
        for (int y = 0; y < 300; y++) {
            for (int x = 0; x < 900; x++) {
                *pixel(&part->cpu.depth_raw, x, y) = DEPTH_EMPTY;
            }
        }
        for (int i = 0; i < part->cpu.depth_raw.blocks_x * part->cpu.depth_raw.blocks_y; i++) {
            part->cpu.depth_raw.ranges[i] =
                range_of(&part->cpu.depth_raw, i % part->cpu.depth_raw.blocks_x, i / part->cpu.depth_raw.blocks_x);
        }
        const struct depth_plane *c = run(part);
        for (int y = 0; y < 300; y++) {
            assert_memory_equal(pixel(c, 930, y), pixel(a, 930, y), 270 * sizeof(float));
        }
        fixture_destroy(one);
        fixture_destroy(many);
        fixture_destroy(part);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_a_bump_shrinks_and_nothing_is_lost),
        cmocka_unit_test(test_fluxes_are_the_papers_flow),
        cmocka_unit_test(test_adaptive_flow_smooths_alike_at_every_distance),
        cmocka_unit_test(test_plain_flow_smooths_what_is_far_more),
        cmocka_unit_test(test_steps_and_planes_that_face_the_eye_stay),
        cmocka_unit_test(test_no_depth_and_no_step_leaves_the_range),
        cmocka_unit_test(test_patches_and_threads_do_not_show),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
