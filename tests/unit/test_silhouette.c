/* Silhouettes of known shape, against the part of each pixel that they cover. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "cpu/silhouette.h"
#include "smooth_test.h"

enum { WIDTH = 90, HEIGHT = 70, SAMPLES = 16 };

static const float NEAR_DEPTH = 2, FAR_DEPTH = 3;

/* A half plane (radius 0) whose edge passes near the middle, or a disc there. */
struct shape {
    double cosine, sine, offset, radius;
};

static bool covers(const struct shape *shape, double x, double y)
{
    double dx = x - 0.5 * WIDTH, dy = y - 0.5 * HEIGHT;
    return shape->radius > 0 ? hypot(dx - shape->offset, dy) < shape->radius : dx * shape->cosine + dy * shape->sine < shape->offset;
}

static float part_of(const struct shape *shape, int x, int y)
{
    int inside = 0;
    for (int i = 0; i < SAMPLES * SAMPLES; i++) {
        inside += covers(shape, x + (i % SAMPLES + 0.5) / SAMPLES, y + ((double)(i / SAMPLES) + 0.5) / SAMPLES);
    }
    return (float)inside / (SAMPLES * SAMPLES);
}

static const float near_color[4] = {1, 0.2f, 0, 1}, far_color[4] = {0, 0.6f, 1, 1}, no_color[4] = {0, 0, 0, 0};

/* A picture of the shape over what is behind, as shading leaves it. */
static void draw(struct fixture *fixture, const struct shape *shape, float behind, const float *behind_color, struct mns_image *image)
{
    struct depth_plane *depth = &fixture->cpu.depth_raw;
    for (int y = 0; y < HEIGHT; y++) {
        for (int x = 0; x < WIDTH; x++) {
            bool here = covers(shape, x + 0.5, y + 0.5);
            *pixel(depth, x, y) = here ? NEAR_DEPTH : behind;
            for (int c = 0; c < 4; c++) {
                float value = here ? near_color[c] : behind_color[c];
                if (image->pixel == MNS_PIXEL_F32) {
                    ((float *)image->data)[4 * (y * WIDTH + x) + c] = value;
                } else {
                    ((unsigned char *)image->data)[4 * (y * WIDTH + x) + c] = (unsigned char)(255 * value);
                }
            }
        }
    }
    for (int i = 0; i < depth->blocks_x * depth->blocks_y; i++) {
        depth->ranges[i] = range_of(depth, i % depth->blocks_x, i / depth->blocks_x);
    }
}

static void blend(struct fixture *fixture, const struct mns_image *image)
{
    const struct silhouette silhouette = {.depth = &fixture->cpu.depth_raw, .edge = 0.1f, .slope = 0.02f, .image = image};
    assert_true(mns_silhouette_blend(&fixture->cpu, &silhouette));
}

static void finish(struct fixture *fixture)
{
    mns_memory_put(&fixture->memory, fixture->cpu.picture, fixture->cpu.picture_capacity, 1);
    fixture_destroy(fixture);
}

/* Root of the mean square error of one channel, over the pixels that the edge passes. */
static double error_of(const struct shape *shape, const float *colors, const float *behind_color)
{
    double sum = 0;
    int count = 0;
    for (int y = 8; y < HEIGHT - 8; y++) {
        for (int x = 8; x < WIDTH - 8; x++) {
            float part = part_of(shape, x, y), right = behind_color[0] + part * (near_color[0] - behind_color[0]);
            if (part > 0 && part < 1) {
                double error = (double)colors[4 * (y * WIDTH + x)] - (double)right;
                sum += error * error;
                count++;
            }
        }
    }
    assert_true(count > 10);
    return sqrt(sum / count);
}

static float picture[4 * WIDTH * HEIGHT];

static struct mns_image image_of(void *data, enum mns_pixel pixel)
{
    return (struct mns_image){.data = data, .width = WIDTH, .height = HEIGHT, .channels = 4, .pixel = pixel};
}

/* Squares of the errors without and with blending, added to sums; none is more than `most` times what it was. */
static void add_errors(const struct shape *shape, float behind, double most, double sums[2])
{
    struct fixture *fixture = fixture_create(WIDTH, HEIGHT, MNS_ISA_SCALAR, 1);
    struct mns_image image = image_of(picture, MNS_PIXEL_F32);
    draw(fixture, shape, behind, far_color, &image);
    double before = error_of(shape, picture, far_color);
    blend(fixture, &image);
    double after = error_of(shape, picture, far_color);
    if (!(after <= most * before)) {
        fail_msg("cosine %g, radius %g: error %g, %g without", shape->cosine, shape->radius, after, before);
    }
    sums[0] += before * before;
    sums[1] += after * after;
    finish(fixture);
}

/* A third of the error on the whole; least is gained near 0 and 45 degrees, where the edge may have no step in sight. */
static void test_slanted_edges(void **state)
{
    (void)state;
    double sums[2] = {0, 0};
    for (int degrees = 3; degrees < 360; degrees += 8) {
        double angle = degrees * 3.14159265358979 / 180;
        add_errors(&(struct shape){cos(angle), sin(angle), 0.3, 0}, degrees % 16 > 7 ? DEPTH_EMPTY : FAR_DEPTH, 0.9, sums);
    }
    assert_true(sqrt(sums[1] / sums[0]) < 0.33);
}

static void test_drops(void **state)
{
    (void)state;
    double sums[2] = {0, 0};
    for (int radius = 5; radius < 30; radius += 4) {
        add_errors(&(struct shape){0, 0, 0.2, radius + 0.3}, DEPTH_EMPTY, 0.75, sums);
    }
    assert_true(sqrt(sums[1] / sums[0]) < 0.5);
}

/* Over nothing the colour stays what it is and alpha is the part that is covered. */
static void test_a_transparent_background(void **state)
{
    (void)state;
    struct fixture *fixture = fixture_create(WIDTH, HEIGHT, MNS_ISA_SCALAR, 1);
    struct shape shape = {0.8, 0.6, 0.3, 0};
    struct mns_image image = image_of(picture, MNS_PIXEL_F32);
    draw(fixture, &shape, DEPTH_EMPTY, no_color, &image);
    blend(fixture, &image);
    int partial = 0;
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        float alpha = picture[4 * i + 3];
        partial += alpha > 0 && alpha < 1;
        for (int c = 0; c < 3 && alpha > 0; c++) {
            assert_true(fabsf(picture[4 * i + c] - near_color[c]) < 1e-5f);
        }
        if (alpha > 0 && alpha < 1 && i % WIDTH > 8 && i % WIDTH < WIDTH - 8 && i / WIDTH > 8 && i / WIDTH < HEIGHT - 8) {
            assert_true(fabsf(alpha - part_of(&shape, i % WIDTH, i / WIDTH)) < 0.2f);
        }
    }
    assert_true(partial > 20);
    finish(fixture);
}

/* Away from edges no byte changes, nor on a surface that is only steep; several threads write what one does. */
static void test_only_silhouettes_change(void **state)
{
    (void)state;
    static unsigned char codes[2][4 * WIDTH * HEIGHT], before[4 * WIDTH * HEIGHT];
    struct shape shape = {0.8, 0.6, 0.3, 0};
    for (int i = 0; i < 2; i++) {
        struct fixture *fixture = fixture_create(WIDTH, HEIGHT, MNS_ISA_SCALAR, i ? 3 : 1);
        struct mns_image image = image_of(codes[i], MNS_PIXEL_U8);
        draw(fixture, &shape, NEAR_DEPTH + 0.03f, far_color, &image);
        memcpy(before, codes[i], sizeof(before));
        blend(fixture, &image);
        assert_memory_equal(codes[i], before, sizeof(before)); /* not apart */
        draw(fixture, &shape, FAR_DEPTH, far_color, &image);
        blend(fixture, &image);
        int changed = 0;
        for (int p = 0; p < WIDTH * HEIGHT; p++) {
            bool differs = memcmp(codes[i] + (size_t)(4 * p), before + (size_t)(4 * p), 4) != 0;
            double away =
                fabs((p % WIDTH + 0.5 - 0.5 * WIDTH) * shape.cosine + (p / WIDTH + 0.5 - 0.5 * HEIGHT) * shape.sine - shape.offset);
            assert_true(!differs || away < 1);
            changed += differs;
        }
        assert_true(changed > 50);
        finish(fixture);
    }
    assert_memory_equal(codes[0], codes[1], sizeof(codes[0]));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_slanted_edges),
        cmocka_unit_test(test_drops),
        cmocka_unit_test(test_a_transparent_background),
        cmocka_unit_test(test_only_silhouettes_change),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
