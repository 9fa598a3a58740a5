/* The kernel of stage scene: every instruction set against plain C. */
#include "kernels/kernel_test.h"

#include "cpu/plane.h"

enum { WIDTH = 250, HEIGHT = 140, MAP = 37 };

static float map[MAP * MAP * 4];

static void unit(float v[3], float x, float y, float z)
{
    float length = sqrtf(x * x + y * y + z * z);
    v[0] = x / length;
    v[1] = y / length;
    v[2] = z / length;
}

/* A camera `above` the floor, looking down by `pitch` (radians). */
static struct backdrop backdrop_of(float above, float pitch, bool orthographic, bool sky, bool light)
{
    struct backdrop b = {.has_sky = sky,
                         .has_floor = true,
                         .orthographic = orthographic,
                         .color = {0.1f, 0.2f, 0.3f, 1},
                         .cx = 0.4f * WIDTH,
                         .cy = 0.5f * HEIGHT,
                         .step_x = orthographic ? 0.02f : 1 / 130.0f,
                         .step_y = orthographic ? 0.025f : 1 / 140.0f,
                         .disc_inner = 1e-3f,
                         .disc_outer = 2e-3f,
                         .disc = {30, 29, 28},
                         .light_open = {1.5f, 1.4f, 1.3f},
                         .albedo_mean = {0.4f, 0.4f, 0.3f},
                         .albedo_half = {0.1f, 0.2f, 0.1f},
                         .offset_u = 0.3f,
                         .offset_v = -0.7f,
                         .inv_cell = 3,
                         .light = light ? map : NULL,
                         .light_width = MAP,
                         .light_height = MAP,
                         .light_u = 12,
                         .light_v = -2,
                         .light_scale = 4};
    unit(b.sky.up, 0, -cosf(pitch), -sinf(pitch));
    unit(b.axis_u, 1, 0, 0);
    unit(b.axis_v, 0, -sinf(pitch), cosf(pitch));
    unit(b.sky.sun, 0.3f, -0.3f, 0.9f);
    b.plane = -above;
    for (int c = 0; c < 3; c++) {
        b.sky.zenith[c] = 0.2f;
        b.sky.horizon[c] = 0.6f;
        b.sky.glow_wide[c] = 0.2f;
        b.sky.glow_narrow[c] = 1;
    }
    return b;
}

static void compare(const struct backdrop *b)
{
    const struct kernels *scalar = mns_kernels_get(MNS_ISA_SCALAR), *vector;
    float color[2][4 * (WIDTH + 16)], depth[2][WIDTH + 16];
    for (int y = 0; y < HEIGHT; y += 7) {
        scalar->scene->backdrop(b, 3, y, WIDTH, color[0], depth[0]);
        int index = 0;
        while ((vector = vector_kernels(&index))) {
            vector->scene->backdrop(b, 3, y, WIDTH, color[1], depth[1]);
            for (int x = 0; x < WIDTH; x++) {
                /* Far along the floor the cell's edge moves with the last digits of the depth; there the checker's slope is what counts. */
                assert_near(color[1] + 4 * x, color[0] + 4 * x, 4, 6e-4f);
                if (depth[0][x] < DEPTH_LIMIT && depth[0][x] < 1e3f) {
                    assert_near(depth[1] + x, depth[0] + x, 1, 4e-6f * depth[0][x] * (1 + depth[0][x]));
                }
            }
        }
    }
}

static void test_backdrop(void **state)
{
    (void)state;
    for (int i = 0; i < MAP * MAP * 4; i++) {
        map[i] = uniform(0.5f, 1.5f);
    }
    for (int kind = 0; kind < 8; kind++) {
        struct backdrop b = backdrop_of(2, 0.4f, kind & 1, kind & 2, kind & 4);
        compare(&b);
        b = backdrop_of(0.1f, 0, kind & 1, kind & 2, kind & 4); /* along the floor */
        compare(&b);
        b = backdrop_of(2, -1.2f, kind & 1, kind & 2, kind & 4); /* up */
        compare(&b);
        b.has_floor = false;
        compare(&b);
    }
}

static void test_patterns_and_what_stands_behind_haze(void **state)
{
    (void)state;
    for (int kind = 0; kind < 4; kind++) {
        for (int pattern = MNS_FLOOR_CHECKER; pattern <= MNS_FLOOR_PLAIN; pattern++) {
            struct backdrop b = backdrop_of(2, 0.4f, kind & 1, false, kind & 2);
            b.pattern = pattern;
            b.fades = true;
            b.color[3] = 0;
            compare(&b);
            b = backdrop_of(0.1f, 0, kind & 1, true, kind & 2);
            b.pattern = pattern;
            compare(&b);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_backdrop), cmocka_unit_test(test_patterns_and_what_stands_behind_haze)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
