/* Stage blur: what is even stays even up to the picture's edge, nothing is lost inside, sigma follows the depth. */
#include "stage_test.h"

static const float one[3] = {0, 0, 0};

static void begin(struct stage_test *test, int width, int height, int scale)
{
    stage_test_begin(test, MNS_ISA_AUTO, 3, one, 1);
    mns_camera_init(&test->camera, width, height);
    test->params.radius = 0.05f;
    stage_test_frame(test, NULL, NULL, 0, scale);
}

static void test_even_thickness_stays_even(void **state)
{
    (void)state;
    for (int scale = 1; scale <= 4; scale *= 2) {
        struct stage_test test;
        begin(&test, 77, 51, scale);
        for (int y = 0; y < 51; y++) {
            for (int x = 0; x < 77; x++) {
                *depth_at(&test, x, y) = 2;
                *thickness_at(&test, x / scale, y / scale) = 0.7f;
            }
        }
        static float layer[77 * 51];
        const struct mns_output output = {MNS_LAYER_THICKNESS, image_of(&test, layer, 1, MNS_PIXEL_F32)};
        test.frame.outputs = &output;
        test.frame.output_count = 1;
        assert_int_equal(mns_cpu_blur(test.cpu, &test.frame), MNS_OK);
        for (int i = 0; i < 77 * 51; i++) {
            assert_true(fabsf(layer[i] - 0.7f) < 2e-6f);
        }
        stage_test_end(&test);
    }
}

/* A point of thickness at depth z spreads with sigma = thickness_blur * R * f / z pixels. */
static void test_sigma_follows_the_depth(void **state)
{
    (void)state;
    static const float depths[] = {1, 1.5f, 3};
    for (int i = 0; i < 3; i++) {
        struct stage_test test;
        begin(&test, 161, 121, 1);
        for (int y = 0; y < 121; y++) {
            for (int x = 0; x < 161; x++) {
                *depth_at(&test, x, y) = depths[i];
            }
        }
        *thickness_at(&test, 80, 60) = 1;
        assert_int_equal(mns_cpu_blur(test.cpu, &test.frame), MNS_OK);
        double sum = 0, spread = 0;
        for (int y = 0; y < 121; y++) {
            for (int x = 0; x < 161; x++) {
                double t = (double)test.cpu->blurred.thickness.data[y * test.cpu->blurred.thickness.stride + x];
                sum += t;
                spread += t * (x - 80) * (x - 80);
            }
        }
        double sigma = (double)(test.params.thickness_blur * test.frame.splat_radius * test.frame.view.fx / depths[i]);
        assert_true(fabs(sum - 1) < 1e-4);
        /* Cut at 2.5 sigma with the weight there subtracted, the Gaussian's own spread is 0.893 of it. */
        assert_true(fabs(sqrt(spread) / sigma - 0.893) < 0.01);
        stage_test_end(&test);
    }
}

static void test_nothing_where_no_fluid_is(void **state)
{
    (void)state;
    struct stage_test test;
    begin(&test, 64, 48, 1);
    *thickness_at(&test, 10, 10) = 5;
    *thickness_at(&test, 40, 30) = 5;
    *depth_at(&test, 40, 30) = 2;
    assert_int_equal(mns_cpu_blur(test.cpu, &test.frame), MNS_OK);
    const struct plane *out = &test.cpu->blurred.thickness;
    assert_true(out->data[10 * out->stride + 10] == 0);
    assert_true(out->data[30 * out->stride + 40] > 0 && out->data[30 * out->stride + 41] > 0 && out->data[30 * out->stride + 42] == 0);
    stage_test_end(&test);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_even_thickness_stays_even),
        cmocka_unit_test(test_sigma_follows_the_depth),
        cmocka_unit_test(test_nothing_where_no_fluid_is),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
