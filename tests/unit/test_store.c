/* The stores that a set of particles becomes: what is water, foam and spray, with which radius, and diffuse particles beside them. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "cpu/particles.h"

#include <math.h>
#include <string.h>

enum { SIDE = 20, COUNT = SIDE * SIDE * SIDE };

static const float SPACING = 0.1f;

struct set {
    struct memory memory;
    struct mns_parallel parallel;
    struct particle_store stores[STORE_KINDS];
    float positions[COUNT][3], radius[COUNT], water[COUNT], foam[COUNT], spray[COUNT];
    struct mns_particles particles;
    struct mns_measure measure;
};

static struct set set; /* too large for the stack */

static void run_backwards(void *user, void (*job)(void *context, int index), void *context, int count)
{
    (void)user;
    for (int i = count - 1; i >= 0; i--) {
        job(context, i);
    }
}

/* A lattice in which a particle's column tells what it is: foam 0 water 1 in most, foam x / SIDE and water 1 - x / SIDE in the others. */
static void open_set(void)
{
    memset(&set, 0, sizeof(set));
    mns_memory_init(&set.memory, NULL);
    set.parallel.run = run_backwards;
    mns_particles_init(&set.particles);
    set.particles.count = COUNT;
    for (int i = 0; i < COUNT; i++) {
        const int cell[3] = {i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE};
        for (int k = 0; k < 3; k++) {
            set.positions[i][k] = 7 + SPACING * (float)cell[k];
        }
        set.radius[i] = 0.04f + 0.001f * (float)cell[1];
        set.foam[i] = (float)cell[0] / (SIDE - 1);
        set.water[i] = 1 - set.foam[i];
        set.spray[i] = cell[0] == 3 ? 0.5f : 0;
    }
    set.particles.position = (struct mns_attr){.data = set.positions, .type = MNS_F32};
}

static struct mns_attr scalars(const float *values) { return (struct mns_attr){.data = values, .type = MNS_F32}; }

static void fill(int threads)
{
    assert_int_equal(mns_particle_stores_fill(set.stores, &set.memory, &set.parallel, threads, &set.particles, false, &set.measure, NULL), MNS_OK);
}

static void close_set(void)
{
    for (int kind = 0; kind < STORE_KINDS; kind++) {
        mns_particle_store_free(&set.stores[kind], &set.memory);
    }
    assert_int_equal(set.memory.bytes, 0);
}

static void test_without_attributes_all_is_water(void **state)
{
    (void)state;
    open_set();
    fill(3);
    assert_int_equal(set.stores[STORE_WATER].count, COUNT);
    assert_null(set.stores[STORE_WATER].factor);
    assert_int_equal(set.stores[STORE_FOAM].count, 0);
    assert_int_equal(set.stores[STORE_SPRAY].count, 0);
    close_set();
}

static void test_a_particle_may_be_several_things(void **state)
{
    (void)state;
    open_set();
    set.particles.water = scalars(set.water);
    set.particles.foam = scalars(set.foam);
    set.particles.spray = scalars(set.spray);
    fill(3);
    const struct particle_store *water = &set.stores[STORE_WATER], *foam = &set.stores[STORE_FOAM], *spray = &set.stores[STORE_SPRAY];
    assert_int_equal(water->count, COUNT - SIDE * SIDE); /* the last column has none, the first has no foam */
    assert_int_equal(foam->count, COUNT - SIDE * SIDE);
    assert_int_equal(spray->count, SIDE * SIDE);
    for (size_t i = 0; i < foam->count; i++) {
        float column = (foam->x[i] + (float)foam->facts.origin[0] - 7) / SPACING;
        assert_true(fabsf(foam->factor[i] - column / (SIDE - 1)) < 1e-4f);
        assert_true(foam->factor[i] <= foam->box_factor[i / CHUNK_SIZE]);
    }
    for (size_t i = 0; i < spray->count; i++) {
        assert_true(spray->opacity[i] == 0.5f && spray->factor[i] == 1);
    }
    close_set();
}

static void test_factors_scale_given_radii(void **state)
{
    (void)state;
    open_set();
    set.particles.water = scalars(set.water);
    set.particles.radius = scalars(set.radius);
    fill(1);
    const struct particle_store *water = &set.stores[STORE_WATER];
    for (size_t i = 0; i < water->count; i++) {
        float row = (water->y[i] + (float)water->facts.origin[1] - 7) / SPACING;
        assert_true(fabsf(water->radius[i] / water->factor[i] - (0.04f + 0.001f * row)) < 1e-5f);
        assert_true(water->radius[i] <= water->box_radius[i / CHUNK_SIZE]);
    }
    close_set();
}

/* Water that turns into foam must not change the radius, the volumes or L from one frame to the next. */
static void test_what_becomes_foam_changes_no_measure(void **state)
{
    (void)state;
    open_set();
    set.particles.radius = scalars(set.radius);
    fill(2);
    struct mns_measure before = set.measure;
    struct particle_facts facts = set.stores[STORE_WATER].facts;
    set.particles.water = scalars(set.water);
    set.particles.foam = scalars(set.foam);
    fill(2);
    assert_memory_equal(&before, &set.measure, sizeof(before));
    assert_memory_equal(&facts, &set.stores[STORE_FOAM].facts, sizeof(facts));
    close_set();
}

static void test_nan_counts_as_absent(void **state)
{
    (void)state;
    open_set();
    for (int i = 0; i < COUNT; i++) {
        set.water[i] = set.foam[i] = NAN;
    }
    set.particles.water = scalars(set.water);
    set.particles.foam = scalars(set.foam);
    fill(2);
    assert_int_equal(set.stores[STORE_WATER].count, COUNT);
    assert_int_equal(set.stores[STORE_FOAM].count, 0);
    close_set();
}

static void test_threads_change_no_byte(void **state)
{
    (void)state;
    open_set();
    set.particles.foam = scalars(set.foam);
    fill(1);
    struct particle_store one = set.stores[STORE_FOAM];
    set.stores[STORE_FOAM] = (struct particle_store){0};
    fill(7);
    const struct particle_store *seven = &set.stores[STORE_FOAM];
    assert_int_equal(one.count, seven->count);
    assert_memory_equal(one.x, seven->x, one.count * sizeof(float));
    assert_memory_equal(one.factor, seven->factor, one.count * sizeof(float));
    assert_memory_equal(one.seed, seven->seed, one.count * sizeof(float));
    mns_particle_store_free(&one, &set.memory);
    close_set();
}

static void test_diffuse_particles_join_their_kind_and_are_replaced(void **state)
{
    (void)state;
    open_set();
    set.particles.foam = scalars(set.foam);
    fill(2);
    size_t own = set.stores[STORE_FOAM].count;
    float last = set.stores[STORE_FOAM].x[own - 1];
    enum { DIFFUSE = 1000 };
    static float at[DIFFUSE][3];
    static uint8_t kinds[DIFFUSE];
    for (int i = 0; i < DIFFUSE; i++) {
        at[i][0] = 8 + 0.001f * (float)i;
        at[i][1] = at[i][2] = 9;
        kinds[i] = (uint8_t)(i % 4 == 0 ? MNS_KIND_SPRAY : i % 4 == 1 ? MNS_KIND_BUBBLE : MNS_KIND_FOAM);
    }
    struct mns_particles diffuse;
    mns_particles_init(&diffuse);
    diffuse.count = DIFFUSE;
    diffuse.position = (struct mns_attr){.data = at, .type = MNS_F32};
    diffuse.kind = (struct mns_attr){.data = kinds, .type = MNS_U8};
    size_t dropped;
    for (int times = 0; times < 2; times++) { /* the second replaces the first */
        assert_int_equal(mns_particle_stores_diffuse(set.stores, &set.memory, &set.parallel, 3, &diffuse, &dropped, NULL), MNS_OK);
        assert_int_equal(dropped, 0);
        assert_int_equal(set.stores[STORE_FOAM].count, own + DIFFUSE * 3 / 4);
        assert_int_equal(set.stores[STORE_SPRAY].count, DIFFUSE / 4);
        assert_true(set.stores[STORE_FOAM].factor[own] == 0.5f && set.stores[STORE_FOAM].x[own - 1] == last);
    }
    at[0][0] = NAN;
    assert_int_equal(mns_particle_stores_diffuse(set.stores, &set.memory, &set.parallel, 3, &diffuse, &dropped, NULL), MNS_OK);
    assert_int_equal(dropped, 1);
    diffuse.count = 0;
    assert_int_equal(mns_particle_stores_diffuse(set.stores, &set.memory, &set.parallel, 3, &diffuse, &dropped, NULL), MNS_OK);
    assert_int_equal(set.stores[STORE_FOAM].count, own);
    assert_int_equal(set.stores[STORE_SPRAY].count, 0);
    for (size_t i = own; i < set.stores[STORE_FOAM].chunk_count * CHUNK_SIZE; i++) {
        assert_true(set.stores[STORE_FOAM].x[i] == last); /* padded as before */
    }
    close_set();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_without_attributes_all_is_water),
        cmocka_unit_test(test_a_particle_may_be_several_things),
        cmocka_unit_test(test_factors_scale_given_radii),
        cmocka_unit_test(test_what_becomes_foam_changes_no_measure),
        cmocka_unit_test(test_nan_counts_as_absent),
        cmocka_unit_test(test_threads_change_no_byte),
        cmocka_unit_test(test_diffuse_particles_join_their_kind_and_are_replaced),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
