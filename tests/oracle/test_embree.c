/* Depth and chords of spheres against a ray caster that shares no code: Embree's sphere primitives. Rays are made here from the camera's matrices, in
 * double. */
#include <embree3/rtcore.h>

#include "unit/picture_test.h"

#include <limits.h>

enum { WIDTH = 160, HEIGHT = 120, COUNT = 1500 };

/* One ray: every sphere's way in and out beyond `from`, and what they sum to. */
struct cast {
    struct RTCIntersectContext context;
    double from;    /* distance along the ray at which sight begins */
    double nearest; /* distance of what is seen first */
    double chords;  /* metres */
    double inside;  /* spheres that the ray begins in */
    double grazing; /* the smallest cosine between the ray and a surface it meets */
};

/* Takes every hit, and lets the ray go on. */
static void take_hit(const struct RTCFilterFunctionNArguments *hit)
{
    struct cast *cast = (struct cast *)(void *)hit->context;
    assert_int_equal(hit->N, 1); /* rays are cast one by one: what follows is then one of each */
    struct RTCRay ray = *(const struct RTCRay *)(const void *)hit->ray;
    struct RTCHit at = *(const struct RTCHit *)(const void *)hit->hit;
    float along = ray.dir_x * at.Ng_x + ray.dir_y * at.Ng_y + ray.dir_z * at.Ng_z;
    float length = sqrtf(at.Ng_x * at.Ng_x + at.Ng_y * at.Ng_y + at.Ng_z * at.Ng_z), t = ray.tfar;
    bool enters = along < 0;
    cast->chords += enters ? -(double)t : (double)t;
    cast->inside += enters ? -1 : 1;
    cast->nearest = enters && t < (float)cast->nearest ? (double)t : cast->nearest;
    cast->grazing = fmin(cast->grazing, fabs((double)along) / (double)length);
    hit->valid[0] = 0;
}

static RTCScene scene_of(RTCDevice device, float (*position)[3], float *radius)
{
    RTCScene scene = rtcNewScene(device);
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
    RTCGeometry spheres = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_SPHERE_POINT);
    float(*vertex)[4] = rtcSetNewGeometryBuffer(spheres, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, sizeof(*vertex), COUNT);
    assert_non_null(vertex);
    for (int i = 0; i < COUNT; i++) {
        memcpy(vertex[i], position[i], sizeof(*position));
        vertex[i][3] = radius[i];
    }
    rtcSetGeometryIntersectFilterFunction(spheres, take_hit);
    rtcCommitGeometry(spheres);
    rtcAttachGeometry(scene, spheres);
    rtcReleaseGeometry(spheres);
    rtcCommitScene(scene);
    return scene;
}

/* From view space to the world: view is a rotation and a translation. */
static void to_world(const struct mns_camera *camera, const double point[3], double translate, double out[3])
{
    const double *view = camera->view; /* column-major */
    for (int i = 0; i < 3; i++) {
        out[i] = 0;
        for (int k = 0; k < 3; k++) {
            out[i] += view[4 * i + k] * (point[k] - translate * view[12 + k]);
        }
    }
}

/* Distance along the ray per metre of depth. */
static double cast_pixel(RTCScene scene, const struct mns_camera *camera, int x, int y, struct cast *cast)
{
    const double *p = camera->projection;
    bool parallel = p[11] == 0;
    double clip_x = 2 * (x + 0.5) / WIDTH - 1, clip_y = 1 - 2 * (y + 0.5) / HEIGHT;
    /* row 0: clip = p0 X + p8 Z + p12; a perspective divides by w = -Z */
    double right = parallel ? (clip_x - p[12]) / p[0] : (clip_x + p[8]) / p[0],
           up = parallel ? (clip_y - p[13]) / p[5] : (clip_y + p[9]) / p[5];
    double direction[3] = {parallel ? 0 : right, parallel ? 0 : up, -1}, origin[3] = {parallel ? right : 0, parallel ? up : 0, 0}, d[3],
           o[3];
    double length = sqrt(direction[0] * direction[0] + direction[1] * direction[1] + 1);
    to_world(camera, direction, 0, d);
    to_world(camera, origin, 1, o);
    rtcInitIntersectContext(&cast->context);
    cast->from = camera->near_plane * length;
    cast->nearest = INFINITY;
    cast->chords = cast->inside = 0;
    cast->grazing = 1;
    struct RTCRayHit ray = {.ray = {.org_x = (float)o[0],
                                    .org_y = (float)o[1],
                                    .org_z = (float)o[2],
                                    .dir_x = (float)(d[0] / length),
                                    .dir_y = (float)(d[1] / length),
                                    .dir_z = (float)(d[2] / length),
                                    .tnear = (float)cast->from,
                                    .tfar = INFINITY,
                                    .mask = UINT_MAX},
                            .hit = {.geomID = RTC_INVALID_GEOMETRY_ID, .instID = {RTC_INVALID_GEOMETRY_ID}}};
    rtcIntersect1(scene, &cast->context, &ray);
    cast->chords -= cast->inside * cast->from; /* what is cut by the near plane begins there */
    if (cast->inside > 0.5) {
        cast->nearest = cast->from;
    }
    return length;
}

static void layers_of(const struct mns_camera *camera, float (*position)[3], float *radius, float *depth, float *thickness)
{
    struct mns_params params;
    mns_params_init(&params);
    params.filter = MNS_FILTER_NONE;
    params.radius_scale = 1;
    params.thickness_mode = MNS_THICKNESS_CHORD;
    params.thickness_scale = 1;
    struct mns_particles particles;
    mns_particles_init(&particles);
    particles.count = COUNT;
    particles.position = (struct mns_attr){.data = position, .type = MNS_F32};
    particles.radius = (struct mns_attr){.data = radius, .type = MNS_F32};
    const struct mns_output outputs[] = {{MNS_LAYER_DEPTH_RAW, {.data = depth, .width = WIDTH, .height = HEIGHT, .channels = 1}},
                                         {MNS_LAYER_THICKNESS_RAW, {.data = thickness, .width = WIDTH, .height = HEIGHT, .channels = 1}}};
    struct mns_frame frame;
    mns_frame_init(&frame);
    frame.camera = camera;
    frame.params = &params;
    frame.outputs = outputs;
    frame.output_count = 2;
    mns_renderer *renderer;
    assert_int_equal(mns_renderer_create(&renderer, NULL, NULL), MNS_OK);
    assert_int_equal(mns_renderer_prepare(renderer, &particles), MNS_OK);
    assert_int_equal(mns_renderer_draw(renderer, &frame), MNS_OK);
    mns_renderer_destroy(&renderer);
}

/* Both sides round to float some metres from the eye: where a ray meets a sphere is known to that over the cosine between the two. Where that cosine is
 * less than GRAZING, and the chord itself is within rounding of none, nothing is compared. Depths differ by 3e-6 m and sums of some ten chords
 * by 2e-5 m at most, in spheres of 0.02 to 0.08 m. */
static const double DEPTH_TOLERANCE = 1e-5, CHORDS_TOLERANCE = 5e-5, GRAZING = 0.05;

struct deviation {
    double depth, chords;  /* worst where no sphere is grazed, metres */
    int seen, other, rims; /* pixels with fluid, where only one side sees any, with a grazed sphere */
};

static struct deviation deviation_of(RTCDevice device, const struct mns_camera *camera, uint64_t seed, float least, float most)
{
    static float position[COUNT][3], radius[COUNT], depth[HEIGHT][WIDTH], thickness[HEIGHT][WIDTH];
    for (int i = 0; i < COUNT; i++) {
        for (int k = 0; k < 3; k++) {
            position[i][k] = (float)noise(&seed);
        }
        radius[i] = least + (most - least) * 0.5f * (float)(noise(&seed) + 1);
    }
    RTCScene scene = scene_of(device, position, radius);
    layers_of(camera, position, radius, depth[0], thickness[0]);
    struct deviation worst = {0};
    for (int y = 0; y < HEIGHT; y++) {
        for (int x = 0; x < WIDTH; x++) {
            struct cast cast;
            double per_depth = cast_pixel(scene, camera, x, y, &cast);
            worst.seen += isfinite(cast.nearest) != 0;
            if (cast.grazing < GRAZING) {
                worst.rims++;
                continue;
            }
            if (isfinite(cast.nearest) != isfinite(depth[y][x])) {
                worst.other++;
                continue;
            }
            if (isfinite(cast.nearest)) {
                worst.depth = fmax(worst.depth, fabs(cast.nearest / per_depth - (double)depth[y][x]));
            }
            worst.chords = fmax(worst.chords, fabs(cast.chords - (double)thickness[y][x]));
        }
    }
    rtcReleaseScene(scene);
    return worst;
}

static void expect(const char *name, struct deviation worst, int least_seen)
{
    print_message("%-12s %5d pixels with fluid, %4d grazed: depth within %.2g m, sum of chords within %.2g m, %d seen by one side only\n",
                  name, worst.seen, worst.rims, worst.depth, worst.chords, worst.other);
    assert_true(worst.seen >= least_seen && worst.rims < worst.seen / 50);
    assert_true(worst.other <= 2);
    assert_true(worst.depth <= DEPTH_TOLERANCE);
    assert_true(worst.chords <= CHORDS_TOLERANCE);
}

static const double UP[3] = {0.1, 1, 0}, MIDDLE[3] = {0.05, -0.1, 0};

static struct mns_camera camera_at(double x, double y, double z, const double target[3])
{
    struct mns_camera camera;
    mns_camera_init(&camera, WIDTH, HEIGHT);
    const double eye[3] = {x, y, z};
    assert_int_equal(mns_camera_look_at(&camera, eye, target, UP), MNS_OK);
    return camera;
}

static void test_an_ordinary_view(void **state)
{
    struct mns_camera camera = camera_at(1.5, 1.2, 3, MIDDLE);
    expect("ordinary", deviation_of(*state, &camera, 1, 0.02f, 0.06f), 4000);
}

static void test_the_corners_of_a_wide_view(void **state)
{
    struct mns_camera camera = camera_at(0.3, 0.2, 1.3, MIDDLE);
    assert_int_equal(mns_camera_perspective(&camera, 130, 0.01, 100), MNS_OK);
    expect("wide", deviation_of(*state, &camera, 2, 0.03f, 0.08f), 1000);
}

static void test_a_view_off_the_centre(void **state)
{
    struct mns_camera camera = camera_at(1, 0.5, 3, MIDDLE);
    assert_int_equal(mns_camera_frustum(&camera, -0.1, 0.5, -0.35, 0.1, 1, 100), MNS_OK);
    expect("off-centre", deviation_of(*state, &camera, 3, 0.02f, 0.06f), 2000);
}

static void test_a_parallel_view(void **state)
{
    struct mns_camera camera = camera_at(1, 2, 3, MIDDLE);
    assert_int_equal(mns_camera_orthographic(&camera, 2, 0.1, 100), MNS_OK);
    expect("parallel", deviation_of(*state, &camera, 4, 0.02f, 0.06f), 4000);
}

/* The eye is among the spheres, the near plane and the picture's edge cut some. */
static void test_spheres_that_are_cut(void **state)
{
    const double target[3] = {1, 0.3, -0.2};
    struct mns_camera camera = camera_at(0, 0, 0, target);
    assert_int_equal(mns_camera_perspective(&camera, 70, 0.2, 100), MNS_OK);
    expect("cut", deviation_of(*state, &camera, 5, 0.02f, 0.07f), 4000);
}

/* What the tolerances are for: radii wrong by a thousandth are found. */
static void test_a_wrong_radius_would_be_found(void **state)
{
    struct mns_camera camera = camera_at(1.5, 1.2, 3, MIDDLE);
    static float position[COUNT][3], radius[COUNT], larger[COUNT], depth[HEIGHT][WIDTH], thickness[HEIGHT][WIDTH], other[HEIGHT][WIDTH];
    uint64_t seed = 1;
    for (int i = 0; i < COUNT; i++) {
        for (int k = 0; k < 3; k++) {
            position[i][k] = (float)noise(&seed);
        }
        radius[i] = 0.05f;
        larger[i] = 0.05f * 1.001f;
    }
    (void)state;
    layers_of(&camera, position, radius, depth[0], thickness[0]);
    layers_of(&camera, position, larger, other[0], thickness[0]);
    int apart = 0;
    for (int y = 0; y < HEIGHT; y++) {
        for (int x = 0; x < WIDTH; x++) {
            apart += isfinite(depth[y][x]) && isfinite(other[y][x]) && depth[y][x] - other[y][x] > (float)DEPTH_TOLERANCE;
        }
    }
    assert_true(apart > 4000);
}

static int setup(void **state)
{
    *state = rtcNewDevice("threads=1");
    return !*state;
}

static int teardown(void **state)
{
    rtcReleaseDevice(*state);
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_an_ordinary_view),      cmocka_unit_test(test_the_corners_of_a_wide_view),
        cmocka_unit_test(test_a_view_off_the_centre), cmocka_unit_test(test_a_parallel_view),
        cmocka_unit_test(test_spheres_that_are_cut),  cmocka_unit_test(test_a_wrong_radius_would_be_found),
    };
    return cmocka_run_group_tests(tests, setup, teardown);
}
