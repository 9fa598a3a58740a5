/* The kernels of the explicit flows: every instruction set against plain C, on random depths and on the worst ones. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "cpu/kernels.h"

#include <math.h>
#include <string.h>

enum { COUNT = 48, MARGIN = 16, WIDTH = COUNT + 2 * MARGIN };

static uint32_t random_state = 1;

static float uniform(void) /* in [0, 1) */
{
    random_state = random_state * 1664525u + 1013904223u;
    return (float)(random_state >> 8) / 16777216.0f;
}

/* kind 0: rough; 1: with steps and holes; 2: the ends of float; 3: at the lens. */
static float depth_of(int kind)
{
    float choice = uniform(), noise = 0.05f * uniform();
    switch (kind) {
    case 0: return 2 + noise;
    case 1: return choice < 0.2f ? DEPTH_EMPTY : choice < 0.4f ? 4 + noise : 2 + noise;
    case 2: return choice < 0.2f ? 1e-30f : choice < 0.4f ? 9e36f : choice < 0.6f ? DEPTH_EMPTY : choice < 0.8f ? 0 : 1e10f * (1 + noise);
    default: return 0.01f + noise;
    }
}

struct rows {
    _Alignas(64) float depth[4][WIDTH], start[WIDTH], across[3][WIDTH], down[3][WIDTH], speed[3][WIDTH], flux[WIDTH], out[WIDTH];
};

/* Three rows of speeds, then a step of the middle one. */
static void take(const struct flow_kernels *kernels, const struct flow *flow, struct rows *rows)
{
    struct flow_row row[3];
    for (int y = 0; y < 3; y++) {
        row[y] = (struct flow_row){rows->across[y] + MARGIN, rows->down[y] + MARGIN, rows->speed[y] + MARGIN};
        kernels->speed(flow, rows->depth[y] + MARGIN, rows->depth[y + 1] + MARGIN, rows->start + MARGIN, 3,
                       rows->down[y > 0 ? y - 1 : 0] + MARGIN, COUNT, &row[y]);
    }
    kernels->step(flow, rows->depth[0] + MARGIN, &row[0], row[1].speed, COUNT, rows->flux + MARGIN, rows->out + MARGIN);
    kernels->step(flow, rows->depth[1] + MARGIN, &row[1], row[2].speed, COUNT, rows->flux + MARGIN, rows->out + MARGIN);
}

/* Tolerance: cpu/smooth/flow.h. */
static void compare(const struct rows *expected, const struct rows *got)
{
    for (int x = MARGIN + 1; x < MARGIN + COUNT - 1; x++) {
        float depth = expected->depth[1][x], largest = 0;
        const float differences[4] = {expected->across[1][x - 1], expected->across[1][x], expected->down[0][x], expected->down[1][x]};
        for (int i = 0; i < 4; i++) {
            largest = fmaxf(largest, fabsf(differences[i]));
        }
        assert_true(expected->across[1][x] == got->across[1][x] && expected->down[1][x] == got->down[1][x]);
        assert_true(fabsf(expected->out[x] - got->out[x]) <= 4e-7f * depth + 1e-6f * largest);
    }
}

static void test_every_instruction_set_is_plain_c(void **state)
{
    (void)state;
    static struct rows expected, got;
    for (int i = 0; i < 400; i++) {
        struct flow flow = {.focal_square = {1e6f, 9e5f},
                            .apart = 0.3f,
                            .slope = {0.02f, 0.021f},
                            .rate = {i & 4 ? 0.5f : 100, 0.45f},
                            .count = i & 8 ? 7 : 0,
                            .orthographic = (i & 16) != 0};
        memset(&expected, 0, sizeof(expected));
        for (int x = 0; x < WIDTH; x++) {
            expected.start[x] = 1 + 2 * uniform();
            for (int y = 0; y < 4; y++) {
                expected.depth[y][x] = depth_of(i & 3);
            }
        }
        got = expected;
        take(&mns_flow_kernels_scalar, &flow, &expected);
        for (int isa = MNS_ISA_SSE2; isa <= MNS_ISA_NEON; isa++) {
            struct rows other = got;
            if (mns_kernels_get((enum mns_isa)isa)) {
                take(mns_kernels_get((enum mns_isa)isa)->smooth->flow, &flow, &other);
                compare(&expected, &other);
            }
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_every_instruction_set_is_plain_c)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
