/* test_noise_picture.c: what the noise does to a picture: its derivatives to the normal, its size to what comes through, and nothing where there is none. */
#include "picture_test.h"

enum { PIXELS = POOL_WIDTH * POOL_HEIGHT };

static struct shot noisy_shot(double size)
{
    struct shot shot = pool_shot(size);
    shot.params.foam = MNS_FOAM_NOISE;
    return shot;
}

/* Seen without perspective n is (fx dz/dx, fy dz/dy, -1) in image space, of the depth with the noise on it. */
static void the_normal_is_that_of_the_waves(void **state)
{
    (void)state;
    struct cloud cloud = {0};
    pool(&cloud, 1);
    struct mns_particles particles = cloud_particles(&cloud);
    struct shot shot = noisy_shot(1);
    assert_int_equal(mns_camera_orthographic(&shot.camera, 2.4, 0.1, 100), MNS_OK);
    shot.params.radius = 0.03f;
    shot.params.noise_height = 0.2f;
    const enum mns_layer layers[] = {MNS_LAYER_DEPTH, MNS_LAYER_NOISE, MNS_LAYER_NORMAL};
    float *data[3];
    draw_layers(&shot, &particles, layers, data, 3);
    const double f = POOL_HEIGHT / 2.4, height = 0.2 * 0.03 * (double)shot.params.radius_scale;
    size_t checked = 0;
    double tilt = 0;
    for (int y = 1; y < POOL_HEIGHT - 1; y++) {
        for (int x = 1; x < POOL_WIDTH - 1; x++) {
            double z[5];
            static const int steps[5][2] = {{0, 0}, {-1, 0}, {1, 0}, {0, -1}, {0, 1}};
            bool smooth = true;
            for (int k = 0; k < 5; k++) {
                int at = (y + steps[k][1]) * POOL_WIDTH + x + steps[k][0];
                z[k] = (double)data[0][at] - height * (double)data[1][at];
                smooth = smooth && isfinite(data[0][at]) && fabs(z[k] - z[0]) < 0.05;
            }
            if (!smooth) {
                continue;
            }
            double n[3] = {0.5 * f * (z[2] - z[1]), -0.5 * f * (z[4] - z[3]), 1}, length = sqrt(n[0] * n[0] + n[1] * n[1] + 1);
            for (int c = 0; c < 3; c++) {
                assert_true(fabs(n[c] / length - (double)data[2][3 * (y * POOL_WIDTH + x) + c]) < 1e-3);
            }
            tilt = fmax(tilt, height * f * fabs((double)data[1][y * POOL_WIDTH + x] - (double)data[1][y * POOL_WIDTH + x - 1]));
            checked++;
        }
    }
    assert_true(checked > PIXELS / 10 && tilt > 0.1); /* and the waves are seen */
    for (int k = 0; k < 3; k++) {
        free(data[k]);
    }
    cloud_free(&cloud);
}

/* Without waves: noise_foam * (|N| - noise_threshold) of what comes through without foam is hidden. */
static void grey_foam_hides_what_is_behind(void **state)
{
    (void)state;
    struct cloud cloud = {0};
    pool(&cloud, 1);
    struct mns_particles particles = cloud_particles(&cloud);
    struct shot shot = noisy_shot(1);
    shot.params.noise_height = 0;
    shot.params.noise_foam = 0.8f;
    shot.params.noise_threshold = 0.1f;
    const enum mns_layer layers[] = {MNS_LAYER_TRANSMITTANCE, MNS_LAYER_NOISE, MNS_LAYER_ALPHA};
    float *with[3], *without[3];
    draw_layers(&shot, &particles, layers, with, 3);
    shot.params.foam = MNS_FOAM_NONE;
    draw_layers(&shot, &particles, layers, without, 3);
    float most = 0;
    for (int i = 0; i < PIXELS; i++) {
        float part = fminf(fmaxf(0.8f * (fabsf(with[1][i]) - 0.1f), 0), 1), sum = 0;
        most = fmaxf(most, part);
        for (int c = 0; c < 3; c++) {
            assert_true(fabsf(with[0][3 * i + c] - without[0][3 * i + c] * (1 - part)) < 1e-6f);
            sum += with[0][3 * i + c];
        }
        assert_true(fabsf(with[2][i] - (1 - sum / 3)) < 1e-6f);
        assert_true(without[1][i] == 0);
    }
    assert_true(most > 0.3f);
    for (int k = 0; k < 3; k++) {
        free(with[k]);
        free(without[k]);
    }
    cloud_free(&cloud);
}

/* Calm particles: the very picture without foam. */
static void still_water_stays_as_it_is(void **state)
{
    (void)state;
    struct cloud cloud = {0};
    pool(&cloud, 1);
    struct mns_particles particles = cloud_particles(&cloud);
    float *calm = calloc(cloud.count, sizeof(float));
    assert_non_null(calm);
    particles.noise = (struct mns_attr){.data = calm, .type = MNS_F32};
    struct shot shot = noisy_shot(1);
    float *with = draw_layer(&shot, &particles, MNS_LAYER_BEAUTY);
    shot.params.foam = MNS_FOAM_NONE;
    float *without = draw_layer(&shot, &particles, MNS_LAYER_BEAUTY);
    assert_memory_equal(with, without, 4 * PIXELS * sizeof(float));
    free(with);
    free(without);
    free(calm);
    cloud_free(&cloud);
}

static void a_scaled_scene_has_the_same_noise(void **state)
{
    (void)state;
    float *noise_of[2];
    for (int i = 0; i < 2; i++) {
        double size = i == 0 ? 1 : 1000;
        struct cloud cloud = {0};
        pool(&cloud, size);
        struct mns_particles particles = cloud_particles(&cloud);
        struct shot shot = noisy_shot(size);
        shot.params.radius = (float)(0.025 * size);
        noise_of[i] = draw_layer(&shot, &particles, MNS_LAYER_NOISE);
        cloud_free(&cloud);
    }
    struct difference d = compare(noise_of[0], noise_of[1], PIXELS, 0.02);
    assert_true(d.part < 0.003 && d.mean < 1e-3); /* rims come and go with a rounding */
    free(noise_of[0]);
    free(noise_of[1]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_normal_is_that_of_the_waves),
        cmocka_unit_test(grey_foam_hides_what_is_behind),
        cmocka_unit_test(still_water_stays_as_it_is),
        cmocka_unit_test(a_scaled_scene_has_the_same_noise),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
