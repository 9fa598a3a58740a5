/* The kernels of the implicit curvature flow: every instruction set against a dense solve in double precision and against plain C. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "cpu/kernels.h"

#include <math.h>
#include <string.h>

enum { COUNT = 48, AXIS = 1 };

static const float DEPTH = 3, R = 0.02f;

static uint32_t random_state = 1;

static float uniform(void) /* in [0, 1) */
{
    random_state = random_state * 1664525u + 1013904223u;
    return (float)(random_state >> 8) / 16777216.0f;
}

/* Kind 0 noise; 1 noise, steps and holes; 2 a steep plane; 3 nearly all empty; 4 the ends of what is fluid, and what is not; 5 at the lens. */
static float depth_of(int kind, int i)
{
    static const float ends[] = {1e-40f, 1e-38f, 1e36f, 9e36f, DEPTH_EMPTY, INFINITY, NAN, 0, -1};
    float noise = R * uniform(), choice = uniform();
    switch (kind) {
    case 0: return DEPTH + noise;
    case 1: return choice < 0.1f ? DEPTH_EMPTY : choice < 0.3f ? DEPTH + 20 * R + noise : DEPTH + noise;
    case 2: return DEPTH + R * (float)i + noise;
    case 3: return choice < 0.9f ? DEPTH_EMPTY : DEPTH + noise;
    case 4: return ends[(int)(choice * 9)];
    default: return 1e-3f * R + 0.1f * noise;
    }
}

/* sigma: pixels at DEPTH. */
static struct implicit_flow flow_of(float sigma, bool orthographic)
{
    float p = sigma / sqrtf(8);
    struct implicit_flow flow = {.apart = 10 * R, .slant = R};
    flow.inverse[AXIS].slope = orthographic ? 0 : 1 / (p * DEPTH);
    flow.inverse[AXIS].offset = orthographic ? 1 / p : 0;
    return flow;
}

static double inverse_of(const struct implicit_flow *flow, float z)
{
    double inverse = (double)flow->inverse[AXIS].slope * z + flow->inverse[AXIS].offset;
    return fmin(fmax(inverse, 1 / (double)FLOW_P_MOST), FLOW_INVERSE_MOST);
}

static bool is_fluid(float z) { return z > 0 && z < DEPTH_LIMIT; }

/* What passes between two pixels. */
static double coefficient(const struct implicit_flow *flow, float a, float b)
{
    if (!is_fluid(a) || !is_fluid(b)) {
        return 0;
    }
    double p = inverse_of(flow, a), q = inverse_of(flow, b);
    return fabs((double)a - b) <= fmax(flow->apart, flow->slant * fmin(p, q)) ? 1 / (p * q) : 0;
}

/* (1 - L) z' = z by Gauss elimination of the whole matrix. */
static void solve_dense(const struct implicit_flow *flow, const float z[COUNT], double out[COUNT])
{
    static double matrix[COUNT][COUNT];
    memset(matrix, 0, sizeof(matrix));
    for (int i = 0; i < COUNT; i++) {
        matrix[i][i] += 1;
        out[i] = is_fluid(z[i]) ? z[i] : 0;
        if (i + 1 < COUNT) {
            double c = coefficient(flow, z[i], z[i + 1]);
            matrix[i][i] += c;
            matrix[i + 1][i + 1] += c;
            matrix[i][i + 1] = matrix[i + 1][i] = -c;
        }
    }
    for (int i = 0; i < COUNT; i++) {
        for (int j = i + 1; j < COUNT; j++) {
            double factor = matrix[j][i] / matrix[i][i];
            for (int k = i; k < COUNT; k++) {
                matrix[j][k] -= factor * matrix[i][k];
            }
            out[j] -= factor * out[i];
        }
    }
    for (int i = COUNT - 1; i >= 0; i--) {
        for (int k = i + 1; k < COUNT; k++) {
            out[i] -= matrix[i][k] * out[k];
        }
        out[i] /= matrix[i][i];
    }
}

/* Of the fluid of a line. */
static double range_of(const float z[COUNT])
{
    double least = INFINITY, most = 0;
    for (int i = 0; i < COUNT; i++) {
        least = is_fluid(z[i]) ? fmin(least, z[i]) : least;
        most = is_fluid(z[i]) ? fmax(most, z[i]) : most;
    }
    return fmax(most - least, 0);
}

static _Alignas(64) float before[COUNT][LINES], expected[COUNT][LINES], got[COUNT][LINES];
static _Alignas(64) float scratch[2 * COUNT * LINES];

static void fill(int kind)
{
    for (int i = 0; i < COUNT; i++) {
        for (int line = 0; line < LINES; line++) {
            before[i][line] = depth_of(kind, i);
        }
    }
    memcpy(expected, before, sizeof(before));
    memcpy(got, before, sizeof(before));
}

static void check_line(const struct implicit_flow *flow, int line)
{
    float z[COUNT];
    double dense[COUNT];
    for (int i = 0; i < COUNT; i++) {
        z[i] = before[i][line];
    }
    solve_dense(flow, z, dense);
    double p = fmin(1 / (flow->inverse[AXIS].slope * (double)DEPTH + flow->inverse[AXIS].offset), FLOW_P_MOST);
    double spread = fmax(1e-5, 3e-7 * p) * range_of(z); /* cpu/smooth/implicit_flow.h */
    for (int i = 0; i < COUNT; i++) {
        if (is_fluid(z[i])) {
            double tolerance = 4e-7 * dense[i] + spread;
            assert_true(fabs(got[i][line] - dense[i]) <= tolerance);
            assert_true(fabs(got[i][line] - (double)expected[i][line]) <= tolerance);
        } else {
            assert_memory_equal(&got[i][line], &before[i][line], sizeof(float));
        }
    }
}

static void test_every_instruction_set_solves_the_system(void **state)
{
    (void)state;
    static const float sigmas[] = {0.05f, 1, 12, 300, 20000};
    for (int isa = MNS_ISA_SCALAR; isa <= MNS_ISA_NEON; isa++) {
        const struct kernels *kernels = mns_kernels_get((enum mns_isa)isa);
        for (int i = 0; kernels && i < 60; i++) {
            struct implicit_flow flow = flow_of(sigmas[i % 5], i >= 30);
            fill(i % 6);
            mns_kernels_get(MNS_ISA_SCALAR)->smooth->implicit_flow->solve(&flow, AXIS, expected[0], LINES, COUNT, scratch);
            kernels->smooth->implicit_flow->solve(&flow, AXIS, got[0], LINES, COUNT, scratch);
            for (int line = 0; line < LINES; line++) {
                check_line(&flow, line);
            }
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_instruction_set_solves_the_system),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
