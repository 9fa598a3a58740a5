/* The kernels of the smoothing spline: every instruction set against a dense solve in double precision and against plain C. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "cpu/kernels.h"
#include "cpu/smooth/window.h"

#include <math.h>
#include <string.h>

enum { COUNT = 48, AXIS = AXIS_Y };

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
    case 1: return choice < 0.1f ? DEPTH_EMPTY : choice < 0.2f ? 0 : choice < 0.4f ? DEPTH + 20 * R + noise : DEPTH + noise;
    case 2: return DEPTH + R * (float)i + noise;
    case 3: return choice < 0.9f ? DEPTH_EMPTY : DEPTH + noise;
    case 4: return ends[(int)(choice * 9)];
    default: return 1e-3f * R + 0.1f * noise;
    }
}

/* sigma: pixels at DEPTH. */
static struct spline spline_of(float sigma, bool orthographic, float mu)
{
    float v = R / DEPTH, scale = orthographic ? 1 : v;
    struct spline spline = {.orthographic = orthographic, .radius = R, .apart = 10, .mu = mu};
    for (int axis = 0; axis < 2; axis++) { /* the other axis is another scale */
        spline.width[axis] = (axis == AXIS ? 1 : 3) * sigma / scale;
        spline.slant[axis] = (axis == AXIS ? 1.0f : 3.0f) * (orthographic ? 1 : v); /* of R a pixel */
    }
    return spline;
}

static bool is_fluid(float v) { return fabsf(v) < SPLINE_FLUID; }

static double sigma_of(const struct spline *spline, float v)
{
    double sigma = (double)spline->width[AXIS] * (spline->orthographic ? 1 : (double)v);
    return fmin(fmax(sigma, SPLINE_NARROW), SPLINE_WIDE);
}

static bool holds(const struct spline *spline, float a, float b)
{
    double apart = spline->orthographic ? spline->apart : (double)spline->apart * a * b;
    double slant = spline->orthographic ? spline->slant[AXIS] : (double)spline->slant[AXIS] * fmin(a, b);
    return is_fluid(a) && is_fluid(b) && fabs((double)a - b) <= fmax(apart, slant);
}

/* The normal equations of what is minimised. */
static struct {
    double matrix[COUNT][COUNT + 1];
} equations;

/* Adds weight * (sum of factors * u from pixel i on - target)^2. */
static void add(int i, int terms, const double *factors, double target, double weight)
{
    for (int a = 0; a < terms; a++) {
        for (int b = 0; b < terms; b++) {
            equations.matrix[i + a][i + b] += weight * factors[a] * factors[b];
        }
        equations.matrix[i + a][COUNT] += weight * factors[a] * target;
    }
}

/* The slope beyond pixel i, where other stands there, is expected to fall. */
static void add_end(const struct spline *spline, float v, float other, int first, double sign)
{
    static const double slope[] = {-1, 1};
    if (other < v) {
        double sigma = sigma_of(spline, v), square = spline->orthographic ? 1 : (double)v * v;
        add(first, 2, slope, sign * SPLINE_BEND * spline->mu / sigma * square, pow(sigma, 3) / SPLINE_BEND);
    }
}

static void eliminate(double out[COUNT])
{
    for (int i = 0; i < COUNT; i++) {
        for (int row = i + 1; row < COUNT; row++) {
            double factor = equations.matrix[row][i] / equations.matrix[i][i];
            for (int j = i; j <= COUNT; j++) {
                equations.matrix[row][j] -= factor * equations.matrix[i][j];
            }
        }
    }
    for (int i = COUNT - 1; i >= 0; i--) {
        double sum = equations.matrix[i][COUNT];
        for (int j = i + 1; j < COUNT; j++) {
            sum -= equations.matrix[i][j] * out[j];
        }
        out[i] = sum / equations.matrix[i][i];
    }
}

static void dense(const struct spline *spline, const float *v, float before, float after, double out[COUNT])
{
    static const double one[] = {1}, second[] = {1, -2, 1};
    memset(&equations, 0, sizeof(equations));
    for (int i = 0; i < COUNT; i++) {
        bool back = i > 0 && holds(spline, v[i - 1], v[i]), on = i + 1 < COUNT && holds(spline, v[i], v[i + 1]);
        add(i, 1, one, is_fluid(v[i]) ? v[i] : 0, 1);
        if (back && on) {
            add(i - 1, 3, second, 0, pow(sigma_of(spline, v[i]), 4));
        } else if (on) {
            add_end(spline, v[i], i > 0 ? v[i - 1] : before, i, 1);
        } else if (back) {
            add_end(spline, v[i], i + 1 < COUNT ? v[i + 1] : after, i - 1, -1);
        }
    }
    eliminate(out);
    for (int i = 0; i < COUNT; i++) {
        double half = v[i] / SPLINE_SWING, twice = v[i] * SPLINE_SWING;
        out[i] = is_fluid(v[i]) ? fmin(fmax(out[i], fmin(half, twice)), fmax(half, twice)) : v[i];
    }
}

static _Alignas(64) float before[COUNT][LINES], expected[COUNT][LINES], got[COUNT][LINES];
static _Alignas(64) float scratch[3 * COUNT * LINES];

/* What is no fluid keeps its bits. */
static void check_line(const struct spline *spline, int line, const double *exact, double range)
{
    for (int i = 0; i < COUNT; i++) {
        float v = before[i][line];
        if (!is_fluid(v)) {
            assert_memory_equal(&got[i][line], &v, sizeof(v));
            continue;
        }
        assert_true(fabsf(got[i][line]) >= fabsf(v) / SPLINE_SWING && fabsf(got[i][line]) <= fabsf(v) * SPLINE_SWING);
        double bend = spline->mu * (spline->orthographic ? 1 : (double)v * v), tolerance = 1e-6 * fabs((double)v) + 1e-5 * (range + bend);
        if (!(fabs((double)got[i][line] - expected[i][line]) <= tolerance) || (exact && !(fabs(got[i][line] - exact[i]) <= tolerance))) {
            fail_msg("pixel %d of sigma %g: %.9g, plain C %.9g, exact %.9g, tolerance %.3g", i, sigma_of(spline, v), (double)got[i][line],
                     (double)expected[i][line], exact ? exact[i] : NAN, tolerance);
        }
    }
}

static void check_lines(const struct spline *spline, float first, float last, bool against_dense, bool sane)
{
    for (int line = 0; line < LINES; line++) {
        double least = INFINITY, most = -INFINITY, exact[COUNT];
        float v[COUNT];
        for (int i = 0; i < COUNT; i++) {
            v[i] = before[i][line];
            least = is_fluid(v[i]) ? fmin(least, v[i]) : least;
            most = is_fluid(v[i]) ? fmax(most, v[i]) : most;
        }
        dense(spline, v, first, last, exact);
        check_line(spline, line, against_dense ? exact : NULL, sane ? fmax(most - least, 0) : INFINITY);
    }
}

/* The dense system of sigma = 100 is as much as double can solve to six digits. Depths at the ends of what is fluid, among others of quite another size, need
 * only stay fluid. */
static void test_every_instruction_set_solves_the_system(void **state)
{
    (void)state;
    static const float sigmas[] = {0.005f, 0.8f, 4, 30, 100, 5000};
    const struct spline_kernels *scalar = mns_kernels_get(MNS_ISA_SCALAR)->smooth->spline;
    for (int isa = MNS_ISA_SCALAR; isa <= MNS_ISA_NEON; isa++) {
        const struct kernels *kernels = mns_kernels_get((enum mns_isa)isa);
        for (int i = 0; kernels && i < 144; i++) {
            int kind = i % 6;
            float sigma = sigmas[i / 6 % 6], first = i & 1 ? SPLINE_OUTSIDE : SPLINE_EMPTY, last = i & 2 ? SPLINE_OUTSIDE : SPLINE_EMPTY;
            struct spline spline = spline_of(sigma, i >= 72, i % 5 ? 1 : 0);
            for (int j = 0; j < COUNT * LINES; j++) {
                before[j / LINES][j % LINES] = depth_of(kind, j / LINES);
            }
            scalar->enter(&spline, before[0], COUNT * LINES);
            memcpy(expected, before, sizeof(expected));
            memcpy(got, before, sizeof(got));
            scalar->solve(&spline, AXIS, expected[0], LINES, COUNT, first, last, scratch);
            kernels->smooth->spline->solve(&spline, AXIS, got[0], LINES, COUNT, first, last, scratch);
            check_lines(&spline, first, last, kind < 4 && sigma <= 100, kind != 4);
        }
    }
}

/* Holes between particles, of 1 to 6 pixels in a surface that rises, under a sigma for which 4 may be filled; and what is no hole: something else seen
 * through it, a step, the picture's edge. */
static void test_holes_are_filled(void **state)
{
    (void)state;
    for (int isa = MNS_ISA_SCALAR; isa <= MNS_ISA_NEON; isa++) {
        const struct kernels *kernels = mns_kernels_get((enum mns_isa)isa);
        for (int i = 0; kernels && i < 2; i++) {
            struct spline spline = spline_of(4.5f / SPLINE_HOLE, i > 0, 1);
            for (int j = 0; j < COUNT * LINES; j++) {
                int pixel = j / LINES, line = j % LINES, kind = line % 4, wide = line / 4 % 6 + 1;
                bool hole = kind < 3 && pixel >= 20 && pixel < 20 + wide;
                bool other = (kind == 1 && pixel == 20) || (kind == 2 && pixel >= 20 + wide);
                float depth = DEPTH + 0.1f * R * (float)pixel + (other ? 20 * R : 0);
                before[pixel][line] = (hole && !other) || (kind == 3 && pixel < wide) ? DEPTH_EMPTY : depth;
            }
            kernels->smooth->spline->enter(&spline, before[0], COUNT * LINES);
            memcpy(got, before, sizeof(got));
            kernels->smooth->spline->fill(&spline, AXIS, got[0], LINES, COUNT);
            for (int line = 0; line < LINES; line++) {
                int wide = line / 4 % 6 + 1;
                for (int pixel = 0; pixel < COUNT; pixel++) {
                    float v = before[pixel][line];
                    if (line % 4 == 0 && wide <= 4 && pixel >= 20 && pixel < 20 + wide) {
                        float a = before[19][line], b = before[20 + wide][line];
                        v = a + (b - a) * (float)(pixel - 19) / (float)(wide + 1);
                    }
                    assert_true(fabsf(got[pixel][line] - v) <= 1e-6f * fabsf(v));
                }
            }
        }
    }
}

/* There and back. */
static void test_depths_become_values_and_depths_again(void **state)
{
    (void)state;
    static _Alignas(64) float v[BLOCK_HEIGHT * BLOCK_WIDTH], raw[BLOCK_HEIGHT * BLOCK_WIDTH];
    for (int isa = MNS_ISA_SCALAR; isa <= MNS_ISA_NEON; isa++) {
        const struct kernels *kernels = mns_kernels_get((enum mns_isa)isa);
        for (int i = 0; kernels && i < 12; i++) {
            struct spline spline = spline_of(4, i >= 6, 1);
            float nearest = DEPTH_EMPTY, farthest = 0;
            for (int j = 0; j < BLOCK_HEIGHT * BLOCK_WIDTH; j++) {
                raw[j] = v[j] = depth_of(i % 6, j % 16);
            }
            kernels->smooth->spline->enter(&spline, v, BLOCK_HEIGHT * BLOCK_WIDTH);
            for (int j = 0; j < BLOCK_HEIGHT * BLOCK_WIDTH; j++) {
                bool fluid = raw[j] > 0 && raw[j] < DEPTH_LIMIT;
                assert_true(is_fluid(v[j]) == fluid);
                assert_true(fluid || v[j] == (raw[j] <= 0 ? SPLINE_OUTSIDE : SPLINE_EMPTY));
                if (fluid && i % 6 != 4) {
                    double exact = spline.orthographic ? -(double)raw[j] / R : R / (double)raw[j];
                    assert_true(fabs(v[j] - exact) <= 2e-7 * fabs(exact));
                }
            }
            struct depth_range range = kernels->smooth->spline->leave(&spline, raw, v, BLOCK_WIDTH);
            for (int j = 0; j < BLOCK_HEIGHT * BLOCK_WIDTH; j++) {
                bool fluid = raw[j] > 0 && raw[j] < DEPTH_LIMIT;
                assert_true(fluid ? v[j] > 0 && v[j] < DEPTH_LIMIT : memcmp(&v[j], &raw[j], sizeof(float)) == 0);
                assert_true(!fluid || i % 6 == 4 || fabsf(v[j] - raw[j]) <= 4e-7f * raw[j]);
                nearest = raw[j] > 0 ? fminf(nearest, v[j]) : nearest;
                farthest = fmaxf(farthest, v[j]);
            }
            assert_true(i % 6 == 4 || (range.min == nearest && range.max == farthest)); /* no range has NaN in it */
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_instruction_set_solves_the_system),
        cmocka_unit_test(test_holes_are_filled),
        cmocka_unit_test(test_depths_become_values_and_depths_again),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
