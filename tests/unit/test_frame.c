/* Frames: what the caller says, checked; what is `auto`, told. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "core/frame.h"

/* A frame over a camera, with facts of 2000 particles of spacing 0.1. */
struct fixture {
    struct mns_camera camera;
    struct mns_params params;
    struct mns_frame frame;
    struct particle_facts facts;
    struct frame resolved;
    struct mns_message message;
};

static void set_up(struct fixture *f)
{
    memset(f, 0, sizeof(*f));
    mns_camera_init(&f->camera, 64, 48);
    mns_params_init(&f->params);
    mns_frame_init(&f->frame);
    f->frame.camera = &f->camera;
    f->frame.params = &f->params;
    f->facts = (struct particle_facts){.count = 2000, .spacing = 0.1, .radius = 0.05, .origin = {1, 2, 3}};
    for (int k = 0; k < 3; k++) {
        f->facts.bounds_min[k] = -2;
        f->facts.bounds_max[k] = 2;
    }
}

static mns_result resolve(struct fixture *f)
{
    f->message.text[0] = '\0';
    return mns_frame_resolve(&f->resolved, &f->frame, &f->facts, &f->message);
}

static void assert_refused(struct fixture *f, const char *words)
{
    assert_int_equal(resolve(f), MNS_ERR_INVALID_ARGUMENT);
    if (!strstr(f->message.text, words)) {
        fail_msg("'%s' is not in '%s'", words, f->message.text);
    }
}

/* Where a world point falls, by the matrices themselves. */
static void project(const struct mns_camera *camera, const double world[3], double pixel[2])
{
    double view[4] = {0}, clip[4] = {0}, p[4] = {world[0], world[1], world[2], 1};
    for (int row = 0; row < 4; row++) {
        for (int k = 0; k < 4; k++) {
            view[row] += camera->view[4 * k + row] * p[k];
        }
    }
    for (int row = 0; row < 4; row++) {
        for (int k = 0; k < 4; k++) {
            clip[row] += camera->projection[4 * k + row] * view[k];
        }
    }
    pixel[0] = (clip[0] / clip[3] + 1) / 2 * camera->width;
    pixel[1] = (1 - clip[1] / clip[3]) / 2 * camera->height;
}

static void assert_view_agrees(struct fixture *f)
{
    assert_int_equal(resolve(f), MNS_OK);
    const struct view *v = &f->resolved.view;
    static const double points[][3] = {{1, 2, 3}, {0, 0, 0}, {2.5, 1, -1}, {-1, 3, 2}};
    for (size_t i = 0; i < sizeof(points) / sizeof(points[0]); i++) {
        double q[3], pixel[2];
        for (int row = 0; row < 3; row++) {
            q[row] = (double)v->translation[row];
            for (int k = 0; k < 3; k++) {
                q[row] += (double)v->rotation[3 * row + k] * (points[i][k] - f->facts.origin[k]);
            }
        }
        assert_true(q[2] > 0);
        double scale = v->orthographic ? 1 : 1 / q[2];
        project(&f->camera, points[i], pixel);
        assert_true(fabs((double)v->cx + (double)v->fx * q[0] * scale - pixel[0]) < 1e-3);
        assert_true(fabs((double)v->cy + (double)v->fy * q[1] * scale - pixel[1]) < 1e-3);
    }
}

static void views_agree_with_the_matrices(void **state)
{
    (void)state;
    struct fixture f;
    set_up(&f);
    const double eye[3] = {4, 5, 9}, target[3] = {1, 2, 2}, up[3] = {0.1, 1, 0};
    assert_int_equal(mns_camera_look_at(&f.camera, eye, target, up), MNS_OK);
    assert_view_agrees(&f);
    assert_int_equal(mns_camera_frustum(&f.camera, -0.1, 0.3, -0.05, 0.2, 0.2, 100), MNS_OK);
    assert_view_agrees(&f);
    assert_int_equal(mns_camera_orthographic(&f.camera, 5, 0.1, 100), MNS_OK);
    f.camera.projection[12] = 0.25; /* off-centre */
    f.camera.projection[13] = -0.5;
    assert_view_agrees(&f);
    assert_int_equal(mns_camera_orthographic(&f.camera, 5, -3, 100), MNS_OK);
    assert_view_agrees(&f);
    assert_true(f.resolved.view.near_plane > 0 && f.resolved.view.near_plane < 1e-6f); /* depths are positive */
}

static void wrong_cameras_are_refused(void **state)
{
    (void)state;
    struct fixture f;
    set_up(&f);
    f.camera.width = 0;
    assert_refused(&f, "0 x 48");
    set_up(&f);
    f.camera.view[0] = 2;
    assert_refused(&f, "scales");
    set_up(&f);
    f.camera.view[0] = -1;
    assert_refused(&f, "mirrors");
    set_up(&f);
    f.camera.view[12] = NAN;
    assert_refused(&f, "not finite");
    set_up(&f);
    f.camera.projection[4] = 0.1;
    assert_refused(&f, "neither");
    set_up(&f);
    f.camera.projection[0] = -f.camera.projection[0];
    assert_refused(&f, "mirrors");
    set_up(&f);
    f.camera.projection[0] = 1e30;
    assert_refused(&f, "focal lengths");
    set_up(&f);
    f.camera.projection[8] = -1e30;
    assert_refused(&f, "centre");
    set_up(&f);
    f.camera.near_plane = 0;
    assert_refused(&f, "near plane");
    set_up(&f);
    f.camera.far_plane = f.camera.near_plane;
    assert_refused(&f, "far");
    set_up(&f);
    f.frame.camera = NULL;
    assert_refused(&f, "camera");
}

static void wrong_outputs_are_refused(void **state)
{
    (void)state;
    static float pixels[64 * 48 * 4];
    struct fixture f;
    set_up(&f);
    struct mns_output outputs[2] = {
        {MNS_LAYER_DEPTH, {.data = pixels, .width = 64, .height = 48, .channels = 1, .pixel = MNS_PIXEL_F32}},
        {MNS_LAYER_BEAUTY, {.data = pixels, .width = 64, .height = 48, .channels = 4, .pixel = MNS_PIXEL_U8}},
    };
    const struct mns_output right[2] = {outputs[0], outputs[1]};
    f.frame.outputs = outputs;
    f.frame.output_count = 2;
    assert_int_equal(resolve(&f), MNS_OK);
    assert_int_equal(f.resolved.wanted, 1u << MNS_LAYER_DEPTH | 1u << MNS_LAYER_BEAUTY);
    assert_ptr_equal(mns_frame_output(&f.resolved, MNS_LAYER_BEAUTY), &outputs[1].image);
    assert_null(mns_frame_output(&f.resolved, MNS_LAYER_NORMAL));

    outputs[0].image.width = 63;
    assert_refused(&f, "63 x 48");
    outputs[0] = right[0];
    outputs[0].image.channels = 3;
    assert_refused(&f, "channels");
    outputs[0] = right[0];
    outputs[0].image.pixel = MNS_PIXEL_U8;
    assert_refused(&f, "float32");
    outputs[0] = right[0];
    outputs[0].image.stride = 64 * 4 - 4;
    assert_refused(&f, "stride");
    outputs[0] = right[0];
    outputs[0].image.data = NULL;
    assert_refused(&f, "no data");
    outputs[0] = right[1];
    assert_refused(&f, "twice");
    outputs[0].layer = (enum mns_layer)99;
    assert_refused(&f, "unknown layer");
}

static void sizes_follow_the_particles(void **state)
{
    (void)state;
    struct fixture f;
    set_up(&f);
    assert_int_equal(resolve(&f), MNS_OK);
    assert_true(fabsf(f.resolved.splat_radius - 0.06f) < 1e-6f);
    assert_true(f.resolved.splat_scale == 0);
    assert_true(fabsf(f.resolved.volume - 1e-3f) < 1e-8f);
    assert_true(fabs((double)f.resolved.fluid_size - cbrt(2.0)) < 1e-5);
    assert_true(fabsf(f.resolved.absorption[0] * f.resolved.fluid_size - f.params.absorption_relative[0]) < 1e-5f);

    f.facts.has_mass = true; /* with a rest density the masses decide */
    f.facts.mass_sum = 4000;
    f.params.rest_density = 1000;
    assert_int_equal(resolve(&f), MNS_OK);
    assert_true(fabsf(f.resolved.volume_per_mass - 1e-3f) < 1e-9f);
    assert_true(fabs((double)f.resolved.fluid_size - cbrt(4.0)) < 1e-5);

    set_up(&f); /* own radii: volumes go with their cubes */
    f.facts.has_radius = true;
    f.facts.radius_cubed_sum = 2000 * 0.05 * 0.05 * 0.05;
    assert_int_equal(resolve(&f), MNS_OK);
    assert_true(f.resolved.splat_scale == f.params.radius_scale);
    assert_true(fabs((double)f.resolved.volume_per_cube * 0.05 * 0.05 * 0.05 - 1e-3) < 1e-8);
    f.params.radius = 0.1f; /* one that is asked for overrides them */
    assert_int_equal(resolve(&f), MNS_OK);
    assert_true(f.resolved.splat_scale == 0);
    assert_true(f.resolved.volume_per_cube == 0);

    set_up(&f); /* few particles: their spacing is no measure of a volume */
    f.facts.count = 100;
    f.params.radius = 0.1f;
    assert_int_equal(resolve(&f), MNS_OK);
    assert_true(fabsf(f.resolved.volume - 8e-3f) < 1e-7f);

    set_up(&f); /* one particle of which nothing is known */
    f.facts.count = 1;
    f.facts.spacing = f.facts.radius = 0;
    assert_int_equal(resolve(&f), MNS_OK);
    assert_true(f.resolved.splat_radius > 0 && isfinite(f.resolved.fluid_size) && f.resolved.fluid_size > 0);
}

static void the_sun_and_the_floor_follow_the_up_axis(void **state)
{
    (void)state;
    struct fixture f;
    for (int axis = 0; axis < 3; axis++) {
        set_up(&f);
        f.params.up_axis = axis;
        f.params.sun_elevation = 30;
        f.params.sun_azimuth = 90; /* to the right of the framed camera's straight view */
        assert_int_equal(resolve(&f), MNS_OK);
        int right = axis == 0 ? 1 : 0;
        assert_true(fabsf(f.resolved.look.sun[axis] - 0.5f) < 1e-6f);
        assert_true(fabsf(f.resolved.look.sun[right] - sqrtf(0.75f)) < 1e-6f);
        assert_true(fabsf(f.resolved.look.floor_height - (-2 - f.resolved.splat_radius)) < 1e-6f);
        f.params.floor_height = 7;
        assert_int_equal(resolve(&f), MNS_OK);
        assert_true(fabs((double)f.resolved.look.floor_height - (7 - f.facts.origin[axis])) < 1e-5);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(views_agree_with_the_matrices),
        cmocka_unit_test(wrong_cameras_are_refused),
        cmocka_unit_test(wrong_outputs_are_refused),
        cmocka_unit_test(sizes_follow_the_particles),
        cmocka_unit_test(the_sun_and_the_floor_follow_the_up_axis),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
