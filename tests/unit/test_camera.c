/* Cameras: matrices against hand-worked values; framing shows the whole box. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <meniscus/camera.h>

#include <math.h>

/* Normalised device x, y of a world point, and its view-space z. */
static void project(const struct mns_camera *camera, const double p[3], double ndc[2], double *z)
{
    double v[4] = {0}, c[4] = {0}, w[4] = {p[0], p[1], p[2], 1};
    for (int row = 0; row < 4; row++) {
        for (int k = 0; k < 4; k++) {
            v[row] += camera->view[4 * k + row] * w[k];
        }
    }
    for (int row = 0; row < 4; row++) {
        for (int k = 0; k < 4; k++) {
            c[row] += camera->projection[4 * k + row] * v[k];
        }
    }
    ndc[0] = c[0] / c[3];
    ndc[1] = c[1] / c[3];
    *z = v[2];
}

static void test_look_at(void **state)
{
    (void)state;
    struct mns_camera camera;
    mns_camera_init(&camera, 200, 100);
    const double eye[3] = {1, 2, 3}, target[3] = {1, 2, -7}, up[3] = {0, 1, 0}, p[3] = {3, 3, 1};
    assert_int_equal(mns_camera_look_at(&camera, eye, target, up), MNS_OK);
    assert_int_equal(mns_camera_perspective(&camera, 90, 0.1, 10), MNS_OK);
    double ndc[2], z;
    project(&camera, p, ndc, &z); /* 2 right, 1 up, 2 ahead; tan(45) = 1, aspect 2 */
    assert_true(fabs(ndc[0] - 0.5) < 1e-12 && fabs(ndc[1] - 0.5) < 1e-12 && fabs(z + 2) < 1e-12);
    assert_int_equal(mns_camera_look_at(&camera, eye, eye, up), MNS_ERR_INVALID_ARGUMENT);
    const double below[3] = {1, -5, 3};
    assert_int_equal(mns_camera_look_at(&camera, eye, below, up), MNS_OK); /* straight down along up */
    assert_true(isfinite(camera.view[0]));
}

static void test_far_planes_at_infinity(void **state)
{
    (void)state;
    struct mns_camera camera;
    mns_camera_init(&camera, 200, 100);
    assert_int_equal(mns_camera_perspective(&camera, 90, 0.5, INFINITY), MNS_OK);
    const double *p = camera.projection;
    assert_true(p[10] == -1 && p[14] == -1); /* depth -1 at the near plane: (-p10 * near + p14) / near; towards 1 far away */
    assert_int_equal(mns_camera_orthographic(&camera, 2, 0.5, INFINITY), MNS_OK);
    for (int i = 0; i < 16; i++) {
        assert_true(isfinite(p[i]));
    }
    assert_int_equal(mns_camera_perspective(&camera, 90, 0.5, NAN), MNS_ERR_INVALID_ARGUMENT);
}

static void test_framing_shows_the_box(void **state)
{
    (void)state;
    static const double boxes[][6] = {{-1, 0, -1, 1, 1, 1}, {100, 50, -3, 900, 60, 500}, {0, 0, 0, 1e-3, 5e-3, 1e-3}, {2, 2, 2, 2, 2, 2}};
    for (size_t i = 0; i < sizeof(boxes) / sizeof(boxes[0]); i++) {
        for (int axis = 0; axis < 3; axis++) {
            for (int fov = 0; fov <= 45; fov += 45) {
                struct mns_camera camera;
                mns_camera_init(&camera, 1920, 1080);
                assert_int_equal(mns_camera_frame(&camera, boxes[i], boxes[i] + 3, 0, axis, fov), MNS_OK);
                double reach = 0, low[2] = {2, 2}, high[2] = {-2, -2};
                for (int corner = 0; corner < 8; corner++) {
                    double p[3], ndc[2], z;
                    for (int k = 0; k < 3; k++) {
                        p[k] = boxes[i][(corner >> k & 1) * 3 + k];
                    }
                    project(&camera, p, ndc, &z);
                    assert_true(fabs(ndc[0]) < 1 && fabs(ndc[1]) < 1 && -z > camera.near_plane && -z < camera.far_plane);
                    for (int k = 0; k < 2; k++) {
                        reach = fmax(reach, fabs(ndc[k]));
                        low[k] = fmin(low[k], ndc[k]);
                        high[k] = fmax(high[k], ndc[k]);
                    }
                }
                assert_true(i == 3 || reach > 0.9); /* as large as the picture allows, and in its middle */
                assert_true(i == 3 || (fabs(low[0] + high[0]) < 0.01 && fabs(low[1] + high[1]) < 0.01));
            }
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_look_at), cmocka_unit_test(test_far_planes_at_infinity),
                                       cmocka_unit_test(test_framing_shows_the_box)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
