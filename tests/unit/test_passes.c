/* Layers for compositors against every particle tried at every pixel. */
#include <math.h>
#include <setjmp.h>
#include <stdbool.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <meniscus/meniscus.h>

enum { W = 150, H = 97, COUNT = 700 };

static const double RADIUS = 0.06, FAR_AWAY[3] = {400, -30, 1000};

static struct {
    double position[COUNT][3];
    float velocity[COUNT][3], shape[COUNT][6];
    int32_t id[COUNT];
} set;

static float velocity[H][W][3], motion[H][W][2], id[H][W], position[H][W][3], depth[H][W];

static double random_to(double most)
{
    static uint64_t state = 7;
    state = state * 6364136223846793005u + 1442695040888963407u;
    return most * (double)(state >> 40) / (double)(1 << 24);
}

static void fill(bool shapes, struct mns_particles *out)
{
    for (int i = 0; i < COUNT; i++) {
        for (int c = 0; c < 3; c++) {
            set.position[i][c] = FAR_AWAY[c] + random_to(2) - 1;
            set.velocity[i][c] = (float)(random_to(10) - 5);
            set.shape[i][c] = (float)(0.5 + random_to(1));
            set.shape[i][3 + c] = (float)(random_to(0.4) - 0.2);
        }
        set.id[i] = 10000 - 3 * i;
    }
    mns_particles_init(out);
    out->count = COUNT;
    out->position = (struct mns_attr){set.position, 0, MNS_F64};
    out->velocity = (struct mns_attr){set.velocity, 0, MNS_F32};
    out->id = (struct mns_attr){set.id, 0, MNS_I32};
    out->shape = (struct mns_attr){shapes ? set.shape : NULL, 0, MNS_F32};
}

/* The eye in front of the particles, or among them. */
static void look(struct mns_camera *camera, bool orthographic, double away)
{
    const double eye[3] = {FAR_AWAY[0] + 0.3, FAR_AWAY[1] + 0.5, FAR_AWAY[2] + away}, up[3] = {0, 1, 0.2};
    mns_camera_init(camera, W, H);
    assert_int_equal(mns_camera_look_at(camera, eye, FAR_AWAY, up), MNS_OK);
    assert_int_equal(orthographic ? mns_camera_orthographic(camera, 2.5, 0.1, 100) : mns_camera_perspective(camera, 50, 0.1, 100), MNS_OK);
}

static mns_result draw(const struct mns_particles *particles, const struct mns_camera *camera, int threads, int passes)
{
    mns_renderer *renderer;
    struct mns_renderer_params setup;
    struct mns_params params;
    struct mns_frame frame;
    mns_renderer_params_init(&setup);
    setup.threads = threads;
    setup.passes = passes;
    assert_int_equal(mns_renderer_create(&renderer, &setup, NULL), MNS_OK);
    assert_int_equal(mns_renderer_prepare(renderer, particles), MNS_OK);
    mns_params_init(&params);
    params.radius = (float)RADIUS;
    params.radius_scale = 1;
    params.filter = MNS_FILTER_NONE;
    params.floor = 0;
    params.motion_time = 0.01f;
    const struct mns_output outputs[] = {{MNS_LAYER_VELOCITY, {velocity, 0, W, H, 3, MNS_PIXEL_F32}},
                                         {MNS_LAYER_MOTION, {motion, 0, W, H, 2, MNS_PIXEL_F32}},
                                         {MNS_LAYER_ID, {id, 0, W, H, 1, MNS_PIXEL_F32}},
                                         {MNS_LAYER_POSITION, {position, 0, W, H, 3, MNS_PIXEL_F32}},
                                         {MNS_LAYER_DEPTH, {depth, 0, W, H, 1, MNS_PIXEL_F32}}};
    mns_frame_init(&frame);
    frame.camera = camera;
    frame.params = &params;
    frame.outputs = outputs;
    frame.output_count = 5;
    mns_result result = mns_renderer_draw(renderer, &frame);
    mns_renderer_destroy(&renderer);
    return result;
}

/* A world point to pixels; returns its depth. */
static double project(const struct mns_camera *camera, const double p[3], double out[2])
{
    double v[4] = {0}, clip[4] = {0};
    for (int r = 0; r < 4; r++) {
        v[r] = camera->view[r] * p[0] + camera->view[4 + r] * p[1] + camera->view[8 + r] * p[2] + camera->view[12 + r];
    }
    for (int r = 0; r < 4; r++) {
        for (int c = 0; c < 4; c++) {
            clip[r] += camera->projection[4 * c + r] * v[c];
        }
    }
    out[0] = (clip[0] / clip[3] * 0.5 + 0.5) * W;
    out[1] = (0.5 - clip[1] / clip[3] * 0.5) * H;
    return -v[2];
}

/* How far a world point is from being on the particle's surface, over its radius: |A^-1 (p - c)| / R - 1. */
static double off_surface(bool shapes, int i, const float p[3])
{
    double d[3], a[6] = {1, 1, 1, 0, 0, 0};
    for (int c = 0; c < 3; c++) {
        d[c] = ((double)p[c] - set.position[i][c]) / RADIUS;
    }
    for (int c = 0; c < 6 && shapes; c++) {
        a[c] = (double)set.shape[i][c];
    }
    double xx = a[1] * a[2] - a[5] * a[5], yy = a[0] * a[2] - a[4] * a[4], zz = a[0] * a[1] - a[3] * a[3];
    double xy = a[4] * a[5] - a[3] * a[2], xz = a[3] * a[5] - a[4] * a[1], yz = a[3] * a[4] - a[0] * a[5];
    double det = a[0] * xx + a[3] * xy + a[4] * xz;
    double x = (xx * d[0] + xy * d[1] + xz * d[2]) / det, y = (xy * d[0] + yy * d[1] + yz * d[2]) / det;
    double z = (xz * d[0] + yz * d[1] + zz * d[2]) / det;
    return sqrt(x * x + y * y + z * z) - 1;
}

/* The position is the pixel's, at its depth, on the surface of the particle whose id, velocity and way are told. What the near plane cuts
shows its inside. */
static void check(const struct mns_camera *camera, bool shapes)
{
    int shown = 0;
    for (int y = 0; y < H; y++) {
        for (int x = 0; x < W; x++) {
            if (!(depth[y][x] < INFINITY)) {
                assert_true(id[y][x] == -1 && velocity[y][x][0] == 0 && motion[y][x][1] == 0 && position[y][x][2] == 0);
                continue;
            }
            const double p[3] = {(double)position[y][x][0], (double)position[y][x][1], (double)position[y][x][2]};
            double pixel[2], before[2], after[2], moved[3], at = project(camera, p, pixel);
            assert_true(fabs(at - (double)depth[y][x]) < 3e-4); /* float32 positions 1000 m from the origin */
            assert_true(fabs(pixel[0] - x - 0.5) < 0.1 && fabs(pixel[1] - y - 0.5) < 0.1);
            int i = (int)((10000 - id[y][x]) / 3);
            assert_true(i >= 0 && i < COUNT && id[y][x] == (float)set.id[i]);
            assert_memory_equal(velocity[y][x], set.velocity[i], sizeof(set.velocity[i]));
            double off = off_surface(shapes, i, position[y][x]);
            bool inside = at < camera->near_plane + 1e-3;
            assert_true(inside ? off < 0.01 : fabs(off) < 0.05); /* 3e-4 m of 0.06, at a grazing angle */
            for (int c = 0; c < 3; c++) {
                moved[c] = p[c] + 0.01 * (double)set.velocity[i][c];
            }
            project(camera, p, before);
            project(camera, moved, after);
            for (int c = 0; c < 2 && !inside; c++) {
                double wanted = after[c] - before[c];
                assert_true(fabs((double)motion[y][x][c] - wanted) < 0.02 + 0.01 * fabs(wanted));
            }
            shown++;
        }
    }
    assert_true(shown > W * H / 5);
}

static void passes_are_those_of_the_nearest(void **state)
{
    (void)state;
    struct mns_particles particles;
    struct mns_camera camera;
    for (int shapes = 0; shapes < 2; shapes++) {
        fill(shapes, &particles);
        for (int orthographic = 0; orthographic < 2; orthographic++) {
            look(&camera, orthographic, 3);
            assert_int_equal(draw(&particles, &camera, 3, 1), MNS_OK);
            check(&camera, shapes);
        }
        look(&camera, false, 0.5); /* among them: some are around the eye, some cut */
        assert_int_equal(draw(&particles, &camera, 3, 1), MNS_OK);
        check(&camera, shapes);
    }
}

static void threads_change_nothing(void **state)
{
    (void)state;
    static float first[H][W];
    struct mns_particles particles;
    struct mns_camera camera;
    fill(false, &particles);
    look(&camera, false, 3);
    assert_int_equal(draw(&particles, &camera, 1, 1), MNS_OK);
    memcpy(first, id, sizeof(id));
    assert_int_equal(draw(&particles, &camera, 7, 1), MNS_OK);
    assert_memory_equal(first, id, sizeof(id));
    particles.id.data = particles.velocity.data = NULL; /* the index, and no velocity */
    assert_int_equal(draw(&particles, &camera, 7, 1), MNS_OK);
    for (int y = 0; y < H; y++) {
        for (int x = 0; x < W; x++) {
            int index = first[y][x] >= 0 ? (int)((10000 - first[y][x]) / 3) : -1;
            assert_int_equal((int)id[y][x], index);
            assert_true(velocity[y][x][0] == 0 && motion[y][x][0] == 0);
        }
    }
    assert_int_equal(draw(&particles, &camera, 1, 0), MNS_ERR_INVALID_ARGUMENT); /* they were not kept */
    particles.count = 0;
    assert_int_equal(draw(&particles, &camera, 1, 1), MNS_OK);
    assert_true(id[3][3] == -1 && position[3][3][0] == 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(passes_are_those_of_the_nearest),
        cmocka_unit_test(threads_change_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
