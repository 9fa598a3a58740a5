/* The lab's measures on surfaces with errors that are known. */
#include "lab/lab_test.h"

static const double PI = 3.14159265358979323846;

static double degrees_of(double radians) { return radians * 180 / PI; }

/* A surface without errors measures as one, in every scene. */
static void test_the_truth_has_no_error(void **state)
{
    (void)state;
    for (int s = 0; s < lab_scene_count(); s++) {
        struct lab_test *test = lab_test_create(lab_scene_name(s), 0, 0);
        struct lab_values values = lab_test_measure(test);
        assert_near(values.of[LAB_DRIFT], 0, 1e-5);
        assert_near(values.of[LAB_DEPTH_WORST], 0, 1e-4);
        assert_near(values.of[LAB_NORMAL_95], 0, 0.02);
        assert_near(values.of[LAB_BUMPS], 0, 1e-4);
        unsigned tells = test->scene.tells;
        assert_true(!(tells & LAB_TELLS_EDGE) ? isnan(values.of[LAB_EDGE]) : values.of[LAB_EDGE] == 0);
        assert_true(!(tells & LAB_TELLS_BESIDE) ? isnan(values.of[LAB_BESIDE_DEPTH]) : values.of[LAB_BESIDE_DEPTH] < 1e-4);
        assert_true(!(tells & LAB_TELLS_RIM) ? isnan(values.of[LAB_RIM]) : fabs(values.of[LAB_RIM] - 1) < 1e-4);
        lab_test_destroy(test);
    }
}

/* Everything a quarter of r farther away, measured across the surface. */
static void test_a_surface_that_moved(void **state)
{
    (void)state;
    static const char *const names[] = {"plane-0", "plane-80", "sphere", "waves"};
    for (int s = 0; s < 4; s++) {
        struct lab_test *test = lab_test_create(names[s], 0, 0);
        for (size_t i = 0; i < LAB_TEST_PIXELS; i++) {
            test->depth[i] += (float)(0.25 * LAB_TEST_RADIUS / (double)test->reference.cosine[i]);
        }
        struct lab_values values = lab_test_measure(test);
        assert_near(values.of[LAB_DRIFT], 0.25, 1e-4);
        assert_near(values.of[LAB_DEPTH_RMS], 0.25, 1e-4);
        assert_near(values.of[LAB_DEPTH_WORST], 0.25, 1e-3);
        lab_test_destroy(test);
    }
}

/* Turns a normal about the view axis' right by an angle. */
static void turn_normal(float normal[3], double angle)
{
    double y = (double)normal[1], z = (double)normal[2];
    normal[1] = (float)(cos(angle) * y - sin(angle) * z);
    normal[2] = (float)(sin(angle) * y + cos(angle) * z);
}

/* All normals turned by 3 degrees, and every twentieth pixel by 9: the median, and what 95 % keep. A turn that is the same everywhere is no
 * bump. */
static void test_normals_that_turned(void **state)
{
    (void)state;
    struct lab_test *test = lab_test_create("plane-0", 0, 0);
    for (size_t i = 0; i < LAB_TEST_PIXELS; i++) {
        turn_normal(test->normal + 3 * i, 3 * PI / 180);
    }
    struct lab_values values = lab_test_measure(test);
    assert_near(values.of[LAB_NORMAL_MEDIAN], 3, 0.01);
    assert_near(values.of[LAB_NORMAL_95], 3, 0.01);
    assert_near(values.of[LAB_BUMPS], 0, 1e-3);
    for (size_t i = 0; i < LAB_TEST_PIXELS; i += 10) {
        turn_normal(test->normal + 3 * i, 6 * PI / 180);
    }
    values = lab_test_measure(test);
    assert_near(values.of[LAB_NORMAL_MEDIAN], 3, 0.01);
    assert_near(values.of[LAB_NORMAL_95], 9, 0.01);
    lab_test_destroy(test);
}

/* Adds to the normals a wave of so many pixels along (dx, dy), whose slopes point along it. */
static void add_wave(struct lab_test *test, double pixels, double dx, double dy, double amplitude)
{
    for (int i = 0; i < LAB_TEST_PIXELS; i++) {
        double phase = 2 * PI * (i % LAB_WIDTH_MIN * dx + i / LAB_WIDTH_MIN * dy) / pixels;
        test->normal[3 * i] += (float)(amplitude * dx * sin(phase));
        test->normal[3 * i + 1] -= (float)(amplitude * dy * sin(phase)); /* rows go down */
    }
}

/* A wave of a spacing is all bump, one of twenty is none; along the axes it is a streak, along a diagonal the opposite of one. */
static void test_waves_on_a_plane(void **state)
{
    (void)state;
    static const double half = 0.70710678118654752;
    static const struct {
        double spacings, dx, dy, bumps, streaks;
    } cases[] = {{1, 1, 0, 1, 1}, {1, 0, 1, 1, 1}, {1, half, half, 1, -1}, {1, half, -half, 1, -1}, {20, 1, 0, 0, 1}};
    for (int c = 0; c < 5; c++) {
        static const double amplitude = 0.05;
        struct lab_test *test = lab_test_create("plane-0", 0, 0);
        add_wave(test, cases[c].spacings * LAB_SPACING_PIXELS, cases[c].dx, cases[c].dy, amplitude);
        struct lab_values values = lab_test_measure(test);
        double whole = degrees_of(amplitude / sqrt(2));
        assert_near(values.of[LAB_BUMPS], cases[c].bumps * whole, 0.25 * whole); /* the picture's edges cut the mean */
        assert_near(values.of[LAB_STREAKS], cases[c].streaks, 0.05);
        lab_test_destroy(test);
    }
}

/* The foremost body grown to the right by 3 pixels: an edge of all rows by 3, a disc by the 2 / pi of it. */
static void test_a_silhouette_that_moved(void **state)
{
    (void)state;
    enum { MOVE = 3 };
    static const struct {
        const char *name;
        double edge;
    } cases[] = {{"step", MOVE}, {"drop-0", MOVE * 2 / 3.14159265358979323846}};
    for (int c = 0; c < 2; c++) {
        struct lab_test *test = lab_test_create(cases[c].name, 0, 0);
        for (int i = 0; i < LAB_TEST_PIXELS; i++) {
            int from = i % LAB_WIDTH_MIN < MOVE ? i : i - MOVE;
            test->depth[i] = test->raw[from];
        }
        assert_near(lab_test_measure(test).of[LAB_EDGE], cases[c].edge, 0.03 * MOVE); /* a disc is made of pixels */
        lab_test_destroy(test);
    }
}

/* An error of the plane within 2.1 r of the drop is seen there and there alone. */
static void test_errors_beside_a_drop(void **state)
{
    (void)state;
    for (int near = 0; near < 2; near++) {
        struct lab_test *test = lab_test_create("drop-45", 0, 0);
        const struct lab_reference *reference = &test->reference;
        for (size_t i = 0; i < LAB_TEST_PIXELS; i++) {
            double away = -(double)reference->silhouette[i] / lab_reference_pixels(reference, i, LAB_TEST_RADIUS);
            if (reference->body[i] == 0 && (away < 2.1) == near) {
                test->depth[i] += (float)(0.5 * LAB_TEST_RADIUS / (double)reference->cosine[i]);
                turn_normal(test->normal + 3 * i, 5 * PI / 180);
            }
        }
        struct lab_values values = lab_test_measure(test);
        assert_near(values.of[LAB_BESIDE_DEPTH], near ? 0.5 : 0, 1e-3);
        assert_near(values.of[LAB_BESIDE_NORMAL], near ? 5 : 0, 0.02);
        assert_near(values.of[LAB_NORMAL_95], 5, 0.02); /* it is a twentieth of the picture, or more */
        lab_test_destroy(test);
    }
}

/* A sphere whose normals tilt by half as much, or all as much as at the start of the rim. */
static void test_a_rim_that_is_flattened(void **state)
{
    (void)state;
    for (int flat = 0; flat < 2; flat++) {
        struct lab_test *test = lab_test_create("drop-0", 0, 0);
        for (size_t i = 0; i < LAB_TEST_PIXELS; i++) {
            float *normal = test->normal + 3 * i;
            double across = hypot((double)normal[0], (double)normal[1]), tilt = flat ? 1 : 0.5 * acos((double)normal[2]);
            if (across > 0 && test->reference.body[i] == 1) {
                normal[0] *= (float)(sin(tilt) / across);
                normal[1] *= (float)(sin(tilt) / across);
                normal[2] = (float)cos(tilt);
            }
        }
        assert_near(lab_test_measure(test).of[LAB_RIM], flat ? 0 : 0.5, 1e-3);
        lab_test_destroy(test);
    }
}

/* Normals that are wrong near the picture's edge are the border's, and nothing else's. */
static void test_the_border_is_apart(void **state)
{
    (void)state;
    struct lab_test *test = lab_test_create("waves", 0, 0);
    const double reach = 3.6 * LAB_TEST_RADIUS * LAB_SPACING_PIXELS; /* in the middle */
    for (int i = 0; i < LAB_TEST_PIXELS; i++) {
        int x = i % LAB_WIDTH_MIN, y = i / LAB_WIDTH_MIN;
        if (x < 0.8 * reach || x > LAB_WIDTH_MIN - 0.8 * reach || y < 0.8 * reach || y > LAB_HEIGHT_MIN - 0.8 * reach) {
            turn_normal(test->normal + 3 * i, 7 * PI / 180);
        }
    }
    struct lab_values values = lab_test_measure(test);
    assert_near(values.of[LAB_NORMAL_95], 0, 0.02);
    assert_near(values.of[LAB_BORDER], 7, 0.02);
    lab_test_destroy(test);
}

/* Adds a wave of 20 pixels across the surface, fixed to the picture at `right` pixels. */
static void add_depth_wave(struct lab_test *test, double right, double amplitude)
{
    for (int i = 0; i < LAB_TEST_PIXELS; i++) {
        double error = amplitude * sin(2 * PI * (i % LAB_WIDTH_MIN - right) / 20);
        test->depth[i] += (float)(error * LAB_TEST_RADIUS / (double)test->reference.cosine[i]);
        test->normal[3 * i] += (float)error;
    }
}

/* An error that moves with the surface does not flicker; one that stays in the picture changes by what the move makes of it. */
static void test_flicker(void **state)
{
    (void)state;
    static const double right = 1.0 / 3, down = 0.2, amplitude = 0.1;
    for (int stays = 0; stays < 2; stays++) {
        struct lab_test *from = lab_test_create("waves", 0, 0), *to = lab_test_create("waves", right, down);
        struct lab_residual a, b;
        struct lab_values values = lab_values_none();
        add_depth_wave(from, 0, amplitude);
        add_depth_wave(to, stays ? 0 : right, amplitude);
        assert_true(lab_residual_make(&a, &from->reference, from->depth, from->normal));
        assert_true(lab_residual_make(&b, &to->reference, to->depth, to->normal));
        lab_measure_flicker(&a, &b, right, down, &values);
        double change = stays ? 2 * amplitude * sin(PI * right / 20) / sqrt(2) : 0;
        assert_near(values.of[LAB_FLICKER_DEPTH], change, 3e-4); /* of 0.1: the cubic between pixels, and float32 depths */
        assert_near(values.of[LAB_FLICKER_NORMAL], degrees_of(change), degrees_of(3e-4));
        lab_residual_free(&a);
        lab_residual_free(&b);
        lab_test_destroy(from);
        lab_test_destroy(to);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_the_truth_has_no_error),
        cmocka_unit_test(test_a_surface_that_moved),
        cmocka_unit_test(test_normals_that_turned),
        cmocka_unit_test(test_waves_on_a_plane),
        cmocka_unit_test(test_a_silhouette_that_moved),
        cmocka_unit_test(test_errors_beside_a_drop),
        cmocka_unit_test(test_a_rim_that_is_flattened),
        cmocka_unit_test(test_the_border_is_apart),
        cmocka_unit_test(test_flicker),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
