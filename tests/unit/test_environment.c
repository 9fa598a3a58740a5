/* Environments: what is seen in which direction, the light they shed, and the fluid's mirror. */
#include "unit/picture_test.h"

enum { WIDTH = 64, HEIGHT = 48, PIXELS = WIDTH * HEIGHT };

/* Front red, right green, back blue, left grey; the upper half 1, the lower half as bright. */
static mns_environment *quarters(void)
{
    enum { COLUMNS = 64, ROWS = 32 };
    static float pixels[ROWS][COLUMNS][3];
    for (int y = 0; y < ROWS; y++) {
        for (int x = 0; x < COLUMNS; x++) {
            static const float colors[4][3] = {{0, 0, 1}, {0.5f, 0.5f, 0.5f}, {1, 0, 0}, {0, 1, 0}};
            memcpy(pixels[y][x], colors[(x + COLUMNS / 8) / (COLUMNS / 4) % 4], sizeof(pixels[y][x]));
        }
    }
    const struct mns_image image = {.data = pixels, .width = COLUMNS, .height = ROWS, .channels = 3, .pixel = MNS_PIXEL_F32};
    mns_environment *environment;
    assert_int_equal(mns_environment_create(&environment, &image, NULL), MNS_OK);
    return environment;
}

static mns_environment *uniform(float radiance)
{
    float pixels[2 * 4 * 3];
    for (int i = 0; i < 24; i++) {
        pixels[i] = radiance;
    }
    const struct mns_image image = {.data = pixels, .width = 4, .height = 2, .channels = 3, .pixel = MNS_PIXEL_F32};
    mns_environment *environment;
    assert_int_equal(mns_environment_create(&environment, &image, NULL), MNS_OK);
    return environment;
}

static void aim(struct shot *shot, double x, double y, double z, int up_axis)
{
    const double eye[3] = {0, 0, 0}, target[3] = {x, y, z};
    double up[3] = {0};
    up[up_axis] = 1;
    shot->params.up_axis = up_axis;
    assert_int_equal(mns_camera_look_at(&shot->camera, eye, target, up), MNS_OK);
}

/* A renderer with a ball of water 3 before the eye along -z. */
static mns_renderer *renderer_of(enum mns_isa isa)
{
    struct mns_renderer_params params;
    mns_renderer *renderer;
    struct cloud cloud = {0};
    mns_renderer_params_init(&params);
    params.isa = isa;
    params.threads = 2;
    assert_int_equal(mns_renderer_create(&renderer, &params, NULL), MNS_OK);
    const double low[3] = {-0.5, -0.5, -3.5};
    const int n[3] = {20, 20, 20};
    cloud_box(&cloud, low, n, 0.05, 0.2, 3);
    const struct mns_particles particles = cloud_particles(&cloud);
    assert_int_equal(mns_renderer_prepare(renderer, &particles), MNS_OK);
    cloud_free(&cloud);
    return renderer;
}

static void draw(mns_renderer *renderer, const struct shot *shot, const mns_environment *environment, const struct mns_scene *scene,
                 enum mns_layer layer, float *pixels)
{
    const struct mns_output output = {
        layer, {.data = pixels, .width = WIDTH, .height = HEIGHT, .channels = mns_layer_channels(layer), .pixel = MNS_PIXEL_F32}};
    struct mns_frame frame;
    mns_frame_init(&frame);
    frame.camera = &shot->camera;
    frame.params = &shot->params;
    frame.outputs = &output;
    frame.output_count = 1;
    frame.environment = environment;
    frame.scene = scene;
    if (mns_renderer_draw(renderer, &frame) != MNS_OK) {
        fail_msg("%s", mns_renderer_message(renderer));
    }
}

static void expect_middle(mns_renderer *renderer, const struct shot *shot, const mns_environment *environment, float r, float g, float b)
{
    static float color[3 * PIXELS];
    draw(renderer, shot, environment, NULL, MNS_LAYER_SCENE_COLOR, color);
    const float *middle = color + 3 * (HEIGHT / 2 * WIDTH + WIDTH / 2);
    assert_true(fabsf(middle[0] - r) < 1e-3f && fabsf(middle[1] - g) < 1e-3f && fabsf(middle[2] - b) < 1e-3f);
}

static void test_directions(void **state)
{
    (void)state;
    mns_renderer *renderer = renderer_of(MNS_ISA_AUTO);
    mns_environment *environment = quarters();
    struct shot shot = shot_of(WIDTH, HEIGHT);
    shot.params.floor = 0;
    aim(&shot, 0, 0.2, -1, MNS_AXIS_Y);
    expect_middle(renderer, &shot, environment, 1, 0, 0);
    aim(&shot, 1, 0.2, 0, MNS_AXIS_Y);
    expect_middle(renderer, &shot, environment, 0, 1, 0);
    aim(&shot, 0, -0.2, 1, MNS_AXIS_Y);
    expect_middle(renderer, &shot, environment, 0, 0, 1);
    aim(&shot, 0, 1, 0.2, MNS_AXIS_Z); /* the front of a scene with z up is -y */
    expect_middle(renderer, &shot, environment, 1, 0, 0);
    aim(&shot, 1, 0, 0.2, MNS_AXIS_Z);
    expect_middle(renderer, &shot, environment, 0, 1, 0);
    shot.params.environment_rotation = 90;
    shot.params.environment_intensity = 2;
    aim(&shot, 0, 0.2, -1, MNS_AXIS_Y);
    expect_middle(renderer, &shot, environment, 0, 2, 0);
    assert_int_equal(mns_camera_orthographic(&shot.camera, 2, 0.01, 100), MNS_OK);
    expect_middle(renderer, &shot, environment, 0, 2, 0);
    mns_environment_destroy(&environment);
    mns_renderer_destroy(&renderer);
}

static void test_floor_fades_into_it(void **state)
{
    (void)state;
    static float color[3 * PIXELS];
    mns_renderer *renderer = renderer_of(MNS_ISA_AUTO);
    mns_environment *environment = uniform(0.5f);
    struct shot shot = shot_of(WIDTH, HEIGHT);
    shot.params.floor_height = -1;
    aim(&shot, 1, 0, 0, MNS_AXIS_Y);
    draw(renderer, &shot, environment, NULL, MNS_LAYER_SCENE_COLOR, color);
    for (int x = 0; x < WIDTH; x++) {
        assert_true(fabsf(color[3 * x] - 0.5f) < 1e-5f);                          /* the sky */
        assert_true(fabsf(color[3 * (HEIGHT / 2 * WIDTH + x)] - 0.5f) < 0.15f);   /* right under the horizon: nearly that */
        assert_true(fabsf(color[3 * ((HEIGHT - 1) * WIDTH + x)] - 0.5f) > 0.05f); /* the floor */
    }
    mns_environment_destroy(&environment);
    mns_renderer_destroy(&renderer);
}

static void test_light_of_a_uniform_one(void **state)
{
    (void)state;
    mns_renderer *renderer = renderer_of(MNS_ISA_AUTO);
    mns_environment *environment = uniform(0.5f);
    struct shot shot = shot_of(WIDTH, HEIGHT);
    struct mns_frame frame;
    struct mns_light light;
    mns_frame_init(&frame);
    mns_light_init(&light);
    frame.camera = &shot.camera;
    frame.params = &shot.params;
    frame.environment = environment;
    shot.params.floor = 0;
    assert_int_equal(mns_renderer_light(renderer, &frame, &light), MNS_OK);
    for (int c = 0; c < 3; c++) {
        assert_true(fabsf(light.sky_light[c] - 0.5f) < 1e-5f && fabsf(light.ground_light[c] - 0.5f) < 1e-5f);
    }
    mns_environment_destroy(&environment);
    mns_renderer_destroy(&renderer);
}

/* Over a caller's own picture nothing but the mirror differs: twice the radiance, twice the difference, within what Fresnel allows. */
static void test_water_mirrors_it(void **state)
{
    (void)state;
    static float scene_pixels[3 * PIXELS], picture[2][3][4 * PIXELS];
    const struct mns_scene scene = {
        .color = {.data = scene_pixels, .width = WIDTH, .height = HEIGHT, .channels = 3, .pixel = MNS_PIXEL_F32}};
    static const enum mns_isa isas[2] = {MNS_ISA_SCALAR, MNS_ISA_AUTO};
    struct shot shot = shot_of(WIDTH, HEIGHT);
    shot.params.fluid_color[0] = shot.params.fluid_color[1] = shot.params.fluid_color[2] = 0;
    aim(&shot, 0, 0, -1, MNS_AXIS_Y);
    for (int k = 0; k < 2; k++) {
        mns_renderer *renderer = renderer_of(isas[k]);
        for (int i = 0; i < 3; i++) {
            mns_environment *environment = uniform((float)i);
            draw(renderer, &shot, environment, &scene, MNS_LAYER_BEAUTY, picture[k][i]);
            mns_environment_destroy(&environment);
        }
        mns_renderer_destroy(&renderer);
    }
    int mirrors = 0;
    for (int i = 0; i < PIXELS; i++) {
        float once = picture[0][1][4 * i] - picture[0][0][4 * i], twice = picture[0][2][4 * i] - picture[0][0][4 * i];
        assert_true(once >= 0 && once <= 1 && fabsf(twice - 2 * once) < 1e-4f);
        mirrors += once > 0.015f; /* water reflects 2 % straight on */
        if (fabsf(picture[1][1][4 * i] - picture[0][1][4 * i]) > 1e-2f) {
            mirrors -= 100; /* instruction sets agree but at rims */
        }
    }
    assert_true(mirrors > 100);
}

static void test_bad_pictures(void **state)
{
    (void)state;
    float pixels[2 * 2 * 3] = {NAN, INFINITY, -1, 1e30f, 0, 0, 0, 0, 0, 0, 0, 0};
    static float color[3 * PIXELS];
    struct mns_image image = {.data = pixels, .width = 2, .height = 2, .channels = 3, .pixel = MNS_PIXEL_F32};
    mns_environment *environment;
    struct mns_message message;
    assert_int_equal(mns_environment_create(&environment, &image, &message), MNS_OK);
    mns_renderer *renderer = renderer_of(MNS_ISA_AUTO);
    struct shot shot = shot_of(WIDTH, HEIGHT);
    draw(renderer, &shot, environment, NULL, MNS_LAYER_SCENE_COLOR, color);
    for (int i = 0; i < 3 * PIXELS; i++) {
        assert_true(isfinite(color[i]) && color[i] >= 0);
    }
    mns_environment_destroy(&environment);
    mns_renderer_destroy(&renderer);
    image.channels = 1;
    assert_int_equal(mns_environment_create(&environment, &image, &message), MNS_ERR_INVALID_ARGUMENT);
    assert_null(environment);
    image.channels = 3;
    image.width = 0;
    assert_int_equal(mns_environment_create(&environment, &image, &message), MNS_ERR_INVALID_ARGUMENT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_directions),       cmocka_unit_test(test_floor_fades_into_it), cmocka_unit_test(test_light_of_a_uniform_one),
        cmocka_unit_test(test_water_mirrors_it), cmocka_unit_test(test_bad_pictures),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
