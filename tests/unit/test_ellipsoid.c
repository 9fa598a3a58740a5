/* test_ellipsoid.c: stages bin and splat with particles that have a shape, against ellipsoids in closed form and against spheres. */
#include "splat_test.h"

/* As for spheres (test_splat.c), of the longest semi-axis. */
static const double TOLERANCE = 3e-4, RIM = 0.1;

/* xx, yy, zz, xy, xz, yz of the matrix with these semi-axes along three axes turned by the angles, degrees. */
static void make_shape(float out[6], const double axes[3], double about_y, double about_x)
{
    double c = cos(about_y * 0.0174532925199433), s = sin(about_y * 0.0174532925199433);
    double d = cos(about_x * 0.0174532925199433), t = sin(about_x * 0.0174532925199433);
    const double to[3][3] = {{c, s * t, s * d}, {0, d, -t}, {-s, c * t, c * d}};
    static const int rows[6] = {0, 1, 2, 0, 0, 1}, columns[6] = {0, 1, 2, 1, 2, 2};
    for (int k = 0; k < 6; k++) {
        double sum = 0;
        for (int axis = 0; axis < 3; axis++) {
            sum += to[rows[k]][axis] * axes[axis] * to[columns[k]][axis];
        }
        out[k] = (float)sum;
    }
}

/* p = A^-1 p / radius. */
static void to_unit(const float shape[6], double radius, double p[3])
{
    const double m[3][3] = {{(double)shape[0], (double)shape[3], (double)shape[4]},
                            {(double)shape[3], (double)shape[1], (double)shape[5]},
                            {(double)shape[4], (double)shape[5], (double)shape[2]}};
    double det = 0, solved[3];
    for (int k = 0; k < 3; k++) {
        det += m[0][k] * (m[1][(k + 1) % 3] * m[2][(k + 2) % 3] - m[1][(k + 2) % 3] * m[2][(k + 1) % 3]);
    }
    for (int k = 0; k < 3; k++) { /* Cramer */
        double n[3][3];
        memcpy(n, m, sizeof(n));
        for (int row = 0; row < 3; row++) {
            n[row][k] = p[row];
        }
        solved[k] = 0;
        for (int j = 0; j < 3; j++) {
            solved[k] += n[0][j] * (n[1][(j + 1) % 3] * n[2][(j + 2) % 3] - n[1][(j + 2) % 3] * n[2][(j + 1) % 3]);
        }
    }
    for (int k = 0; k < 3; k++) {
        p[k] = solved[k] / (det * radius);
    }
}

/* As meet_sphere, in the space where the ellipsoid is a unit sphere. view: the camera's, looking along a coordinate axis or not. */
static double meet_ellipsoid(const struct mns_camera *camera, const struct test_ray *ray, const float world[3], const float shape[6],
                             double radius, double *enter, double *leave)
{
    double from[3] = {ray->origin[0], ray->origin[1], 0}, along[3] = {ray->direction[0], ray->direction[1], -1}, o[3], d[3];
    for (int k = 0; k < 3; k++) {
        from[k] -= camera->view[12 + k];
    }
    for (int k = 0; k < 3; k++) { /* back to the world by the transpose */
        o[k] = -(double)world[k];
        d[k] = 0;
        for (int row = 0; row < 3; row++) {
            o[k] += camera->view[4 * k + row] * from[row];
            d[k] += camera->view[4 * k + row] * along[row];
        }
    }
    to_unit(shape, radius, o);
    to_unit(shape, radius, d);
    double a = d[0] * d[0] + d[1] * d[1] + d[2] * d[2], b = o[0] * d[0] + o[1] * d[1] + o[2] * d[2];
    double x = o[1] * d[2] - o[2] * d[1], y = o[2] * d[0] - o[0] * d[2], z = o[0] * d[1] - o[1] * d[0];
    double square = 1 - (x * x + y * y + z * z) / a; /* of the half chord in the unit sphere */
    double half = sqrt(fmax(square, 0) / a);
    *enter = -b / a - half;
    *leave = -b / a + half;
    return square > 0 ? sqrt(square) : -sqrt(-square);
}

static struct mns_particles particles_of(const float *position, const float *shape, size_t count)
{
    struct mns_particles particles;
    mns_particles_init(&particles);
    particles.count = count;
    particles.position = (struct mns_attr){.data = position, .type = MNS_F32};
    particles.shape = (struct mns_attr){.data = shape, .type = MNS_F32};
    return particles;
}

static void look(struct mns_camera *camera, int width, int height, double x, double y, double z, double tx, double ty, double tz)
{
    mns_camera_init(camera, width, height);
    assert_int_equal(mns_camera_look_at(camera, (double[]){x, y, z}, (double[]){tx, ty, tz}, (double[]){0, 1, 0}), MNS_OK);
}

/* Every pixel of a picture of one ellipsoid. longest: semi-axis over radius. */
static void check_ellipsoid(struct stage_test *t, const float center[3], const float shape[6], double radius, double longest)
{
    const struct mns_camera *camera = &t->camera;
    t->params.radius = (float)radius;
    t->params.thickness_mode = MNS_THICKNESS_CHORD;
    t->params.thickness_scale = 1;
    stage_test_draw(t);
    size_t hits = 0;
    for (int y = 0; y < camera->height; y++) {
        for (int x = 0; x < camera->width; x++) {
            struct test_ray ray = ray_of(camera, x + 0.5, y + 0.5);
            double enter, leave, inside = meet_ellipsoid(camera, &ray, center, shape, radius, &enter, &leave);
            bool hit = inside > 0 && leave > camera->near_plane && enter < camera->far_plane;
            double depth = hit ? fmax(enter, camera->near_plane) : INFINITY;
            double chord = hit ? (fmin(leave, camera->far_plane) - depth) * ray.length : 0;
            bool rim = fabs(inside) < RIM && inside > 0;
            float got = depth_at(t, x, y);
            if (hit != (got < DEPTH_LIMIT)) {
                assert_true(inside < RIM);
                continue;
            }
            hits += hit;
            double room = (rim ? 0.1 : TOLERANCE) * longest * radius;
            if (hit) {
                assert_true(fabs((double)got - depth) <= room);
            }
            assert_true(fabs((double)thickness_at(t, x, y) - chord) <= 2 * room * ray.length);
        }
    }
    assert_int_equal(t->cpu->stats.particles_splatted, hits > 0);
    assert_true(hits > 0);
}

static const double DISC[3] = {1.6, 1.6, 0.4}, NEEDLE[3] = {2.5, 0.6, 0.7}, FLAT[3] = {4, 1, 0.25};

/* With every instruction set, at the centre and in the corners of a field of view of 90 degrees both ways. */
static void one_ellipsoid(void **state)
{
    (void)state;
    const double *const axes[] = {DISC, NEEDLE, FLAT};
    enum mns_isa isas[6];
    for (int i = test_isas(isas) - 1; i >= 0; i--) {
        for (int corner = -1; corner < 4; corner++) {
            float x = corner < 0 ? 0.01f : corner & 1 ? 1.7f : -1.7f, y = corner < 0 ? 0.02f : corner & 2 ? 1.75f : -1.75f;
            float center[3] = {x, y, -2}, shape[6];
            const double *a = axes[(corner + 1) % 3], longest = fmax(a[0], a[1]);
            make_shape(shape, a, 35 + 20 * corner, -25 + 40 * corner);
            struct mns_particles particles = particles_of(center, shape, 1);
            struct stage_test t;
            stage_test_open(&t, isas[i], 2, &particles);
            look(&t.camera, 300, 300, 0, 0, 0, 0, 0, -1);
            mns_camera_perspective(&t.camera, 90, 0.1, 100);
            check_ellipsoid(&t, center, shape, 0.2, longest);
            check_ellipsoid(&t, center, shape, 0.01, longest); /* a pixel or two */
            look(&t.camera, 300, 300, 0.3, -0.4, 0.8, 0.3, -0.1, -1);
            mns_camera_perspective(&t.camera, 110, 0.1, 100); /* and turned */
            check_ellipsoid(&t, center, shape, 0.2, longest);
            mns_camera_orthographic(&t.camera, 6, -10, 100);
            check_ellipsoid(&t, center, shape, 0.3, longest);
            stage_test_close(&t);
        }
    }
}

/* Across the near and the far plane and the picture's edge, and around the eye. */
static void cut_ellipsoid(void **state)
{
    (void)state;
    enum mns_isa isas[6];
    for (int i = test_isas(isas) - 1; i >= 0; i--) {
        float center[3] = {0.1f, 0.05f, -0.5f}, shape[6];
        make_shape(shape, DISC, 40, 25);
        struct mns_particles particles = particles_of(center, shape, 1);
        struct stage_test t;
        stage_test_open(&t, isas[i], 2, &particles);
        look(&t.camera, 200, 150, 0, 0, 0, 0.1, 0, -1);
        mns_camera_perspective(&t.camera, 60, 0.45, 100);
        check_ellipsoid(&t, center, shape, 0.12, 1.6); /* near plane */
        mns_camera_perspective(&t.camera, 60, 0.01, 0.5);
        check_ellipsoid(&t, center, shape, 0.12, 1.6); /* far plane */
        mns_camera_perspective(&t.camera, 60, 0.01, 100);
        check_ellipsoid(&t, center, shape, 0.3, 1.6); /* close */
        check_ellipsoid(&t, center, shape, 2, 1.6);   /* around the eye */
        look(&t.camera, 200, 150, 0.2, 0, 0, 2, 0, -1);
        mns_camera_perspective(&t.camera, 60, 0.01, 100);
        check_ellipsoid(&t, center, shape, 0.49, 1.6); /* partly behind the eye */
        look(&t.camera, 200, 150, 0.55, 0, 0.5, 0.55, 0, -1);
        mns_camera_perspective(&t.camera, 40, 0.01, 100);
        check_ellipsoid(&t, center, shape, 0.12, 1.6); /* the picture's edge */
        mns_camera_orthographic(&t.camera, 0.9, 0.55, 100);
        check_ellipsoid(&t, center, shape, 0.2, 1.6);
        stage_test_close(&t);
    }
}

enum { COUNT = 20000 };

/* A cloud before the eye, with shapes of the given semi-axes turned every way; the same seed gives the same cloud. */
static void make_cloud(float *position, float *shape, size_t count, const double axes[3])
{
    uint64_t seed = 11;
    for (size_t i = 0; i < count; i++) {
        position[3 * i] = (float)(2 * random_unit(&seed) - 1);
        position[3 * i + 1] = (float)(1.4 * random_unit(&seed) - 0.7);
        position[3 * i + 2] = (float)(-2 * random_unit(&seed) - 3);
        make_shape(shape + 6 * i, axes, 360 * random_unit(&seed), 360 * random_unit(&seed));
    }
}

static void open_cloud(struct stage_test *t, enum mns_isa isa, int threads, const struct mns_particles *particles, int scale)
{
    stage_test_open(t, isa, threads, particles);
    look(&t->camera, 350, 202, 0, 0, 0, 0, 0, -1);
    mns_camera_perspective(&t->camera, 50, 0.1, 100);
    t->params.radius = 0.03f;
    t->params.particle_volume = 1e-4f;
    t->params.thickness_scale = scale;
}

/* A = 1 is the sphere. */
static void identity_is_a_sphere(void **state)
{
    (void)state;
    float *position = malloc(COUNT * 3 * sizeof(float)), *shape = malloc(COUNT * 6 * sizeof(float));
    make_cloud(position, shape, COUNT, (double[]){1, 1, 1});
    struct mns_particles shaped = particles_of(position, shape, COUNT), plain = shaped;
    plain.shape.data = NULL;
    enum mns_isa isas[6];
    for (int i = test_isas(isas) - 1; i >= 0; i--) {
        for (int scale = 1; scale <= 4; scale *= 2) {
            struct stage_test a, b;
            open_cloud(&a, isas[i], 2, &shaped, scale);
            open_cloud(&b, isas[i], 2, &plain, scale);
            stage_test_draw(&a);
            stage_test_draw(&b);
            size_t differ = 0;
            double sums[2] = {0, 0};
            for (int y = 0; y < a.camera.height; y++) {
                for (int x = 0; x < a.camera.width; x++) {
                    float one = depth_at(&a, x, y), other = depth_at(&b, x, y);
                    differ += fabsf(one - other) > 2 * (float)TOLERANCE * a.params.radius + 1.2e-6f * other; /* each is off by as much */
                }
            }
            assert_true(differ < 40); /* of 70 700: rims that came or went */
            const struct plane *p = &a.cpu->raw.thickness, *q = &b.cpu->raw.thickness;
            for (int y = 0; y < p->height; y++) {
                for (int x = 0; x < p->width; x++) {
                    float one = p->data[y * p->stride + x], other = q->data[y * q->stride + x];
                    assert_true(fabsf(one - other) <= 0.01f * other + 0.002f);
                    sums[0] += (double)one;
                    sums[1] += (double)other;
                }
            }
            assert_true(sums[1] > 0 && fabs(sums[0] - sums[1]) <= 5e-4 * sums[1]);
            stage_test_close(&a);
            stage_test_close(&b);
        }
    }
    free(position);
    free(shape);
}

/* However flat, the same volume: seen by parallel rays the thickness sums up to it, at every size of texel and of particle. */
static void volume_stays(void **state)
{
    (void)state;
    enum { FEW = 2000 };
    const double *const axes[] = {DISC, NEEDLE, FLAT};
    const float radii[] = {0.004f, 0.02f, 0.08f};
    float *position = malloc(FEW * 3 * sizeof(float)), *shape = malloc(FEW * 6 * sizeof(float));
    enum mns_isa isas[6];
    for (int i = test_isas(isas) - 1; i >= 0; i--) {
        for (int k = 0; k < 9; k++) {
            make_cloud(position, shape, FEW, axes[k % 3]);
            struct mns_particles particles = particles_of(position, shape, FEW);
            for (int scale = 1; scale <= 4; scale *= 2) {
                struct stage_test t;
                open_cloud(&t, isas[i], 2, &particles, scale);
                t.params.radius = radii[k / 3];
                mns_camera_orthographic(&t.camera, 3, 0.1, 100);
                stage_test_draw(&t);
                const struct plane *p = &t.cpu->raw.thickness;
                double sum = 0, texel = 3.0 / t.camera.height * scale;
                for (int y = 0; y < p->height; y++) {
                    for (int x = 0; x < p->width; x++) {
                        sum += (double)p->data[y * p->stride + x] * texel * texel;
                    }
                }
                /* Chords of discs under a pixel wide are told by the few whose centres rays meet. */
                bool sampled = scale == 1 && k / 3 == 0;
                assert_true(fabs(sum / (FEW * 1e-4) - 1) < (sampled ? 0.1 : 0.005));
                stage_test_close(&t);
            }
        }
    }
    free(position);
    free(shape);
}

/* What lies behind the scene adds nothing; before it, all. */
static void scene_cuts(void **state)
{
    (void)state;
    float *position = malloc(COUNT * 3 * sizeof(float)), *shape = malloc(COUNT * 6 * sizeof(float));
    make_cloud(position, shape, COUNT, DISC);
    struct mns_particles particles = particles_of(position, shape, COUNT);
    enum mns_isa isas[6];
    for (int i = test_isas(isas) - 1; i >= 0; i--) {
        for (int scale = 1; scale <= 4; scale *= 2) {
            double sums[3];
            for (int part = 0; part < 3; part++) { /* before 4 m, behind 4 m, all */
                struct stage_test t;
                open_cloud(&t, isas[i], 2, &particles, scale);
                mns_camera_orthographic(&t.camera, 3, part == 1 ? 4 : 0.1, 100);
                if (part == 0) {
                    assert_true(mns_plane_resize(&t.cpu->scene.depth, &t.memory, t.camera.width, t.camera.height, 0));
                    for (size_t f = 0; f < t.cpu->scene.depth.floats; f++) {
                        t.cpu->scene.depth.block[f] = 4;
                    }
                    t.cpu->scene.has_depth = t.cpu->scene.cuts_fluid = true;
                }
                stage_test_draw(&t);
                sums[part] = 0;
                for (int y = 0; y < t.cpu->raw.thickness.height; y++) {
                    for (int x = 0; x < t.cpu->raw.thickness.width; x++) {
                        sums[part] += (double)thickness_at(&t, x, y);
                    }
                }
                stage_test_close(&t);
            }
            assert_true(sums[0] > 0.4 * sums[2] && sums[1] > 0.4 * sums[2]);
            assert_true(fabs(sums[0] + sums[1] - sums[2]) < 2e-3 * sums[2]);
        }
    }
    free(position);
    free(shape);
}

static void threads_make_no_difference(void **state)
{
    (void)state;
    float *position = malloc(COUNT * 3 * sizeof(float)), *shape = malloc(COUNT * 6 * sizeof(float));
    make_cloud(position, shape, COUNT, FLAT);
    struct mns_particles particles = particles_of(position, shape, COUNT);
    struct stage_test one, many;
    open_cloud(&one, MNS_ISA_AUTO, 1, &particles, 4);
    open_cloud(&many, MNS_ISA_AUTO, 5, &particles, 4);
    stage_test_draw(&one);
    stage_test_draw(&many);
    const struct plane *a = &one.cpu->depth_raw.plane, *b = &many.cpu->depth_raw.plane;
    assert_memory_equal(a->block, b->block, a->floats * sizeof(float));
    a = &one.cpu->raw.thickness;
    b = &many.cpu->raw.thickness;
    assert_memory_equal(a->block, b->block, a->floats * sizeof(float));
    stage_test_close(&one);
    stage_test_close(&many);
    free(position);
    free(shape);
}

/* Shapes that are none are refused by name, and leave nothing behind. */
static void bad_shapes(void **state)
{
    (void)state;
    static const float bad[][6] = {
        {1, 1, NAN, 0, 0, 0},    {1, 1, 0, 0, 0, 0},        {1, 1, -1, 0, 0, 0},      {-1, -1, 1, 0, 0, 0},
        {1, 1, 1, 1.5f, 0, 0},   {INFINITY, 1, 1, 0, 0, 0}, {900, 900, 900, 0, 0, 0}, {1e-3f, 1e-3f, 1e-3f, 0, 0, 0},
        {50, 50, 0.02f, 0, 0, 0}};
    static const float good[][6] = {{100, 100, 1, 0, 0, 0}, {0.01f, 0.01f, 1, 0, 0, 0}, {1, 1, 1, 0.9f, 0, 0}};
    float position[6] = {0, 0, 0, 1, 0, 0}, shape[12] = {1, 1, 1, 0, 0, 0};
    mns_renderer *renderer;
    assert_int_equal(mns_renderer_create(&renderer, NULL, NULL), MNS_OK);
    struct mns_particles particles = particles_of(position, shape, 2);
    for (size_t i = 0; i < sizeof(bad) / sizeof(bad[0]); i++) {
        memcpy(shape + 6, bad[i], sizeof(bad[i]));
        assert_int_equal(mns_renderer_prepare(renderer, &particles), MNS_ERR_INVALID_ARGUMENT);
        assert_non_null(strstr(mns_renderer_message(renderer), "shape of particle 1"));
    }
    for (size_t i = 0; i < sizeof(good) / sizeof(good[0]); i++) {
        memcpy(shape + 6, good[i], sizeof(good[i]));
        assert_int_equal(mns_renderer_prepare(renderer, &particles), MNS_OK);
    }
    mns_renderer_destroy(&renderer);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_ellipsoid), cmocka_unit_test(cut_ellipsoid), cmocka_unit_test(identity_is_a_sphere),
        cmocka_unit_test(volume_stays),  cmocka_unit_test(scene_cuts),    cmocka_unit_test(threads_make_no_difference),
        cmocka_unit_test(bad_shapes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
