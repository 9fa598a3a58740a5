/* test_splat.c: stages bin and splat against spheres in closed form, against brute force, and against themselves. */
#include "splat_test.h"

/* Depth and chord are good to 3e-4 R where the ray is at least a tenth of R inside (splat.h). At the rim a pixel may come or go.
 * ROUNDING: of the depth, some five roundings of float between a particle and a pixel; PLACE: of a projected centre, pixels. */
static const double TOLERANCE = 3e-4, RIM = 0.1, ROUNDING = 6e-7, PLACE = 1e-4;

static struct mns_particles particles_of(const float *position, size_t count)
{
    struct mns_particles particles;
    mns_particles_init(&particles);
    particles.count = count;
    particles.position = (struct mns_attr){.data = position, .type = MNS_F32};
    return particles;
}

static void look(struct mns_camera *camera, int width, int height, double x, double y, double z, double tx, double ty, double tz)
{
    mns_camera_init(camera, width, height);
    assert_int_equal(mns_camera_look_at(camera, (double[]){x, y, z}, (double[]){tx, ty, tz}, (double[]){0, 1, 0}), MNS_OK);
}

/* Every pixel of a picture of one sphere: depth and chord, cut by the planes. */
static void check_sphere(struct stage_test *t, const float center[3], double radius)
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
            double enter = 0, leave = 0, inside = meet_sphere(camera, &ray, center, radius, &enter, &leave);
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
            if (hit) {
                assert_true(fabs((double)got - depth) <= (rim ? 0.1 : TOLERANCE) * radius);
            }
            assert_true(fabs((double)thickness_at(t, x, y) - chord) <= 2 * (rim ? 0.1 : TOLERANCE) * radius);
        }
    }
    assert_int_equal(t->cpu->stats.particles_splatted, hits > 0);
    assert_true(hits > 0);
}

/* With every instruction set, at the centre and in the corners of a field of view of 90 degrees both ways. */
static void one_sphere(void **state)
{
    (void)state;
    enum mns_isa isas[6];
    for (int i = test_isas(isas) - 1; i >= 0; i--) {
        for (int corner = -1; corner < 4; corner++) {
            float x = corner < 0 ? 0.01f : corner & 1 ? 1.7f : -1.7f, y = corner < 0 ? 0.02f : corner & 2 ? 1.75f : -1.75f;
            float center[3] = {x, y, -2};
            struct mns_particles particles = particles_of(center, 1);
            struct stage_test t;
            stage_test_open(&t, isas[i], 2, &particles);
            look(&t.camera, 300, 300, 0, 0, 0, 0, 0, -1);
            mns_camera_perspective(&t.camera, 90, 0.1, 100);
            check_sphere(&t, center, 0.2);
            check_sphere(&t, center, 0.004); /* half a pixel wide */
            mns_camera_frustum(&t.camera, -0.02, 0.16, -0.1, 0.04, 0.1, 100);
            if (x > -1 && y < 1) {
                check_sphere(&t, center, 0.3);
            }
            mns_camera_orthographic(&t.camera, 4, -10, 100);
            check_sphere(&t, center, 0.3);
            stage_test_close(&t);
        }
    }
}

/* Across the near and the far plane and the picture's edge, and around the eye. */
static void cut_sphere(void **state)
{
    (void)state;
    enum mns_isa isas[6];
    for (int i = test_isas(isas) - 1; i >= 0; i--) {
        float center[3] = {0.1f, 0.05f, -0.5f};
        struct mns_particles particles = particles_of(center, 1);
        struct stage_test t;
        stage_test_open(&t, isas[i], 2, &particles);
        look(&t.camera, 200, 150, 0, 0, 0, 0.1, 0, -1);
        mns_camera_perspective(&t.camera, 60, 0.45, 100);
        check_sphere(&t, center, 0.2); /* near plane */
        mns_camera_perspective(&t.camera, 60, 0.01, 0.5);
        check_sphere(&t, center, 0.2); /* far plane */
        mns_camera_perspective(&t.camera, 60, 0.01, 100);
        check_sphere(&t, center, 0.4); /* one radius and a bit away */
        check_sphere(&t, center, 2);   /* around the eye */
        look(&t.camera, 200, 150, 0.2, 0, 0, 2, 0, -1);
        mns_camera_perspective(&t.camera, 60, 0.01, 100);
        check_sphere(&t, center, 0.49); /* partly behind the eye */
        look(&t.camera, 200, 150, 0.55, 0, 0.5, 0.55, 0, -1);
        mns_camera_perspective(&t.camera, 40, 0.01, 100);
        check_sphere(&t, center, 0.15); /* the picture's edge */
        mns_camera_orthographic(&t.camera, 0.9, 0.95, 100);
        check_sphere(&t, center, 0.2);
        stage_test_close(&t);
    }
}

/* Balls in a box before the eye. */
static float *random_balls(size_t count, uint64_t seed)
{
    float *position = malloc(count * 3 * sizeof(float));
    for (size_t i = 0; i < count; i++) {
        position[3 * i] = (float)(4 * random_unit(&seed) - 2);
        position[3 * i + 1] = (float)(3 * random_unit(&seed) - 1.5);
        position[3 * i + 2] = (float)(-3 * random_unit(&seed) - 2);
    }
    return position;
}

struct reference {
    double *depth, *chords, *rim; /* [height][width]; rim: the most that spheres just at their rim may add */
    double *doubtful;             /* nearest sphere that the ray meets at its rim only */
};

/* Every sphere in every pixel that it may touch. */
static struct reference brute_force(const struct mns_camera *camera, const float *position, size_t count, double radius)
{
    size_t pixels = (size_t)camera->width * (size_t)camera->height;
    struct reference r = {calloc(pixels, sizeof(double)), calloc(pixels, sizeof(double)), calloc(pixels, sizeof(double)),
                          calloc(pixels, sizeof(double))};
    for (size_t i = 0; i < pixels; i++) {
        r.depth[i] = r.doubtful[i] = (double)DEPTH_EMPTY;
    }
    double focal = 0.5 * camera->height * camera->projection[5];
    for (size_t i = 0; i < count; i++) {
        const float *p = position + 3 * i;
        double depth = -(double)p[2]; /* the camera stands at the origin and looks down -z */
        double x = 0.5 * camera->width + focal * (double)p[0] / depth, y = 0.5 * camera->height - focal * (double)p[1] / depth;
        double reach = 2 * focal * radius / depth + 1;
        for (int py = (int)fmax(y - reach, 0); py < fmin(y + reach, camera->height); py++) {
            for (int px = (int)fmax(x - reach, 0); px < fmin(x + reach, camera->width); px++) {
                struct test_ray ray = ray_of(camera, px + 0.5, py + 0.5);
                double enter, leave, inside = meet_sphere(camera, &ray, p, radius, &enter, &leave);
                size_t at = (size_t)py * (size_t)camera->width + (size_t)px;
                if (inside > -RIM) {
                    double *nearest = inside < RIM ? &r.doubtful[at] : &r.depth[at];
                    *nearest = fmin(*nearest, enter);
                    r.chords[at] += 2 * fmax(inside, 0) * radius;
                    double lateral = PLACE * depth / focal / (inside * radius); /* what a shift of the centre does to s */
                    r.rim[at] += (inside < RIM ? 0.2 : 2 * (TOLERANCE + lateral)) * radius;
                }
            }
        }
    }
    return r;
}

static void free_reference(struct reference *r)
{
    free(r->depth);
    free(r->doubtful);
    free(r->chords);
    free(r->rim);
}

enum { BALLS = 100000 };

static void compare(const struct stage_test *t, const struct reference *r, double radius)
{
    size_t fluid = 0;
    for (int y = 0; y < t->camera.height; y++) {
        for (int x = 0; x < t->camera.width; x++) {
            size_t at = (size_t)y * (size_t)t->camera.width + (size_t)x;
            double depth = (double)depth_at(t, x, y), room = TOLERANCE * radius + ROUNDING * depth;
            assert_true(depth <= r->depth[at] + (depth < (double)DEPTH_LIMIT ? room : 0));
            /* Nearer than every sphere that is met well inside: at the rim of another, whose root may be off by RIM. */
            assert_true(depth >= r->depth[at] - room || depth >= r->doubtful[at] - RIM * radius);
            assert_true(fabs((double)thickness_at(t, x, y) - r->chords[at]) <= r->rim[at] + 1e-6 * r->chords[at]);
            fluid += depth < (double)DEPTH_LIMIT;
        }
    }
    assert_int_equal(t->cpu->stats.pixels_covered, fluid);
}

static void many_spheres(void **state)
{
    (void)state;
    float *position = random_balls(BALLS, 1);
    struct mns_particles particles = particles_of(position, BALLS);
    enum mns_isa isas[6];
    const double radii[] = {0.006, 0.02, 0.09};
    for (int k = 0; k < 3; k++) {
        struct mns_camera camera;
        look(&camera, 333, 201, 0, 0, 0, 0, 0, -1);
        mns_camera_perspective(&camera, 50, 0.1, 100);
        struct reference r = brute_force(&camera, position, BALLS, radii[k]);
        for (int i = test_isas(isas) - 1; i >= 0; i--) {
            struct stage_test t;
            stage_test_open(&t, isas[i], 2, &particles);
            t.camera = camera;
            t.params.radius = (float)radii[k];
            t.params.thickness_mode = MNS_THICKNESS_CHORD;
            t.params.thickness_scale = 1;
            stage_test_draw(&t);
            compare(&t, &r, radii[k]);
            assert_true(t.cpu->stats.particles_splatted < t.cpu->stats.particles_visible);
            stage_test_close(&t);
        }
        free_reference(&r);
    }
    free(position);
}

/* The same bytes for any number of threads; the same depths for any order, and sums that differ by rounding only. */
static void threads_and_order(void **state)
{
    (void)state;
    float *position = random_balls(BALLS, 2), *shuffled = malloc(BALLS * 3 * sizeof(float));
    for (size_t i = 0; i < BALLS; i++) {
        memcpy(shuffled + 3 * i, position + 3 * ((i * 7919 + 13) % BALLS), 3 * sizeof(float));
    }
    struct mns_particles particles = particles_of(position, BALLS), others = particles_of(shuffled, BALLS);
    enum mns_isa isas[6];
    for (int i = test_isas(isas) - 1; i >= 0; i--) {
        for (int scale = 1; scale <= 4; scale *= 2) {
            struct stage_test first, t;
            stage_test_open(&first, isas[i], 1, &particles);
            look(&first.camera, 350, 202, 0, 0, 0, 0, 0, -1);
            mns_camera_perspective(&first.camera, 50, 0.1, 100);
            first.params.radius = 0.02f;
            first.params.particle_volume = 1e-4f;
            first.params.thickness_scale = scale;
            stage_test_draw(&first);
            const int threads[] = {2, 7, 3};
            for (int k = 0; k < 3; k++) {
                bool reordered = k == 2;
                stage_test_open(&t, isas[i], threads[k], reordered ? &others : &particles);
                t.camera = first.camera;
                t.params = first.params;
                stage_test_draw(&t);
                const struct plane *a = &first.cpu->depth_raw.plane, *b = &t.cpu->depth_raw.plane;
                assert_memory_equal(a->block, b->block, a->floats * sizeof(float));
                size_t blocks = (size_t)first.cpu->depth_raw.blocks_x * (size_t)first.cpu->depth_raw.blocks_y;
                assert_memory_equal(first.cpu->depth_raw.ranges, t.cpu->depth_raw.ranges, blocks * sizeof(struct depth_range));
                a = &first.cpu->raw.thickness;
                b = &t.cpu->raw.thickness;
                for (size_t f = 0; f < a->floats; f++) {
                    assert_true(reordered ? fabsf(a->block[f] - b->block[f]) <= 1e-5f * a->block[f] : a->block[f] == b->block[f]);
                }
                stage_test_close(&t);
            }
            stage_test_close(&first);
        }
    }
    free(position);
    free(shuffled);
}

/* Ranges are those of the pixels, and what lies outside the picture is as the filters want it. */
static void ranges(void **state)
{
    (void)state;
    float *position = random_balls(3000, 3);
    struct mns_particles particles = particles_of(position, 3000);
    enum mns_isa isas[6];
    for (int i = test_isas(isas) - 1; i >= 0; i--) {
        struct stage_test t;
        stage_test_open(&t, isas[i], 2, &particles);
        look(&t.camera, 203, 141, 0, 0, 0, 0, 0, -1);
        mns_camera_perspective(&t.camera, 50, 0.1, 100);
        t.params.radius = 0.05f;
        stage_test_draw(&t);
        const struct depth_plane *depth = &t.cpu->depth_raw;
        for (int by = 0; by < depth->blocks_y; by++) {
            for (int bx = 0; bx < depth->blocks_x; bx++) {
                struct depth_range range = {.min = DEPTH_EMPTY, .max = 0};
                for (int y = by * BLOCK_HEIGHT; y < (by + 1) * BLOCK_HEIGHT; y++) {
                    for (int x = bx * BLOCK_WIDTH; x < (bx + 1) * BLOCK_WIDTH; x++) {
                        float z = depth_at(&t, x, y);
                        if (x < 203 && y < 141) {
                            range.min = fminf(range.min, z);
                            range.max = fmaxf(range.max, z);
                        } else {
                            assert_true(z == 0);
                        }
                    }
                }
                struct depth_range got = depth->ranges[by * depth->blocks_x + bx];
                assert_true(got.min == range.min && got.max == range.max);
            }
        }
        stage_test_close(&t);
    }
    free(position);
}

/* A block 1 m deep of jittered particles, seen along z by parallel rays or from far away: mean thickness over its middle. */
static double block_thickness(size_t along, int thickness_scale, bool orthographic, enum mns_isa isa)
{
    size_t wide = along, count = along * wide * wide;
    double spacing = 1.0 / (double)along;
    float *position = malloc(count * 3 * sizeof(float));
    uint64_t seed = 5;
    for (size_t i = 0; i < count; i++) {
        size_t place[3] = {i % wide, i / wide % wide, i / (wide * wide)};
        for (size_t k = 0; k < 3; k++) {
            position[3 * i + k] = (float)(((double)place[k] + 0.5 + 0.3 * (random_unit(&seed) - 0.5)) * spacing - 0.5);
        }
    }
    struct mns_particles particles = particles_of(position, count);
    struct stage_test t;
    stage_test_open(&t, isa, 2, &particles);
    t.params.radius_scale = 1.2f;
    t.params.radius = (float)(0.5 * spacing);
    t.params.particle_volume = (float)(spacing * spacing * spacing);
    t.params.thickness_scale = thickness_scale;
    look(&t.camera, 640, 480, 0, 0, orthographic ? 3 : 40, 0, 0, 0);
    if (orthographic) {
        mns_camera_orthographic(&t.camera, 1.2, 0.1, 100);
    } else {
        mns_camera_perspective(&t.camera, 1.7, 1, 100);
    }
    stage_test_draw(&t);
    const struct plane *plane = &t.cpu->raw.thickness;
    double sum = 0;
    size_t texels = 0;
    for (int y = plane->height * 3 / 8; y < plane->height * 5 / 8; y++) {
        for (int x = plane->width * 3 / 8; x < plane->width * 5 / 8; x++) {
            sum += (double)thickness_at(&t, x, y);
            texels++;
        }
    }
    stage_test_close(&t);
    free(position);
    return sum / (double)texels;
}

static void block_is_as_thick_as_deep(void **state)
{
    (void)state;
    enum mns_isa isas[6];
    for (int i = test_isas(isas) - 1; i >= 0; i--) {
        for (int orthographic = 0; orthographic < 2; orthographic++) {
            const size_t sides[] = {10, 46}; /* 1,000 and 97,336 particles */
            for (int k = 0; k < 2; k++) {
                double exact = block_thickness(sides[k], 1, orthographic, isas[i]);
                assert_true(fabs(exact - 1) < 0.02);
                for (int scale = 0; scale <= 4; scale += 2) {
                    assert_true(fabs(block_thickness(sides[k], scale, orthographic, isas[i]) - exact) < 0.01 * exact);
                }
            }
        }
    }
}

/* What is gathered is the particle's volume: V = sum of thickness * z^2 / (f^2 |v|), whatever its radius, mass and the texels. */
static void volumes(void **state)
{
    (void)state;
    const float position[] = {-0.5f, 0.1f, -3, 0.6f, -0.3f, -3.5f, 0.1f, 0.5f, -2.8f};
    const float radius[] = {0.15f, 0.3f, 0.05f}, mass[] = {2, 5, 0.5f}, color[] = {1, 0, 0, 0, 0.5f, 0, 0.25f, 0.25f, 1};
    struct mns_particles particles = particles_of(position, 3);
    particles.mass = (struct mns_attr){.data = mass, .type = MNS_F32};
    particles.color = (struct mns_attr){.data = color, .type = MNS_F32};
    enum mns_isa isas[6];
    for (int i = test_isas(isas) - 1; i >= 0; i--) {
        for (int own = 0; own < 8; own++) { /* bit 0: own radii, bit 1: rest volumes from masses, bit 2: a volume given */
            particles.radius = (struct mns_attr){.data = own & 1 ? radius : NULL, .type = MNS_F32};
            for (int scale = 1; scale <= 4; scale *= 2) {
                struct stage_test t;
                stage_test_open(&t, isas[i], 2, &particles);
                look(&t.camera, 640, 480, 0, 0, 0, 0, 0, -1);
                mns_camera_perspective(&t.camera, 60, 0.1, 100);
                t.params.radius = own & 1 ? 0 : 0.1f;
                t.params.rest_density = own & 2 ? 1000 : 0;
                t.params.particle_volume = own & 4 ? 0.004f : 0;
                t.params.thickness_scale = scale;
                stage_test_draw(&t);
                double f = t.frame.view.fx / (float)scale, got[4] = {0}, expected[4] = {0};
                for (int p = 0; p < 3; p++) {
                    double r = (double)radius[p], v = own & 4 ? 0.004 : own & 2 ? (double)mass[p] / 1000 : own & 1 ? 8 * r * r * r : 0.008;
                    double z = -(double)position[3 * p + 2];
                    double a = (double)position[3 * p] / z, b = (double)position[3 * p + 1] / z,
                           share = v * sqrt(a * a + b * b + 1) / (z * z);
                    expected[0] += share;
                    for (int c = 0; c < 3; c++) {
                        expected[1 + c] += share * (double)color[3 * p + c];
                    }
                }
                const struct plane *planes[4] = {&t.cpu->raw.thickness, &t.cpu->raw.color[0], &t.cpu->raw.color[1], &t.cpu->raw.color[2]};
                for (int k = 0; k < 4; k++) {
                    for (int y = 0; y < planes[k]->height; y++) {
                        for (int x = 0; x < planes[k]->width; x++) {
                            got[k] += (double)planes[k]->data[y * planes[k]->stride + x] / (f * f);
                        }
                    }
                    assert_true(fabs(got[k] - expected[k]) < 0.02 * expected[k]);
                }
                stage_test_close(&t);
            }
        }
    }
}

/* A wall in the right half of the picture: thickness ends at it, depth does not. */
static void scene_cuts_thickness(void **state)
{
    (void)state;
    float *position = random_balls(5000, 4);
    struct mns_particles particles = particles_of(position, 5000);
    enum mns_isa isas[6];
    for (int i = test_isas(isas) - 1; i >= 0; i--) {
        for (int scale = 1; scale <= 4; scale += 3) {
            struct stage_test open, cut;
            struct stage_test *both[] = {&open, &cut};
            for (int k = 0; k < 2; k++) {
                struct stage_test *t = both[k];
                stage_test_open(t, isas[i], 2, &particles);
                look(&t->camera, 256, 160, 0, 0, 0, 0, 0, -1);
                mns_camera_perspective(&t->camera, 60, 0.1, 100);
                t->params.radius = scale == 1 ? 0.1f : 0.03f;
                t->params.thickness_scale = scale;
            }
            struct scene_image *scene = &cut.cpu->scene;
            assert_true(mns_plane_resize(&scene->depth, &cut.memory, 256, 160, 0));
            for (int y = 0; y < 160; y++) {
                for (int x = 0; x < 256; x++) {
                    scene->depth.data[y * scene->depth.stride + x] = x < 128 ? DEPTH_EMPTY : y < 80 ? 3.5f : 1.0f;
                }
            }
            scene->has_depth = scene->cuts_fluid = true;
            stage_test_draw(&open);
            stage_test_draw(&cut);
            double before = 0, all = 0;
            for (int y = 0; y < 160; y++) {
                for (int x = 0; x < 256; x++) {
                    assert_true(depth_at(&open, x, y) == depth_at(&cut, x, y));
                    float whole = thickness_at(&open, x / scale, y / scale), part = thickness_at(&cut, x / scale, y / scale);
                    assert_true(x >= 128 || fabsf(whole - part) <= 1e-3f * whole);
                    assert_true(x < 128 || y < 80 || part == 0);
                    assert_true(part <= whole * 1.001f + 1e-6f);
                    before += x >= 132 && x < 160 && y >= 40 && y < 76 ? (double)part : 0;
                    all += x >= 132 && x < 160 && y >= 40 && y < 76 ? (double)whole : 0;
                }
            }
            /* Half of the box's 3 m lie before 3.5 m. */
            assert_true(fabs(before / all - 0.5) < 0.05);
            stage_test_close(&open);
            stage_test_close(&cut);
        }
    }
    free(position);
}

/* Nothing to draw, nothing in view, and cameras that make no sense: an empty picture. */
static void nothing_to_see(void **state)
{
    (void)state;
    const float position[] = {0, 0, 5, 0.5f, 0.5f, 6};
    enum mns_isa isas[6];
    for (int i = test_isas(isas) - 1; i >= 0; i--) {
        for (size_t count = 0; count <= 2; count += 2) {
            struct mns_particles particles = particles_of(position, count);
            struct stage_test t;
            stage_test_open(&t, isas[i], 2, &particles);
            t.params.radius = 0.1f;
            for (int k = 0; k < 3; k++) {
                double away = k == 0 ? 0 : k == 1 ? 1e25 : 1e300;
                look(&t.camera, 150, 100, 0, away, 0, 0, away, -1);
                stage_test_draw(&t);
                assert_int_equal(t.cpu->stats.pixels_covered, 0);
                assert_int_equal(t.cpu->stats.particles_splatted, 0);
                for (int y = 0; y < 100; y++) {
                    for (int x = 0; x < 150; x++) {
                        assert_true(depth_at(&t, x, y) == DEPTH_EMPTY);
                        assert_true(thickness_at(&t, x / t.cpu->raw.scale, y / t.cpu->raw.scale) == 0);
                    }
                }
            }
            stage_test_close(&t);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_sphere),     cmocka_unit_test(cut_sphere),
        cmocka_unit_test(many_spheres),   cmocka_unit_test(threads_and_order),
        cmocka_unit_test(ranges),         cmocka_unit_test(block_is_as_thick_as_deep),
        cmocka_unit_test(volumes),        cmocka_unit_test(scene_cuts_thickness),
        cmocka_unit_test(nothing_to_see),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
