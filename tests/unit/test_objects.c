/* The caller's objects in our own scene: covered by parts, before and behind the floor, in the fluid's shadow. */
#include "unit/picture_test.h"

#include "cpu/cpu.h"
#include "cpu/shadow.h"
#include "stage_test.h"

enum { WIDTH = 64, HEIGHT = 48, PIXELS = WIDTH * HEIGHT };

struct look {
    struct shot shot;
    mns_renderer *renderer;
    struct mns_object_pixel pixels[PIXELS];
    struct mns_objects objects;
    float color[3 * PIXELS], depth[PIXELS];
};

static const struct mns_object_pixel nothing = {.depth = INFINITY, .reach = INFINITY, .floor_sun = 1, .floor_sky = 1};

/* Looks down at a floor at y = 0 beside a block of water over x from -1 to 0. */
static void begin(struct look *look)
{
    look->shot = shot_of(WIDTH, HEIGHT);
    const double eye[3] = {1, 4, 5}, target[3] = {0.5, 0, 0}, up[3] = {0, 1, 0};
    assert_int_equal(mns_camera_look_at(&look->shot.camera, eye, target, up), MNS_OK);
    look->shot.params.floor_height = 0;
    for (int i = 0; i < PIXELS; i++) {
        look->pixels[i] = nothing;
    }
    look->objects = (struct mns_objects){.pixels = look->pixels, .width = WIDTH, .height = HEIGHT};
    assert_int_equal(mns_renderer_create(&look->renderer, NULL, NULL), MNS_OK);
    struct cloud cloud = {0};
    const double low[3] = {-1, 0, -0.5};
    const int n[3] = {20, 10, 20};
    cloud_box(&cloud, low, n, 0.05, 0.2, 3);
    const struct mns_particles particles = cloud_particles(&cloud);
    assert_int_equal(mns_renderer_prepare(look->renderer, &particles), MNS_OK);
    cloud_free(&cloud);
}

static struct mns_frame frame_of(struct look *look, struct mns_output outputs[2])
{
    const struct mns_image color = {.data = look->color, .width = WIDTH, .height = HEIGHT, .channels = 3, .pixel = MNS_PIXEL_F32};
    const struct mns_image depth = {.data = look->depth, .width = WIDTH, .height = HEIGHT, .channels = 1, .pixel = MNS_PIXEL_F32};
    outputs[0] = (struct mns_output){MNS_LAYER_SCENE_COLOR, color};
    outputs[1] = (struct mns_output){MNS_LAYER_SCENE_DEPTH, depth};
    struct mns_frame frame;
    mns_frame_init(&frame);
    frame.camera = &look->shot.camera;
    frame.params = &look->shot.params;
    frame.outputs = outputs;
    frame.output_count = 2;
    return frame;
}

static void draw(struct look *look, bool with_objects)
{
    struct mns_output outputs[2];
    struct mns_frame frame = frame_of(look, outputs);
    frame.objects = with_objects ? &look->objects : NULL;
    assert_int_equal(mns_renderer_draw(look->renderer, &frame), MNS_OK);
}

static void test_empty_objects_change_nothing(void **state)
{
    (void)state;
    static struct look look;
    static float before[3 * PIXELS];
    begin(&look);
    draw(&look, false);
    memcpy(before, look.color, sizeof(before));
    draw(&look, true);
    assert_memory_equal(before, look.color, sizeof(before));
    mns_renderer_destroy(&look.renderer);
}

static void test_objects_cover_their_part(void **state)
{
    (void)state;
    static struct look look;
    static float before[3 * PIXELS], floor_depth[PIXELS];
    begin(&look);
    draw(&look, false);
    memcpy(before, look.color, sizeof(before));
    memcpy(floor_depth, look.depth, sizeof(floor_depth));
    const int half = 3 * WIDTH + 50, near = 40 * WIDTH + 50, far = 41 * WIDTH + 50,
              strange = 42 * WIDTH + 50; /* to the right of all water */
    look.pixels[half] = (struct mns_object_pixel){{0.1f, 0.2f, 0.3f, 0.5f}, {0.2f, 0, 0}, INFINITY, INFINITY, 1, 1};
    look.pixels[near] = (struct mns_object_pixel){{1, 2, 3, 1}, {4, 5, 6}, 2, 2, 1, 1};
    look.pixels[far] = (struct mns_object_pixel){{1, 2, 3, 1}, {4, 5, 6}, 1000, 1000, 1, 1};
    look.pixels[strange] = (struct mns_object_pixel){{NAN, INFINITY, 1, 7}, {NAN, 0, -INFINITY}, NAN, NAN, NAN, NAN};
    draw(&look, true);
    static const float expected[3] = {0.3f, 0.2f, 0.3f}; /* a half covered, of both lights */
    for (int c = 0; c < 3; c++) {
        assert_true(fabsf(look.color[3 * half + c] - (expected[c] + 0.5f * before[3 * half + c])) < 1e-6f);
        assert_true(fabsf(look.color[3 * near + c] - (float)(5 + 2 * c)) < 1e-5f);
        assert_true(isfinite(look.color[3 * strange + c]));
    }
    assert_true(look.depth[half] == floor_depth[half] && look.depth[near] == 2 && look.depth[far] == floor_depth[far]);
    assert_true(look.depth[strange] == floor_depth[strange]);
    int spans[2 * HEIGHT] = {0};
    look.objects.spans = spans;
    spans[2 * 40] = 50;
    spans[2 * 40 + 1] = 51;
    draw(&look, true);
    assert_true(look.depth[near] == 2 && fabsf(look.color[3 * half] - before[3 * half]) < 1e-6f); /* rows without a span are not read */
    mns_renderer_destroy(&look.renderer);
}

static void test_objects_throw_shadows_on_the_floor(void **state)
{
    (void)state;
    static struct look look;
    static float before[3 * PIXELS];
    begin(&look);
    draw(&look, false);
    memcpy(before, look.color, sizeof(before));
    const int open = 30 * WIDTH + 60, dark = 31 * WIDTH + 60;
    look.pixels[open].floor_sun = 0;
    look.pixels[dark].floor_sun = look.pixels[dark].floor_sky = 0;
    draw(&look, true);
    struct mns_output outputs[2];
    const struct mns_frame frame = frame_of(&look, outputs);
    struct mns_light light;
    mns_light_init(&light);
    assert_int_equal(mns_renderer_light(look.renderer, &frame, &light), MNS_OK);
    assert_true(light.has_floor && fabs(light.floor_height) < 1e-6 && light.up[1] == 1);
    for (int c = 0; c < 3; c++) {
        float sun = light.sun_light[c] * (float)light.sun[1], left = (light.sky_light[c] + 0.15f * sun) / (sun + light.sky_light[c]);
        assert_true(fabsf(look.color[3 * open + c] / before[3 * open + c] - left) < 1e-3f);
        assert_true(look.color[3 * dark + c] < 1e-3f);
    }
    mns_renderer_destroy(&look.renderer);
}

static void test_what_cannot_be_is_refused(void **state)
{
    (void)state;
    static struct look look;
    begin(&look);
    struct mns_output outputs[2];
    struct mns_frame frame = frame_of(&look, outputs);
    frame.objects = &look.objects;
    const struct mns_scene scene = {.color = outputs[0].image};
    frame.scene = &scene;
    assert_int_equal(mns_renderer_draw(look.renderer, &frame), MNS_ERR_INVALID_ARGUMENT);
    assert_non_null(strstr(mns_renderer_message(look.renderer), "both a scene and objects"));
    frame.scene = NULL;
    look.shot.params.background = MNS_BACKGROUND_TRANSPARENT;
    assert_int_equal(mns_renderer_draw(look.renderer, &frame), MNS_ERR_UNSUPPORTED);
    look.shot.params.background = MNS_BACKGROUND_SKY;
    look.objects.width--;
    assert_int_equal(mns_renderer_draw(look.renderer, &frame), MNS_ERR_INVALID_ARGUMENT);
    look.objects.width++;
    int spans[2 * HEIGHT] = {0, WIDTH + 1};
    look.objects.spans = spans;
    assert_int_equal(mns_renderer_draw(look.renderer, &frame), MNS_ERR_INVALID_ARGUMENT);
    look.objects.spans = NULL;
    look.objects.pixels = NULL;
    assert_int_equal(mns_renderer_draw(look.renderer, &frame), MNS_ERR_INVALID_ARGUMENT);
    mns_renderer_destroy(&look.renderer);
}

/* A slab of water from 1 to 2 over the floor, under a sun straight overhead: half way down in it half its shadow has fallen, and none above. */
static void test_shadow_falls_below_the_fluid_only(void **state)
{
    (void)state;
    enum { SIDE = 40, UP = 20, COUNT = SIDE * SIDE * UP };
    float *positions = malloc(sizeof(float) * 3 * COUNT);
    for (int i = 0; i < COUNT; i++) {
        positions[3 * i] = 0.05f * (float)(i % SIDE);
        positions[3 * i + 1] = 1.025f + 0.05f * (float)(i / SIDE % UP);
        positions[3 * i + 2] = 0.05f * (float)(i / SIDE / UP);
    }
    struct stage_test test;
    stage_test_begin(&test, MNS_ISA_AUTO, 2, positions, COUNT);
    test.params.floor_height = 0;
    test.params.sun_elevation = 90;
    test.params.particle_volume = 0.05f * 0.05f * 0.05f;
    for (int c = 0; c < 3; c++) {
        test.params.absorption[c] = 1;
    }
    const struct mns_object_pixel pixel = {.depth = INFINITY};
    const struct mns_objects objects = {.pixels = &pixel, .width = 64, .height = 48};
    stage_test_frame(&test, NULL, NULL, 0, 1);
    test.frame.objects = &objects;
    const float light[3] = {1, 1, 1};
    assert_int_equal(mns_shadow_update(test.cpu, &test.frame, light, light), MNS_OK);
    const struct shadow *shadow = test.cpu->scene.shadow;
    float u = 0.5f * (float)shadow->width, v = 0.5f * (float)shadow->height, above[3], half[3], below[3], beside[3];
    mns_shadow_at(shadow, u, v, 2.1f, above);
    mns_shadow_at(shadow, u, v, 1.5f, half);
    mns_shadow_at(shadow, u, v, 0.9f, below);
    mns_shadow_at(shadow, -1, v, 0, beside);
    assert_true(above[0] > 0.97f && beside[0] == 1);
    /* The absorption of a metre; the surfaces' loss is the same for both. */
    assert_true(fabsf(logf(half[0] / below[0]) - 0.5f) < 0.02f);
    assert_true(below[0] < expf(-1) && below[0] > 0.5f * expf(-1));
    stage_test_end(&test);
    free(positions);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_empty_objects_change_nothing),       cmocka_unit_test(test_objects_cover_their_part),
        cmocka_unit_test(test_objects_throw_shadows_on_the_floor), cmocka_unit_test(test_what_cannot_be_is_refused),
        cmocka_unit_test(test_shadow_falls_below_the_fluid_only),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
