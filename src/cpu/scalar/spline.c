/* spline.c: cubic smoothing splines in plain C. */
#include "cpu/smooth/spline.h"

#include "cpu/smooth/lines.h"
#include "cpu/smooth/window.h"

#include <math.h>

static float clamp(float a, float low, float high) { return lesser(greater(a, low), high); }

static float value_of(const struct spline *spline, float depth)
{
    if (!(depth > 0 && depth < DEPTH_LIMIT)) {
        return depth <= 0 ? SPLINE_OUTSIDE : SPLINE_EMPTY;
    }
    float v = clamp(spline->orthographic ? depth / spline->radius : spline->radius / depth, SPLINE_LEAST, SPLINE_MOST);
    return spline->orthographic ? -v : v;
}

static void enter(const struct spline *spline, float *values, int count)
{
    for (int i = 0; i < count; i++) {
        values[i] = value_of(spline, values[i]);
    }
}

static bool is_fluid(float v) { return fabsf(v) < SPLINE_FLUID; }

/* Whether two neighbours belong together. */
static bool holds(const struct spline *spline, int axis, float a, float b)
{
    float apart = spline->orthographic ? spline->apart : spline->apart * (a * b);
    float slant = spline->orthographic ? spline->slant[axis] : spline->slant[axis] * lesser(a, b);
    return is_fluid(a) && is_fluid(b) && fabsf(a - b) <= greater(apart, slant);
}

/* s, pixels. */
static float width_of(const struct spline *spline, int axis, float v)
{
    return clamp(spline->width[axis] * (spline->orthographic ? 1 : v), SPLINE_NARROW, SPLINE_WIDE);
}

static void fill_line(const struct spline *spline, int axis, float *v, ptrdiff_t stride, int count)
{
    float last = v[0];
    int gap = 0; /* pixels since */
    for (int i = 1; i < count; i++) {
        float here = v[i * stride];
        if (holds(spline, axis, last, here)) {
            for (int j = 1; j <= gap; j++) {
                v[(i - j) * stride] = here + (last - here) * ((float)j / (float)(gap + 1));
            }
            last = here;
            gap = 0;
        } else if (is_fluid(last) && here <= SPLINE_EMPTY && (float)(gap + 1) <= SPLINE_HOLE * width_of(spline, axis, last)) {
            gap++;
        } else {
            last = here;
            gap = 0;
        }
    }
}

static void fill(const struct spline *spline, int axis, float *v, ptrdiff_t stride, int count)
{
    for (int l = 0; l < LINES; l++) {
        fill_line(spline, axis, v + l, stride, count);
    }
}

static struct depth_range leave(const struct spline *spline, const float *raw, float *v, ptrdiff_t stride)
{
    struct depth_range range = {DEPTH_EMPTY, 0};
    for (int y = 0; y < BLOCK_HEIGHT; y++, raw += stride, v += stride) {
        for (int x = 0; x < BLOCK_WIDTH; x++) {
            float depth = raw[x];
            if (is_fluid(value_of(spline, depth))) {
                depth = spline->orthographic ? -v[x] * spline->radius : spline->radius / v[x];
                depth = clamp(depth, SPLINE_LEAST, 0.99f * DEPTH_LIMIT);
            }
            range.min = raw[x] > 0 ? lesser(range.min, depth) : range.min;
            range.max = greater(range.max, depth);
            v[x] = depth;
        }
    }
    return range;
}

/* What is known of value and slope before a pixel's sample: what the sample is above the expected value, the expected slope, and the variances of
 * the two, their covariance, and the determinant of these. */
struct state {
    float error, slope;
    float value_variance, covariance, slope_variance, determinant;
    bool starts; /* nothing */
    bool bends;  /* ... and what is on the other side is farther */
};

/* What one pixel leaves for the way back. At the end of what holds together gain_value is -1, and gain_slope the moment there. */
struct step {
    float error, gain_value, gain_slope;
};

static struct step forward(const struct spline *spline, int axis, float v, float next, struct state *state)
{
    float inverse = 1 / width_of(spline, axis, v), cube = inverse * inverse * inverse;
    float bend = SPLINE_BEND * spline->mu * inverse * (spline->orthographic ? 1 : v * v), bend_variance = SPLINE_BEND * cube;

    struct step step = {0, 1, 0};
    float slope = state->bends ? bend : 0, value_variance = 1, covariance = 0;
    float slope_variance = state->bends ? bend_variance : SPLINE_NATURAL, determinant = slope_variance;
    if (!state->starts) {
        float scale = 1 / (state->value_variance + 1);
        step = (struct step){state->error * scale, state->value_variance * scale, state->covariance * scale};
        slope = state->slope + step.gain_slope * state->error;
        value_variance = step.gain_value;
        covariance = step.gain_slope;
        slope_variance = (state->slope_variance + state->determinant) * scale;
        determinant = state->determinant * scale;
    }

    float above = step.error; /* the sample, of what is now expected */
    bool on = holds(spline, axis, v, next), falls = is_fluid(v) && !on && next < v;
    if (!on) {
        float moment = falls ? (-bend - slope) / (slope_variance + bend_variance) : 0;
        step = (struct step){step.error - step.gain_slope * moment, -1, moment};
    }
    float grows = state->starts ? 0 : cube * inverse;
    slope_variance += grows;
    *state = (struct state){.error = (next - v) + (above - slope),
                            .slope = slope,
                            .value_variance = value_variance + 2 * covariance + slope_variance,
                            .covariance = covariance + slope_variance,
                            .slope_variance = slope_variance,
                            .determinant = determinant + grows * value_variance,
                            .starts = !on,
                            .bends = !on && is_fluid(next) && v < next};
    return step;
}

static void solve_line(const struct spline *spline, int axis, float *v, ptrdiff_t stride, int count, float before, float after,
                       float *scratch)
{
    struct state state = {.starts = true, .bends = is_fluid(*v) && before < *v};
    for (int i = 0; i < count; i++) {
        float next = i + 1 < count ? v[(i + 1) * stride] : after;
        struct step step = forward(spline, axis, v[i * stride], next, &state);
        scratch[(3 * i + 0) * LINES] = step.error;
        scratch[(3 * i + 1) * LINES] = step.gain_value;
        scratch[(3 * i + 2) * LINES] = step.gain_slope;
    }
    float force = 0, moment = 0; /* the sum of the residuals behind a pixel, and the sum of these sums */
    for (int i = count - 1; i >= 0; i--) {
        float error = scratch[(3 * i + 0) * LINES], gain_value = scratch[(3 * i + 1) * LINES], gain_slope = scratch[(3 * i + 2) * LINES];
        float residual = gain_value < 0 ? error : error - gain_value * force - gain_slope * moment;
        force = residual + (gain_value < 0 ? 0 : force);
        moment = (gain_value < 0 ? gain_slope : moment) + force;
        float *at = v + i * stride, half = *at * (1 / SPLINE_SWING), twice = *at * SPLINE_SWING;
        *at = clamp(*at - residual, lesser(half, twice), greater(half, twice));
    }
}

static void solve(const struct spline *spline, int axis, float *v, ptrdiff_t stride, int count, float before, float after, float *scratch)
{
    for (int l = 0; l < LINES; l++) {
        solve_line(spline, axis, v + l, stride, count, before, after, scratch + l);
    }
}

const struct spline_kernels mns_spline_kernels_scalar = {.enter = enter, .fill = fill, .solve = solve, .leave = leave};
