/* The classifier: its formulas by hand, its memory, what it derives, and sequences that are not as they should be. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <meniscus/classify.h>

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static uint32_t random_state = 1;

static double uniform(void) /* in [0, 1) */
{
    random_state = random_state * 1664525u + 1013904223u;
    return (random_state >> 8) / 16777216.0;
}

/* V = 5 m/s, V / gravity = 0.5 s: foam lasts 2 s, fades in within 0.25 s and out within 0.75 s, noise cools down in 1 s. */
static struct mns_params hand_params(void)
{
    struct mns_params params;
    mns_params_init(&params);
    params.foam = MNS_FOAM_LAYERED;
    params.gravity = 10;
    params.fluid_size = 2.5f;
    params.rest_density = 1000;
    params.radius = 0.01f;
    params.foam_air = 0.09f;
    params.foam_weber_low = 0.5f;
    params.foam_weber_high = 1;
    params.foam_lifetime = 2;
    return params;
}

static mns_classifier *create(struct mns_log log, int threads)
{
    struct mns_classifier_params params;
    mns_classifier_params_init(&params);
    params.threads = threads;
    params.log = log;
    mns_classifier *classifier;
    assert_int_equal(mns_classifier_create(&classifier, &params, NULL), MNS_OK);
    return classifier;
}

static mns_classifier *quiet(void) { return create((struct mns_log){0}, 1); }

struct set {
    float *position, *velocity, *density;
    int64_t *id;
    size_t count;
};

static struct set set_create(size_t count)
{
    struct set set = {.count = count};
    set.position = calloc(3 * count, sizeof(float));
    set.velocity = calloc(3 * count, sizeof(float));
    set.density = calloc(count, sizeof(float));
    set.id = calloc(count, sizeof(*set.id));
    for (size_t i = 0; i < count; i++) {
        set.position[3 * i] = (float)i;
        set.density[i] = 900; /* a tenth of what is around is air: enough for all the foam */
        set.id[i] = (int64_t)i;
    }
    return set;
}

static void set_free(struct set *set)
{
    free(set->position);
    free(set->velocity);
    free(set->density);
    free(set->id);
}

static struct mns_particles view(const struct set *set)
{
    struct mns_particles particles;
    mns_particles_init(&particles);
    particles.count = set->count;
    particles.position = (struct mns_attr){.data = set->position, .type = MNS_F32};
    particles.velocity = (struct mns_attr){.data = set->velocity, .type = MNS_F32};
    particles.density = (struct mns_attr){.data = set->density, .type = MNS_F32};
    return particles;
}

/* The attributes of a step, which must succeed. */
static struct mns_particles step(mns_classifier *classifier, struct mns_particles particles, double time, const struct mns_params *params)
{
    if (mns_classifier_step(classifier, &particles, time, params) != MNS_OK) {
        fail_msg("%s", mns_classifier_message(classifier));
    }
    mns_classifier_attach(classifier, &particles);
    return particles;
}

static float at(const struct mns_attr *attr, size_t i) { return attr->data ? ((const float *)attr->data)[i] : -1; }

static void assert_near(float value, double expected, double tolerance)
{
    if (!(fabs((double)value - expected) <= tolerance)) {
        fail_msg("%.9g is not %.9g", (double)value, expected);
    }
}

/* ---- formulas ---- */

/* [BSW10] eq. 5: We = rho v^2 l / sigma with rho 900, l 0.02. */
static void test_weber_number_by_hand(void **state)
{
    (void)state;
    struct set set = set_create(5);
    mns_classifier *classifier = quiet();
    struct mns_params params = hand_params();
    params.surface_tension = 72;
    const float speeds[] = {0, 1.4f, sqrtf(2), sqrtf(3), 2.1f}; /* We = v^2 / 4: 0, 0.49, 0.5, 0.75, 1.1 */
    for (size_t i = 0; i < 5; i++) {
        set.velocity[3 * i + i % 3] = i % 2 ? speeds[i] : -speeds[i];
    }
    struct mns_particles out = step(classifier, view(&set), 0, &params);
    const double foam[] = {0, 0, 0, 0.5, 1}; /* between 0.5 and 1 */
    for (size_t i = 0; i < 5; i++) {
        assert_near(at(&out.foam, i), foam[i], 2e-6);
        assert_near(at(&out.water, i), cbrt(1 - foam[i] * foam[i] * foam[i]), 2e-6);
        assert_true(i == 2 || at(&out.foam_age, i) == (foam[i] > 0 ? 0 : 1)); /* We is about 0.5 in the third */
    }
    assert_null(out.spray.data);

    params.surface_tension = 0; /* auto: We = 0.9 v^2 / 25 */
    set.velocity[0] = (float)sqrt(0.8 * 25 / 0.9);
    mns_classifier_reset(classifier);
    out = step(classifier, view(&set), 0, &params);
    assert_near(at(&out.foam, 0), 0.6, 2e-6);
    assert_near(at(&out.foam, 4), 0, 0);

    struct mns_class_stats stats;
    mns_class_stats_init(&stats);
    mns_classifier_stats(classifier, &stats);
    assert_true(stats.count == 5 && stats.foam == 1 && stats.spray == 0 && stats.rest_density == 1000);
    assert_true(fabs(stats.foam_volume - 0.216) < 1e-5);
    mns_classifier_destroy(&classifier);
    assert_null(classifier);
    set_free(&set);
}

static void test_foam_needs_air(void **state)
{
    (void)state;
    struct set set = set_create(4);
    mns_classifier *classifier = quiet();
    struct mns_params params = hand_params();
    params.foam_air = 0.1f;
    const float density[] = {1010, 990, 940, 899}; /* air: none, 1 %, 6 %, 10 %; it counts from 2 % to 10 % */
    for (size_t i = 0; i < 4; i++) {
        set.density[i] = density[i];
        set.velocity[3 * i] = 10;
    }
    struct mns_particles out = step(classifier, view(&set), 0, &params);
    assert_near(at(&out.foam, 0), 0, 0);
    assert_near(at(&out.foam, 1), 0, 0);
    assert_near(at(&out.foam, 2), 0.5, 1e-5);
    assert_near(at(&out.foam, 3), 1, 1e-5);
    params.foam_air = 0;
    mns_classifier_reset(classifier);
    out = step(classifier, view(&set), 0, &params);
    assert_near(at(&out.foam, 0), 1, 0);
    mns_classifier_destroy(&classifier);
    set_free(&set);
}

/* By volume: spray, foam^3 and water^3 add up to 1. Densities of one alone, just emitted, of a pair, half way, of a sheet. */
static void test_spray_by_density(void **state)
{
    (void)state;
    struct set set = set_create(6);
    mns_classifier *classifier = quiet();
    struct mns_params params = hand_params();
    const float density[] = {254.6f, 0, 350, 400, 550, 400};
    const double spray[] = {1, 0, 0.75, 0.5, 0, 0.5};
    memcpy(set.density, density, sizeof(density));
    set.velocity[15] = (float)sqrt(0.75 * 25 / 0.4); /* foam 0.5 */
    struct mns_particles out = step(classifier, view(&set), 0, &params);
    for (size_t i = 0; i < 6; i++) {
        float w = at(&out.water, i), f = at(&out.foam, i);
        assert_near(at(&out.spray, i), spray[i], 2e-6);
        assert_near(at(&out.spray, i) + w * w * w + f * f * f, 1, 4e-6);
    }
    assert_near(at(&out.foam, 5), 0.5 * cbrt(0.5), 2e-6);
    assert_near(at(&out.water, 0), 0, 0);
    assert_near(at(&out.water, 1), 1, 0);
    mns_classifier_destroy(&classifier);
    set_free(&set);
}

/* The rest density is the frame's own where it is not set: any unit will do. */
static void test_densities_of_any_unit(void **state)
{
    (void)state;
    enum { COUNT = 1000 };
    struct set set = set_create(COUNT);
    mns_classifier *classifier = quiet();
    struct mns_params params = hand_params();
    params.rest_density = 0;
    for (size_t i = 0; i < COUNT; i++) { /* surfaces and strays among them, and some that were just emitted */
        set.density[i] = 1e-3f * (i % 7 == 0 ? 0 : i % 5 == 0 ? 0.66f : i % 11 == 0 ? 0.2546f : 1);
        set.velocity[3 * i] = 6;
    }
    struct mns_particles out = step(classifier, view(&set), 0, &params);
    assert_near(at(&out.spray, 11), 1, 1e-6);
    assert_near(at(&out.spray, 7), 0, 0);
    assert_near(at(&out.foam, 5), 2 * (0.66 * 36 / 25 - 0.5), 1e-5);
    mns_classifier_destroy(&classifier);
    set_free(&set);
}

/* ---- over time ---- */

/* One particle that is fast for one frame of 0.05 s: foam grows by 0.2 a frame once its cause has passed it by, no more; so make it last. */
static void test_life_of_foam_by_hand(void **state)
{
    (void)state;
    struct set set = set_create(1);
    mns_classifier *classifier = quiet();
    struct mns_params params = hand_params();
    const double dt = 0.05;
    double time = 0, foam[60], age[60];
    for (int i = 0; i < 60; i++, time += dt) { /* fast in frames 1 to 5 */
        set.velocity[0] = i >= 1 && i <= 5 ? 10 : 0;
        struct mns_particles out = step(classifier, view(&set), time, &params);
        foam[i] = out.foam.data ? (double)at(&out.foam, 0) : 0;
        age[i] = out.foam.data ? (double)at(&out.foam_age, 0) : 1;
    }
    assert_true(foam[0] == 0);
    for (int i = 1; i <= 5; i++) {
        assert_near((float)foam[i], 0.2 * i, 1e-5);
    }
    for (int i = 6; i < 60; i++) { /* 0.05 / (2 * 2) of the strength a frame; life ends after 40 frames, the last 15 of them fading */
        double life = fmax(1 - 0.025 * (i - 5), 0), strength = 1 - 0.0125 * (i - 5);
        assert_near((float)foam[i], fmin(strength, life * 2 / 0.75), 1e-5);
        assert_near((float)age[i], foam[i] > 0 ? 1 - life : 1, 1e-5);
    }
    assert_true(foam[45] < 1e-5 && foam[43] > 0.1);
    mns_classifier_destroy(&classifier);
    set_free(&set);
}

/* [LGS09] eq. 12: tau is 0.15 * 5 and what gravity adds in a frame of 0.05 s: 1.25 m/s. */
static void test_noise_cools_down(void **state)
{
    (void)state;
    struct set set = set_create(2);
    mns_classifier *classifier = quiet();
    struct mns_params params = hand_params();
    params.noise_calm = 0;
    double noise[40];
    for (int i = 0; i < 40; i++) {
        set.velocity[0] = i >= 3 ? 1.27f : 0;
        set.velocity[3] = i >= 3 ? 1.23f : 0;
        struct mns_particles out = step(classifier, view(&set), 0.05 * i, &params);
        noise[i] = (double)at(&out.noise, 0);
        assert_near(at(&out.noise, 1), 0, 0);
    }
    const double expected[] = {0, 0, 0, 0.2, 0.4, 0.6, 0.8, 0.75, 0.7};
    for (int i = 0; i < 9; i++) {
        assert_near((float)noise[i], i < 7 ? expected[i] : 1 - 0.05 * (i - 3), 1e-5);
    }
    assert_near((float)noise[23], 0, 1e-5);

    params.noise_calm = 0.4f; /* by the Weber number, 0.9 * 1.27^2 / 25, over foam_weber_low */
    struct mns_particles out = step(classifier, view(&set), 2, &params);
    assert_near(at(&out.noise, 0), 0.4 * 0.9 * 1.27 * 1.27 / 25 / 0.5, 1e-5);
    mns_classifier_destroy(&classifier);
    set_free(&set);
}

/* A scene of particles that are shaken now and then. */
static void shake(struct set *set, int frame)
{
    for (size_t i = 0; i < set->count; i++) {
        uint32_t hash = ((uint32_t)i * 2654435761u) ^ ((uint32_t)(frame / 3) * 2246822519u);
        hash = (hash ^ hash >> 15) * 2654435761u;
        set->velocity[3 * i] = (hash >> 8) % 16 ? 0.3f : (float)(hash >> 16 & 255) / 32;
        set->velocity[3 * i + 1] = (float)(hash >> 24) / 512;
        set->density[i] = 850 + (float)(hash >> 12 & 127);
    }
}

/* A classifier that begins as late as mns_classifier_memory allows gives the same bytes as one that saw all. */
static void test_memory_is_as_long_as_told(void **state)
{
    (void)state;
    enum { COUNT = 700, FRAMES = 150 };
    const double dt = 1 / 24.0;
    struct set set = set_create(COUNT);
    struct mns_params params = hand_params();
    const int back = (int)ceil(mns_classifier_memory(&params) / dt) + 2;
    assert_near((float)mns_classifier_memory(&params), 4.25, 1e-6);
    mns_classifier *whole = quiet(), *part = quiet();
    size_t foamy = 0;
    for (int frame = 0; frame < FRAMES; frame++) {
        shake(&set, frame);
        struct mns_particles a = step(whole, view(&set), frame * dt, &params);
        if (frame < FRAMES - 10 - back) {
            continue;
        }
        struct mns_particles b = step(part, view(&set), frame * dt, &params);
        if (frame < FRAMES - 10) {
            continue;
        }
        for (size_t i = 0; i < COUNT; i++) {
            foamy += at(&a.foam, i) > 0 && at(&a.foam, i) < 1;
        }
        assert_memory_equal(a.foam.data, b.foam.data, COUNT * sizeof(float));
        assert_memory_equal(a.foam_age.data, b.foam_age.data, COUNT * sizeof(float));
        assert_memory_equal(a.noise.data, b.noise.data, COUNT * sizeof(float));
        assert_memory_equal(a.water.data, b.water.data, COUNT * sizeof(float));
    }
    assert_true(foamy > COUNT); /* in ten frames: most are on their way */
    mns_classifier_destroy(&whole);
    mns_classifier_destroy(&part);
    set_free(&set);
}

/* No particle's foam changes by more in a frame than its fading allows: nothing pops. */
static void test_nothing_pops(void **state)
{
    (void)state;
    enum { COUNT = 500 };
    const double dt = 1 / 30.0;
    struct set set = set_create(COUNT);
    struct mns_params params = hand_params();
    mns_classifier *classifier = quiet();
    float before[COUNT] = {0}, noisy[COUNT] = {0};
    float rise = 0, drop = 0, jolt = 0;
    for (int frame = 0; frame < 200; frame++) {
        shake(&set, frame);
        struct mns_particles out = step(classifier, view(&set), frame * dt, &params);
        for (size_t i = 0; i < COUNT; i++) {
            if (frame > 0) {
                rise = fmaxf(rise, at(&out.foam, i) - before[i]);
                drop = fmaxf(drop, before[i] - at(&out.foam, i));
                jolt = fmaxf(jolt, at(&out.noise, i) - noisy[i]);
            }
            before[i] = at(&out.foam, i);
            noisy[i] = at(&out.noise, i);
        }
    }
    assert_true(rise <= dt / 0.25 + 1e-5 && rise > 0.1);
    assert_true(drop <= dt / 0.75 + 1e-5 && drop > 0.01);
    assert_true(jolt <= dt / 0.25 + 1e-5 && jolt > 0.1);
    mns_classifier_destroy(&classifier);
    set_free(&set);
}

/* ---- sizes ---- */

/* A lattice of 12^3 particles, the upper half of it thrown about, at a scale of lengths and of times, through 12 frames with nothing given but positions
 * and velocities. */
static void throw_about(double lengths, double times, float gravity, float *foam, float *noise)
{
    enum { SIDE = 12, COUNT = SIDE * SIDE * SIDE };
    struct set set = set_create(COUNT);
    struct mns_params params;
    mns_params_init(&params);
    params.foam = MNS_FOAM_LAYERED;
    params.gravity = gravity;
    mns_classifier *classifier = quiet();
    struct mns_particles out;
    random_state = 3;
    for (int frame = 0; frame < 12; frame++) {
        for (int i = 0; i < COUNT; i++) {
            const int cell[3] = {i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE};
            for (int k = 0; k < 3; k++) {
                double jitter = cell[1] > SIDE / 2 ? 0.2 * (uniform() - 0.5) : 0;
                set.position[3 * i + k] = (float)(lengths * 0.1 * (cell[k] + jitter));
                set.velocity[3 * i + k] = (float)(lengths / times * (cell[1] > SIDE / 2 ? 5 * uniform() : 0.01));
            }
        }
        struct mns_particles in = view(&set);
        in.density.data = NULL;
        out = step(classifier, in, frame / 30.0 * times, &params);
    }
    memcpy(foam, out.foam.data, COUNT * sizeof(float));
    memcpy(noise, out.noise.data, COUNT * sizeof(float));
    mns_classifier_destroy(&classifier);
    set_free(&set);
}

/* A thousand times larger under the same gravity (then times and speeds are sqrt(1000) larger), and in millimetres (then gravity is 9810). */
static void test_scale_changes_nothing(void **state)
{
    (void)state;
    enum { COUNT = 12 * 12 * 12 };
    static float foam[4][COUNT], noise[4][COUNT];
    throw_about(1, 1, 9.81f, foam[0], noise[0]);
    throw_about(1000, sqrt(1000), 9.81f, foam[1], noise[1]);
    throw_about(0.001, sqrt(0.001), 9.81f, foam[2], noise[2]);
    throw_about(1000, 1, 9810, foam[3], noise[3]);
    size_t foamy = 0;
    for (size_t i = 0; i < COUNT; i++) {
        foamy += foam[0][i] > 0.2f;
        for (int k = 1; k < 4; k++) {
            assert_near(foam[k][i], (double)foam[0][i], 2e-4);
            assert_near(noise[k][i], (double)noise[0][i], 2e-4);
        }
    }
    assert_true(foamy > COUNT / 10 && foamy < COUNT / 2);
}

/* Positions alone, a hand's breadth of waves: neither foam nor spray nor noise, at first or later. */
static void test_a_still_pool_has_no_foam(void **state)
{
    (void)state;
    enum { SIDE = 24, COUNT = SIDE * SIDE * 6 };
    struct set set = set_create(COUNT);
    struct mns_params params;
    mns_params_init(&params);
    params.foam = MNS_FOAM_LAYERED;
    mns_classifier *classifier = quiet();
    struct mns_class_stats stats;
    mns_class_stats_init(&stats);
    for (int frame = 0; frame < 6; frame++) {
        for (int i = 0; i < COUNT; i++) {
            const int cell[3] = {i % SIDE, i / SIDE / SIDE, i / SIDE % SIDE};
            for (int k = 0; k < 3; k++) {
                set.position[3 * i + k] = (float)(0.02 * (cell[k] + 0.01 * sin(frame + i * 1.7 + k)));
            }
        }
        struct mns_particles in = view(&set);
        in.density.data = in.velocity.data = NULL;
        struct mns_particles out = step(classifier, in, frame / 30.0, &params);
        mns_classifier_stats(classifier, &stats);
        assert_true(stats.foam == 0 && stats.spray == 0);
        assert_true(!out.foam.data && !out.spray.data && !out.water.data);
        assert_non_null(out.velocity.data);
        for (size_t i = 0; i < COUNT; i++) {
            assert_true(at(&out.noise, i) < 0.001f);
        }
    }
    mns_classifier_destroy(&classifier);
    set_free(&set);
}

/* ---- what is derived ---- */

static void test_density_from_neighbours(void **state)
{
    (void)state;
    enum { SIDE = 9, BLOCK = SIDE * SIDE * SIDE, COUNT = BLOCK + 3 };
    struct set set = set_create(COUNT);
    const float s = 0.02f;
    for (int i = 0; i < BLOCK; i++) {
        set.position[3 * i] = s * (float)(i % SIDE);
        set.position[3 * i + 1] = s * (float)(i / SIDE % SIDE);
        set.position[3 * i + 2] = s * (float)(i / SIDE / SIDE);
    }
    for (int k = 0; k < 3; k++) {
        set.position[3 * BLOCK + k] = 5;       /* one alone */
        set.position[3 * (BLOCK + 1) + k] = 7; /* a pair, a spacing apart */
        set.position[3 * (BLOCK + 2) + k] = k == 0 ? 7 + s : 7;
    }
    struct mns_params params = hand_params();
    mns_classifier *classifier = quiet();
    struct mns_particles in = view(&set);
    in.density.data = NULL;
    struct mns_particles out = step(classifier, in, 0, &params);
    /* The cubic spline with support 4 r at distances 0, s, sqrt(2) s, sqrt(3) s: 1 + 6 / 4 + 12 * 2 (1 - sqrt(2) / 2)^3 + 8 * 2 (1 - sqrt(3) / 2)^3,
     * over pi. The middle particle and most others have it: so it is the density at rest. */
    double middle = 1 + 1.5 + 24 * pow(1 - sqrt(2) / 2, 3) + 16 * pow(1 - sqrt(3) / 2, 3);
    assert_near(at(&out.density, BLOCK / 2), 1000, 0.01);
    assert_near(at(&out.density, BLOCK), 1000 / middle, 0.01);
    assert_near(at(&out.density, BLOCK + 1), 1250 / middle, 0.01);
    assert_near(at(&out.density, 4 + 4 * SIDE), 1000 * (1 + 1.25 + 16 * pow(1 - sqrt(2) / 2, 3) + 8 * pow(1 - sqrt(3) / 2, 3)) / middle,
                0.01);
    assert_near(at(&out.spray, BLOCK), 1, 2e-6 + 5 * fmax(1 / middle - 0.3, 0));
    assert_near(at(&out.spray, BLOCK / 2), 0, 0);
    mns_classifier_destroy(&classifier);
    set_free(&set);
}

/* From positions alone the same foam comes as from the velocities that moved them; by id, whatever the order. */
static void test_velocity_from_two_frames(void **state)
{
    (void)state;
    enum { COUNT = 300 };
    const double dt = 1 / 30.0;
    struct set given = set_create(COUNT), bare = set_create(COUNT);
    struct mns_params params = hand_params();
    mns_classifier *one = quiet(), *two = quiet();
    for (int frame = 0; frame < 20; frame++) {
        for (size_t i = 0; i < COUNT; i++) {
            size_t j = (i * 7 + (size_t)frame) % COUNT; /* where it stands in the other set */
            given.velocity[3 * i] = (float)(i % 10);
            given.position[3 * i] = (float)((double)i + given.velocity[3 * i] * dt * frame);
            bare.position[3 * j] = given.position[3 * i];
            bare.id[j] = (int64_t)i;
        }
        struct mns_particles in = view(&bare);
        in.velocity.data = NULL;
        in.id = (struct mns_attr){.data = bare.id, .type = MNS_I64};
        struct mns_particles a = step(one, view(&given), frame * dt, &params), b = step(two, in, frame * dt, &params);
        assert_true((frame == 0) == !b.foam.data);
        for (size_t i = 0; i < COUNT && frame > 0; i++) {
            size_t j = (i * 7 + (size_t)frame) % COUNT;
            assert_near(((const float *)b.velocity.data)[3 * j], (double)(i % 10), 1e-3);
            if (frame > 9) { /* grown by then in both */
                assert_near(at(&b.foam, j), (double)at(&a.foam, i), 1e-3);
                assert_near(at(&b.noise, j), (double)at(&a.noise, i), 1e-3);
            }
        }
    }
    mns_classifier_destroy(&one);
    mns_classifier_destroy(&two);
    set_free(&given);
    set_free(&bare);
}

/* ---- sequences that are not as they should be ---- */

struct heard {
    int count;
    char last[512];
};

static void hear(void *user, enum mns_log_level level, const char *text)
{
    struct heard *heard = user;
    assert_int_equal(level, MNS_LOG_WARNING);
    heard->count++;
    snprintf(heard->last, sizeof(heard->last), "%s", text);
}

static void test_warnings_once_each(void **state)
{
    (void)state;
    struct heard heard = {0};
    struct set set = set_create(10);
    struct mns_params params = hand_params();
    mns_classifier *classifier = create((struct mns_log){.message = hear, .user = &heard}, 1);
    struct mns_particles in = view(&set);
    step(classifier, in, 0, &params);
    in.count = 8;
    step(classifier, in, 1, &params);
    assert_int_equal(heard.count, 1);
    assert_non_null(strstr(heard.last, "changes from 10 to 8"));
    assert_non_null(strstr(heard.last, "role id"));
    in.count = 10;
    step(classifier, in, 2, &params);
    assert_int_equal(heard.count, 1);

    in.id = (struct mns_attr){.data = set.id, .type = MNS_I64};
    mns_classifier_reset(classifier);
    step(classifier, in, 0, &params);
    assert_int_equal(heard.count, 1);
    set.id[4] = 3;
    step(classifier, in, 1, &params);
    assert_int_equal(heard.count, 3); /* 3 twice, 4 gone */
    assert_non_null(strstr(heard.last, "1 particles vanish"));
    set.id[4] = 4;
    step(classifier, in, 2, &params);
    assert_int_equal(heard.count, 4);
    assert_non_null(strstr(heard.last, "come back"));
    assert_non_null(strstr(heard.last, "the first: 4"));

    set.velocity[0] = 1e7f;
    step(classifier, in, 2.1, &params);
    assert_int_equal(heard.count, 5);
    assert_non_null(strstr(heard.last, "1 particles would cross the scene"));
    struct mns_class_stats stats;
    mns_class_stats_init(&stats);
    mns_classifier_stats(classifier, &stats);
    assert_true(stats.fast == 1 && stats.appeared == 0);
    mns_classifier_destroy(&classifier);
    set_free(&set);
}

static void test_bad_values_do_no_harm(void **state)
{
    (void)state;
    struct set set = set_create(6);
    struct mns_params params = hand_params();
    mns_classifier *classifier = quiet();
    set.velocity[1] = NAN;
    set.velocity[4] = INFINITY;
    set.velocity[6] = 1e30f;
    set.density[3] = NAN;
    set.density[4] = -5;
    set.density[5] = INFINITY;
    set.position[9] = NAN;
    for (int frame = 0; frame < 4; frame++) {
        struct mns_particles out = step(classifier, view(&set), frame, &params);
        for (size_t i = 0; i < 6; i++) {
            const struct mns_attr *attrs[] = {&out.noise, &out.foam, &out.water, &out.foam_age, &out.spray};
            for (int k = 0; k < 5; k++) {
                assert_true(!attrs[k]->data || (at(attrs[k], i) >= 0 && at(attrs[k], i) <= 1));
            }
        }
    }
    struct mns_particles in = view(&set);
    in.velocity.data = in.density.data = NULL;
    step(classifier, in, 4, &params);
    step(classifier, in, 5, &params);
    in.count = 0;
    step(classifier, in, 6, &params);
    mns_classifier_destroy(&classifier);
    set_free(&set);
}

static void test_wrong_calls(void **state)
{
    (void)state;
    struct set set = set_create(3);
    struct mns_params params = hand_params();
    mns_classifier *classifier = quiet();
    struct mns_particles in = view(&set);
    step(classifier, in, 1, &params);
    assert_int_equal(mns_classifier_step(classifier, &in, 1, &params), MNS_ERR_INVALID_ARGUMENT);
    assert_non_null(strstr(mns_classifier_message(classifier), "it must go up"));
    struct mns_particles out = in;
    mns_classifier_attach(classifier, &out);
    assert_null(out.noise.data); /* forgotten */
    step(classifier, in, 1, &params);
    params.foam_weber_low = 3;
    assert_int_equal(mns_classifier_step(classifier, &in, 2, &params), MNS_ERR_INVALID_ARGUMENT);
    assert_non_null(strstr(mns_classifier_message(classifier), "foam_weber_low"));
    params = hand_params();
    in.position.data = NULL;
    assert_int_equal(mns_classifier_step(classifier, &in, 3, &params), MNS_ERR_INVALID_ARGUMENT);
    in.position.data = set.position;
    in.position.type = MNS_I32;
    assert_int_equal(mns_classifier_step(classifier, &in, 3, &params), MNS_ERR_INVALID_ARGUMENT);
    in.position.type = MNS_F32;
    in.struct_size = 3;
    assert_int_equal(mns_classifier_step(classifier, &in, 3, &params), MNS_ERR_INVALID_ARGUMENT);

    in = view(&set);
    params.foam = MNS_FOAM_NONE;
    out = step(classifier, in, 4, &params);
    assert_null(out.noise.data);
    struct mns_classifier_params wrong;
    struct mns_message message;
    mns_classifier_params_init(&wrong);
    wrong.threads = -1;
    mns_classifier *none;
    assert_int_equal(mns_classifier_create(&none, &wrong, &message), MNS_ERR_INVALID_ARGUMENT);
    assert_null(none);
    mns_classifier_destroy(&none);
    mns_classifier_destroy(&classifier);
    set_free(&set);
}

static void test_same_whatever_the_threads(void **state)
{
    (void)state;
    enum { COUNT = 40000 };
    struct set set = set_create(COUNT);
    struct mns_params params = hand_params();
    mns_classifier *one = create((struct mns_log){0}, 1), *five = create((struct mns_log){0}, 5);
    for (int frame = 0; frame < 4; frame++) {
        shake(&set, frame);
        for (size_t i = 0; i < COUNT; i++) {
            set.position[3 * i] = 0.02f * (float)(i % 40);
            set.position[3 * i + 1] = 0.02f * (float)(i / 40 % 40);
            set.position[3 * i + 2] = 0.02f * (float)(i / 1600) + 0.001f * (float)frame;
            set.id[i] = (int64_t)((i * 3 + (size_t)frame) % (COUNT - 1)); /* one is there twice */
        }
        struct mns_particles in = view(&set);
        in.id = (struct mns_attr){.data = set.id, .type = MNS_I64};
        in.density.data = frame > 1 ? NULL : in.density.data;
        struct mns_particles a = step(one, in, frame * 0.04, &params), b = step(five, in, frame * 0.04, &params);
        assert_memory_equal(a.foam.data, b.foam.data, COUNT * sizeof(float));
        assert_memory_equal(a.noise.data, b.noise.data, COUNT * sizeof(float));
        assert_memory_equal(a.density.data, b.density.data, COUNT * sizeof(float));
    }
    mns_classifier_destroy(&one);
    mns_classifier_destroy(&five);
    set_free(&set);
}

/* Noise alone: no particle is foam, and the pool is as it was. */
static void test_noise_makes_no_foam_particles(void **state)
{
    (void)state;
    struct set set = set_create(4);
    struct mns_params params = hand_params();
    params.foam = MNS_FOAM_NOISE;
    set.velocity[0] = 10;
    set.density[1] = 200;
    mns_classifier *classifier = quiet();
    struct mns_particles out = step(classifier, view(&set), 0, &params);
    assert_null(out.foam.data);
    assert_near(at(&out.spray, 1), 1, 0);
    assert_near(at(&out.water, 0), 1, 0);
    assert_near(at(&out.noise, 0), 0.3, 1e-6);
    mns_classifier_destroy(&classifier);
    set_free(&set);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_weber_number_by_hand),
        cmocka_unit_test(test_foam_needs_air),
        cmocka_unit_test(test_spray_by_density),
        cmocka_unit_test(test_densities_of_any_unit),
        cmocka_unit_test(test_life_of_foam_by_hand),
        cmocka_unit_test(test_noise_cools_down),
        cmocka_unit_test(test_memory_is_as_long_as_told),
        cmocka_unit_test(test_nothing_pops),
        cmocka_unit_test(test_scale_changes_nothing),
        cmocka_unit_test(test_a_still_pool_has_no_foam),
        cmocka_unit_test(test_density_from_neighbours),
        cmocka_unit_test(test_velocity_from_two_frames),
        cmocka_unit_test(test_warnings_once_each),
        cmocka_unit_test(test_bad_values_do_no_harm),
        cmocka_unit_test(test_wrong_calls),
        cmocka_unit_test(test_same_whatever_the_threads),
        cmocka_unit_test(test_noise_makes_no_foam_particles),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
