/* The closed forms of the lab's scenes against other arithmetic, and the particles against the closed forms. */
#include "lab/lab_test.h"

/* A direction through a pixel of a small grid over the picture. */
static void grid_ray(const struct lab_view *view, int i, int j, double out[3])
{
    lab_view_ray(view, i * (view->width - 1) / 10, j * (view->height - 1) / 10, out);
}

static struct lab_scene scene_of(const char *name, const struct lab_view *view)
{
    struct lab_scene scene;
    lab_scene_make(&scene, lab_scene_find(name), view);
    return scene;
}

/* The edges of the picture are seen under 15 degrees up and down; a shifted picture shows everything moved. */
static void test_rays_go_through_pixels(void **state)
{
    (void)state;
    struct lab_view view = lab_view_make(640, 480), shifted = lab_view_shift(&view, 2, 3);
    double top[3], bottom[3], ray[3], moved[3];
    lab_view_ray(&view, 0, 0, top);
    lab_view_ray(&view, 639, 479, bottom);
    double half_pixel = 0.5 / view.focal;
    assert_near(top[1] + half_pixel, tan(15 * 3.14159265358979 / 180), 1e-12);
    assert_near(top[0] - half_pixel, -top[1] * 640 / 480 - half_pixel * 640 / 480, 1e-12);
    for (int k = 0; k < 2; k++) {
        assert_near(top[k], -bottom[k], 1e-12);
    }
    lab_view_ray(&view, 100, 100, ray);
    lab_view_ray(&shifted, 102, 103, moved);
    for (int k = 0; k < 3; k++) {
        assert_near(ray[k], moved[k], 1e-12);
    }
}

/* The camera that the renderer is given projects each ray's points to its pixel. */
static void test_the_camera_agrees_with_the_rays(void **state)
{
    (void)state;
    struct lab_view whole = lab_view_make(640, 480), view = lab_view_shift(&whole, 0.3, -0.7);
    struct mns_camera camera;
    assert_int_equal(lab_view_camera(&view, &camera), MNS_OK);
    for (int n = 0; n < 121; n++) {
        int x = n % 11 * 63, y = n / 11 * 47;
        double ray[3], clip[4] = {0};
        lab_view_ray(&view, x, y, ray);
        double point[4] = {7 * ray[0], 7 * ray[1], 7 * ray[2], 1};
        for (int i = 0; i < 16; i++) {
            clip[i % 4] += camera.projection[i] * point[i / 4];
        }
        assert_near((0.5 + 0.5 * clip[0] / clip[3]) * 640, x + 0.5, 1e-9);
        assert_near((0.5 - 0.5 * clip[1] / clip[3]) * 480, y + 0.5, 1e-9);
    }
}

/* A plane: its point at the middle, its normal by the tilt, every hit at the offset above it. */
static void test_planes(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        double tilt;
    } planes[] = {{"plane-0", 0}, {"plane-45", 45}, {"plane-70", 70}, {"plane-80", 80}};
    struct lab_view view = lab_view_make(640, 480);
    for (int p = 0; p < 4; p++) {
        struct lab_scene scene = scene_of(planes[p].name, &view);
        double tilt = planes[p].tilt * 3.14159265358979323846 / 180, offset = 0.37;
        int hits = 0;
        for (int n = 0; n < 121; n++) {
            double ray[3];
            grid_ray(&view, n % 11, n / 11, ray);
            struct lab_hit hit = lab_body_hit(&scene.body[0], ray, offset);
            if (hit.body < 0) { /* beyond the horizon: the ray rises along the plane */
                assert_true(ray[1] * sin(tilt) - cos(tilt) >= -1e-12);
                continue;
            }
            double y = hit.depth * ray[1], z = -hit.depth;
            hits++;
            assert_near(sin(tilt) * y + cos(tilt) * (z + view.focal / 10), offset, 1e-9);
            assert_near(hit.normal[1], sin(tilt), 1e-12);
            assert_near(hit.normal[2], cos(tilt), 1e-12);
            assert_near(hit.cosine, cos(tilt) - sin(tilt) * ray[1], 1e-12);
        }
        assert_true(hits > 50);
    }
}

/* A sphere: hits lie on it, on the near side, and happen where the ray passes the middle within the radius. */
static void test_spheres(void **state)
{
    (void)state;
    struct lab_view view = lab_view_make(640, 480);
    struct lab_scene scene = scene_of("sphere", &view);
    const struct lab_body *ball = &scene.body[0];
    int hits = 0, misses = 0;
    for (int n = 0; n < 121; n++) {
        double ray[3], offset = 0.25, radius = ball->radius + offset;
        grid_ray(&view, n % 11, n / 11, ray);
        struct lab_hit hit = lab_body_hit(ball, ray, offset);
        double across = hypot(ray[0], ray[1]), passes = -ball->origin[2] * across / sqrt(1 + across * across);
        assert_true((hit.body >= 0) == (passes < radius));
        if (hit.body < 0) {
            misses++;
            continue;
        }
        double x = hit.depth * ray[0], y = hit.depth * ray[1], z = -hit.depth - ball->origin[2];
        hits++;
        assert_near(sqrt(x * x + y * y + z * z), radius, 1e-9);
        assert_near(hit.normal[0] * radius, x, 1e-9);
        assert_near(hit.normal[1] * radius, y, 1e-9);
        assert_true(hit.cosine > 0);
    }
    assert_true(hits > 20 && misses > 20);
}

/* Where the waves have a point (u, v), in the world, moved along nothing. */
static void wave_point(const struct lab_body *body, double u, double v, double out[3])
{
    double wave[3];
    lab_waves(u, v, wave);
    for (int k = 0; k < 3; k++) {
        out[k] = body->origin[k] + u * body->u[k] + v * body->v[k] + wave[0] * body->w[k];
    }
}

static double distance(const double a[3], const double b[3])
{
    return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
}

/* The least distance from a point to the waves, by search: ever smaller steps from the foot in the plane. */
static double search_distance(const struct lab_body *body, const double point[3], double nearest[3])
{
    double u = 0, v = 0, candidate[3];
    for (int k = 0; k < 3; k++) {
        u += (point[k] - body->origin[k]) * body->u[k];
        v += (point[k] - body->origin[k]) * body->v[k];
    }
    wave_point(body, u, v, nearest);
    for (double step = 0.5; step > 1e-9; step *= 0.5) {
        for (bool moved = true; moved;) {
            moved = false;
            for (int d = 0; d < 4; d++) {
                double du = d == 0 ? step : d == 1 ? -step : 0, dv = d == 2 ? step : d == 3 ? -step : 0;
                wave_point(body, u + du, v + dv, candidate);
                if (distance(candidate, point) < distance(nearest, point)) {
                    u += du;
                    v += dv;
                    memcpy(nearest, candidate, sizeof(candidate));
                    moved = true;
                }
            }
        }
    }
    return distance(nearest, point);
}

/* Hits stand off the waves by the offset, as a search finds it, on the side of the normal; the derivatives are those of the height. */
static void test_waves(void **state)
{
    (void)state;
    struct lab_view view = lab_view_make(640, 480);
    struct lab_scene scene = scene_of("waves", &view);
    const struct lab_body *body = &scene.body[0];
    for (int n = 0; n < 121; n++) {
        double ray[3], nearest[3], offset = 0.4, step = 1e-5;
        grid_ray(&view, n % 11, n / 11, ray);
        struct lab_hit hit = lab_body_hit(body, ray, offset);
        assert_int_equal(hit.body, 0);
        double point[3] = {hit.depth * ray[0], hit.depth * ray[1], hit.depth * ray[2]};
        assert_near(search_distance(body, point, nearest), offset, 1e-7);
        for (int k = 0; k < 3; k++) {
            assert_near(hit.normal[k], (point[k] - nearest[k]) / offset, 1e-4); /* the search ends where distances are equal to rounding */
        }
        double u = n % 11, v = n / 11, wave[3], ahead[3], behind[3];
        lab_waves(u, v, wave);
        lab_waves(u + step, v, ahead);
        lab_waves(u - step, v, behind);
        assert_near(wave[1], (ahead[0] - behind[0]) / (2 * step), 1e-8);
        lab_waves(u, v + step, ahead);
        lab_waves(u, v - step, behind);
        assert_near(wave[2], (ahead[0] - behind[0]) / (2 * step), 1e-8);
    }
}

/* The silhouette changes its sign where rays begin to hit the foremost body, by a pixel per pixel. */
static void test_silhouettes(void **state)
{
    (void)state;
    static const char *const names[] = {"sphere", "step", "drop-0", "drop-45"};
    struct lab_view view = lab_view_make(LAB_WIDTH_MIN, LAB_HEIGHT_MIN);
    for (int s = 0; s < 4; s++) {
        struct lab_scene scene = scene_of(names[s], &view);
        int front = scene.bodies - 1, y = view.height / 2;
        for (int i = 0; i < view.width * view.height; i++) {
            double ray[3];
            lab_view_ray(&view, i % view.width, i / view.width, ray);
            bool hits = lab_scene_hit(&scene, ray, &LAB_TEST_OFFSETS).body == front;
            double inside = lab_scene_silhouette(&scene, &view, i % view.width, i / view.width, &LAB_TEST_OFFSETS);
            assert_true(hits == (inside > 0));
        }
        double step =
            lab_scene_silhouette(&scene, &view, 20, y, &LAB_TEST_OFFSETS) - lab_scene_silhouette(&scene, &view, 10, y, &LAB_TEST_OFFSETS);
        assert_near(fabs(step), 10, 1e-3);
    }
    struct lab_scene plane = scene_of("plane-0", &view);
    assert_true(isinf(lab_scene_silhouette(&plane, &view, 0, 0, &LAB_TEST_OFFSETS)));
}

/* What parts two bodies is nowhere near either of them, whatever the picture's size: bumps do not change sides. */
static void test_bodies_are_told_apart(void **state)
{
    (void)state;
    enum { WIDTH = 640, HEIGHT = 480 };
    static const char *const names[] = {"step", "drop-0", "drop-45"};
    static float raw[WIDTH * HEIGHT];
    struct lab_view view = lab_view_make(WIDTH, HEIGHT);
    for (int s = 0; s < 3; s++) {
        struct lab_scene scene = scene_of(names[s], &view);
        struct lab_reference reference;
        for (int i = 0; i < WIDTH * HEIGHT; i++) {
            double ray[3];
            lab_view_ray(&view, i % WIDTH, i / WIDTH, ray);
            raw[i] = (float)lab_scene_hit(&scene, ray, &LAB_TEST_OFFSETS).depth;
        }
        assert_true(lab_reference_fill(&reference, &scene, &view, raw, LAB_TEST_RADIUS, &LAB_TEST_OFFSETS));
        for (int i = 0; i < WIDTH * HEIGHT; i++) {
            assert_true(reference.body[i] == (reference.silhouette[i] > 0));
            assert_true(fabs((double)(raw[i] - reference.split[i])) > 2);
        }
        lab_reference_free(&reference);
    }
}

/* From depths of a surface at known offsets, the offsets. */
static void test_offsets_are_found(void **state)
{
    (void)state;
    for (int s = 0; s < lab_scene_count(); s++) {
        struct lab_test *test = lab_test_create(lab_scene_name(s), 0, 0);
        struct lab_reference found;
        assert_true(lab_reference_make(&found, &test->scene, &test->view, test->raw, LAB_TEST_RADIUS));
        for (int i = 0; i < test->scene.bodies; i++) {
            assert_near(found.offsets.body[i], LAB_TEST_OFFSETS.body[i], 1e-5); /* raw is float32 */
        }
        lab_reference_free(&found);
        lab_test_destroy(test);
    }
}

/* Particles keep to their surface, and leave no hole in what is measured: every ray ends within three layers of it. */
static void test_particles_fill_the_surface(void **state)
{
    (void)state;
    struct lab_settings settings = {.width = LAB_WIDTH_MIN, .height = LAB_HEIGHT_MIN, .repeat = 1, .threads = 2};
    mns_params_init(&settings.params);
    struct lab lab;
    assert_int_equal(lab_create(&lab, &settings), MNS_OK);
    for (int s = 0; s < lab_scene_count(); s++) {
        assert_int_equal(lab_enter(&lab, s), MNS_OK);
        assert_near(lab.stats.splat_radius, LAB_TEST_RADIUS, 1e-6);
        const struct lab_reference *reference = &lab.reference[0];
        size_t counted = 0;
        for (size_t i = 0; i < LAB_TEST_PIXELS; i++) {
            if (lab_reference_counts(reference, i)) {
                double below = (double)(lab.raw[0][i] - reference->depth[i]) * (double)reference->cosine[i];
                counted++;
                assert_true(below > -LAB_TEST_RADIUS && below < 8 * LAB_TEST_RADIUS);
            }
        }
        assert_true(counted > LAB_TEST_PIXELS / 4);
        for (int i = 0; i < reference->scene.bodies; i++) { /* of spheres whose centres lie within a tenth of a spacing of the surface */
            assert_true(reference->offsets.body[i] > 0.2 * LAB_TEST_RADIUS && reference->offsets.body[i] < LAB_TEST_RADIUS);
        }
    }
    lab_destroy(&lab);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_rays_go_through_pixels),
        cmocka_unit_test(test_the_camera_agrees_with_the_rays),
        cmocka_unit_test(test_planes),
        cmocka_unit_test(test_spheres),
        cmocka_unit_test(test_waves),
        cmocka_unit_test(test_silhouettes),
        cmocka_unit_test(test_bodies_are_told_apart),
        cmocka_unit_test(test_offsets_are_found),
        cmocka_unit_test(test_particles_fill_the_surface),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
