/* Every filter by the lab's measures: what each keeps to, that sigma is a fraction of a pixel, and that no scene breaks one. */
#include "lab/lab_test.h"

static struct lab *lab_begin(void)
{
    struct lab_settings settings = {.width = LAB_WIDTH_MIN, .height = LAB_HEIGHT_MIN, .repeat = 1, .threads = 2};
    struct lab *lab = calloc(1, sizeof(*lab));
    assert_non_null(lab);
    mns_params_init(&settings.params);
    assert_int_equal(lab_create(lab, &settings), MNS_OK);
    return lab;
}

static void lab_end(struct lab *lab)
{
    lab_destroy(lab);
    free(lab);
}

/* ---- bounds ---- */

static const char *const planes[] = {"plane-0", "plane-45", "plane-70", "plane-80"};
enum { PLANES = 4 };

/* What a filter keeps to: a fifth above what the lab measures on the same scenes. Lengths in r, angles in degrees; INFINITY: not promised. */
static const struct bounds {
    const char *filter;
    double normal_95[PLANES]; /* 95 % of the normals of a plane are nearer to it */
    double drift[PLANES];     /* mean depth error of a plane */
    double edge;              /* pixels that a silhouette moves */
    double beside;            /* median error of the normals of an inclined plane beside a drop */
} bounds[] = {
/* Depth is no linear function of the pixel on a plane that is seen at a slant (its inverse is), so that means of it lie farther away: a drift that
 * grows with the tilt. The bias correction keeps the plane beside the drop; rows and columns each see less of it than a square. */
#define SLANTED                                                                                                                            \
    {                                                                                                                                      \
        0.02, 0.02, 0.06, 0.14                                                                                                             \
    }
    {"narrow-range", {5, 3.4, 1.9, 1.3}, SLANTED, 0, 3.5},
    {"narrow-range-1d", {4.5, 3.1, 1.7, 1.2}, SLANTED, 0, 4.5},
    {"narrow-range-1d-cleanup", {4.5, 3.1, 1.7, 1.2}, SLANTED, 0, 4.5},
    {"gaussian", {4.5, 3.1, 1.7, 1.2}, SLANTED, INFINITY, INFINITY}, /* joins what lies apart */
    /* Depths across a slanted surface differ by as much as those of two surfaces: little is smoothed ([TY18] 2). */
    {"bilateral", {5, 3.6, 6.5, 21}, SLANTED, 0, INFINITY},
    {"bilateral-1d", {4.5, 3.3, 3.1, 7}, SLANTED, 0, INFINITY},
    /* A number of explicit steps that is bounded smooths less where the surface is slanted (the root of the cosine), and nearer. */
    {"curvature-flow", {5.8, 5.5, 6.2, 11}, SLANTED, 0, INFINITY},
    {"adaptive-curvature-flow", {5.6, 7, 9, 12}, SLANTED, 0, INFINITY},
    {"implicit-curvature-flow", {5.9, 3.8, 2.3, 1.6}, SLANTED, 0, INFINITY},
    {"plane-fit", {5, 3.4, 2.2, 1.8}, {0.02, 0.02, 0.02, 0.02}, 0, 3.5},          /* planes are what it fits */
    {"smoothing-spline", {2.9, 1.9, 1.2, 0.9}, {0.02, 0.02, 0.02, 0.02}, 0, 1.9}, /* straight lines in inverse depth stay */
    {"", {6, 6, 6, 6}, SLANTED, 0, INFINITY},                                     /* any other, until it has a line of its own */
#undef SLANTED
};

static const struct bounds *bounds_of(int filter)
{
    const struct bounds *found = bounds;
    while (*found->filter && strcmp(found->filter, lab_filter_name(filter)) != 0) {
        found++;
    }
    return found;
}

static void check(const char *what, int filter, const char *scene, double value, double bound)
{
    if (!(fabs(value) <= bound)) {
        fail_msg("%s of %s in %s: %.4g is not within %.4g", what, lab_filter_name(filter), scene, value, bound);
    }
}

static void test_planes_are_kept(void **state)
{
    (void)state;
    struct lab *lab = lab_begin();
    for (int p = 0; p < PLANES; p++) {
        assert_int_equal(lab_enter(lab, lab_scene_find(planes[p])), MNS_OK);
        for (int filter = MNS_FILTER_NONE + 1; filter < lab_filter_count(); filter++) {
            const struct bounds *bound = bounds_of(filter);
            struct mns_params params = lab_params(lab, filter);
            struct lab_values values;
            assert_int_equal(lab_run(lab, &params, &values), MNS_OK);
            check("95 % of the normals", filter, planes[p], values.of[LAB_NORMAL_95], bound->normal_95[p]);
            check("the drift", filter, planes[p], values.of[LAB_DRIFT], bound->drift[p]);
        }
    }
    lab_end(lab);
}

static void test_silhouettes_and_what_is_beside_them(void **state)
{
    (void)state;
    struct lab *lab = lab_begin();
    assert_int_equal(lab_enter(lab, lab_scene_find("drop-45")), MNS_OK);
    for (int filter = MNS_FILTER_NONE + 1; filter < lab_filter_count(); filter++) {
        const struct bounds *bound = bounds_of(filter);
        struct mns_params params = lab_params(lab, filter);
        struct lab_values values;
        assert_int_equal(lab_run(lab, &params, &values), MNS_OK);
        check("the silhouette", filter, "drop-45", values.of[LAB_EDGE], bound->edge);
        check("the plane beside the drop", filter, "drop-45", values.of[LAB_BESIDE_NORMAL], bound->beside);
    }
    lab_end(lab);
}

/* ---- sigma ---- */

/* The part of the pixels that a millionth of the sigmas moves by more than 1e-4 r. */
static double moved_by_a_millionth(struct lab *lab, int filter, float *room)
{
    struct mns_params params = lab_params(lab, filter);
    assert_int_equal(lab_draw(lab, &params, 0, 1, NULL), MNS_OK);
    memcpy(room, lab->depth, LAB_TEST_PIXELS * sizeof(*room));
    params.sigma *= 1.000001f;
    params.flow_sigma *= 1.000001f;
    assert_int_equal(lab_draw(lab, &params, 0, 1, NULL), MNS_OK);
    double moved = 0;
    for (int i = 0; i < LAB_TEST_PIXELS; i++) {
        moved += fabs((double)lab->depth[i] - (double)room[i]) > 1e-4 * LAB_TEST_RADIUS;
    }
    return moved / LAB_TEST_PIXELS;
}

static void test_sigma_has_no_steps(void **state)
{
    (void)state;
    struct lab *lab = lab_begin();
    float *room = malloc(LAB_TEST_PIXELS * sizeof(*room));
    assert_non_null(room);
    static const char *const scenes[] = {"plane-80", "drop-45", "waves", "waves-far"};
    for (int i = 0; i < 4; i++) {
        assert_int_equal(lab_enter(lab, lab_scene_find(scenes[i])), MNS_OK);
        for (int filter = MNS_FILTER_NONE; filter < lab_filter_count(); filter++) {
            check("pixels moved by a millionth of sigma", filter, scenes[i], moved_by_a_millionth(lab, filter, room), 1e-3);
        }
    }
    free(room);
    lab_end(lab);
}

/* ---- extremes ---- */

enum { WIDTH = 97, HEIGHT = 61, PIXELS = WIDTH * HEIGHT, PARTICLES = 64 };

static const struct extreme {
    const char *what;
    double spread, radius, distance; /* metres: particles fill a cube of this half side, so far before the eye */
} extremes[] = {
    {"one heap", 0, 1, 5},
    {"a dust of distant points", 1e3, 1e-3, 3e3},
    {"spheres that fill the picture", 1, 100, 300},
    {"the eye inside", 1, 0.2, 0},
    {"an atom", 1e-10, 1e-11, 3e-10},
    {"an orbit", 1e11, 1e10, 3e11},
    {"a wall at the lens", 0.01, 0.02, 0.05},
};

static void place(float positions[PARTICLES][3], const struct extreme *extreme)
{
    uint64_t seed = 1;
    for (int i = 0; i < PARTICLES; i++) {
        for (int k = 0; k < 3; k++) {
            seed = seed * 6364136223846793005u + 1442695040888963407u;
            double uniform = (double)(seed >> 40) / (1 << 23) - 1;
            positions[i][k] = (float)(extreme->spread * uniform - (k == 2 ? extreme->distance : 0));
        }
    }
}

static void draw_extreme(mns_renderer *renderer, const struct extreme *extreme, int filter)
{
    static float raw[PIXELS], depth[PIXELS], normal[PIXELS][3];
    struct mns_image image = {.width = WIDTH, .height = HEIGHT, .channels = 1};
    struct mns_output outputs[] = {{MNS_LAYER_DEPTH_RAW, image}, {MNS_LAYER_DEPTH, image}, {MNS_LAYER_NORMAL, image}};
    outputs[0].image.data = raw;
    outputs[1].image.data = depth;
    outputs[2].image.data = normal;
    outputs[2].image.channels = 3;
    struct mns_params params;
    struct mns_camera camera;
    struct mns_frame frame;
    mns_params_init(&params);
    params.filter = filter;
    params.radius = (float)extreme->radius;
    params.floor = params.shadow = 0;
    mns_camera_init(&camera, WIDTH, HEIGHT);
    assert_int_equal(mns_camera_perspective(&camera, 60, 0.01 * extreme->radius, INFINITY), MNS_OK);
    mns_frame_init(&frame);
    frame.camera = &camera;
    frame.params = &params;
    frame.outputs = outputs;
    frame.output_count = 3;
    assert_int_equal(mns_renderer_draw(renderer, &frame), MNS_OK);
    for (int i = 0; i < PIXELS; i++) {
        double length = hypot(hypot((double)normal[i][0], (double)normal[i][1]), (double)normal[i][2]);
        bool fluid = isfinite(raw[i]);
        if (fluid ? !(depth[i] > 0 && isfinite(depth[i]) && fabs(length - 1) < 1e-4) : !(depth[i] == INFINITY && length == 0)) {
            fail_msg("%s, %s: pixel %d, %d: raw %g, depth %g, normal of length %g", extreme->what, lab_filter_name(filter), i % WIDTH,
                     i / WIDTH, (double)raw[i], (double)depth[i], length);
        }
    }
}

/* Whatever the scene, fluid stays where it was, at depths that are numbers. */
static void test_no_scene_breaks_a_filter(void **state)
{
    (void)state;
    mns_renderer *renderer;
    assert_int_equal(mns_renderer_create(&renderer, NULL, NULL), MNS_OK);
    for (size_t e = 0; e < sizeof(extremes) / sizeof(extremes[0]); e++) {
        float positions[PARTICLES][3];
        struct mns_particles particles;
        place(positions, &extremes[e]);
        mns_particles_init(&particles);
        particles.count = PARTICLES;
        particles.position = (struct mns_attr){.data = positions, .type = MNS_F32};
        assert_int_equal(mns_renderer_prepare(renderer, &particles), MNS_OK);
        for (int filter = MNS_FILTER_NONE; filter < lab_filter_count(); filter++) {
            draw_extreme(renderer, &extremes[e], filter);
        }
    }
    mns_renderer_destroy(&renderer);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_planes_are_kept),
        cmocka_unit_test(test_silhouettes_and_what_is_beside_them),
        cmocka_unit_test(test_sigma_has_no_steps),
        cmocka_unit_test(test_no_scene_breaks_a_filter),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
