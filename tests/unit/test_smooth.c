/* Stage smooth on depth images known in closed form: against the paper's equations, and what they promise. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "smooth_test.h"

#include <float.h>

/* [TY18] as printed, in double precision with its negative z: eq. 2, 4, 6 or 3, 7 to 9, along one line; samples outside the line drop
 * their pair. sigma is exact, cut and its subtracted weight are ours. */
static double paper_line(const struct mns_params *params, double sigma, const double *z, int i, int count)
{
    double r = R, delta = params->delta * r, mu = params->mu * r, cut = params->kernel_cut;
    double low[2] = {delta, delta}, high[2] = {delta, delta}; /* of each side */
    double sum = z[i] * (1 - exp(-cut * cut / 2)), weights = 1 - exp(-cut * cut / 2);
    for (int k = 1; k < cut * sigma && i - k >= 0 && i + k < count; k++) {
        double w = exp(-k * k / (2 * sigma * sigma)) - exp(-cut * cut / 2), zj[2] = {z[i - k], z[i + k]}, f[2];
        bool above[2], within[2];
        for (int side = 0; side < 2; side++) {
            above[side] = zj[side] > z[i] + high[side];
            f[side] = zj[side] >= z[i] - low[side] ? zj[side] : z[i] - mu;
            within[side] = !above[side] && zj[side] >= z[i] - low[side];
        }
        for (int side = 0; side < 2; side++) {
            if (!above[side] && !(params->bias_correction && above[1 - side])) {
                sum += w * f[side];
                weights += w;
            }
            if (within[side] && params->dynamic_range) {
                low[side] = fmax(low[side], z[i] - zj[side] + delta);
                high[side] = fmax(high[side], zj[side] - z[i] + delta);
            }
        }
    }
    return sum / weights;
}

static void test_rows_and_columns_follow_the_paper(void **state)
{
    (void)state;
    enum { WIDTH = 96, HEIGHT = 80 };
    static double raw[HEIGHT][WIDTH], rows[HEIGHT][WIDTH];
    for (int mode = 0; mode < 4; mode++) {
        struct fixture *fixture = fixture_create(WIDTH, HEIGHT, MNS_ISA_SCALAR, 1);
        struct mns_params *params = &fixture->frame.params;
        params->filter = MNS_FILTER_NARROW_RANGE_1D;
        params->iterations = 1;
        params->bias_correction = mode & 1;
        params->dynamic_range = mode >> 1;
        fill(fixture, splashes);
        for (int y = 0; y < HEIGHT; y++) {
            for (int x = 0; x < WIDTH; x++) {
                raw[y][x] = -(double)*pixel(&fixture->cpu.depth_raw, x, y);
            }
        }
        double size = (double)params->sigma * R * FOCAL; /* eq. 5: sigma in pixels times depth */
        for (int y = 0; y < HEIGHT; y++) {
            for (int x = 0; x < WIDTH; x++) {
                double z = raw[y][x];
                rows[y][x] = z < -DEPTH_LIMIT ? z : paper_line(params, size / -z, raw[y], x, WIDTH);
            }
        }
        const struct depth_plane *result = run(fixture);
        int apart = 0;
        for (int x = 0; x < WIDTH; x++) {
            double column[HEIGHT];
            for (int y = 0; y < HEIGHT; y++) {
                column[y] = rows[y][x];
            }
            for (int y = 0; y < HEIGHT; y++) {
                if (column[y] > -DEPTH_LIMIT) {
                    double expected = -paper_line(params, size / -column[y], column, y, HEIGHT);
                    apart += fabs(*pixel(result, x, y) - expected) > 1e-4 * R; /* float depths carry 6e-6 R here */
                } else {
                    assert_true(*pixel(result, x, y) == DEPTH_EMPTY);
                }
            }
        }
        assert_true(apart <= 3); /* pixels of 7680: a sample within rounding of a bound */
        fixture_destroy(fixture);
    }
}

/* Eq. 4 to 9 in two dimensions: rings of equal max(|dx|, |dy|), bounds as the ring before left them. */
static double paper_disc(const struct mns_params *params, const struct depth_plane *raw, int x, int y)
{
    double z = -(double)*pixel(raw, x, y), sigma = (double)params->sigma * R * FOCAL / -z, cut = params->kernel_cut;
    double delta = (double)params->delta * R, low = delta, high = delta, end = exp(-cut * cut / 2), sum = z * (1 - end), weights = 1 - end;
    for (int ring = 1; ring < cut * sigma; ring++) {
        double next_low = low, next_high = high;
        for (int dy = -ring; dy <= ring; dy++) {
            for (int dx = -ring; dx <= ring; dx++) {
                if (abs(dx) != ring && abs(dy) != ring) {
                    continue;
                }
                double zj = -(double)*pixel(raw, x + dx, y + dy), zk = -(double)*pixel(raw, x - dx, y - dy);
                double w = fmax(0, exp(-(dx * dx + dy * dy) / (2 * sigma * sigma)) - end);
                if (zj <= z + high && zk <= z + high) {
                    sum += w * (zj >= z - low ? zj : z - (double)params->mu * R);
                    weights += w;
                }
                if (zj <= z + high && zj >= z - low) {
                    next_low = fmax(next_low, z - zj + delta);
                    next_high = fmax(next_high, zj - z + delta);
                }
            }
        }
        low = next_low;
        high = next_high;
    }
    return sum / weights;
}

static void test_two_dimensions_follow_the_paper(void **state)
{
    (void)state;
    struct fixture *fixture = fixture_create(80, 64, MNS_ISA_SCALAR, 1);
    fixture->frame.params.filter = MNS_FILTER_NARROW_RANGE;
    fixture->frame.params.iterations = 1;
    fill(fixture, splashes);
    const struct depth_plane *result = run(fixture);
    for (int y = 0; y < 64; y++) {
        for (int x = 0; x < 80; x++) {
            if (*pixel(result, x, y) < DEPTH_LIMIT) {
                assert_near(*pixel(result, x, y), -paper_disc(&fixture->frame.params, &fixture->cpu.depth_raw, x, y), 1e-4 * R);
            }
        }
    }
    fixture_destroy(fixture);
}

/* A plane stays where it is. In a parallel view its depths are linear in the pixels, and only rounding moves them; in perspective they
 * bend, d'' = 2 slope^2 d^3 / (MIDDLE focal)^2 per pixel^2, and a pass along them adds sigma^2 d'' / 2 at most: 0.08 R at 80 degrees,
 * where the surface is 0.08 R tan(80) = 0.014 R away from where it was. */
static void test_planes_stay(void **state)
{
    (void)state;
    static const double degrees[] = {0, 45, 70, 80};
    static const enum mns_filter filters[] = {MNS_FILTER_NARROW_RANGE, MNS_FILTER_NARROW_RANGE_1D, MNS_FILTER_NARROW_RANGE_1D_CLEANUP};
    for (size_t i = 0; i < 24; i++) {
        struct fixture *fixture = fixture_create(112, 200, mns_isa_best(), 2);
        fixture->frame.params.filter = (int)filters[i % 3];
        slope_of_tilt = (float)tan(degrees[i / 3 % 4] * acos(-1) / 180);
        if (i >= 12) {
            use_orthographic(fixture);
        }
        fill(fixture, tilted);
        const struct depth_plane *result = run(fixture);
        for (int y = 60; y < 140; y++) { /* 60 > reach of both iterations */
            for (int x = 0; x < 112; x++) {
                double depth = *pixel(&fixture->cpu.depth_raw, x, y), sigma_world = 0.7 * R;
                double bend = i < 12 ? slope_of_tilt * slope_of_tilt * depth / (MIDDLE * MIDDLE) : 0;
                assert_near(*pixel(result, x, y), depth, 2.2 * sigma_world * sigma_world * bend + 2e-6 * depth);
            }
        }
        fixture_destroy(fixture);
    }
}

/* [TY18] fig. 4. Pixels of the plane at most 14 from the drop, and far from the picture's edge. */
static double worst_beside_drop(bool bias_correction, enum mns_filter filter)
{
    struct fixture *fixture = fixture_create(128, 128, mns_isa_best(), 2);
    use_orthographic(fixture);
    fixture->frame.params.bias_correction = bias_correction;
    fixture->frame.params.filter = (int)filter;
    slope_of_tilt = 1;
    fill(fixture, drop_before_plane);
    const struct depth_plane *result = run(fixture);
    double worst = 0;
    for (int y = 20; y < 108; y++) {
        for (int x = 20; x < 108; x++) {
            if (*pixel(&fixture->cpu.depth_raw, x, y) > MIDDLE - 40 * R) {
                worst = fmax(worst, fabs(*pixel(result, x, y) - *pixel(&fixture->cpu.depth_raw, x, y)));
            }
        }
    }
    fixture_destroy(fixture);
    return worst / R;
}

static void test_the_plane_beside_a_drop_keeps_its_depth(void **state)
{
    (void)state;
    for (int filter = MNS_FILTER_NARROW_RANGE; filter <= MNS_FILTER_NARROW_RANGE_1D_CLEANUP; filter++) {
        assert_near(worst_beside_drop(true, (enum mns_filter)filter), 0, 1e-3);
        assert_true(worst_beside_drop(false, (enum mns_filter)filter) > 0.1);
    }
}

static void test_nothing_leaks_across_a_step(void **state)
{
    (void)state;
    for (int filter = MNS_FILTER_NARROW_RANGE; filter <= MNS_FILTER_NARROW_RANGE_1D_CLEANUP; filter++) {
        struct fixture *fixture = fixture_create(100, 64, mns_isa_best(), 1);
        fixture->frame.params.filter = filter;
        fill(fixture, step);
        const struct depth_plane *result = run(fixture);
        for (int y = 0; y < 64; y++) {
            for (int x = 50; x < 100; x++) {
                assert_near(*pixel(result, x, y), MIDDLE + 50 * R, 1e-6);
            }
            for (int x = 0; x < 50; x++) { /* the front bends back at its rim, by less than mu a pass, and only there */
                float back = *pixel(result, x, y) - MIDDLE;
                assert_true(back > -1e-6f && back < 4 * R);
                assert_true(x > 15 || back < 1e-6f);
            }
            assert_true(*pixel(result, 49, y) - MIDDLE > 0.2f * R);
            assert_true(*pixel(result, 49, y) > *pixel(result, 45, y));
        }
        fixture_destroy(fixture);
    }
}

static float rough_and_steep(const struct fixture *fixture, int x, int y)
{
    float u = (float)(x % 10) / 10 - 0.45f, v = (float)(y % 4) / 4 - 0.375f;
    return slanted(fixture, y, slope_of_tilt) - R * (1 - 2 * u * u - 2 * v * v) + 0.3f * R * uniform();
}

/* [TY18] fig. 5: seen at a grazing angle, neighbours within the kernel leave the fixed range, and the surface stays rough. */
static double roughness(bool dynamic_range)
{
    struct fixture *fixture = fixture_create(112, 112, mns_isa_best(), 1);
    use_orthographic(fixture);
    fixture->frame.params.delta = 3;
    fixture->frame.params.dynamic_range = dynamic_range;
    slope_of_tilt = (float)tan(80 * acos(-1) / 180);
    fill(fixture, rough_and_steep);
    const struct depth_plane *result = run(fixture);
    double sum = 0, squares = 0, n = 0;
    for (int y = 32; y < 80; y++) {
        for (int x = 32; x < 80; x++, n++) {
            double off = (*pixel(result, x, y) - slanted(fixture, y, slope_of_tilt)) / R;
            sum += off;
            squares += off * off;
        }
    }
    fixture_destroy(fixture);
    return sqrt(squares / n - sum / n * (sum / n));
}

static void test_dynamic_range_closes_cracks(void **state)
{
    (void)state;
    double on = roughness(true), off = roughness(false);
    assert_true(on < 0.01);
    assert_true(off > 2 * on);
}

/* The widths of all filters, and what the explicit flow has in their place. */
static void scale_sigma(struct fixture *fixture, float factor)
{
    struct mns_params *params = &fixture->frame.params;
    params->sigma *= factor;
    params->flow_sigma *= factor;
    params->spline_sigma *= factor;
    params->flow_step *= params->filter == MNS_FILTER_CURVATURE_FLOW ? factor : 1;
}

static void test_sigma_changes_without_a_step(void **state)
{
    (void)state;
    for (int i = 0; i < FILTERS; i++) {
        int filter = (int)all_filters[i];
        for (int side = -1; side <= 1; side += 2) {
            struct fixture *a = fixture_create(200, 120, mns_isa_best(), 2), *b = fixture_create(200, 120, mns_isa_best(), 2);
            a->frame.params.filter = b->frame.params.filter = filter;
            /* all pixels of the second half have a tap just at the end of their kernel: reach 14 exactly */
            scale_sigma(b, 1 + 1e-6f * (float)side);
            fill(a, splashes);
            fill(b, splashes);
            assert_true(pixels_apart(run(a), run(b), 1e-4) <= 200 * 120 / 1000);
            fixture_destroy(a);
            fixture_destroy(b);
        }
    }
}

static int mirror_x, mirror_y; /* of the depth function below */

static float mirrored(const struct fixture *fixture, int x, int y)
{
    int width = fixture->frame.view.width, height = fixture->frame.view.height;
    return splashes(fixture, mirror_x ? width - 1 - x : x, mirror_y ? height - 1 - y : y);
}

/* Blocks lie differently in the mirror, so that a pixel may be filtered by the plain kernel here and by the other there: they round
 * differently, and a sample within rounding of a bound may fall on its other side (at most 0.1 % of the pixels). */
static void test_a_mirrored_picture_is_smoothed_to_the_mirror(void **state)
{
    (void)state;
    for (int i = 0; i < FILTERS; i++) {
        int filter = (int)all_filters[i];
        for (int mirror = 1; mirror < 4; mirror++) {
            struct fixture *a = fixture_create(201, 123, mns_isa_best(), 2), *b = fixture_create(201, 123, mns_isa_best(), 2);
            a->frame.params.filter = b->frame.params.filter = filter;
            mirror_x = mirror_y = 0;
            fill(a, mirrored);
            mirror_x = mirror & 1;
            mirror_y = mirror >> 1;
            fill(b, mirrored);
            const struct depth_plane *right = run(a), *left = run(b);
            int apart = 0;
            for (int y = 0; y < 123; y++) {
                for (int x = 0; x < 201; x++) {
                    double other = *pixel(left, mirror_x ? 200 - x : x, mirror_y ? 122 - y : y);
                    apart += fabs(*pixel(right, x, y) - other) > 1e-4 * R;
                }
            }
            assert_true(apart <= 201 * 123 / 1000);
            fixture_destroy(a);
            fixture_destroy(b);
        }
    }
}

/* Across instruction sets: within 1e-4 R but for samples within rounding of a bound (0.1 % of the pixels). */
static void test_instruction_sets_agree(void **state)
{
    (void)state;
    for (int isa = MNS_ISA_SSE2; isa <= MNS_ISA_NEON; isa++) {
        for (int i = 0; mns_kernels_get((enum mns_isa)isa) && i < FILTERS; i++) {
            int filter = (int)all_filters[i];
            struct fixture *a = fixture_create(200, 120, MNS_ISA_SCALAR, 2), *b = fixture_create(200, 120, (enum mns_isa)isa, 2);
            a->frame.params.filter = b->frame.params.filter = filter;
            fill(a, splashes);
            fill(b, splashes);
            assert_true(pixels_apart(run(a), run(b), 1e-4) <= 200 * 120 / 1000);
            fixture_destroy(a);
            fixture_destroy(b);
        }
    }
}

static float calm_and_splashes(const struct fixture *fixture, int x, int y)
{
    return x < 150 ? slanted(fixture, y, 0.5f) + 0.2f * R * uniform() : splashes(fixture, x, y);
}

/* The plain kernels, counted: blocks must have gone through them. */
static struct narrow_range_kernels counted;
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
    for (int filter = MNS_FILTER_NARROW_RANGE; filter <= MNS_FILTER_NARROW_RANGE_1D_CLEANUP; filter++) {
        struct fixture *a = fixture_create(240, 120, mns_isa_best(), 1), *b = fixture_create(240, 120, mns_isa_best(), 1);
        a->frame.params.filter = b->frame.params.filter = filter;
        counted = a->narrow_range;
        plain_runs = 0;
        a->narrow_range.line_plain = count_line;
        a->narrow_range.disc_plain = count_disc;
        b->narrow_range.line_plain = b->narrow_range.line;
        b->narrow_range.disc_plain = b->narrow_range.disc;
        b->narrow_range.square_plain = b->narrow_range.square;
        fill(a, calm_and_splashes);
        fill(b, calm_and_splashes);
        const struct depth_plane *plain = run(a), *whole = run(b);
        assert_true(pixels_apart(plain, whole, 1e-4) <= 240 * 120 / 1000);
        assert_true(plain_runs > 10);
        fixture_destroy(a);
        fixture_destroy(b);
    }
}

static void test_threads_do_not_change_a_byte(void **state)
{
    (void)state;
    static const int threads[] = {2, 7};
    for (int i = 0; i < FILTERS; i++) {
        int filter = (int)all_filters[i];
        struct fixture *one = fixture_create(203, 121, mns_isa_best(), 1);
        one->frame.params.filter = filter;
        fill(one, splashes);
        const struct depth_plane *expected = run(one);
        for (size_t j = 0; j < 2; j++) {
            struct fixture *many = fixture_create(203, 121, mns_isa_best(), threads[j]);
            many->frame.params.filter = filter;
            fill(many, splashes);
            const struct depth_plane *result = run(many);
            assert_memory_equal(result->plane.block, expected->plane.block, expected->plane.floats * sizeof(float));
            assert_memory_equal(result->ranges, expected->ranges,
                                (size_t)expected->blocks_x * (size_t)expected->blocks_y * sizeof(*expected->ranges));
            fixture_destroy(many);
        }
        fixture_destroy(one);
    }
}

static float empty(const struct fixture *fixture, int x, int y)
{
    (void)fixture;
    (void)x;
    (void)y;
    return DEPTH_EMPTY;
}

static void check_planes(const struct depth_plane *raw, const struct depth_plane *result)
{
    for (int i = 0; i < result->blocks_x * result->blocks_y; i++) {
        struct depth_range range = range_of(result, i % result->blocks_x, i / result->blocks_x), stored = result->ranges[i];
        assert_true(range.min == stored.min && range.max == stored.max);
    }
    int width = raw->plane.width, height = raw->plane.height;
    for (int y = -PLANE_BORDER; y < height + PLANE_BORDER; y++) {
        for (int x = -PLANE_BORDER; x < width + PLANE_BORDER; x++) {
            bool inside = x >= 0 && x < width && y >= 0 && y < height;
            assert_true(inside ? (*pixel(result, x, y) < DEPTH_LIMIT) == (*pixel(raw, x, y) < DEPTH_LIMIT) : *pixel(result, x, y) == 0);
        }
    }
}

/* At a size that is no whole number of blocks, twice, with other pictures: what was there before does not show. */
static void test_planes_come_with_borders_and_ranges(void **state)
{
    (void)state;
    for (int i = 0; i <= FILTERS; i++) {
        int filter = i < FILTERS ? (int)all_filters[i] : MNS_FILTER_NONE;
        for (int iterations = 1; iterations < 4; iterations++) {
            struct fixture *fixture = fixture_create(75, 45, mns_isa_best(), 1);
            fixture->frame.params.filter = filter;
            fixture->frame.params.iterations = iterations;
            fill(fixture, iterations == 2 ? empty : step);
            run(fixture);
            fill(fixture, splashes);
            const struct depth_plane *result = run(fixture);
            check_planes(&fixture->cpu.depth_raw, result);
            assert_true(filter != MNS_FILTER_NONE || result == &fixture->cpu.depth_raw);
            fixture_destroy(fixture);
        }
    }
}

static float near_and_flat(const struct fixture *fixture, int x, int y)
{
    (void)fixture;
    return 3 * R + 0.01f * R * (float)((x + y) % 2);
}

/* Nearer than delta, the border's 0 lies within delta of the fluid: it must stay outside all the same; and kernels wider than a plane's
 * border must be held there. */
static void test_fluid_at_the_lens(void **state)
{
    (void)state;
    for (int isa = MNS_ISA_SCALAR; isa <= MNS_ISA_NEON; isa++) {
        for (int mode = 0; mns_kernels_get((enum mns_isa)isa) && mode < 6; mode++) {
            struct fixture *fixture = fixture_create(90, 60, (enum mns_isa)isa, 1);
            fixture->frame.params.filter = MNS_FILTER_NARROW_RANGE + mode % 3;
            fixture->frame.params.bias_correction = mode / 3;
            fixture->frame.params.sigma = 20;
            fill(fixture, near_and_flat);
            const struct depth_plane *result = run(fixture);
            for (int y = 0; y < 60; y++) {
                for (int x = 0; x < 90; x++) {
                    assert_near(*pixel(result, x, y), 3.005 * R, 0.0051 * R);
                }
            }
            fixture_destroy(fixture);
        }
    }
}

/* All that a float can be, here and there among depths. */
static float broken(const struct fixture *fixture, int x, int y)
{
    (void)fixture;
    switch ((x * 7 + y * 13) % 41) {
    case 0: return NAN;
    case 1: return INFINITY;
    case 2: return 1e-42f;
    case 3: return DEPTH_EMPTY;
    case 4: return 1e35f;
    case 5: return 1e-20f;
    case 6: return 9.9e36f;
    case 7: return FLT_MAX;
    case 8: return -1;
    case 9: return -INFINITY;
    default: return MIDDLE + R * uniform();
    }
}

/* Depths at their ends only, whose sums and differences are the largest. */
static float huge(const struct fixture *fixture, int x, int y)
{
    (void)fixture;
    return (x + y) % 3 ? 9.9e36f : 5e36f;
}

static float not_a_number(const struct fixture *fixture, int x, int y)
{
    (void)fixture;
    return x == 0 && y == 0 ? MIDDLE : NAN;
}

static bool is_fluid(float depth) { return depth > 0 && depth < DEPTH_LIMIT; }

/* What is no depth is empty, what is empty stays so, and no fluid becomes anything else. */
static void test_no_filter_spreads_what_is_no_depth(void **state)
{
    (void)state;
    static depth_function *const scenes[] = {broken, huge, not_a_number, empty};
    for (size_t i = 0; i < FILTERS * 4; i++) {
        for (int isa = MNS_ISA_SCALAR; isa <= MNS_ISA_NEON; isa++) {
            if (!mns_kernels_get((enum mns_isa)isa)) {
                continue;
            }
            struct fixture *fixture = fixture_create(70, 45, (enum mns_isa)isa, 1);
            fixture->frame.params.filter = (int)all_filters[i / 4];
            fill(fixture, scenes[i % 4]);
            const struct depth_plane *result = run(fixture);
            test_random = 7; /* as when they were filled */
            for (int y = 0; y < 45; y++) {
                for (int x = 0; x < 70; x++) {
                    float before = scenes[i % 4](fixture, x, y), after = *pixel(result, x, y);
                    if (is_fluid(before) ? !is_fluid(after) : !(after >= DEPTH_LIMIT && after <= DEPTH_EMPTY)) {
                        fail_msg("filter %d, instruction set %d, scene %d: %g became %g at %d, %d", (int)all_filters[i / 4], isa,
                                 (int)(i % 4), (double)before, (double)after, x, y);
                    }
                }
            }
            fixture_destroy(fixture);
        }
    }
}

/* Kernels as wide as they get, over depths so large that a plain sum of them is infinite. */
static void test_no_sum_of_depths_overflows(void **state)
{
    (void)state;
    static const enum mns_filter lines[] = {MNS_FILTER_GAUSSIAN, MNS_FILTER_BILATERAL_1D, MNS_FILTER_NARROW_RANGE_1D};
    for (int i = 0; i < 3; i++) {
        for (int isa = MNS_ISA_SCALAR; isa <= MNS_ISA_NEON; isa++) {
            if (!mns_kernels_get((enum mns_isa)isa)) {
                continue;
            }
            struct fixture *fixture = fixture_create(300, 8, (enum mns_isa)isa, 1);
            use_orthographic(fixture);
            fixture->frame.params.filter = (int)lines[i];
            fixture->frame.params.sigma = 20;
            fill(fixture, huge);
            *pixel(&fixture->cpu.depth_raw, 150, 4) = 1;
            fixture->cpu.depth_raw.ranges[150 / BLOCK_WIDTH].min = 1;
            const struct depth_plane *result = run(fixture);
            for (int x = 0; x < 300; x++) {
                if (!is_fluid(*pixel(result, x, 4))) {
                    fail_msg("filter %d, instruction set %d: %g at %d", (int)lines[i], isa, (double)*pixel(result, x, 4), x);
                }
            }
            fixture_destroy(fixture);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_rows_and_columns_follow_the_paper),
        cmocka_unit_test(test_two_dimensions_follow_the_paper),
        cmocka_unit_test(test_planes_stay),
        cmocka_unit_test(test_the_plane_beside_a_drop_keeps_its_depth),
        cmocka_unit_test(test_nothing_leaks_across_a_step),
        cmocka_unit_test(test_dynamic_range_closes_cracks),
        cmocka_unit_test(test_sigma_changes_without_a_step),
        cmocka_unit_test(test_a_mirrored_picture_is_smoothed_to_the_mirror),
        cmocka_unit_test(test_instruction_sets_agree),
        cmocka_unit_test(test_plain_blocks_are_what_the_others_would_be),
        cmocka_unit_test(test_threads_do_not_change_a_byte),
        cmocka_unit_test(test_planes_come_with_borders_and_ranges),
        cmocka_unit_test(test_fluid_at_the_lens),
        cmocka_unit_test(test_no_filter_spreads_what_is_no_depth),
        cmocka_unit_test(test_no_sum_of_depths_overflows),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
