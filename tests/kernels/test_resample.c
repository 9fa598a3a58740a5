/* The kernels of smoothing at part of the size: plain C against closed forms, every instruction set against plain C. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "cpu/kernels.h"

#include <math.h>
#include <string.h>

enum { TEXELS = 37, ROWS = 7, STRIDE = 4 * TEXELS + 256, MARGIN = 64 };

static const float R = 0.02f, FOCAL = 1000, MIDDLE = 2;

static uint32_t random_state = 1;

static float uniform(void) /* in [0, 1) */
{
    random_state = random_state * 1664525u + 1013904223u;
    return (float)(random_state >> 8) / 16777216.0f;
}

static struct resample resample_of(int scale, bool orthographic)
{
    return (struct resample){.scale = scale,
                             .orthographic = orthographic,
                             .edge = 10 * R,
                             .slant_x = 20 * (float)scale / FOCAL,
                             .slant_y = 20 * (float)scale / FOCAL};
}

/* An image with a margin of 0 around it, as planes have. */
struct image {
    float values[ROWS * 4 + 2 * 8][STRIDE];
};

static float *at(struct image *image, int x, int y) { return &image->values[y + 8][x + MARGIN]; }

/* A slanted plane, then by kind: 1 two surfaces and holes, 2 the ends of what is fluid and what is not. */
static float depth_of(bool orthographic, int kind, double x, double y)
{
    static const float ends[] = {0.1f, 1e36f, 9e36f, DEPTH_EMPTY, INFINITY, NAN, 0, -1};
    double slope = 0.3 * (x - 60) / (double)FOCAL + 0.7 * (y - 10) / (double)FOCAL;
    float plane = (float)(orthographic ? MIDDLE + 2 * slope : MIDDLE / (1 - slope)), choice = uniform();
    return kind == 0                    ? plane
           : kind == 1 && choice < 0.1f ? DEPTH_EMPTY
           : kind == 1 && choice < 0.3f ? plane - 30 * R
           : kind == 1                  ? plane + R * uniform()
                                        : ends[(int)(choice * 8)];
}

static void fill(struct image *image, bool orthographic, int kind, int width, int height, double pixel)
{
    memset(image, 0, sizeof(*image));
    for (int y = 0; y < height; y++) {
        for (int x = 0; x < width; x++) {
            *at(image, x, y) = depth_of(orthographic, kind, pixel * (x + 0.5), pixel * (y + 0.5));
        }
    }
}

static bool same(float a, float b, float tolerance) { return a == b || (isnan(a) && isnan(b)) || fabsf(a - b) <= tolerance; }

/* On a plane: its flat depth at the texel's middle. Of two surfaces: the nearer, never anything between them. */
static void test_reduces_to_the_nearest_surface(void **state)
{
    (void)state;
    static struct image image;
    for (int i = 0; i < 8; i++) {
        int scale = i & 1 ? 2 : 4, kind = i >> 2;
        struct resample resample = resample_of(scale, i & 2);
        float out[TEXELS + 16];
        fill(&image, resample.orthographic, kind, TEXELS * scale, scale, 1);
        mns_resample_kernels_scalar.reduce(&resample, at(&image, 0, 0), STRIDE, scale, TEXELS * scale, TEXELS, out);
        for (int t = 0; t < TEXELS; t++) {
            float nearest = DEPTH_EMPTY;
            for (int k = 0; k < scale * scale; k++) {
                nearest = fminf(nearest, *at(&image, t * scale + k % scale, k / scale));
            }
            if (kind == 0) {
                float middle = depth_of(resample.orthographic, 0, (t + 0.5) * scale, 0.5 * scale);
                assert_true(fabsf(out[t] - middle) < 2e-6f * MIDDLE);
            } else if (nearest < DEPTH_LIMIT) {
                assert_true(out[t] >= nearest && out[t] - nearest < 2 * R);
            } else {
                assert_true(out[t] == DEPTH_EMPTY);
            }
        }
    }
}

struct texels {
    float flat[3][STRIDE], slope_x[3][STRIDE], slope_y[3][STRIDE];
};

/* The tangents of three rows of texels, and how the kernel sees them. */
static void make_tangents(const struct resample_kernels *kernels, const struct resample *resample, struct image *texels, struct texels *out,
                          struct texel_row rows[3])
{
    memset(out, 0, sizeof(*out));
    for (int j = 0; j < 3; j++) {
        kernels->tangents(resample, at(texels, 0, j + 1), STRIDE, TEXELS, out->flat[j] + MARGIN, out->slope_x[j] + MARGIN,
                          out->slope_y[j] + MARGIN);
        rows[j] = (struct texel_row){out->flat[j] + MARGIN, out->slope_x[j] + MARGIN, out->slope_y[j] + MARGIN};
    }
}

/* A plane comes back as it was, also at its last pixel before nothing, and before and behind another surface. */
static void test_a_plane_comes_back(void **state)
{
    (void)state;
    static struct image pixels, texels;
    static struct texels tangents;
    for (int i = 0; i < 8; i++) {
        int scale = i & 1 ? 2 : 4, width = TEXELS * scale;
        struct resample resample = resample_of(scale, i & 2);
        struct texel_row rows[3];
        bool drop = i & 4;
        fill(&texels, resample.orthographic, 0, TEXELS, 5, scale);
        fill(&pixels, resample.orthographic, 0, width, 5 * scale, 1);
        for (int y = 0; y < 5; y++) { /* texels 9 to 11 are nearer, or not there */
            for (int t = 9; t < 12; t++) {
                *at(&texels, t, y) = drop ? MIDDLE - 40 * R : DEPTH_EMPTY;
            }
        }
        make_tangents(&mns_resample_kernels_scalar, &resample, &texels, &tangents, rows);
        for (int row = 0; row < scale; row++) {
            float out[STRIDE];
            const float *raw = at(&pixels, 0, 2 * scale + row);
            mns_resample_kernels_scalar.interpolate(&resample, rows, row, raw, width, out);
            for (int x = 0; x < width; x++) {
                assert_true(same(out[x], raw[x], 3e-6f * MIDDLE));
            }
        }
    }
}

/* A pixel whose surface no texel near it has keeps its raw depth; what is empty stays so. */
static void test_what_no_texel_has_stays(void **state)
{
    (void)state;
    static struct image texels;
    static struct texels tangents;
    struct resample resample = resample_of(4, false);
    struct texel_row rows[3];
    float raw[4 * TEXELS], out[4 * TEXELS];
    fill(&texels, false, 0, TEXELS, 5, 4);
    make_tangents(&mns_resample_kernels_scalar, &resample, &texels, &tangents, rows);
    for (int x = 0; x < 4 * TEXELS; x++) {
        raw[x] = x % 3 == 0 ? MIDDLE + 50 * R : x % 3 == 1 ? MIDDLE - 50 * R : DEPTH_EMPTY;
    }
    mns_resample_kernels_scalar.interpolate(&resample, rows, 1, raw, 4 * TEXELS, out);
    assert_memory_equal(out, raw, sizeof(raw));
}

/* Values off by more than rounding: a difference within rounding of a limit falls on its other side, of a few thousand values at most a few. */
static void compare_with_plain_c(const struct resample_kernels *kernels, const struct resample *resample, int kind, int *apart)
{
    const struct resample_kernels *plain = &mns_resample_kernels_scalar;
    static struct image pixels, texels;
    static struct texels expected, found;
    struct texel_row rows[3], rows_found[3];
    int scale = resample->scale, width = TEXELS * scale - 1;
    float reduced[2][STRIDE], out[2][STRIDE];
    fill(&pixels, resample->orthographic, kind, width, 5 * scale, 1);
    plain->reduce(resample, at(&pixels, 0, 0), STRIDE, scale, width, TEXELS, reduced[0]);
    kernels->reduce(resample, at(&pixels, 0, 0), STRIDE, scale, width, TEXELS, reduced[1]);
    for (int t = 0; t < TEXELS; t++) {
        *apart += !same(reduced[0][t], reduced[1][t], 1e-6f * fabsf(reduced[0][t]));
    }
    fill(&texels, resample->orthographic, kind, TEXELS, 5, scale);
    make_tangents(kernels, resample, &texels, &found, rows_found);
    make_tangents(plain, resample, &texels, &expected, rows);
    for (int t = MARGIN; t < MARGIN + TEXELS; t++) {
        float flat = expected.flat[1][t];
        assert_true(same(flat, found.flat[1][t], 1e-6f * flat));
        *apart += !same(expected.slope_x[1][t], found.slope_x[1][t], 1e-6f * flat + 1e-6f * fabsf(expected.slope_x[1][t]));
        *apart += !same(expected.slope_y[1][t], found.slope_y[1][t], 1e-6f * flat + 1e-6f * fabsf(expected.slope_y[1][t]));
    }
    for (int row = 0; row < scale; row++) {
        const float *raw = at(&pixels, 0, 2 * scale + row);
        plain->interpolate(resample, rows, row, raw, width, out[0]);
        out[1][width] = 7; /* stays */
        kernels->interpolate(resample, rows, row, raw, width, out[1]);
        assert_true(out[1][width] == 7);
        for (int x = 0; x < width; x++) {
            *apart += !same(out[0][x], out[1][x], 2e-6f * fabsf(out[0][x]));
        }
    }
}

static void test_instruction_sets_agree(void **state)
{
    (void)state;
    for (enum mns_isa isa = MNS_ISA_SSE2; isa <= MNS_ISA_NEON; isa++) {
        const struct kernels *kernels = mns_kernels_get(isa);
        int apart = 0;
        for (int i = 0; kernels && i < 120; i++) {
            struct resample resample = resample_of(i & 1 ? 2 : 4, i & 2);
            random_state = 99u + (uint32_t)i;
            compare_with_plain_c(kernels->smooth->resample, &resample, i % 3, &apart);
        }
        assert_true(apart <= 5);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_reduces_to_the_nearest_surface),
        cmocka_unit_test(test_a_plane_comes_back),
        cmocka_unit_test(test_what_no_texel_has_stays),
        cmocka_unit_test(test_instruction_sets_agree),
    };
    return cmocka_run_group_tests_name("resample", tests, NULL, NULL);
}
