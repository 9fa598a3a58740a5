/* lab_test.h: what the tests of the lab share: pictures made from the closed forms, without particles. */
#ifndef MNS_TESTS_LAB_TEST_H
#define MNS_TESTS_LAB_TEST_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "lab/run.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { LAB_TEST_PIXELS = LAB_WIDTH_MIN * LAB_HEIGHT_MIN };

static const struct lab_offsets LAB_TEST_OFFSETS = {{0.31, 0.42}};
static const double LAB_TEST_RADIUS = 0.6;

/* The truth as a picture: a scene whose surface nothing disturbs. Errors are added to depth and normal. */
struct lab_test {
    struct lab_view view;
    struct lab_scene scene;
    struct lab_reference reference;
    float raw[LAB_TEST_PIXELS], depth[LAB_TEST_PIXELS], normal[3 * LAB_TEST_PIXELS];
};

static inline struct lab_test *lab_test_create(const char *scene, double right, double down)
{
    struct lab_test *test = calloc(1, sizeof(*test));
    assert_non_null(test);
    struct lab_view view = lab_view_make(LAB_WIDTH_MIN, LAB_HEIGHT_MIN);
    test->view = lab_view_shift(&view, right, down);
    assert_true(lab_scene_find(scene) >= 0);
    lab_scene_make(&test->scene, lab_scene_find(scene), &view);
    for (int i = 0; i < LAB_TEST_PIXELS; i++) {
        double ray[3];
        lab_view_ray(&test->view, i % LAB_WIDTH_MIN, i / LAB_WIDTH_MIN, ray);
        struct lab_hit hit = lab_scene_hit(&test->scene, ray, &LAB_TEST_OFFSETS);
        test->raw[i] = test->depth[i] = (float)hit.depth;
        for (int k = 0; k < 3; k++) {
            test->normal[3 * i + k] = (float)hit.normal[k];
        }
    }
    assert_true(lab_reference_fill(&test->reference, &test->scene, &test->view, test->raw, LAB_TEST_RADIUS, &LAB_TEST_OFFSETS));
    return test;
}

static inline void lab_test_destroy(struct lab_test *test)
{
    lab_reference_free(&test->reference);
    free(test);
}

static inline struct lab_values lab_test_measure(const struct lab_test *test)
{
    struct lab_values values = lab_values_none();
    struct lab_residual residual;
    assert_true(lab_residual_make(&residual, &test->reference, test->depth, test->normal));
    assert_true(lab_measure(&residual, test->raw, test->depth, &values));
    lab_residual_free(&residual);
    return values;
}

static inline void assert_near(double is, double should, double tolerance)
{
    if (!(fabs(is - should) <= tolerance)) {
        fail_msg("%.9g is not %.9g within %.3g", is, should, tolerance);
    }
}

#endif
