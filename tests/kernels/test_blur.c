/* The kernels of stage blur: every instruction set against plain C, and plain C against the formula. */
#include "kernels/kernel_test.h"

#include "cpu/plane.h"

enum { COUNT = 83, BORDER = 128, ROW = COUNT + 2 * BORDER + 16, ROWS = 260 };

static float depths[3][ROW], texels[ROWS][ROW];

static void fill_depths(int kind)
{
    for (int y = 0; y < 3; y++) {
        for (int x = 0; x < ROW; x++) {
            float z = expf(uniform(-12, 12));
            depths[y][x] = kind == 0 ? z : uniform(0, 1) < (kind == 1 ? 0.5f : 0.95f) ? DEPTH_EMPTY : z;
        }
    }
}

static void test_decay(void **state)
{
    (void)state;
    const struct kernels *scalar = mns_kernels_get(MNS_ISA_SCALAR), *vector;
    for (int kind = 0; kind < 6; kind++) {
        fill_depths(kind % 3);
        const struct blur_sigma sigma = {.scale = kind == 5 ? 1e-7f : 3, .least = kind & 1 ? 1.5f : 1e-3f, .orthographic = kind >= 3};
        float expected[COUNT + 16], got[COUNT + 16];
        scalar->blur->decay(&sigma, depths[1] + BORDER, ROW, COUNT, expected);
        int index = 0;
        while ((vector = vector_kernels(&index))) {
            vector->blur->decay(&sigma, depths[1] + BORDER, ROW, COUNT, got);
            assert_near(got, expected, COUNT, 4e-6f);
        }
    }
}

/* sigma 0: texels where nothing shows. */
static float decay_of(float sigma) { return sigma > 0 ? expf(-fminf(0.5f / (sigma * sigma), 80)) : -1; }

static void test_line(void **state)
{
    (void)state;
    static const float sigmas[] = {1e-3f, 0.5f, 1.5f, 7.3f, BLUR_SIGMA_MAX};
    const struct kernels *scalar = mns_kernels_get(MNS_ISA_SCALAR), *vector;
    for (int y = 0; y < ROWS; y++) {
        for (int x = 0; x < ROW; x++) {
            texels[y][x] = uniform(0, 1) < 0.3f ? 0 : uniform(0, 2);
        }
    }
    for (int down = 0; down < 2; down++) {
        for (int kind = 0; kind < 6; kind++) {
            float decay[COUNT + 16], expected[COUNT + 16] = {0}, got[COUNT + 16] = {0};
            for (int i = 0; i < COUNT + 16; i++) {
                decay[i] = decay_of(kind < 5 ? sigmas[kind] : uniform(0, 1) < 0.3f ? 0 : uniform(0, BLUR_SIGMA_MAX));
            }
            struct blur_line line = {.in = texels[130] + BORDER,
                                     .step = down ? ROW : 1,
                                     .decay = decay,
                                     .out = expected,
                                     .before = down ? 5 : 0,
                                     .after = down ? 60 : COUNT - 1,
                                     .slope = !down,
                                     .count = COUNT};
            scalar->blur->line(&line);
            line.out = got;
            int index = 0;
            while ((vector = vector_kernels(&index))) {
                vector->blur->line(&line);
                assert_near(got, expected, COUNT, 2e-5f);
            }
        }
    }
}

/* The weights that the recurrence stands for. */
static void test_line_is_the_gaussian(void **state)
{
    (void)state;
    const float sigma = 4.4f;
    float in[257] = {0}, decay[1] = {decay_of(sigma)}, out[16];
    double sum = 0;
    for (int i = -20; i <= 20; i++) {
        sum += fmax(exp(-i * i / (2.0 * (double)sigma * (double)sigma)) - (double)BLUR_FLOOR, 0);
    }
    for (int i = -20; i <= 20; i++) {
        in[128 + i] = 1;
        const struct blur_line line = {
            .in = in + 128, .step = 1, .decay = decay, .out = out, .before = 120, .after = 120, .slope = 0, .count = 1};
        mns_kernels_get(MNS_ISA_SCALAR)->blur->line(&line);
        double expected = fmax(exp(-i * i / (2.0 * (double)sigma * (double)sigma)) - (double)BLUR_FLOOR, 0) / sum;
        assert_true(fabs((double)out[0] - expected) < 1e-5);
        in[128 + i] = 0;
    }
}

static void test_upsample(void **state)
{
    (void)state;
    const struct kernels *scalar = mns_kernels_get(MNS_ISA_SCALAR), *vector;
    float expected[256 + 16], got[256 + 16];
    for (int scale = 1; scale <= 4; scale *= 2) {
        for (int count = 1; count <= 256; count += 17) {
            scalar->blur->upsample(texels[3] + BORDER, texels[4] + BORDER, 0.375f, scale, 16, count, expected);
            int index = 0;
            while ((vector = vector_kernels(&index))) {
                vector->blur->upsample(texels[3] + BORDER, texels[4] + BORDER, 0.375f, scale, 16, count, got);
                assert_near(got, expected, count, 2e-6f);
            }
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_decay),
        cmocka_unit_test(test_line),
        cmocka_unit_test(test_line_is_the_gaussian),
        cmocka_unit_test(test_upsample),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
