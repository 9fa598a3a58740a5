/* test_anisotropy.c: shapes of particles on sets where they can be told: inside, at a plane, on a thread, alone; turned, scaled, moved. */
#include "splat_test.h"

#include <meniscus/meniscus.h>

#include "core/attr.h"

/* A block of `side` particles each way, spacing 1, each moved by up to jitter / 2, about the origin. */
static double *make_block(size_t side, double jitter)
{
    double *position = malloc(side * side * side * 3 * sizeof(double));
    uint64_t seed = 3;
    for (size_t i = 0; i < side * side * side; i++) {
        const size_t place[3] = {i % side, i / side % side, i / (side * side)};
        for (int k = 0; k < 3; k++) {
            position[3 * i + (size_t)k] = (double)place[k] - 0.5 * (double)(side - 1) + jitter * (random_unit(&seed) - 0.5);
        }
    }
    return position;
}

struct found {
    size_t count;
    double (*shape)[6];
    double (*position)[3];
};

/* What a step gives, copied out. radius: metres, or 0 for auto. */
static struct found find(const void *position, enum mns_type type, size_t count, double radius, enum mns_isa isa, int threads,
                         const struct mns_params *with)
{
    struct mns_anisotropy_params create;
    struct mns_message message;
    mns_anisotropy *anisotropy;
    struct mns_particles particles;
    struct mns_params params;
    mns_anisotropy_params_init(&create);
    create.isa = isa;
    create.threads = threads;
    mns_particles_init(&particles);
    particles.count = count;
    particles.position = (struct mns_attr){.data = position, .type = type};
    mns_params_init(&params);
    if (with) {
        params = *with;
    }
    params.radius = (float)radius;
    assert_int_equal(mns_anisotropy_create(&anisotropy, &create, &message), MNS_OK);
    assert_int_equal(mns_anisotropy_step(anisotropy, &particles, &params), MNS_OK);
    mns_anisotropy_attach(anisotropy, &particles);
    struct found found = {count, calloc(count, sizeof(*found.shape)), calloc(count, sizeof(*found.position))};
    for (size_t i = 0; i < count; i++) {
        for (int k = 0; k < 6 && particles.shape.data; k++) {
            found.shape[i][k] = mns_attr_get(&particles.shape, particles.shape.type, 6, i, k);
        }
        for (int k = 0; k < 3; k++) {
            found.position[i][k] = mns_attr_get(&particles.position, particles.position.type, 3, i, k);
        }
    }
    mns_anisotropy_destroy(&anisotropy);
    return found;
}

static void free_found(struct found *found)
{
    free(found->shape);
    free(found->position);
}

static double determinant(const double a[6])
{
    return a[0] * (a[1] * a[2] - a[5] * a[5]) - a[3] * (a[3] * a[2] - a[5] * a[4]) + a[4] * (a[3] * a[5] - a[1] * a[4]);
}

/* Round inside, flat at the faces, and everywhere of the same volume; the middle of a face moves straight inwards. */
static void inside_and_surface(void **state)
{
    (void)state;
    enum { SIDE = 13, COUNT = SIDE * SIDE * SIDE };
    double *position = make_block(SIDE, 0.1);
    enum mns_isa isas[6];
    for (int n = test_isas(isas) - 1; n >= 0; n--) {
        struct found f = find(position, MNS_F64, COUNT, 0.5, isas[n], 2, NULL);
        for (size_t i = 0; i < COUNT; i++) {
            assert_true(fabs(determinant(f.shape[i]) - 1) < 1e-3);
            const size_t place[3] = {i % SIDE, i / SIDE % SIDE, i / (SIDE * SIDE)};
            int depth[3], inner = 0, face = -1;
            for (int k = 0; k < 3; k++) {
                depth[k] = (int)(place[k] < SIDE - 1 - place[k] ? place[k] : SIDE - 1 - place[k]);
                inner += depth[k] >= 3;
                face = depth[k] == 0 ? k : face;
            }
            double x = f.shape[i][0], y = f.shape[i][1], z = f.shape[i][2];
            if (inner == 3) {
                assert_true(fmin(fmin(x, y), z) > 0.85 && fmax(fmax(x, y), z) < 1.15);
            } else if (inner == 2 && face >= 0) {
                assert_true(f.shape[i][face] < 0.6 && f.shape[i][(face + 1) % 3] > 1.2 && f.shape[i][(face + 2) % 3] > 1.2);
                double inwards = position[3 * i + (size_t)face] > 0 ? -1 : 1;
                double moved = inwards * (f.position[i][face] - position[3 * i + (size_t)face]);
                assert_true(moved > 0.2 && moved < 0.6); /* half of 0.32 of a reach of 2.4 spacings */
                assert_true(fabs(f.position[i][(face + 1) % 3] - position[3 * i + (size_t)(face + 1) % 3]) < 0.1);
            }
        }
        free_found(&f);
    }
    free(position);
}

/* Alone: small spheres. On a thread: needles along it. In a sheet: discs in it. All held to the ratio. */
static void thin_things(void **state)
{
    (void)state;
    enum { LONG = 41 };
    float *position = malloc(LONG * LONG * 3 * sizeof(float));
    for (size_t i = 0; i < 5; i++) {
        memcpy(position + 3 * i, (float[]){20 * (float)i, 3, -7 * (float)i}, 3 * sizeof(float));
    }
    struct found f = find(position, MNS_F32, 5, 0.5, MNS_ISA_AUTO, 2, NULL);
    for (size_t i = 0; i < 5; i++) {
        for (int k = 0; k < 6; k++) {
            assert_true(fabs(f.shape[i][k] - (k < 3 ? 0.75 : 0)) < 1e-6);
        }
        for (int k = 0; k < 3; k++) {
            assert_true(f.position[i][k] == (double)position[3 * i + (size_t)k]);
        }
    }
    free_found(&f);
    for (size_t i = 0; i < LONG; i++) {
        float along = 0.6f * ((float)i - 20);
        memcpy(position + 3 * i, (float[]){along, along, 0}, 3 * sizeof(float));
    }
    struct mns_params params;
    mns_params_init(&params);
    params.anisotropy_neighbors = 0.02f;
    f = find(position, MNS_F32, LONG, 0.5, MNS_ISA_AUTO, 2, &params);
    const double *a = f.shape[20], along = 0.5 * (a[0] + a[1]) + a[3],
                 across = 0.5 * (a[0] + a[1]) - a[3]; /* along (1, 1, 0) and (1, -1, 0) */
    assert_true(fabs(along / across - 4) < 0.01 && fabs(a[2] - across) < 1e-3 && fabs(determinant(a) - 1) < 1e-3);
    free_found(&f);
    for (size_t i = 0; i < LONG * LONG; i++) {
        memcpy(position + 3 * i, (float[]){(float)(i % LONG), 5, (float)(i / LONG)}, 3 * sizeof(float));
    }
    f = find(position, MNS_F32, LONG * LONG, 0.5, MNS_ISA_AUTO, 2, NULL);
    a = f.shape[LONG * 20 + 20];
    assert_true(fabs(a[0] / a[1] - 4) < 0.01 && fabs(a[2] - a[0]) < 0.01 && fabs(determinant(a) - 1) < 1e-3);
    assert_true(fabs(f.position[LONG * 20 + 20][1] - 5) < 1e-6);
    free_found(&f);
    free(position);
}

/* R A R'. */
static void turn(const double r[3][3], const double a[6], double out[6])
{
    static const int rows[6] = {0, 1, 2, 0, 0, 1}, columns[6] = {0, 1, 2, 1, 2, 2};
    const double m[3][3] = {{a[0], a[3], a[4]}, {a[3], a[1], a[5]}, {a[4], a[5], a[2]}};
    for (int k = 0; k < 6; k++) {
        out[k] = 0;
        for (int i = 0; i < 3; i++) {
            for (int j = 0; j < 3; j++) {
                out[k] += r[rows[k]][i] * m[i][j] * r[columns[k]][j];
            }
        }
    }
}

/* Turned, moved far away and a thousand times as large, the ellipsoids are the same ones, turned. */
static void moves_with_the_particles(void **state)
{
    (void)state;
    enum { SIDE = 9, COUNT = SIDE * SIDE * SIDE };
    static const double scales[] = {1, 1000, 0.001}, away[] = {-400, 77, 20};
    const double c = 0.36, s = 0.48, r[3][3] = {{0.8, 0, 0.6}, {s, 0.6, -0.64}, {-c, 0.8, s}};
    double *position = make_block(SIDE, 0.4), *moved = malloc(COUNT * 3 * sizeof(double));
    enum mns_isa isas[6];
    for (int n = test_isas(isas) - 1; n >= 0; n--) {
        struct found f = find(position, MNS_F64, COUNT, 0.5, isas[n], 2, NULL);
        for (int k = 0; k < 3; k++) {
            for (size_t i = 0; i < COUNT; i++) {
                for (int row = 0; row < 3; row++) {
                    double at = away[row];
                    for (int j = 0; j < 3; j++) {
                        at += r[row][j] * position[3 * i + (size_t)j];
                    }
                    moved[3 * i + (size_t)row] = at * scales[k];
                }
            }
            struct found g = find(moved, MNS_F64, COUNT, 0.5 * scales[k], isas[n], 2, NULL);
            for (size_t i = 0; i < COUNT; i++) {
                double turned[6];
                turn(r, f.shape[i], turned);
                for (int j = 0; j < 6; j++) {
                    assert_true(fabs(g.shape[i][j] - turned[j]) < 2e-3);
                }
                for (int row = 0; row < 3; row++) {
                    double at = away[row];
                    for (int j = 0; j < 3; j++) {
                        at += r[row][j] * f.position[i][j];
                    }
                    assert_true(fabs(g.position[i][row] / scales[k] - at) < 1e-3);
                }
            }
            free_found(&g);
        }
        free_found(&f);
    }
    free(position);
    free(moved);
}

/* The same bytes for any number of threads; instruction sets within rounding; a radius that is measured gives nearly what a given one does. */
static void threads_and_isas(void **state)
{
    (void)state;
    enum { SIDE = 20, COUNT = SIDE * SIDE * SIDE };
    double *position = make_block(SIDE, 0.5);
    struct found plain = find(position, MNS_F64, COUNT, 0.5, MNS_ISA_SCALAR, 1, NULL);
    enum mns_isa isas[6];
    for (int n = test_isas(isas) - 1; n >= 0; n--) {
        struct found one = find(position, MNS_F64, COUNT, 0.5, isas[n], 1, NULL);
        const int threads[] = {2, 7};
        for (int k = 0; k < 2; k++) {
            struct found many = find(position, MNS_F64, COUNT, 0.5, isas[n], threads[k], NULL);
            assert_memory_equal(one.shape, many.shape, COUNT * sizeof(*one.shape));
            assert_memory_equal(one.position, many.position, COUNT * sizeof(*one.position));
            free_found(&many);
        }
        for (size_t i = 0; i < COUNT; i++) {
            for (int k = 0; k < 6; k++) {
                assert_true(fabs(one.shape[i][k] - plain.shape[i][k]) < 2e-3);
            }
        }
        free_found(&one);
    }
    struct found measured = find(position, MNS_F64, COUNT, 0, MNS_ISA_AUTO, 2, NULL);
    for (size_t i = 0; i < COUNT; i++) {
        for (int k = 0; k < 6; k++) {
            assert_true(fabs(measured.shape[i][k] - plain.shape[i][k]) < 0.3);
        }
    }
    free_found(&measured);
    free_found(&plain);
    free(position);
}

/* All in one place, some nowhere, none, one: shapes that the renderer takes. */
static void odd_sets(void **state)
{
    (void)state;
    enum { COUNT = 3000 };
    float *position = calloc(COUNT * 3, sizeof(float));
    struct found f = find(position, MNS_F32, COUNT, 0.5, MNS_ISA_AUTO, 2, NULL);
    for (size_t i = 0; i < COUNT; i++) {
        assert_true(f.shape[i][0] > 0.9 && f.shape[i][0] < 1.1 && fabs(determinant(f.shape[i]) - 1) < 1e-3);
    }
    free_found(&f);
    for (size_t i = 0; i < COUNT; i++) {
        position[3 * i] = i % 7 == 0 ? NAN : (float)(i % 31);
        position[3 * i + 1] = i % 11 == 0 ? INFINITY : (float)(i / 31 % 10);
        position[3 * i + 2] = (float)(i / 310);
    }
    f = find(position, MNS_F32, COUNT, 0.5, MNS_ISA_AUTO, 2, NULL);
    for (size_t i = 0; i < COUNT; i++) {
        if (i % 7 == 0 || i % 11 == 0) {
            assert_true(f.shape[i][0] == 1 && f.shape[i][3] == 0);
            assert_false(isfinite(f.position[i][0]) && isfinite(f.position[i][1]));
        } else {
            assert_true(determinant(f.shape[i]) > 0.1 && isfinite(f.position[i][0]));
        }
    }
    free_found(&f);
    for (size_t count = 0; count < 2; count++) {
        f = find(position, MNS_F32, count, 0, MNS_ISA_AUTO, 2, NULL);
        free_found(&f);
    }
    free(position);
}

/* Radius and spacing, and so every volume, are those of the positions as they were. */
static void sizes_stay(void **state)
{
    (void)state;
    enum { SIDE = 12, COUNT = SIDE * SIDE * SIDE };
    double *position = make_block(SIDE, 0.5);
    struct mns_particles particles;
    struct mns_stats stats[2];
    mns_anisotropy *anisotropy;
    mns_renderer *renderer;
    mns_particles_init(&particles);
    particles.count = COUNT;
    particles.position = (struct mns_attr){.data = position, .type = MNS_F64};
    assert_int_equal(mns_anisotropy_create(&anisotropy, NULL, NULL), MNS_OK);
    assert_int_equal(mns_renderer_create(&renderer, NULL, NULL), MNS_OK);
    for (int i = 0; i < 2; i++) {
        mns_stats_init(&stats[i]);
        assert_int_equal(mns_renderer_prepare(renderer, &particles), MNS_OK);
        mns_renderer_stats(renderer, &stats[i]);
        assert_int_equal(mns_anisotropy_step(anisotropy, &particles, NULL), MNS_OK);
        mns_anisotropy_attach(anisotropy, &particles);
    }
    assert_true(stats[0].measure.spacing > 0.5 && stats[1].measure.spacing == stats[0].measure.spacing);
    assert_true(stats[1].measure.radius == stats[0].measure.radius && stats[1].measure.bounds_max[0] < stats[0].measure.bounds_max[0]);
    mns_renderer_destroy(&renderer);
    mns_anisotropy_destroy(&anisotropy);
    free(position);
}

static void *no_memory(void *user, size_t size, size_t alignment)
{
    int *left = user;
    return (*left)-- > 0 ? aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment) : NULL;
}

static void give_back(void *user, void *block, size_t size)
{
    (void)user;
    (void)size;
    free(block);
}

static void failures(void **state)
{
    (void)state;
    struct mns_anisotropy_params create;
    struct mns_message message;
    mns_anisotropy *anisotropy;
    mns_anisotropy_params_init(&create);
    create.threads = -1;
    assert_int_equal(mns_anisotropy_create(&anisotropy, &create, &message), MNS_ERR_INVALID_ARGUMENT);
    assert_null(anisotropy);
    double *position = make_block(5, 0.2);
    struct mns_particles particles;
    mns_particles_init(&particles);
    particles.count = 125;
    particles.position = (struct mns_attr){.data = position, .type = MNS_F64};
    int left = 0;
    mns_result result = MNS_ERR_OUT_OF_MEMORY;
    for (int allowed = 0; allowed < 60 && result == MNS_ERR_OUT_OF_MEMORY; allowed++) {
        mns_anisotropy_params_init(&create);
        create.threads = 1;
        create.allocator = (struct mns_allocator){.allocate = no_memory, .release = give_back, .user = &left};
        left = allowed;
        result = mns_anisotropy_create(&anisotropy, &create, &message);
        if (result == MNS_OK) {
            result = mns_anisotropy_step(anisotropy, &particles, NULL);
            struct mns_particles after = particles;
            mns_anisotropy_attach(anisotropy, &after);
            assert_true((after.shape.data != NULL) == (result == MNS_OK));
            mns_anisotropy_destroy(&anisotropy);
        }
    }
    assert_int_equal(result, MNS_OK);
    assert_int_equal(mns_anisotropy_create(&anisotropy, NULL, &message), MNS_OK);
    struct mns_params params;
    mns_params_init(&params);
    params.anisotropy_ratio = NAN;
    assert_int_equal(mns_anisotropy_step(anisotropy, &particles, &params), MNS_ERR_INVALID_ARGUMENT);
    assert_non_null(strstr(mns_anisotropy_message(anisotropy), "anisotropy_ratio"));
    mns_anisotropy_destroy(&anisotropy);
    free(position);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(inside_and_surface), cmocka_unit_test(thin_things), cmocka_unit_test(moves_with_the_particles),
        cmocka_unit_test(threads_and_isas),   cmocka_unit_test(odd_sets),    cmocka_unit_test(sizes_stay),
        cmocka_unit_test(failures),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
