/* Layered foam ([BSW10] 5.2 and 5.3) against values worked by hand: depths, thicknesses, what is in front of what, and colours. */
#include "picture_test.h"

#include "cpu/kernels.h"

enum { SIZE = 64, PIXELS = SIZE * SIZE };

static const enum mns_layer LAYERS[] = {MNS_LAYER_FOAM_DEPTH,      MNS_LAYER_FOAM_THICKNESS, MNS_LAYER_FOAM_FRONT_THICKNESS,
                                        MNS_LAYER_THICKNESS_FRONT, MNS_LAYER_THICKNESS_BACK, MNS_LAYER_THICKNESS,
                                        MNS_LAYER_BEAUTY};
enum { FOAM_DEPTH, FOAM, FOAM_FRONT, FRONT, BACK, THICKNESS, BEAUTY, LAYER_COUNT };

/* Balls, of which foam is some part. */
struct scene {
    struct shot shot;
    struct cloud cloud;
    float foam[20000], water[20000], age[20000];
    struct mns_particles particles;
    float *layers[LAYER_COUNT];
};

static struct scene scene;

/* Looks down -z at a square of 2 m, from z = 10; lengths in the tests below are depths from there. */
static void begin(void)
{
    memset(&scene, 0, sizeof(scene));
    scene.shot = shot_of(SIZE, SIZE);
    const double eye[3] = {0, 0, 10}, target[3] = {0, 0, 0}, up[3] = {0, 1, 0};
    assert_int_equal(mns_camera_look_at(&scene.shot.camera, eye, target, up), MNS_OK);
    assert_int_equal(mns_camera_orthographic(&scene.shot.camera, 2, 0.1, 100), MNS_OK);
    scene.shot.params.foam = MNS_FOAM_LAYERED;
    scene.shot.params.foam_detail = 0;
    scene.shot.params.foam_radius = 1;
    scene.shot.params.floor = 0;
    scene.shot.params.radius = 0.25f;
    scene.shot.params.radius_scale = 1;
    scene.shot.params.particle_volume = 4.18879f * 0.25f * 0.25f * 0.25f; /* that of the ball: thicknesses are chords */
    scene.shot.params.thickness_scale = 1;
    scene.shot.params.thickness_blur = 0;
    scene.shot.params.filter = MNS_FILTER_NONE;
}

static void ball(double x, double y, double depth, float water, float foam)
{
    scene.water[scene.cloud.count] = water;
    scene.foam[scene.cloud.count] = foam;
    cloud_add(&scene.cloud, x, y, 10 - depth);
}

static void draw(void)
{
    scene.particles = cloud_particles(&scene.cloud);
    scene.particles.foam = (struct mns_attr){.data = scene.foam, .type = MNS_F32};
    scene.particles.water = (struct mns_attr){.data = scene.water, .type = MNS_F32};
    scene.particles.foam_age = (struct mns_attr){.data = scene.age, .type = MNS_F32};
    for (int i = 0; i < LAYER_COUNT; i++) {
        free(scene.layers[i]);
    }
    draw_layers(&scene.shot, &scene.particles, LAYERS, scene.layers, LAYER_COUNT);
}

static void end(void)
{
    for (int i = 0; i < LAYER_COUNT; i++) {
        free(scene.layers[i]);
    }
    cloud_free(&scene.cloud);
}

/* Beside the middle: its pixel's centre is half a pixel from the axis each way. */
enum { MIDDLE = SIZE / 2 * SIZE + SIZE / 2 };

static void near(int layer, int pixel, double expected)
{
    double got = (double)scene.layers[layer][pixel];
    if (!(fabs(got - expected) <= 1e-3 * fabs(expected) + 1e-4)) {
        fail_msg("%s is %g; %g is right", mns_layer_name(LAYERS[layer]), got, expected);
    }
}

/* Half the chord of a ball of radius r at the middle pixel. */
static double half_chord(double r) { return sqrt(r * r - 2 * (1.0 / SIZE) * (1.0 / SIZE)); }

static void test_depth_and_thicknesses_of_balls_in_a_row(void **state)
{
    (void)state;
    begin();
    scene.shot.params.foam_range = 4; /* 1 m */
    ball(0, 0, 4, 1, 0);              /* water before */
    ball(0, 0, 5, 0, 1);              /* foam */
    ball(0, 0, 5.85, 0, 0.5f);        /* half-grown foam: an eighth of the volume in a ball of half the radius */
    ball(0, 0, 7, 0, 1);              /* foam beyond the range */
    ball(0, 0, 8, 1, 0);              /* water behind */
    draw();
    double full = half_chord(0.25), half = half_chord(0.125), depth = 5 - full;
    near(FOAM_DEPTH, MIDDLE, depth);
    near(FOAM, MIDDLE, 4 * full + 2 * half);                          /* [BSW10] eq. 6 */
    near(FOAM_FRONT, MIDDLE, 2 * full + (depth + 1 - (5.85 - half))); /* the second is cut by the range */
    near(FRONT, MIDDLE, 2 * full);
    near(BACK, MIDDLE, 2 * full);
    assert_true(isinf(scene.layers[FOAM_DEPTH][0]) && scene.layers[FOAM][0] == 0);
    end();
}

/* Water through whose middle the foam's first sphere goes is cut there. */
static void test_water_is_cut_at_the_depth_of_the_foam(void **state)
{
    (void)state;
    begin();
    ball(0, 0, 5, 1, 0);
    ball(0, 0, 5.35, 0, 1);
    draw();
    double full = half_chord(0.25), depth = 5.35 - full;
    near(FOAM_DEPTH, MIDDLE, depth);
    near(FRONT, MIDDLE, depth - (5 - full));
    near(BACK, MIDDLE, 5 + full - depth);
    end();
}

/* The same depths, thicknesses and sums at any size of texel, with blur: everywhere, each pixel's water is what is before and what is behind. */
static void test_layers_add_up(void **state)
{
    (void)state;
    for (int scale = 1; scale <= 4; scale *= 2) {
        begin();
        uint64_t seed = 3;
        scene.shot.params.radius = 0.04f;
        scene.shot.params.particle_volume = 0;
        scene.shot.params.thickness_scale = scale;
        scene.shot.params.thickness_blur = 1.5f;
        for (int i = 0; i < 6000; i++) {
            float foam = i % 7 == 0 ? (float)(0.5 + 0.5 * noise(&seed)) : 0;
            double x = noise(&seed), y = noise(&seed), z = noise(&seed);
            ball(x, y, 5 + 0.3 * z, 1 - foam, foam);
        }
        draw();
        double most = 0, sum = 0;
        for (int i = 0; i < PIXELS; i++) {
            double front = (double)scene.layers[FRONT][i], back = (double)scene.layers[BACK][i], all = (double)scene.layers[THICKNESS][i];
            assert_true(front >= 0 && back >= 0 && fabs(front + back - all) <= 1e-6 * all);
            most = fmax(most, front);
            sum += back;
        }
        assert_true(most > 0 && sum > 0);
        end();
    }
}

/* A pool with a sheet of foam at a third of its depth: a third of the water is before it, at every size of texel. */
static void test_a_sheet_of_foam_in_a_pool(void **state)
{
    (void)state;
    for (int scale = 1; scale <= 4; scale *= 2) {
        begin();
        enum { SIDE = 24, LAYERS_DEEP = 24 };
        const double spacing = 0.1;
        scene.shot.params.radius = 0.05f;
        scene.shot.params.radius_scale = 1.2f;
        scene.shot.params.particle_volume = 0.001f;
        scene.shot.params.thickness_scale = scale;
        scene.shot.params.thickness_blur = 1.5f;
        for (int i = 0; i < SIDE * SIDE * LAYERS_DEEP; i++) {
            int layer = i / (SIDE * SIDE);
            bool is_foam = layer == 8;
            ball((i % SIDE - 11.5) * spacing, (i / SIDE % SIDE - 11.5) * spacing, 4 + spacing * layer, is_foam ? 0 : 1, is_foam ? 1 : 0);
        }
        draw();
        double front = 0, all = 0, foam = 0, pixels = 0;
        for (int y = 16; y < 48; y++) {
            for (int x = 16; x < 48; x++) {
                int i = y * SIZE + x;
                bool here = isfinite(scene.layers[FOAM_DEPTH][i]); /* there are gaps between the spheres */
                front += here ? (double)scene.layers[FRONT][i] : 0;
                pixels += here;
                all += (double)scene.layers[THICKNESS][i] / 1024;
                foam += (double)scene.layers[FOAM][i] / 1024;
            }
        }
        assert_true(fabs(all - 2.3) < 0.03 && fabs(foam - 0.1) < 0.003);
        /* The sheet's spheres begin about where those of the layer before it end. */
        assert_true(front / pixels > 0.78 && front / pixels < 0.81);
        end();
    }
}

static void test_detail_keeps_the_volume_and_moves_with_the_particle(void **state)
{
    (void)state;
    begin();
    scene.shot.params.foam_detail = 0.5f;
    scene.shot.params.radius = 0.5f;
    ball(-0.25, -0.25, 5, 0, 1);
    draw();
    float *before = scene.layers[FOAM];
    scene.layers[FOAM] = NULL;
    double sum = 0, rough = 0;
    for (int i = 0; i < PIXELS; i++) {
        sum += (double)before[i] * 4 / PIXELS;
    }
    scene.cloud.position[0][0] += 8 * 2.0f / (float)SIZE; /* to the right by 8 pixels, up by 4 */
    scene.cloud.position[0][1] += 4 * 2.0f / (float)SIZE;
    draw();
    for (int y = 4; y < SIZE; y++) {
        for (int x = 0; x < SIZE - 8; x++) {
            assert_true(fabsf(before[y * SIZE + x] - scene.layers[FOAM][(y - 4) * SIZE + x + 8]) < 1e-3f);
        }
    }
    double volume = 4.18879 * 0.25 * 0.25 * 0.25;
    assert_true(fabs(sum / volume - 1) < 0.2);
    scene.age[0] = 0.01f; /* a little later the pattern has changed a little, much later altogether */
    draw();
    double later[2] = {0, 0};
    for (int i = 0; i < PIXELS; i++) {
        float *row = scene.layers[FOAM];
        later[0] += i + 8 - 4 * SIZE >= 0 && i + 8 - 4 * SIZE < PIXELS ? fabs((double)row[i + 8 - 4 * SIZE] - (double)before[i]) : 0;
    }
    scene.age[0] = 0.5f;
    draw();
    for (int i = 0; i < PIXELS; i++) {
        float *row = scene.layers[FOAM];
        later[1] += i + 8 - 4 * SIZE >= 0 && i + 8 - 4 * SIZE < PIXELS ? fabs((double)row[i + 8 - 4 * SIZE] - (double)before[i]) : 0;
    }
    assert_true(later[0] > 0 && later[1] > 2 * later[0]);
    scene.shot.params.foam_detail = 0;
    draw();
    for (int i = 0; i < PIXELS; i++) {
        float *row = scene.layers[FOAM];
        rough +=
            i + 8 - 4 * SIZE >= 0 && i + 8 - 4 * SIZE < PIXELS ? fabs((double)row[i + 8 - 4 * SIZE] - (double)before[i]) * 4 / PIXELS : 0;
    }
    assert_true(rough > 0.1 * volume);
    free(before);
    end();
}

/* Foam is hidden by what the caller's scene puts before it, and cut where it stands half in it. */
static void test_a_scene_hides_foam(void **state)
{
    (void)state;
    begin();
    ball(-0.5, 0, 5, 0, 1);
    ball(0.5, 0, 5, 0, 1);
    static float color[PIXELS][3], depth[PIXELS];
    for (int i = 0; i < PIXELS; i++) {
        depth[i] = i % SIZE < SIZE / 2 ? 4 : 5;
    }
    struct mns_renderer_params params;
    mns_renderer_params_init(&params);
    mns_renderer *renderer;
    assert_int_equal(mns_renderer_create(&renderer, &params, NULL), MNS_OK);
    scene.particles = cloud_particles(&scene.cloud);
    scene.particles.foam = (struct mns_attr){.data = scene.foam, .type = MNS_F32};
    scene.particles.water = (struct mns_attr){.data = scene.water, .type = MNS_F32};
    assert_int_equal(mns_renderer_prepare(renderer, &scene.particles), MNS_OK);
    static float foam[PIXELS], picture[PIXELS][4];
    const struct mns_output outputs[2] = {
        {MNS_LAYER_FOAM_THICKNESS, {.data = foam, .width = SIZE, .height = SIZE, .channels = 1, .pixel = MNS_PIXEL_F32}},
        {MNS_LAYER_BEAUTY, {.data = picture, .width = SIZE, .height = SIZE, .channels = 4, .pixel = MNS_PIXEL_F32}}};
    const struct mns_scene behind = {.color = {.data = color, .width = SIZE, .height = SIZE, .channels = 3, .pixel = MNS_PIXEL_F32},
                                     .depth = {.data = depth, .width = SIZE, .height = SIZE, .channels = 1, .pixel = MNS_PIXEL_F32}};
    struct mns_frame frame;
    mns_frame_init(&frame);
    frame.camera = &scene.shot.camera;
    frame.params = &scene.shot.params;
    frame.scene = &behind;
    frame.outputs = outputs;
    frame.output_count = 2;
    assert_int_equal(mns_renderer_draw(renderer, &frame), MNS_OK);
    int left = SIZE / 2 * SIZE + SIZE / 4, right = left + SIZE / 2;
    assert_true(foam[left] == 0 && picture[left][0] == 0);
    assert_true(fabs((double)foam[right] - half_chord(0.25)) < 1e-3); /* the half before the wall */
    assert_true(picture[right][0] > 0.1f);
    mns_renderer_destroy(&renderer);
    end();
}

/* Alone before nothing: its own colour, and alpha by Beer and Lambert. */
static void test_foam_over_nothing(void **state)
{
    (void)state;
    begin();
    scene.shot.params.background = MNS_BACKGROUND_TRANSPARENT;
    ball(0, 0, 5, 0, 1);
    draw();
    double thickness = 2 * half_chord(0.25), alpha = 1 - exp(-(double)scene.shot.params.foam_extinction / 0.25 * thickness);
    assert_true(fabs((double)scene.layers[BEAUTY][4 * MIDDLE + 3] - alpha) < 1e-3);
    assert_true(scene.layers[BEAUTY][3] == 0);
    end();
}

static void test_no_foam_is_no_change(void **state)
{
    (void)state;
    begin();
    for (int i = 0; i < 50; i++) {
        ball(0.03 * i - 0.7, 0.02 * i - 0.5, 5, 1, 0);
    }
    draw();
    float *layered = scene.layers[BEAUTY];
    scene.layers[BEAUTY] = NULL;
    scene.shot.params.foam = MNS_FOAM_NONE;
    draw();
    assert_memory_equal(layered, scene.layers[BEAUTY], 4 * PIXELS * sizeof(float));
    free(layered);
    end();
}

static void test_threads_change_no_byte_and_the_eye_may_be_inside(void **state)
{
    (void)state;
    begin();
    uint64_t seed = 9;
    const double eye[3] = {0, 0, 0.3}, target[3] = {0, 0, -1}, up[3] = {0, 1, 0};
    assert_int_equal(mns_camera_look_at(&scene.shot.camera, eye, target, up), MNS_OK);
    assert_int_equal(mns_camera_perspective(&scene.shot.camera, 60, 0.05, 100), MNS_OK);
    scene.shot.params.foam_detail = 1;
    for (int i = 0; i < 400; i++) {
        double x = noise(&seed), y = noise(&seed), z = noise(&seed);
        scene.age[i] = (float)(0.5 + 0.5 * x);
        ball(x, y, 10 + z, (float)(i % 2), (float)(1 - i % 2));
    }
    float *first[LAYER_COUNT];
    scene.shot.threads = 1;
    draw();
    memcpy(first, scene.layers, sizeof(first));
    memset(scene.layers, 0, sizeof(scene.layers));
    scene.shot.threads = 3;
    draw();
    for (int i = 0; i < LAYER_COUNT; i++) {
        size_t floats = PIXELS * (size_t)mns_layer_channels(LAYERS[i]);
        assert_memory_equal(first[i], scene.layers[i], floats * sizeof(float));
        for (size_t k = 0; k < floats; k++) {
            assert_true(!isnan(first[i][k]));
        }
        free(first[i]);
    }
    end();
}

/* [BSW10] eq. 7 to 10 of one pixel with a surface that faces the eye, worked in double precision. */
static void test_compositing_by_hand(void **state)
{
    (void)state;
    static float behind[4 * 4] = {0.4f, 0.5f, 0.6f, 1, 0.4f, 0.5f, 0.6f, 1, 0.4f, 0.5f, 0.6f, 1, 0.4f, 0.5f, 0.6f, 1};
    struct shade_optics o = {.orthographic = true,
                             .fx = 1,
                             .fy = 1,
                             .step_x = 1,
                             .step_y = 1,
                             .index = 1.333f,
                             .absorption = {2, 0.7f, 0.3f},
                             .scatter = {0.01f, 0.05f, 0.1f},
                             .reflection = 1,
                             .shininess = 10,
                             .foam_front = {0.9f, 0.95f, 1},
                             .foam_back = {0.2f, 0.3f, 0.4f},
                             .foam_extinction = 3,
                             .foam_range_extinction = 5,
                             .foam_blend = 0.1f,
                             .scene = behind,
                             .scene_stride = 2,
                             .width = 1,
                             .height = 1};
    const struct shade_kernels *kernels = mns_kernels_get(MNS_ISA_SCALAR)->shade;
    const double depths[3] = {6, 4, 5}; /* behind the water's surface, before it, in it */
    for (int k = 0; k < 3; k++) {
        static struct shade_row row;
        memset(&row, 0, sizeof(row));
        row.count = 1;
        row.nz[0] = -1;
        row.depth[0] = 5;
        row.thickness[0] = 0.8f;
        row.before[0] = k == 1 ? 0 : 0.3f;
        row.foam[0] = 0.25f;
        row.foam_range[0] = 0.1f;
        row.foam_depth[0] = (float)depths[k];
        kernels->optics(&o, false, &row);
        kernels->fetch(&o, &row);
        kernels->veil(&o, &row);
        kernels->layered(&o, false, &row);
        double share = k == 0 ? 1 : k == 1 ? 0 : 0.5, F = pow((1.333 - 1) / (1.333 + 1), 2), front = (double)row.before[0];
        for (int c = 0; c < 3; c++) {
            double a = (double)o.absorption[c], s = (double)o.scatter[c], b = (double)behind[c], veil = exp(-3 * 0.25);
            /* The front tenth hides 1 - e^-0.3 of what is behind it, the rest what is left; each has its own share of the back colour. */
            double hides = 1 - exp(-3 * 0.1), thin = (hides * exp(-5 * 0.1) + (1 - veil - hides) * exp(-5 * 0.15)) / (1 - veil);
            double foam = (double)o.foam_front[c] + ((double)o.foam_back[c] - (double)o.foam_front[c]) * thin;
            double c_wb = s + (b - s) * exp(-a * (0.8 - front)), c_f = foam + (c_wb - foam) * veil, c_wf = s + (c_f - s) * exp(-a * front);
            double wet = c_wf * (1 - F), dry = foam + ((s + (b - s) * exp(-a * 0.8)) * (1 - F) - foam) * veil; /* the sky here is black */
            assert_true(fabs((double)row.out[c][0] - (dry + share * (wet - dry))) < 1e-5);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_depth_and_thicknesses_of_balls_in_a_row),
        cmocka_unit_test(test_water_is_cut_at_the_depth_of_the_foam),
        cmocka_unit_test(test_layers_add_up),
        cmocka_unit_test(test_a_sheet_of_foam_in_a_pool),
        cmocka_unit_test(test_detail_keeps_the_volume_and_moves_with_the_particle),
        cmocka_unit_test(test_a_scene_hides_foam),
        cmocka_unit_test(test_foam_over_nothing),
        cmocka_unit_test(test_no_foam_is_no_change),
        cmocka_unit_test(test_threads_change_no_byte_and_the_eye_may_be_inside),
        cmocka_unit_test(test_compositing_by_hand),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
