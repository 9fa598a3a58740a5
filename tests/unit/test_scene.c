/* Stage scene: the caller's pictures come back as they were, the floor lies where it should, the shadow holds the fluid's volume. */
#include "stage_test.h"

#include "cpu/shadow.h"

static const float one[3] = {0, 0, 0};

static void test_pictures_of_the_caller_come_back(void **state)
{
    (void)state;
    struct stage_test test;
    stage_test_begin(&test, MNS_ISA_AUTO, 3, one, 1);
    enum { SIDE = 256, VALUES = SIDE * SIDE * 3 };
    mns_camera_init(&test.camera, SIDE, SIDE);
    static uint16_t words[VALUES], words_back[VALUES];
    static uint8_t bytes[VALUES], bytes_back[VALUES];
    static float floats[VALUES], floats_back[VALUES];
    for (int i = 0; i < VALUES; i++) {
        words[i] = (uint16_t)(i / 3 + 7 * (i % 3));
        bytes[i] = (uint8_t)(i % 251);
        floats[i] = 0.001f * (float)i - 3;
    }
    void *in[] = {words, bytes, floats}, *out[] = {words_back, bytes_back, floats_back};
    static const enum mns_pixel pixels[] = {MNS_PIXEL_U16, MNS_PIXEL_U8, MNS_PIXEL_F32};
    static const size_t sizes[] = {2, 1, 4};
    for (int i = 0; i < 3; i++) {
        const struct mns_scene scene = {.color = image_of(&test, in[i], 3, pixels[i])};
        const struct mns_output outputs[2] = {{MNS_LAYER_BEAUTY, image_of(&test, out[i], 3, pixels[i])},
                                              {MNS_LAYER_SCENE_COLOR, image_of(&test, out[i], 3, pixels[i])}};
        for (int output = 0; output < 2; output++) { /* through the empty picture, and as a layer */
            memset(out[i], 1, VALUES * sizes[i]);
            stage_test_frame(&test, &scene, outputs + output, 1, 1);
            assert_int_equal(mns_cpu_scene(test.cpu, &test.frame), MNS_OK);
            assert_int_equal(mns_cpu_blur(test.cpu, &test.frame), MNS_OK);
            assert_int_equal(mns_cpu_shade(test.cpu, &test.frame), MNS_OK);
            assert_memory_equal(out[i], in[i], VALUES * sizes[i]);
        }
    }
    stage_test_end(&test);
}

static void test_depths_of_the_caller_are_made_safe(void **state)
{
    (void)state;
    struct stage_test test;
    stage_test_begin(&test, MNS_ISA_AUTO, 1, one, 1);
    mns_camera_init(&test.camera, 5, 1);
    float depth[5] = {NAN, INFINITY, -2, 3, 1e38f}, color[5 * 4] = {NAN, 1, -INFINITY}, back[5], back_color[5 * 3];
    const struct mns_scene scene = {.color = image_of(&test, color, 4, MNS_PIXEL_F32), .depth = image_of(&test, depth, 1, MNS_PIXEL_F32)};
    const struct mns_output outputs[2] = {{MNS_LAYER_SCENE_DEPTH, image_of(&test, back, 1, MNS_PIXEL_F32)},
                                          {MNS_LAYER_SCENE_COLOR, image_of(&test, back_color, 3, MNS_PIXEL_F32)}};
    stage_test_frame(&test, &scene, outputs, 2, 1);
    assert_int_equal(mns_cpu_scene(test.cpu, &test.frame), MNS_OK);
    assert_true(test.cpu->scene.has_depth && test.cpu->scene.cuts_fluid);
    assert_true(isinf(back[0]) && isinf(back[1]) && back[2] == 0 && back[3] == 3 && isinf(back[4]));
    assert_true(back_color[0] == 0 && back_color[1] == 1 && back_color[2] == 0);
    stage_test_end(&test);
}

/* World position of a pixel at a depth, by the camera's own matrices. */
static void position_of(const struct stage_test *test, int x, int y, double depth, double out[3])
{
    const double *p = test->camera.projection, *v = test->camera.view;
    double clip_x = 2 * (x + 0.5) / test->camera.width - 1, clip_y = 1 - 2 * (y + 0.5) / test->camera.height;
    bool orthographic = p[15] == 1;
    double view[3] = {orthographic ? (clip_x - p[12]) / p[0] : depth * (clip_x + p[8]) / p[0],
                      orthographic ? (clip_y - p[13]) / p[5] : depth * (clip_y + p[9]) / p[5], -depth};
    for (int k = 0; k < 3; k++) {
        out[k] = 0;
        for (int row = 0; row < 3; row++) {
            out[k] += v[4 * k + row] * (view[row] - v[12 + row]);
        }
    }
}

static void check_floor(struct stage_test *test, const double eye[3], const double target[3], bool expect_floor)
{
    static float depth[64 * 48], color[64 * 48 * 3];
    const double up[3] = {0, 1, 0};
    assert_int_equal(mns_camera_look_at(&test->camera, eye, target, up), MNS_OK);
    const struct mns_output outputs[2] = {{MNS_LAYER_SCENE_DEPTH, image_of(test, depth, 1, MNS_PIXEL_F32)},
                                          {MNS_LAYER_SCENE_COLOR, image_of(test, color, 3, MNS_PIXEL_F32)}};
    stage_test_frame(test, NULL, outputs, 2, 1);
    assert_int_equal(mns_cpu_scene(test->cpu, &test->frame), MNS_OK);
    int floor_pixels = 0;
    for (int i = 0; i < 64 * 48; i++) {
        double at[3];
        for (int c = 0; c < 3; c++) {
            assert_true(color[3 * i + c] >= 0 && isfinite(color[3 * i + c]));
        }
        if (isfinite(depth[i])) {
            position_of(test, i % 64, i / 64, depth[i], at);
            assert_true(fabs(at[1] - (double)test->params.floor_height) < 2e-5 * (double)depth[i]);
            floor_pixels++;
        }
    }
    assert_int_equal(floor_pixels > 0, expect_floor);
}

static void test_floor_lies_at_its_height(void **state)
{
    (void)state;
    struct stage_test test;
    const float far_away[3] = {100, -50, 1000}; /* the set's origin must not show */
    stage_test_begin(&test, MNS_ISA_AUTO, 2, far_away, 1);
    test.params.floor_height = -51;
    const double eye[3] = {103, -48, 1004}, target[3] = {100, -51, 1000}, below[3] = {100, -55, 1000}, sky[3] = {100, 20, 900};
    check_floor(&test, eye, target, true);
    check_floor(&test, eye, sky, false);
    check_floor(&test, below, target, false); /* seen from below there is none */
    assert_int_equal(mns_camera_orthographic(&test.camera, 6, -100, 100), MNS_OK);
    check_floor(&test, eye, target, true);
    check_floor(&test, below, target, false);
    stage_test_end(&test);
}

/* Towards the horizon the checker fades before pixels are wider than two cells: there rows are flat. */
static void test_far_checker_has_no_moire(void **state)
{
    (void)state;
    struct stage_test test;
    stage_test_begin(&test, MNS_ISA_AUTO, 2, one, 1);
    static float color[64 * 48 * 3];
    const double eye[3] = {0.3, 1, 2}, target[3] = {0, 1, -10}, up[3] = {0, 1, 0};
    mns_camera_look_at(&test.camera, eye, target, up);
    test.params.floor_height = 0;
    test.params.floor_cell = 0.2f;
    test.params.shadow = 0;
    const struct mns_output output = {MNS_LAYER_SCENE_COLOR, image_of(&test, color, 3, MNS_PIXEL_F32)};
    stage_test_frame(&test, NULL, &output, 1, 1);
    assert_int_equal(mns_cpu_scene(test.cpu, &test.frame), MNS_OK);
    for (int y = 25; y < 34; y++) {
        for (int x = 1; x < 64; x++) { /* the glow alone changes along the row */
            assert_true(fabsf(color[3 * (64 * y + x)] - color[3 * (64 * y + x - 1)]) < 0.004f);
        }
    }
    float largest = 0;
    for (int x = 1; x < 64; x++) {
        largest = fmaxf(largest, fabsf(color[3 * (64 * 47 + x)] - color[3 * (64 * 47 + x - 1)]));
    }
    assert_true(largest > 0.02f); /* and near the eye it is there */
    stage_test_end(&test);
}

enum { SIDE = 20, CUBE = SIDE * SIDE * SIDE };

/* A cube of particles 0.05 apart, 0.5 above the floor. */
static float *cube(void)
{
    float *p = malloc(sizeof(float) * 3 * CUBE);
    for (int i = 0; i < CUBE; i++) {
        p[3 * i] = 0.05f * (float)(i % SIDE);
        p[3 * i + 1] = 0.5f + 0.05f * (float)(i / SIDE % SIDE);
        p[3 * i + 2] = 0.05f * (float)(i / SIDE / SIDE);
    }
    return p;
}

static void draw_shadow(struct stage_test *test, int threads, const float *positions)
{
    stage_test_begin(test, MNS_ISA_AUTO, threads, positions, CUBE);
    test->params.floor_height = 0;
    test->params.sun_elevation = 40;
    stage_test_frame(test, NULL, NULL, 0, 1);
    const float sun[3] = {1, 1, 1}, sky[3] = {0.2f, 0.2f, 0.2f};
    assert_int_equal(mns_shadow_update(test->cpu, &test->frame, sun, sky), MNS_OK);
}

static void test_shadow_holds_the_volume_whatever_the_threads(void **state)
{
    (void)state;
    float *positions = cube();
    static const int threads[] = {1, 2, 7};
    float *first = NULL;
    size_t size = 0;
    for (int i = 0; i < 3; i++) {
        struct stage_test test;
        draw_shadow(&test, threads[i], positions);
        const struct shadow *shadow = test.cpu->scene.shadow;
        double sum = 0, darkest = 10, brightest = 0;
        for (int texel = 0; texel < shadow->width * shadow->height; texel++) {
            sum += (double)shadow->sums[0][texel];
            darkest = fmin(darkest, (double)shadow->light[4 * texel]);
            brightest = fmax(brightest, (double)shadow->light[4 * texel]);
        }
        /* Thickness towards the sun over the area across it. */
        double volume = sum * (double)shadow->texel * (double)shadow->texel * sin(40 * 3.14159265 / 180);
        assert_true(fabs(volume / ((double)test.frame.volume * CUBE) - 1) < 1e-3);
        assert_true(fabs(brightest - 1.2) < 1e-3 && darkest < 0.5 && darkest > 0);
        for (int x = 0; x < shadow->width; x++) { /* no seam to the open floor */
            assert_true(fabsf(shadow->light[4 * x] - 1.2f) < 0.01f);
        }
        if (first) {
            assert_memory_equal(shadow->light, first, size);
        } else {
            size = sizeof(float) * 4 * (size_t)shadow->width * (size_t)shadow->height;
            first = malloc(size);
            memcpy(first, shadow->light, size);
        }
        stage_test_end(&test);
    }
    free(first);
    free(positions);
}

static void test_shadow_is_kept_and_made_anew(void **state)
{
    (void)state;
    float *positions = cube();
    struct stage_test test;
    draw_shadow(&test, 2, positions);
    const float sun[3] = {1, 1, 1}, sky[3] = {0.2f, 0.2f, 0.2f};
    test.cpu->scene.shadow->light[0] = -1; /* a mark */
    assert_int_equal(mns_shadow_update(test.cpu, &test.frame, sun, sky), MNS_OK);
    assert_true(test.cpu->scene.shadow->light[0] == -1);
    test.params.sun_elevation = 41;
    stage_test_frame(&test, NULL, NULL, 0, 1);
    assert_int_equal(mns_shadow_update(test.cpu, &test.frame, sun, sky), MNS_OK);
    assert_true(test.cpu->scene.shadow->light[0] != -1);
    stage_test_end(&test);
    free(positions);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_pictures_of_the_caller_come_back),
        cmocka_unit_test(test_depths_of_the_caller_are_made_safe),
        cmocka_unit_test(test_floor_lies_at_its_height),
        cmocka_unit_test(test_far_checker_has_no_moire),
        cmocka_unit_test(test_shadow_holds_the_volume_whatever_the_threads),
        cmocka_unit_test(test_shadow_is_kept_and_made_anew),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
