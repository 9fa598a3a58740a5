/* Measures of a right picture (SPEC 5) on whole draws: spheres, planes, blocks, mirrors, scales, orders, instruction sets. */
#include "unit/picture_test.h"

static const double PI = 3.14159265358979323846;

enum { WIDTH = POOL_WIDTH, HEIGHT = POOL_HEIGHT };

static size_t pixels_of(const struct shot *shot) { return (size_t)shot->camera.width * (size_t)shot->camera.height; }

/* The direction of pixel (x, y) in view space with z = -1, for a perspective in the middle. */
static void ray_of(const struct shot *shot, int x, int y, double ray[3])
{
    double tan_y = 1 / shot->camera.projection[5], tan_x = 1 / shot->camera.projection[0];
    ray[0] = ((x + 0.5) / shot->camera.width * 2 - 1) * tan_x;
    ray[1] = (1 - (y + 0.5) / shot->camera.height * 2) * tan_y;
    ray[2] = -1;
}

/* One sphere without smoothing, at the centre and in the corners of a wide view: depth, chord and normal against closed form. */
static void one_sphere_is_exact(void **state)
{
    (void)state;
    static const double centres[][3] = {{0, 0, -3}, {4.6, 2.5, -3}, {-4.6, 2.5, -3}, {4.6, -2.5, -3}, {-2, -2.5, -3}};
    for (size_t i = 0; i < sizeof(centres) / sizeof(centres[0]); i++) {
        const double *c = centres[i], radius = 0.5;
        struct cloud cloud = {0};
        cloud_add(&cloud, c[0], c[1], c[2]);
        struct shot shot = shot_of(640, 360);
        assert_int_equal(mns_camera_perspective(&shot.camera, 90, 0.01, 100), MNS_OK);
        shot.params.filter = MNS_FILTER_NONE;
        shot.params.radius = (float)radius;
        shot.params.radius_scale = 1;
        shot.params.thickness_mode = MNS_THICKNESS_CHORD;
        shot.params.thickness_scale = 1;
        shot.params.floor = 0;
        struct mns_particles particles = cloud_particles(&cloud);
        const enum mns_layer layers[] = {MNS_LAYER_DEPTH_RAW, MNS_LAYER_THICKNESS_RAW, MNS_LAYER_NORMAL, MNS_LAYER_DEPTH};
        float *data[4];
        draw_layers(&shot, &particles, layers, data, 4);
        size_t inside = 0;
        for (int y = 0; y < 360; y++) {
            for (int x = 0; x < 640; x++) {
                size_t p = (size_t)y * 640 + (size_t)x;
                double v[3], vv = 0, vc = 0, cc = 0;
                ray_of(&shot, x, y, v);
                for (int k = 0; k < 3; k++) {
                    vv += v[k] * v[k];
                    vc += v[k] * c[k];
                    cc += c[k] * c[k];
                }
                double under = vc * vc - vv * (cc - radius * radius);
                if (fabs(under) < 1e-4 * vv * radius * radius) {
                    continue; /* on the rim either answer is right */
                }
                if (under < 0) {
                    assert_true(isinf(data[0][p]) && data[1][p] == 0 && isinf(data[3][p]));
                    continue;
                }
                inside++;
                double t = (vc - sqrt(under)) / vv, chord = 2 * sqrt(under / vv), cosine = 0, length2 = 0;
                assert_true(fabs((double)data[0][p] - t) < 3e-4 * radius);
                assert_true(fabs((double)data[1][p] - chord) < 3e-3 * radius);
                for (int k = 0; k < 3; k++) {
                    cosine += (double)data[2][3 * p + (size_t)k] * (t * v[k] - c[k]) / radius;
                    length2 += (double)(data[2][3 * p + (size_t)k] * data[2][3 * p + (size_t)k]);
                }
                assert_true(fabs(length2 - 1) < 1e-4);
                /* Differences over two pixels cannot tell a normal on the last pixels before the rim. */
                if (chord > 0.8 * radius) {
                    assert_true(cosine > cos(6 * PI / 180));
                }
            }
        }
        assert_true(inside > 1000);
        for (int k = 0; k < 4; k++) {
            free(data[k]);
        }
        cloud_free(&cloud);
    }
}

/* A block of particles 1 m deep, seen through its middle: the mean thickness is 1 m. */
static void a_block_one_metre_deep_is_one_metre_thick(void **state)
{
    (void)state;
    static const int across[] = {10, 22, 46}; /* 1k, 10k, 100k particles */
    static const float scales[] = {0.9f, 1.2f, 2.0f};
    for (int i = 0; i < 3; i++) {
        for (int s = 0; s < 3; s++) {
            const double low[3] = {-0.5, -0.5, -3.5};
            const int n[3] = {across[i], across[i], across[i]};
            struct cloud cloud = {0};
            cloud_box(&cloud, low, n, 1.0 / across[i], 0.2, 7);
            struct shot shot = shot_of(WIDTH, HEIGHT);
            assert_int_equal(mns_camera_orthographic(&shot.camera, 1.5, 0.1, 100), MNS_OK);
            shot.params.radius_scale = scales[s];
            shot.params.particle_volume = (float)pow(1.0 / across[i], 3);
            struct mns_particles particles = cloud_particles(&cloud);
            for (int coarse = 0; coarse < 2; coarse++) {
                shot.params.thickness_scale = coarse ? 0 : 1;
                float *thickness = draw_layer(&shot, &particles, MNS_LAYER_THICKNESS);
                double sum = 0;
                int count = 0;
                for (int y = 60; y < 120; y++) { /* half a metre across the middle */
                    for (int x = 130; x < 190; x++, count++) {
                        sum += (double)thickness[y * WIDTH + x];
                    }
                }
                if (fabs(sum / count - 1) >= 0.02) {
                    fail_msg("%zu particles, radius_scale %g, thickness_scale %d: mean thickness %g", cloud.count, (double)scales[s],
                             shot.params.thickness_scale, sum / count);
                }
                free(thickness);
            }
            cloud_free(&cloud);
        }
    }
}

/* The estimated radius and volume do it too, without being told. */
static void a_block_is_as_thick_as_it_is_without_being_told_its_radius(void **state)
{
    (void)state;
    const double low[3] = {-0.5, -0.5, -3.5};
    const int n[3] = {30, 30, 30};
    struct cloud cloud = {0};
    cloud_box(&cloud, low, n, 1.0 / 30, 0.15, 3);
    struct shot shot = shot_of(WIDTH, HEIGHT);
    assert_int_equal(mns_camera_orthographic(&shot.camera, 1.5, 0.1, 100), MNS_OK);
    struct mns_particles particles = cloud_particles(&cloud);
    float *thickness = draw_layer(&shot, &particles, MNS_LAYER_THICKNESS);
    double sum = 0;
    for (int y = 60; y < 120; y++) {
        for (int x = 130; x < 190; x++) {
            sum += (double)thickness[y * WIDTH + x] / 3600;
        }
    }
    assert_true(fabs(sum - 1) < 0.15); /* SPEC 1: the estimated radius is within 5 % */
    free(thickness);
    cloud_free(&cloud);
}

/* A plane of jittered particles through (0, 0, -4), tilted about x: normals and depth of the smoothed surface. */
static void a_tilted_plane_stays_a_plane(void **state)
{
    (void)state;
    static const double tilts[] = {0, 45, 70};
    static const double median_limit[] = {3, 2, 1}; /* degrees, of the median; particles jittered by a fifth of their spacing */
    for (int i = 0; i < 3; i++) {
        double c = cos(tilts[i] * PI / 180), s = sin(tilts[i] * PI / 180), spacing = 0.04;
        struct cloud cloud = {0};
        uint64_t seed = 5;
        for (int v = -120; v < 120; v++) {
            for (int u = -120; u < 120; u++) {
                for (int w = 0; w < 6; w++) {         /* a surface layer and five below */
                    double between = w % 2 ? 0.5 : 0; /* the particles of a layer fill the gaps of the one above */
                    double a = spacing * (u + between + 0.2 * noise(&seed)), b = spacing * (v + between + 0.2 * noise(&seed));
                    double d = -spacing * (0.75 * w + 0.1 * noise(&seed));
                    cloud_add(&cloud, a, b * c + d * s, -4 - b * s + d * c);
                }
            }
        }
        struct shot shot = shot_of(640, 360);
        assert_int_equal(mns_camera_perspective(&shot.camera, 30, 0.01, 100), MNS_OK);
        shot.params.radius = 0.02f;
        struct mns_particles particles = cloud_particles(&cloud);
        const enum mns_layer layers[] = {MNS_LAYER_DEPTH, MNS_LAYER_NORMAL};
        float *data[2];
        draw_layers(&shot, &particles, layers, data, 2);
        double mean = 0, mean2 = 0;
        size_t count = 0, close = 0;
        double limit = cos(median_limit[i] * PI / 180);
        for (int y = 90; y < 270; y++) {
            for (int x = 160; x < 480; x++) {
                size_t p = (size_t)y * 640 + (size_t)x;
                double ray[3];
                ray_of(&shot, x, y, ray);
                double ideal = 4 * c / (c - ray[1] * s); /* (t ray - (0, 0, -4)) . (0, s, c) = 0 */
                if (!isfinite(data[0][p])) {
                    fail_msg("tilt %g: no fluid at %d, %d", tilts[i], x, y);
                }
                double off = ((double)data[0][p] - ideal) * c / 0.024; /* across the plane, in R */
                mean += off;
                mean2 += off * off;
                count++;
                close += (double)data[1][3 * p + 1] * s + (double)data[1][3 * p + 2] * c > limit;
            }
        }
        mean /= (double)count;
        double deviation = sqrt(mean2 / (double)count - mean * mean);
        /* The surface of spheres lies R before their centres, less what the dips between them take. */
        if (!(close > count / 2 && mean < -0.5 && mean > -1.05 && deviation < 0.2)) {
            fail_msg("tilt %g: %zu of %zu normals within %g degrees, depth %g +- %g R", tilts[i], close, count, median_limit[i], mean,
                     deviation);
        }
        free(data[0]);
        free(data[1]);
        cloud_free(&cloud);
    }
}

/* Nothing needs other values because a scene is larger or smaller. */
static void a_scaled_scene_gives_the_same_picture(void **state)
{
    (void)state;
    static const double sizes[] = {1, 1000, 0.001};
    float *picture[3];
    struct shot shot = {0};
    for (int i = 0; i < 3; i++) {
        struct cloud cloud = {0};
        pool(&cloud, sizes[i]);
        shot = pool_shot(sizes[i]);
        struct mns_particles particles = cloud_particles(&cloud);
        picture[i] = draw_layer(&shot, &particles, MNS_LAYER_BEAUTY);
        cloud_free(&cloud);
    }
    for (int i = 1; i < 3; i++) {
        /* Positions are rounded differently, which moves rims and the edges between near and far; nothing else. */
        struct difference d = compare(picture[0], picture[i], pixels_of(&shot) * 4, 0.01);
        if (d.part > 0.005 || d.mean > 1e-3) {
            fail_msg("scale %g: %g of the values differ, mean difference %g", sizes[i], d.part, d.mean);
        }
    }
    for (int i = 0; i < 3; i++) {
        free(picture[i]);
    }
}

/* Mirrored particles give the mirrored picture (an even light: the sun stands in the plane of the mirror). */
static void mirrored_particles_give_the_mirrored_picture(void **state)
{
    (void)state;
    struct cloud cloud = {0};
    pool(&cloud, 1);
    struct shot shot = pool_shot(1);
    const double eye[3] = {0, 2, 4}, target[3] = {0, 0.3, 0}, up[3] = {0, 1, 0};
    assert_int_equal(mns_camera_look_at(&shot.camera, eye, target, up), MNS_OK);
    shot.params.sun_azimuth = 180;
    shot.params.radius = 0.025f; /* estimates are made from a sample, which the mirror changes */
    shot.params.particle_volume = 1.25e-4f;
    struct mns_particles particles = cloud_particles(&cloud);
    const enum mns_layer layers[] = {MNS_LAYER_DEPTH_RAW, MNS_LAYER_DEPTH, MNS_LAYER_THICKNESS_RAW, MNS_LAYER_THICKNESS};
    float *straight[4], *mirrored[4];
    draw_layers(&shot, &particles, layers, straight, 4);
    for (size_t i = 0; i < cloud.count; i++) {
        cloud.position[i][0] = -cloud.position[i][0];
    }
    draw_layers(&shot, &particles, layers, mirrored, 4);
    for (int k = 0; k < 4; k++) {
        for (int y = 0; y < HEIGHT; y++) {
            for (int x = 0; x < WIDTH / 2; x++) {
                float *row = mirrored[k] + y * WIDTH, swapped = row[x];
                row[x] = row[WIDTH - 1 - x];
                row[WIDTH - 1 - x] = swapped;
            }
        }
        /* Pixels on a rim, where rounding decides whether there is water, may differ; R is about 0.03 m. */
        struct difference d = compare(straight[k], mirrored[k], pixels_of(&shot), 1e-3);
        if (d.part > 0.002) {
            fail_msg("layer %s: %g of the pixels differ", mns_layer_name(layers[k]), d.part);
        }
        free(straight[k]);
        free(mirrored[k]);
    }
    cloud_free(&cloud);
}

/* The order of the particles changes sums in their last digits only; the nearest sphere stays the nearest. */
static void the_order_of_the_particles_does_not_matter(void **state)
{
    (void)state;
    struct cloud cloud = {0};
    pool(&cloud, 1);
    struct shot shot = pool_shot(1);
    struct mns_particles particles = cloud_particles(&cloud);
    const enum mns_layer layers[] = {MNS_LAYER_DEPTH_RAW, MNS_LAYER_THICKNESS_RAW, MNS_LAYER_BEAUTY};
    float *a[3], *b[3];
    draw_layers(&shot, &particles, layers, a, 3);
    uint64_t seed = 99;
    for (size_t i = cloud.count - 1; i > 0; i--) {
        size_t j = (size_t)((noise(&seed) + 1) / 2 * (double)(i + 1));
        for (int k = 0; k < 3; k++) {
            float swapped = cloud.position[i][k];
            cloud.position[i][k] = cloud.position[j][k];
            cloud.position[j][k] = swapped;
        }
    }
    draw_layers(&shot, &particles, layers, b, 3);
    assert_memory_equal(a[0], b[0], pixels_of(&shot) * sizeof(float));
    assert_true(compare(a[1], b[1], pixels_of(&shot), 0).largest < 1e-5);
    assert_true(compare(a[2], b[2], pixels_of(&shot) * 4, 0).largest < 1e-3);
    for (int k = 0; k < 3; k++) {
        free(a[k]);
        free(b[k]);
    }
    cloud_free(&cloud);
}

/* Every instruction set draws what plain C draws, layer by layer. */
static void instruction_sets_agree(void **state)
{
    (void)state;
    struct cloud cloud = {0};
    pool(&cloud, 1);
    struct shot shot = pool_shot(1);
    struct mns_particles particles = cloud_particles(&cloud);
    enum mns_layer layers[MNS_LAYER_COUNT];
    float *plain[MNS_LAYER_COUNT], *vector[MNS_LAYER_COUNT];
    for (int i = 0; i < MNS_LAYER_COUNT; i++) {
        layers[i] = (enum mns_layer)i;
    }
    shot.isa = MNS_ISA_SCALAR;
    draw_layers(&shot, &particles, layers, plain, MNS_LAYER_COUNT);
    int others = 0;
    for (int isa = MNS_ISA_SSE2; isa <= MNS_ISA_NEON; isa++) {
        if (!mns_isa_available((enum mns_isa)isa)) {
            continue;
        }
        others++;
        shot.isa = (enum mns_isa)isa;
        draw_layers(&shot, &particles, layers, vector, MNS_LAYER_COUNT);
        for (int i = 0; i < MNS_LAYER_COUNT; i++) {
            /* Values are metres, 1/metre, colours, all of order 1 here. Rims may go either way. */
            double apart = layers[i] == MNS_LAYER_CURVATURE ? 0.2 : 3e-3;
            struct difference d = compare(plain[i], vector[i], pixels_of(&shot) * (size_t)mns_layer_channels(layers[i]), apart);
            if (d.part > 0.003) {
                fail_msg("%s, layer %s: %g of the values differ by more than %g", mns_isa_name(shot.isa), mns_layer_name(layers[i]), d.part,
                         apart);
            }
            free(vector[i]);
        }
    }
    if (others == 0) {
        print_message("only plain C in this build\n");
    }
    for (int i = 0; i < MNS_LAYER_COUNT; i++) {
        free(plain[i]);
    }
    cloud_free(&cloud);
}

/* Nothing to see is no error. */
static void empty_pictures_are_the_background(void **state)
{
    (void)state;
    struct cloud cloud = {0};
    struct shot shot = pool_shot(1);
    struct mns_particles particles = cloud_particles(&cloud);
    const enum mns_layer layers[] = {MNS_LAYER_BEAUTY, MNS_LAYER_SCENE_COLOR, MNS_LAYER_DEPTH, MNS_LAYER_ALPHA};
    for (int behind = 0; behind < 2; behind++) {
        float *data[4];
        draw_layers(&shot, &particles, layers, data, 4);
        for (size_t p = 0; p < pixels_of(&shot); p++) {
            assert_true(isinf(data[2][p]) && data[3][p] == 0);
            for (size_t c = 0; c < 3; c++) {
                assert_true(fabsf(data[0][4 * p + c] - data[1][3 * p + c]) < 1e-6f);
            }
            assert_true(data[0][4 * p + 3] == 1);
        }
        for (int k = 0; k < 4; k++) {
            free(data[k]);
        }
        pool(&cloud, 1); /* then with everything behind the eye */
        particles = cloud_particles(&cloud);
        const double eye[3] = {0, 0, 5}, target[3] = {0, 0, 10}, up[3] = {0, 1, 0};
        assert_int_equal(mns_camera_look_at(&shot.camera, eye, target, up), MNS_OK);
    }
    cloud_free(&cloud);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_sphere_is_exact),
        cmocka_unit_test(a_block_one_metre_deep_is_one_metre_thick),
        cmocka_unit_test(a_block_is_as_thick_as_it_is_without_being_told_its_radius),
        cmocka_unit_test(a_tilted_plane_stays_a_plane),
        cmocka_unit_test(a_scaled_scene_gives_the_same_picture),
        cmocka_unit_test(mirrored_particles_give_the_mirrored_picture),
        cmocka_unit_test(the_order_of_the_particles_does_not_matter),
        cmocka_unit_test(instruction_sets_agree),
        cmocka_unit_test(empty_pictures_are_the_background),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
