/* Stage shade against closed forms: a sphere's normals and curvature, Fresnel's equations, Beer and Lambert, Snell, and what must never show. */
#include "stage_test.h"

static const float one[3] = {0, 0, 0};

enum { WIDTH = 120, HEIGHT = 90, PIXELS = WIDTH * HEIGHT };

static void begin(struct stage_test *test, enum mns_isa isa)
{
    stage_test_begin(test, isa, 2, one, 1);
    mns_camera_init(&test->camera, WIDTH, HEIGHT);
    test->params.radius = 0.01f;
    test->params.thickness_blur = 0;
    test->params.absorption[0] = 2;
    test->params.absorption[1] = 1;
    test->params.absorption[2] = 0.5f;
}

static void shade(struct stage_test *test)
{
    assert_int_equal(mns_cpu_scene(test->cpu, &test->frame), MNS_OK);
    assert_int_equal(mns_cpu_blur(test->cpu, &test->frame), MNS_OK);
    assert_int_equal(mns_cpu_shade(test->cpu, &test->frame), MNS_OK);
}

/* Ray of a pixel in image space; orthographic: its point on the image plane. */
static void ray_of(const struct view *view, int i, double out[3])
{
    out[0] = (i % WIDTH + 0.5 - (double)view->cx) / (double)view->fx;
    out[1] = (i / WIDTH + 0.5 - (double)view->cy) / (double)view->fy;
    out[2] = 1;
}

/* Fills depth with the near side of a sphere and tells the normal (image space) at each pixel. */
static void sphere(struct stage_test *test, const double center[3], double radius, double (*normals)[3])
{
    const struct view *view = &test->frame.view;
    for (int i = 0; i < PIXELS; i++) {
        double d[3], origin[3] = {0}, direction[3];
        ray_of(view, i, d);
        for (int k = 0; k < 3; k++) {
            origin[k] = view->orthographic && k < 2 ? d[k] : 0;
            direction[k] = view->orthographic ? k == 2 : d[k];
        }
        double a = 0, b = 0, c = -radius * radius;
        for (int k = 0; k < 3; k++) {
            double away = origin[k] - center[k];
            a += direction[k] * direction[k];
            b += direction[k] * away;
            c += away * away;
        }
        double root = b * b - a * c;
        normals[i][2] = 0;
        if (root > 0) {
            double t = (-b - sqrt(root)) / a;
            *depth_at(test, i % WIDTH, i / WIDTH) = (float)(t * direction[2]);
            for (int k = 0; k < 3; k++) {
                normals[i][k] = (origin[k] + t * direction[k] - center[k]) / radius;
            }
        }
    }
}

static void check_sphere(enum mns_isa isa, bool orthographic)
{
    struct stage_test test;
    begin(&test, isa);
    if (orthographic) {
        mns_camera_orthographic(&test.camera, 2.4, 0.1, 100);
    } else {
        mns_camera_frustum(&test.camera, -0.05, 0.09, -0.06, 0.045, 0.1, 100); /* off-centre */
    }
    static float normal[PIXELS * 3], curvature[PIXELS];
    static double expected[PIXELS][3];
    const struct mns_output outputs[2] = {{MNS_LAYER_NORMAL, image_of(&test, normal, 3, MNS_PIXEL_F32)},
                                          {MNS_LAYER_CURVATURE, image_of(&test, curvature, 1, MNS_PIXEL_F32)}};
    test.params.floor = 0;
    stage_test_frame(&test, NULL, outputs, 2, 1);
    const double center[3] = {0.35, 0.15, 3}, radius = 0.8;
    sphere(&test, center, radius, expected);
    shade(&test);
    int seen = 0;
    for (int i = 0; i < PIXELS; i++) {
        double d[3], length, facing = 0, dot = 0;
        ray_of(&test.frame.view, i, d);
        if (expected[i][2] == 0) {
            assert_true(normal[3 * i] == 0 && normal[3 * i + 2] == 0 && curvature[i] == 0);
            continue;
        }
        if (test.frame.view.orthographic) {
            d[0] = d[1] = 0;
        }
        length = sqrt(d[0] * d[0] + d[1] * d[1] + 1);
        const double got[3] = {(double)normal[3 * i], -(double)normal[3 * i + 1], -(double)normal[3 * i + 2]}; /* view to image space */
        for (int k = 0; k < 3; k++) {
            facing -= expected[i][k] * d[k] / length;
            dot += expected[i][k] * got[k];
        }
        assert_true(dot > 0.9); /* the rim's one-sided differences, too */
        if (facing > 0.5) {     /* four pixels inside the rim */
            seen++;
            assert_true(dot > 0.9999);
            /* Differences over two pixels of a sphere of 30: the error grows with the fourth power of the slope. */
            assert_true(fabs((double)curvature[i] * radius - 1) < 0.004 / pow(facing, 4));
        }
    }
    assert_true(seen > 1000);
    stage_test_end(&test);
}

static void test_sphere(void **state)
{
    (void)state;
    static const enum mns_isa isas[] = {MNS_ISA_SCALAR, MNS_ISA_AUTO};
    for (int i = 0; i < 4; i++) {
        check_sphere(isas[i / 2], i % 2);
    }
}

/* A row of the kernels with normals at given angles to the ray. */
static void optics_at(struct shade_optics *optics, const double *angles, int count, struct shade_row *row)
{
    memset(row, 0, sizeof(*row));
    row->count = count;
    optics->orthographic = true;
    optics->fx = optics->fy = optics->step_x = optics->step_y = 1;
    optics->width = optics->height = 1000;
    for (int i = 0; i < count; i++) {
        row->nx[i] = (float)sin(angles[i]);
        row->nz[i] = (float)-cos(angles[i]);
        row->depth[i] = 5;
        row->thickness[i] = 1;
    }
    mns_kernels_get(mns_isa_best())->shade->optics(optics, false, row);
}

static void test_fresnel(void **state)
{
    (void)state;
    static struct shade_row row;
    const double n = 1.333, brewster = atan(n);
    double angles[] = {0, 0.3, 0.7, brewster, 1.2, 1.5, 3.14159265358979 / 2};
    struct shade_optics optics = {.index = (float)n, .absorption = {1, 1, 1}};
    optics_at(&optics, angles, 7, &row);
    for (int i = 0; i < 7; i++) {
        double inside = asin(sin(angles[i]) / n), ci = cos(angles[i]), ct = cos(inside);
        double s = (ci - n * ct) / (ci + n * ct), p = (n * ci - ct) / (n * ci + ct);
        assert_true(fabs((double)row.fresnel[i] - 0.5 * (s * s + p * p)) < 1e-5);
    }
    assert_true(fabs((double)row.fresnel[0] - pow((n - 1) / (n + 1), 2)) < 1e-6);
    assert_true(row.fresnel[6] > 0.9999f);
    optics.schlick = true;
    optics_at(&optics, angles, 7, &row);
    double normal = pow((n - 1) / (n + 1), 2);
    assert_true(fabs((double)row.fresnel[2] - (normal + (1 - normal) * pow(1 - cos(0.7), 5))) < 1e-5);
    optics.schlick = false;
    optics.index = 1; /* no surface at all */
    optics_at(&optics, angles, 7, &row);
    for (int i = 0; i < 6; i++) {
        assert_true(fabsf(row.fresnel[i]) < 1e-6f && fabsf(row.look_x[i] - (float)i) < 1e-3f);
    }
}

/* Through a flat slab the lookup is where Snell's ray meets its far side. */
static void test_slab_refracts_as_snell_says(void **state)
{
    (void)state;
    static struct shade_row row;
    const double n = 1.5;
    double angles[] = {0.9, 0.5, 0, 0.2, 1.3};
    struct shade_optics optics = {.index = (float)n, .refraction = 1, .cx = -500, .cy = -500};
    optics_at(&optics, angles, 5, &row); /* orthographic: the ray runs along z, a metre is a pixel */
    for (int i = 0; i < 5; i++) {
        double slab = cos(angles[i]), inside = asin(sin(angles[i]) / n), path = slab / cos(inside); /* the thickness along the ray is 1 */
        double expected = i - path * sin(angles[i] - inside);                                       /* bent towards the normal */
        assert_true(fabs((double)row.look_x[i] - fabs(expected)) < 1e-3);                           /* mirrored at the edge */
    }
}

static void test_transmittance_and_alpha_of_a_known_thickness(void **state)
{
    (void)state;
    struct stage_test test;
    begin(&test, MNS_ISA_AUTO);
    mns_camera_orthographic(&test.camera, 2, 0.1, 100);
    static float transmittance[PIXELS * 3], alpha[PIXELS], beauty[PIXELS * 4], depth[PIXELS], color[PIXELS * 3];
    const struct mns_output outputs[5] = {{MNS_LAYER_TRANSMITTANCE, image_of(&test, transmittance, 3, MNS_PIXEL_F32)},
                                          {MNS_LAYER_ALPHA, image_of(&test, alpha, 1, MNS_PIXEL_F32)},
                                          {MNS_LAYER_BEAUTY, image_of(&test, beauty, 4, MNS_PIXEL_F32)},
                                          {MNS_LAYER_DEPTH, image_of(&test, depth, 1, MNS_PIXEL_F32)},
                                          {MNS_LAYER_COLOR, image_of(&test, color, 3, MNS_PIXEL_F32)}};
    test.params.background = MNS_BACKGROUND_TRANSPARENT;
    stage_test_frame(&test, NULL, outputs, 5, 1);
    for (int i = 0; i < PIXELS / 2; i++) {
        *depth_at(&test, i % WIDTH, i / WIDTH) = 3;
        *thickness_at(&test, i % WIDTH, i / WIDTH) = 0.4f;
    }
    shade(&test);
    double enters = 1 - pow(0.333 / 2.333, 2), sum = 0;
    for (int c = 0; c < 3; c++) {
        double expected = enters * exp(-(double)test.params.absorption[c] * 0.4);
        assert_true(fabs((double)transmittance[c] - expected) < 1e-5 && transmittance[3 * PIXELS - 1 - c] == 1);
        sum += expected / 3;
        assert_true(color[c] == 0);
    }
    assert_true(fabs((double)alpha[0] - (1 - sum)) < 1e-5 && alpha[PIXELS - 1] == 0);
    assert_true(beauty[3] >= alpha[0] - 1e-6f && beauty[3] <= 1 && beauty[4 * PIXELS - 1] == 0);
    assert_true(depth[0] == 3 && isinf(depth[PIXELS - 1]));
    stage_test_end(&test);
}

/* Water on the right of a bright red post that stands before it, tilted so that lookups go towards the post. */
static void test_lookups_never_show_what_stands_before_the_fluid(void **state)
{
    (void)state;
    static const enum mns_isa isas[] = {MNS_ISA_SCALAR, MNS_ISA_AUTO};
    static float color[PIXELS * 3], scene_depth[PIXELS], beauty[PIXELS * 4], depth[PIXELS];
    for (int k = 0; k < 2; k++) {
        struct stage_test test;
        begin(&test, isas[k]);
        test.params.reflection = test.params.specular = 0;
        test.params.absorption[0] = 0;
        for (int i = 0; i < PIXELS; i++) {
            bool post = i % WIDTH >= 50 && i % WIDTH < 60;
            color[3 * i] = post ? 10 : 0;
            color[3 * i + 1] = color[3 * i + 2] = 0.5f;
            scene_depth[i] = post ? 2 : INFINITY;
        }
        const struct mns_scene scene = {image_of(&test, color, 3, MNS_PIXEL_F32), image_of(&test, scene_depth, 1, MNS_PIXEL_F32)};
        const struct mns_output outputs[2] = {{MNS_LAYER_BEAUTY, image_of(&test, beauty, 4, MNS_PIXEL_F32)},
                                              {MNS_LAYER_DEPTH, image_of(&test, depth, 1, MNS_PIXEL_F32)}};
        stage_test_frame(&test, &scene, outputs, 2, 1);
        for (int i = 0; i < PIXELS; i++) {
            int away = i % WIDTH - 55;
            *depth_at(&test, i % WIDTH, i / WIDTH) = 3 + 0.02f * (float)(away < 0 ? away : -away) + 0.02f * 65;
            *thickness_at(&test, i % WIDTH, i / WIDTH) = 0.6f;
        }
        shade(&test);
        int moved = 0;
        for (int i = 0; i < PIXELS; i++) {
            bool post = i % WIDTH >= 50 && i % WIDTH < 60;
            assert_true(post ? beauty[4 * i] == 10 : beauty[4 * i] < 1e-3f);
            assert_true(post ? isinf(depth[i]) : depth[i] > 2);
            moved += !post && beauty[4 * i + 1] < 0.5f;
        }
        assert_true(moved > 0);
        stage_test_end(&test);
    }
}

static void draw_sphere(double scale, int threads, enum mns_isa isa, int display, uint8_t *pixels)
{
    struct stage_test test;
    float far_away[3] = {0, 0, 0};
    stage_test_begin(&test, isa, threads, far_away, 1);
    mns_camera_init(&test.camera, WIDTH, HEIGHT);
    const double eye[3] = {0, 1.5 * scale, 3 * scale}, target[3] = {0, 0, 0}, up[3] = {0, 1, 0};
    mns_camera_look_at(&test.camera, eye, target, up);
    test.params.radius = (float)(0.5 * scale);
    test.params.display = display;
    const struct mns_output output = {MNS_LAYER_BEAUTY, image_of(&test, pixels, 4, MNS_PIXEL_U8)};
    stage_test_frame(&test, NULL, &output, 1, 1);
    static double normals[PIXELS][3];
    const float *t = test.frame.view.translation;
    const double center[3] = {(double)t[0], (double)t[1], (double)t[2]};
    sphere(&test, center, 0.6 * scale, normals);
    for (int i = 0; i < PIXELS; i++) {
        *thickness_at(&test, i % WIDTH, i / WIDTH) = (float)(normals[i][2] != 0 ? scale * -normals[i][2] : 0);
    }
    shade(&test);
    stage_test_end(&test);
}

static void test_scale_and_threads_change_nothing(void **state)
{
    (void)state;
    static uint8_t pictures[2][PIXELS * 4];
    for (int display = MNS_DISPLAY_BEAUTY; display <= MNS_DISPLAY_COLOR; display++) {
        draw_sphere(1, 1, MNS_ISA_AUTO, display, pictures[0]);
        static const int threads[] = {2, 7};
        for (int i = 0; i < 2; i++) {
            draw_sphere(1, threads[i], MNS_ISA_AUTO, display, pictures[1]);
            assert_memory_equal(pictures[0], pictures[1], sizeof(pictures[0]));
        }
        static const double scales[] = {1e-3, 1e3};
        for (int i = 0; i < 2; i++) {
            draw_sphere(scales[i], 2, MNS_ISA_AUTO, display, pictures[1]);
            int differ = 0;
            for (int k = 0; k < PIXELS * 4; k++) {
                differ += abs(pictures[0][k] - pictures[1][k]) > 2;
            }
            assert_true(differ < PIXELS / 200); /* edges of the checker, and the sphere's rim */
        }
        draw_sphere(1, 2, MNS_ISA_SCALAR, display, pictures[1]);
        for (int k = 0; k < PIXELS * 4; k++) {
            assert_true(abs(pictures[0][k] - pictures[1][k]) <= 2);
        }
    }
}

/* Light beyond white keeps its order, black stays black, and float pictures and diagrams are as they were. */
static void test_tone_maps(void **state)
{
    (void)state;
    static float plain[PIXELS * 4], mapped[PIXELS * 4];
    static uint8_t bytes[PIXELS * 4];
    static const float far_away[3] = {0, 0, 500};
    struct stage_test test;
    stage_test_begin(&test, MNS_ISA_AUTO, 2, far_away, 1);
    mns_camera_init(&test.camera, WIDTH, HEIGHT);
    const double eye[3] = {0, 0, 3}, target[3] = {0, 0, 0}, up[3] = {0, 1, 0};
    mns_camera_look_at(&test.camera, eye, target, up);
    test.params.exposure = 2;
    struct mns_output output = {MNS_LAYER_BEAUTY, image_of(&test, plain, 4, MNS_PIXEL_F32)};
    stage_test_frame(&test, NULL, &output, 1, 1);
    shade(&test);
    for (int map = MNS_TONE_MAP_FILMIC; map <= MNS_TONE_MAP_REINHARD; map++) {
        test.params.tone_map = map;
        output.image = image_of(&test, mapped, 4, MNS_PIXEL_F32);
        stage_test_frame(&test, NULL, &output, 1, 1);
        shade(&test);
        assert_memory_equal(plain, mapped, sizeof(plain));
        output.image = image_of(&test, bytes, 4, MNS_PIXEL_U8);
        stage_test_frame(&test, NULL, &output, 1, 1);
        shade(&test);
        int brighter = 0;
        for (int i = 0; i < PIXELS; i++) {
            double light = (double)plain[4 * i], code = bytes[4 * i] / 255.0,
                   back = code <= 0.04045 ? code / 12.92 : pow((code + 0.055) / 1.055, 2.4);
            double v = 0.6 * light, film = fmin(v * (2.51 * v + 0.03) / (v * (2.43 * v + 0.59) + 0.14), 1);
            double wanted = map == MNS_TONE_MAP_FILMIC ? film : fmin(light * (1 + light / 16) / (1 + light), 1);
            assert_true(fabs(back - wanted) < 0.006); /* half of a code where they are farthest apart */
            brighter += light > 1.2 && bytes[4 * i] < 255;
        }
        assert_true(brighter > PIXELS / 20);
    }
    stage_test_end(&test);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sphere),
        cmocka_unit_test(test_fresnel),
        cmocka_unit_test(test_slab_refracts_as_snell_says),
        cmocka_unit_test(test_transmittance_and_alpha_of_a_known_thickness),
        cmocka_unit_test(test_lookups_never_show_what_stands_before_the_fluid),
        cmocka_unit_test(test_scale_and_threads_change_nothing),
        cmocka_unit_test(test_tone_maps),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
