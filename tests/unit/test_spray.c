/* test_spray.c: stage spray: a drop is as much at any resolution and however it moves, and stands before or behind the water. */
#include "cpu/spray.h"

#include "splat_test.h"

enum { WIDTH = 200, HEIGHT = 150, COUNT = 500 };

static float positions[COUNT][3], velocities[COUNT][3], water[COUNT], spray[COUNT];

/* One ball of water far to the left, then drops. */
static struct mns_particles drops(size_t count)
{
    struct mns_particles particles;
    mns_particles_init(&particles);
    for (size_t i = 0; i < count; i++) {
        water[i] = i == 0 ? 1 : 0;
        spray[i] = i == 0 ? 0 : 0.5f;
    }
    particles.count = count;
    particles.position = (struct mns_attr){.data = positions, .type = MNS_F32};
    particles.velocity = (struct mns_attr){.data = velocities, .type = MNS_F32};
    particles.water = (struct mns_attr){.data = water, .type = MNS_F32};
    particles.spray = (struct mns_attr){.data = spray, .type = MNS_F32};
    return particles;
}

static void open_view(struct stage_test *t, int threads, const struct mns_particles *particles, double height)
{
    stage_test_open(t, MNS_ISA_AUTO, threads, particles);
    mns_camera_init(&t->camera, WIDTH, HEIGHT);
    const double eye[3] = {0, 0, 4}, target[3] = {0, 0, 0}, up[3] = {0, 1, 0};
    assert_int_equal(mns_camera_look_at(&t->camera, eye, target, up), MNS_OK);
    assert_int_equal(mns_camera_orthographic(&t->camera, height, 0.1, 100), MNS_OK);
    t->params.foam = MNS_FOAM_LAYERED;
    t->params.radius = 0.1f;
    t->params.spray_radius = 0.8f;
    t->params.spray_depth = 2;
    t->params.spray_shutter = 0.01f;
}

static void draw(struct stage_test *t)
{
    stage_test_draw(t);
    assert_int_equal(mns_cpu_smooth(t->cpu, &t->frame), MNS_OK);
    assert_int_equal(mns_cpu_spray(t->cpu, &t->frame), MNS_OK);
}

static float at(const struct plane *plane, int x, int y) { return plane->data[y * plane->stride + x]; }

/* Over the picture, square metres. */
static double amount_of(const struct plane *plane, double height)
{
    double sum = 0;
    for (int y = 0; y < HEIGHT; y++) {
        for (int x = 0; x < WIDTH; x++) {
            sum += (double)at(plane, x, y) * height * height / HEIGHT / HEIGHT;
        }
    }
    return sum;
}

/* spray_depth * opacity * pi r^2 / 3, whatever the size in pixels (6, 3, 1, 0.3) and the speed. */
static void test_amount_is_that_of_the_drop(void **state)
{
    (void)state;
    static const double heights[] = {2, 4, 12, 40};
    const double expected = 2 * 0.5 * 3.14159265358979 * 0.08 * 0.08 / 3;
    for (int kind = 0; kind < 12; kind++) {
        double height = heights[kind % 4];
        positions[0][0] = -50;
        positions[1][0] = 0.013f;
        velocities[1][0] = kind / 4 == 0 ? 0 : 30;
        velocities[1][1] = kind / 4 == 2 ? -12.0f : 0;
        struct mns_particles particles = drops(2);
        struct stage_test t;
        open_view(&t, 1, &particles, height);
        draw(&t);
        double front = amount_of(&t.cpu->spray->front, height);
        if (fabs(front - expected) > 0.03 * expected) {
            fail_msg("%g of %g, %g m high, kind %d", front, expected, height, kind);
        }
        assert_true(amount_of(&t.cpu->spray->behind, height) == 0);
        stage_test_close(&t);
    }
}

/* A pixel whose centre the middle of a still drop projects to; and half a radius from it, (1 - 1/4)^2. A moving one is as deep along its way. */
static void test_by_hand(void **state)
{
    (void)state;
    positions[0][0] = -50;
    velocities[1][0] = velocities[1][1] = 0;
    const float pixel = 2.0f / HEIGHT;
    positions[1][0] = 0.5f * pixel; /* the middle of the picture is a corner of pixels */
    positions[1][1] = -0.5f * pixel;
    struct mns_particles particles = drops(2);
    struct stage_test t;
    open_view(&t, 1, &particles, 2);
    draw(&t); /* 6 pixels of radius */
    const struct plane *front = &t.cpu->spray->front;
    assert_true(fabsf(at(front, WIDTH / 2, HEIGHT / 2) - 1) < 1e-3f);
    assert_true(fabsf(at(front, WIDTH / 2 + 3, HEIGHT / 2) - 0.5625f) < 1e-3f);
    assert_true(at(front, WIDTH / 2 + 6, HEIGHT / 2) < 1e-6f);
    stage_test_close(&t);
    velocities[1][0] = 16; /* 0.16 m in 0.01 s: 12 pixels, 6 to each side */
    particles = drops(2);
    open_view(&t, 1, &particles, 2);
    draw(&t);
    front = &t.cpu->spray->front;
    float middle = at(front, WIDTH / 2, HEIGHT / 2), share = 1 / (1 + 2 * 16 / 15.0f / 3.14159265f * 3);
    assert_true(fabsf(middle - share) < 1e-3f);
    assert_true(fabsf(at(front, WIDTH / 2 + 5, HEIGHT / 2) - middle) < 1e-4f &&
                fabsf(at(front, WIDTH / 2 - 6, HEIGHT / 2) - middle) < 1e-4f);
    assert_true(fabsf(at(front, WIDTH / 2, HEIGHT / 2 + 3) - 0.5625f * middle) < 1e-3f);
    stage_test_close(&t);
}

static void test_water_before_it(void **state)
{
    (void)state;
    static const float depths[] = {0.5f, -0.5f};
    for (int i = 0; i < 2; i++) {
        positions[0][0] = positions[0][1] = positions[0][2] = 0;
        positions[1][0] = positions[1][1] = 0.01f;
        positions[1][2] = depths[i];
        velocities[1][0] = 0;
        struct mns_particles particles = drops(2);
        struct stage_test t;
        open_view(&t, 1, &particles, 2);
        t.params.filter = MNS_FILTER_NONE;
        t.params.spray_radius = 0.3f;
        draw(&t);
        double front = amount_of(&t.cpu->spray->front, 2), behind = amount_of(&t.cpu->spray->behind, 2);
        assert_true(i == 0 ? front > 0 && behind == 0 : front == 0 && behind > 0);
        stage_test_close(&t);
    }
}

static void test_threads_and_switch(void **state)
{
    (void)state;
    uint64_t seed = 3;
    for (int i = 0; i < COUNT; i++) {
        for (int k = 0; k < 3; k++) {
            positions[i][k] = (float)(2 * random_unit(&seed) - 1);
            velocities[i][k] = (float)(40 * random_unit(&seed) - 20);
        }
    }
    struct mns_particles particles = drops(COUNT);
    struct stage_test one, three;
    open_view(&one, 1, &particles, 2);
    open_view(&three, 3, &particles, 2);
    draw(&one);
    draw(&three);
    for (int y = 0; y < HEIGHT; y++) {
        const struct spray *a = one.cpu->spray, *b = three.cpu->spray;
        assert_memory_equal(a->front.data + y * a->front.stride, b->front.data + y * b->front.stride, WIDTH * sizeof(float));
        assert_memory_equal(a->behind.data + y * a->behind.stride, b->behind.data + y * b->behind.stride, WIDTH * sizeof(float));
    }
    assert_true(one.cpu->spray->shows);
    one.params.foam = MNS_FOAM_NONE;
    draw(&one);
    assert_false(one.cpu->spray->shows);
    stage_test_close(&one);
    stage_test_close(&three);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_amount_is_that_of_the_drop), cmocka_unit_test(test_by_hand),
                                       cmocka_unit_test(test_water_before_it), cmocka_unit_test(test_threads_and_switch)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
