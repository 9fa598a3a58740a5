/* test_noise.c: stage noise against the sums of its formulas, and what a picture must keep: the pattern moves with the fluid, nothing shimmers. */
#include "cpu/noise.h"
#include "splat_test.h"

enum { WIDTH = 300, HEIGHT = 170, COUNT = 1200 };

static float positions[COUNT][3], amplitudes[COUNT];
static uint32_t ids[COUNT];

/* A slab of jittered particles, 0.1 apart, tilted towards the eye. */
static struct mns_particles slab(void)
{
    uint64_t seed = 5;
    for (int i = 0; i < COUNT; i++) {
        int x = i % 20, y = i / 20 % 20, z = i / 400;
        positions[i][0] = (float)(0.1 * (x - 9.5) + 0.03 * random_unit(&seed));
        positions[i][1] = (float)(0.1 * (y - 9.5) + 0.03 * random_unit(&seed));
        positions[i][2] = (float)(-0.1 * z + 0.03 * random_unit(&seed)) + 0.5f * positions[i][1];
        amplitudes[i] = (float)random_unit(&seed);
        ids[i] = (uint32_t)(7 * i + 1000);
    }
    struct mns_particles particles;
    mns_particles_init(&particles);
    particles.count = COUNT;
    particles.position = (struct mns_attr){.data = positions, .type = MNS_F32};
    particles.id = (struct mns_attr){.data = ids, .type = MNS_U32};
    return particles;
}

static void look(struct stage_test *t, bool orthographic)
{
    mns_camera_init(&t->camera, WIDTH, HEIGHT);
    const double eye[3] = {0.3, 0.2, 4}, target[3] = {0, 0, 0}, up[3] = {0, 1, 0};
    assert_int_equal(mns_camera_look_at(&t->camera, eye, target, up), MNS_OK);
    if (orthographic) {
        assert_int_equal(mns_camera_orthographic(&t->camera, 2.2, 0.1, 100), MNS_OK);
    } else {
        assert_int_equal(mns_camera_perspective(&t->camera, 32, 0.1, 100), MNS_OK);
    }
}

static void draw(struct stage_test *t)
{
    t->params.foam = MNS_FOAM_NOISE;
    t->params.radius = 0.06f;
    stage_test_draw(t);
    assert_int_equal(mns_cpu_smooth(t->cpu, &t->frame), MNS_OK);
    assert_int_equal(mns_cpu_noise(t->cpu, &t->frame), MNS_OK);
}

static float noise_at(const struct stage_test *t, int x, int y) { return t->cpu->noise.data[y * t->cpu->noise.stride + x]; }

static double blend(double t) { return 1 - t * t * t * (t * (6 * t - 15) + 10); }

static double perlin(const float *lattice, double x, double y)
{
    double sum = 0, u = x - floor(x), v = y - floor(y);
    for (int k = 0; k < 4; k++) {
        int i = k % 2, j = k / 2, at = (((int)floor(y) + j) & 63) * NOISE_LATTICE_STRIDE + (((int)floor(x) + i) & 63);
        double plane = (double)lattice[at] * (u - i) + (double)lattice[NOISE_LATTICE_FLOATS + at] * (v - j);
        sum += (i ? 1 - blend(u) : blend(u)) * (j ? 1 - blend(v) : blend(v)) * plane;
    }
    return sum;
}

/* Eq. 11 at a pixel, from every particle of the store. */
static double noise_sum(const struct stage_test *t, int x, int y)
{
    const struct view *view = &t->frame.view;
    const struct particle_store *store = &t->cpu->stores[STORE_WATER];
    const struct mns_params *params = &t->frame.params;
    double radius = (double)t->frame.splat_radius, reach = radius * (double)params->noise_radius, sum = 0;
    double d = (double)t->cpu->smoothed->plane.data[y * t->cpu->smoothed->plane.stride + x];
    for (size_t i = 0; i < store->count && d < (double)DEPTH_LIMIT; i++) {
        const double p[3] = {(double)store->x[i], (double)store->y[i], (double)store->z[i]};
        double q[3];
        for (int k = 0; k < 3; k++) {
            q[k] = (double)view->translation[k];
            for (int axis = 0; axis < 3; axis++) {
                q[k] += (double)view->rotation[3 * k + axis] * p[axis];
            }
        }
        double per_z = view->orthographic ? 1 : 1 / q[2], across = (double)view->fx * per_z, down = (double)view->fy * per_z;
        double dx = x + 0.5 - ((double)view->cx + across * q[0]), dy = y + 0.5 - ((double)view->cy + down * q[1]), e = d - q[2];
        double far = view->orthographic ? 1 : d, px = (x + 0.5 - (double)view->cx) / (double)view->fx * far - q[0];
        double py = (y + 0.5 - (double)view->cy) / (double)view->fy * far - q[1];
        double w = 1 - (px * px + py * py + e * e) / (reach * reach), octaves = 0, weight = 1;
        double cell = radius * (double)params->noise_scale * fmin(across, down);
        for (int octave = 0; w > 0 && octave < params->noise_octaves; octave++) {
            float at_x, at_y;
            noise_window(store->seed[i], octave, &at_x, &at_y);
            double per = exp2(octave) / (radius * (double)params->noise_scale), seen = fmin(fmax((cell * exp2(-octave) - 2) / 2, 0), 1);
            octaves += weight * seen * seen * (3 - 2 * seen) *
                       perlin(t->cpu->noise_lattice, (double)at_x + dx / across * per, (double)at_y + dy / down * per);
            weight *= (double)params->noise_gain;
        }
        double amplitude = store->noise ? (double)store->noise[i] : 1, middle = 1 - pow((double)params->noise_radius, -2);
        sum += w > 0 ? amplitude * pow(w / middle, 3) * octaves * sqrt(2) : 0;
    }
    return sum;
}

static void test_is_the_sum(void **state)
{
    (void)state;
    struct mns_particles particles = slab();
    enum mns_isa isas[6];
    for (int i = test_isas(isas) - 1; i >= 0; i--) {
        for (int kind = 0; kind < 4; kind++) {
            struct stage_test t;
            particles.noise = kind / 2 ? (struct mns_attr){.data = amplitudes, .type = MNS_F32} : (struct mns_attr){0};
            stage_test_open(&t, isas[i], 2, &particles);
            look(&t, kind % 2 == 1);
            t.params.filter = kind == 3 ? MNS_FILTER_NONE : MNS_FILTER_NARROW_RANGE_1D;
            t.params.noise_radius = kind == 2 ? 3.5f : 2;
            draw(&t);
            double largest = 0;
            for (int y = 1; y < HEIGHT; y += 7) {
                for (int x = y % 3; x < WIDTH; x += 5) {
                    double sum = noise_sum(&t, x, y);
                    largest = fmax(largest, fabs(sum));
                    if (fabs(sum - (double)noise_at(&t, x, y)) > 2e-3) {
                        fail_msg("noise at %d, %d is %g, the sum %g", x, y, (double)noise_at(&t, x, y), sum);
                    }
                }
            }
            assert_true(largest > 0.5);
            stage_test_close(&t);
        }
    }
}

static void test_gradients_are_of_unit_length(void **state)
{
    (void)state;
    struct mns_particles particles = slab();
    struct stage_test t;
    stage_test_open(&t, MNS_ISA_AUTO, 1, &particles);
    look(&t, true);
    draw(&t);
    const float *x = t.cpu->noise_lattice, *y = x + NOISE_LATTICE_FLOATS;
    double sum[2] = {0, 0};
    for (int i = 0; i < NOISE_LATTICE_FLOATS; i++) {
        assert_true(fabsf(x[i] * x[i] + y[i] * y[i] - 1) < 1e-6f);
        sum[0] += (double)x[i] / NOISE_LATTICE_FLOATS;
        sum[1] += (double)y[i] / NOISE_LATTICE_FLOATS;
    }
    assert_true(fabs(sum[0]) < 0.05 && fabs(sum[1]) < 0.05); /* no direction is favoured: 3 standard errors of 4096 */
    stage_test_close(&t);
}

/* The whole slab moved by whole pixels: the pattern is where the particles are. */
static void test_moves_with_the_fluid(void **state)
{
    (void)state;
    enum { SHIFT_X = 37, SHIFT_Y = 11 };
    struct mns_particles particles = slab();
    struct stage_test t[2];
    for (int i = 0; i < 2; i++) {
        stage_test_open(&t[i], MNS_ISA_AUTO, 2, &particles);
        mns_camera_init(&t[i].camera, WIDTH, HEIGHT);
        const double eye[3] = {0, 0, 4}, target[3] = {0, 0, 0}, up[3] = {0, 1, 0};
        assert_int_equal(mns_camera_look_at(&t[i].camera, eye, target, up), MNS_OK);
        assert_int_equal(mns_camera_orthographic(&t[i].camera, 2.7, 0.1, 100), MNS_OK);
        draw(&t[i]);
        for (int k = 0; k < COUNT; k++) {
            positions[k][0] += SHIFT_X * 2.7f / HEIGHT;
            positions[k][1] -= SHIFT_Y * 2.7f / HEIGHT;
        }
    }
    double still = 0, moved = 0, square = 0;
    for (int y = 10; y < HEIGHT - 25; y++) {
        for (int x = 60; x < WIDTH - 100; x++) {
            double here = (double)noise_at(&t[0], x, y);
            moved = fmax(moved, fabs(here - (double)noise_at(&t[1], x + SHIFT_X, y + SHIFT_Y)));
            still += pow(here - (double)noise_at(&t[1], x, y), 2);
            square += here * here;
        }
    }
    assert_true(moved < 5e-3);
    assert_true(still > square); /* and not where they were: unlike patterns differ by twice their square */
    stage_test_close(&t[0]);
    stage_test_close(&t[1]);
}

/* By id, whatever the order; without ids by index. */
static void test_pattern_is_the_ids(void **state)
{
    (void)state;
    struct mns_particles particles = slab();
    struct stage_test t[3];
    for (int i = 0; i < 3; i++) {
        if (i == 1) { /* another order */
            for (int k = 0; k < COUNT / 2; k++) {
                for (int c = 0; c < 3; c++) {
                    float swapped = positions[k][c];
                    positions[k][c] = positions[COUNT - 1 - k][c];
                    positions[COUNT - 1 - k][c] = swapped;
                }
                uint32_t swapped = ids[k];
                ids[k] = ids[COUNT - 1 - k];
                ids[COUNT - 1 - k] = swapped;
            }
        } else if (i == 2) {
            particles.id = (struct mns_attr){0};
        }
        stage_test_open(&t[i], MNS_ISA_AUTO, 2, &particles);
        look(&t[i], false);
        draw(&t[i]);
    }
    double same = 0, other = 0, square = 0;
    for (int y = 0; y < HEIGHT; y++) {
        for (int x = 0; x < WIDTH; x++) {
            double here = (double)noise_at(&t[0], x, y);
            same = fmax(same, fabs(here - (double)noise_at(&t[1], x, y)));
            other += pow(here - (double)noise_at(&t[2], x, y), 2);
            square += here * here;
        }
    }
    assert_true(same < 1e-4);
    assert_true(other > square);
    for (int i = 0; i < 3; i++) {
        stage_test_close(&t[i]);
    }
}

static void test_threads_give_the_same_bytes(void **state)
{
    (void)state;
    struct mns_particles particles = slab();
    struct stage_test one, three;
    stage_test_open(&one, MNS_ISA_AUTO, 1, &particles);
    stage_test_open(&three, MNS_ISA_AUTO, 3, &particles);
    look(&one, false);
    look(&three, false);
    draw(&one);
    draw(&three);
    for (int y = 0; y < HEIGHT; y++) {
        assert_memory_equal(one.cpu->noise.data + y * one.cpu->noise.stride, three.cpu->noise.data + y * three.cpu->noise.stride,
                            WIDTH * sizeof(float));
    }
    stage_test_close(&one);
    stage_test_close(&three);
}

/* Largest noise in the picture. */
static float largest_of(const struct stage_test *t)
{
    float largest = 0;
    for (int y = 0; y < HEIGHT; y++) {
        for (int x = 0; x < WIDTH; x++) {
            largest = fmaxf(largest, fabsf(noise_at(t, x, y)));
        }
    }
    return largest;
}

/* From afar, where particles are smaller than pixels, the noise is gone; on the way there it never jumps. */
static void test_fades_with_the_footprint(void **state)
{
    (void)state;
    struct mns_particles particles = slab();
    struct stage_test t;
    stage_test_open(&t, MNS_ISA_AUTO, 2, &particles);
    float before = 0;
    for (int step = 0; step <= 60; step++) {
        double height = 1.6 * pow(1.04, step); /* pixels of R: 6.4 to 0.6 */
        look(&t, true);
        assert_int_equal(mns_camera_orthographic(&t.camera, height, 0.1, 100), MNS_OK);
        draw(&t);
        float largest = largest_of(&t);
        assert_true(step == 0 || largest < before + 0.2f);
        assert_true(step > 0 || largest > 0.8f);
        before = largest;
        if (0.06 * HEIGHT / height < 2) { /* a cell is under 2 pixels */
            assert_true(largest == 0);
        }
    }
    stage_test_close(&t);
}

static void test_amplitude(void **state)
{
    (void)state;
    struct mns_particles particles = slab();
    struct stage_test t[3];
    static const float parts[3] = {1, 0.5f, 0};
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < COUNT; k++) {
            amplitudes[k] = parts[i];
        }
        particles.noise = (struct mns_attr){.data = amplitudes, .type = MNS_F32};
        stage_test_open(&t[i], MNS_ISA_AUTO, 2, &particles);
        look(&t[i], false);
        draw(&t[i]);
    }
    for (int y = 0; y < HEIGHT; y++) {
        for (int x = 0; x < WIDTH; x++) {
            assert_true(fabsf(noise_at(&t[1], x, y) - 0.5f * noise_at(&t[0], x, y)) < 1e-6f);
        }
    }
    assert_true(largest_of(&t[0]) > 0.5f && largest_of(&t[2]) == 0);
    for (int i = 0; i < 3; i++) {
        stage_test_close(&t[i]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_is_the_sum),
        cmocka_unit_test(test_gradients_are_of_unit_length),
        cmocka_unit_test(test_moves_with_the_fluid),
        cmocka_unit_test(test_pattern_is_the_ids),
        cmocka_unit_test(test_threads_give_the_same_bytes),
        cmocka_unit_test(test_fades_with_the_footprint),
        cmocka_unit_test(test_amplitude),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
