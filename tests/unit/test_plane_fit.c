/* The plane-fit filter on depth images known in closed form: against its definition, and what it does and does not promise. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "smooth_test.h"

enum { WIDTH = 96, HEIGHT = 80 };

struct vector {
    double x, y, z;
};

static double dot(struct vector a, struct vector b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

static struct vector add(struct vector a, double scale, struct vector b)
{
    return (struct vector){a.x + scale * b.x, a.y + scale * b.y, a.z + scale * b.z};
}

static double depth_at(const struct fixture *fixture, int x, int y)
{
    return x >= 0 && x < WIDTH && y >= 0 && y < HEIGHT ? *pixel(&fixture->cpu.depth_raw, x, y) : DEPTH_EMPTY;
}

static struct vector ray_of(int x, int y)
{
    return (struct vector){(x + 0.5 - 0.5 * WIDTH) / (double)FOCAL, (y + 0.5 - 0.5 * HEIGHT) / (double)FOCAL, 1};
}

static struct vector position(const struct fixture *fixture, int x, int y)
{
    return add((struct vector){0, 0, 0}, depth_at(fixture, x, y), ray_of(x, y));
}

/* Change of depth per pixel along (dx, dy): central, or to the nearer neighbour where one is apart. */
static double difference(const struct fixture *fixture, int x, int y, int dx, int dy)
{
    double here = depth_at(fixture, x, y), edge = fmax((double)fixture->frame.params.edge_threshold * R, 20 * here / FOCAL);
    double back = here - depth_at(fixture, x - dx, y - dy), ahead = depth_at(fixture, x + dx, y + dy) - here;
    if (fabs(back) <= edge && fabs(ahead) <= edge) {
        return 0.5 * (back + ahead);
    }
    double smaller = fabs(back) < fabs(ahead) ? back : ahead;
    return fabs(smaller) <= edge ? smaller : 0;
}

/* The normal of the surface through a pixel: across its tangents, d/dx and d/dy of depth times ray. */
static struct vector normal(const struct fixture *fixture, int x, int y)
{
    double depth = depth_at(fixture, x, y), step = depth / FOCAL;
    struct vector along_x = add((struct vector){step, 0, 0}, difference(fixture, x, y, 1, 0), ray_of(x, y));
    struct vector along_y = add((struct vector){0, step, 0}, difference(fixture, x, y, 0, 1), ray_of(x, y));
    struct vector n = {along_x.z * along_y.y - along_x.y * along_y.z, along_x.x * along_y.z - along_x.z * along_y.x,
                       along_x.y * along_y.x - along_x.x * along_y.y};
    return add((struct vector){0, 0, 0}, 1 / sqrt(dot(n, n)), n);
}

/* z = (n . p) v_z / (n . v) with the weighted means n and p, in double precision. */
static double defined(const struct fixture *fixture, int x, int y)
{
    const struct mns_params *params = &fixture->frame.params;
    double own = depth_at(fixture, x, y), sigma = (double)params->sigma * R * FOCAL / own, cut = params->kernel_cut,
           delta = params->delta * R;
    struct vector n = {0, 0, 0}, p = n;
    double weights = 0;
    int reach = (int)(cut * sigma) + 1;
    for (int dy = -reach; dy <= reach; dy++) {
        for (int dx = -reach; dx <= reach; dx++) {
            double dz = depth_at(fixture, x + dx, y + dy) - own,
                   weight = exp(-(dx * dx + dy * dy) / (2 * sigma * sigma)) - exp(-cut * cut / 2);
            if (weight > 0 && fabs(dz) < delta && x - abs(dx) >= 0 && x + abs(dx) < WIDTH && y - abs(dy) >= 0 && y + abs(dy) < HEIGHT) {
                weight *= exp(-4.5 * dz * dz / (delta * delta)) - exp(-4.5);
                n = add(n, weight, normal(fixture, x + dx, y + dy));
                p = add(p, weight, position(fixture, x + dx, y + dy));
                weights += weight;
            }
        }
    }
    return dot(n, p) / weights / dot(n, ray_of(x, y));
}

static void test_it_follows_its_definition(void **state)
{
    (void)state;
    for (int best = 0; best < 2; best++) {
        struct fixture *fixture = fixture_create(WIDTH, HEIGHT, best ? mns_isa_best() : MNS_ISA_SCALAR, 1);
        fixture->frame.params.filter = MNS_FILTER_PLANE_FIT;
        fixture->frame.params.iterations = 1;
        fill(fixture, splashes);
        const struct depth_plane *result = run(fixture);
        for (int i = 0; i < WIDTH * HEIGHT; i++) {
            int x = i % WIDTH, y = i / WIDTH;
            if (*pixel(result, x, y) < DEPTH_LIMIT) {
                assert_near(*pixel(result, x, y), defined(fixture, x, y), 1e-4 * R);
            }
        }
        fixture_destroy(fixture);
    }
}

/* A plane stays where it is, however it is seen, also where perspective bends its depths. What is left comes from the normals, which are
 * differences over two pixels, and at the picture's edge over one. */
static void test_planes_stay(void **state)
{
    (void)state;
    static const double degrees[] = {0, 45, 70, 80};
    for (size_t i = 0; i < 8; i++) {
        struct fixture *fixture = fixture_create(112, 100, mns_isa_best(), 2);
        fixture->frame.params.filter = MNS_FILTER_PLANE_FIT;
        if (i >= 4) {
            use_orthographic(fixture);
        }
        slope_of_tilt = (float)tan(degrees[i % 4] * acos(-1) / 180);
        fill(fixture, tilted);
        const struct depth_plane *result = run(fixture);
        for (int y = 0; y < 100; y++) {
            for (int x = 0; x < 112; x++) {
                assert_near(*pixel(result, x, y), *pixel(&fixture->cpu.depth_raw, x, y), 1e-4 * R);
            }
        }
        fixture_destroy(fixture);
    }
}

static void test_nothing_leaks_across_a_step(void **state)
{
    (void)state;
    struct fixture *fixture = fixture_create(100, 64, mns_isa_best(), 1);
    fixture->frame.params.filter = MNS_FILTER_PLANE_FIT;
    fill(fixture, step);
    const struct depth_plane *result = run(fixture);
    for (int y = 0; y < 64; y++) {
        for (int x = 0; x < 100; x++) {
            assert_near(*pixel(result, x, y), *pixel(&fixture->cpu.depth_raw, x, y), 1e-4 * R);
        }
    }
    fixture_destroy(fixture);
}

static float bad_depths(const struct fixture *fixture, int x, int y)
{
    (void)fixture;
    switch ((x * 7 + y * 3) % 23) {
    case 0: return INFINITY;
    case 1: return DEPTH_EMPTY;
    case 2: return 1e-42f;
    case 3: return 1e36f;
    default: return 3 * R + 0.01f * R * (float)((x + y) % 2) + (x > 45 ? R * (float)(x - 45) : 0);
    }
}

/* Depths nearer than delta, kernels wider than a plane's border, denormal and huge depths, empty pixels that are infinite, a surface seen at a grazing
 * angle: fluid stays fluid. */
static void test_no_depth_is_too_bad(void **state)
{
    (void)state;
    for (int isa = MNS_ISA_SCALAR; isa <= MNS_ISA_NEON; isa++) {
        for (int mode = 0; mns_kernels_get((enum mns_isa)isa) && mode < 4; mode++) {
            struct fixture *fixture = fixture_create(90, 60, (enum mns_isa)isa, 1);
            fixture->frame.params.filter = MNS_FILTER_PLANE_FIT;
            fixture->frame.params.sigma = mode & 1 ? 20 : 1;
            if (mode & 2) {
                use_orthographic(fixture);
            }
            fill(fixture, bad_depths);
            const struct depth_plane *result = run(fixture);
            for (int i = 0; i < 90 * 60; i++) {
                float before = *pixel(&fixture->cpu.depth_raw, i % 90, i / 90), after = *pixel(result, i % 90, i / 90);
                assert_true(before < DEPTH_LIMIT ? after > 0 && after < DEPTH_LIMIT : after == before);
            }
            fixture_destroy(fixture);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_it_follows_its_definition),
        cmocka_unit_test(test_planes_stay),
        cmocka_unit_test(test_nothing_leaks_across_a_step),
        cmocka_unit_test(test_no_depth_is_too_bad),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
