/* spline.c: the kernels of cubic smoothing splines over simd.h, with the arithmetic of cpu/scalar/spline.c. A lane is a line. Each pixel
 * waits for the reciprocal of the one before, so that two vectors of lines go side by side. */
#include "cpu/smooth/spline.h"

#include "cpu/simd/window.h"
#include "cpu/smooth/lines.h"

enum {
    PAIR = 2 * VLEN,
    ROWS_AHEAD = 12 /* each row of a column is a cache line of its own, which the processor does not foresee */
};

_Static_assert(LINES % PAIR == 0, "lines are solved in pairs of vectors");

/* 1 / a to the last digit but one: this is what depths go through. */
SIMD vf reciprocal(vf a)
{
    vf r = vf_rcp(a);
    return vf_fma(r, vf_fnma(a, r, vf_set1(1.0f)), r);
}

SIMD vf value_of(const struct spline *spline, vf depth)
{
    vf radius = vf_set1(spline->radius), least = vf_set1(SPLINE_LEAST), most = vf_set1(SPLINE_MOST);
    vm outside = vf_le(depth, vf_zero()), fluid = vm_and(vm_not(outside), vf_lt(depth, vf_set1(DEPTH_LIMIT)));
    vf v;
    if (spline->orthographic) {
        v = -vf_clamp(depth * reciprocal(radius), least, most);
    } else {
        depth = vf_clamp(depth, radius * vf_set1(1 / SPLINE_MOST), radius * vf_set1(1 / SPLINE_LEAST));
        v = vf_clamp(radius * reciprocal(depth), least, most);
    }
    return vf_select(fluid, v, vf_select(outside, vf_set1(SPLINE_OUTSIDE), vf_set1(SPLINE_EMPTY)));
}

static void enter(const struct spline *spline, float *values, int count)
{
    for (int i = 0; i < count; i += VLEN) {
        vf_store(values + i, value_of(spline, vf_load(values + i)));
    }
}

SIMD vm is_fluid(vf v) { return vf_lt(vf_abs(v), vf_set1(SPLINE_FLUID)); }

/* Of one axis. */
struct solver {
    vf width, apart, slant, bend;
};

static struct solver solver_of(const struct spline *spline, int axis)
{
    return (struct solver){vf_set1(spline->width[axis]), vf_set1(spline->apart), vf_set1(spline->slant[axis]),
                           vf_set1(SPLINE_BEND * spline->mu)};
}

/* Whether the depths of two pixels belong together, if both are fluid. */
SIMD vm are_near(const struct solver *s, bool orthographic, vf a, vf b)
{
    vf apart = vf_either(orthographic, s->apart, s->apart * (a * b)), slant = vf_either(orthographic, s->slant, s->slant * vf_min(a, b));
    return vf_le(vf_abs(a - b), vf_max(apart, slant));
}

SIMD vf width_of(const struct solver *s, bool orthographic, vf v)
{
    return vf_clamp(vf_either(orthographic, s->width, s->width * v), vf_set1(SPLINE_NARROW), vf_set1(SPLINE_WIDE));
}

/* Fills what ends before a pixel, `here`, in the lanes of the mask. */
static void fill_gap(vm ends, vf last, vf here, vf gap, float *at, ptrdiff_t stride)
{
    vf part = vf_rcp(gap + vf_set1(1.0f));
    for (int j = 1;; j++) {
        vm fills = vm_and(ends, vf_le(vf_set1((float)j), gap));
        if (!vm_any(fills)) {
            return;
        }
        float *pixel = at - j * stride;
        vf_store(pixel, vf_select(fills, vf_fma(last - here, vf_set1((float)j) * part, here), vf_load(pixel)));
    }
}

static void fill_lines(const struct solver *s, bool orthographic, float *v, ptrdiff_t stride, int count)
{
    vf last = vf_load(v), gap = vf_zero();
    for (int i = 1; i < count; i++) {
        float *at = v + i * stride;
        simd_prefetch(at + ROWS_AHEAD * stride);
        vf here = vf_load(at);
        vm last_fluid = is_fluid(last);
        vm near = vm_and(vm_and(last_fluid, is_fluid(here)), are_near(s, orthographic, last, here)), open = vf_gt(gap, vf_zero());
        if (vm_any(vm_or(vm_not(near), open))) {
            vm ends = vm_and(near, open);
            if (vm_any(ends)) {
                fill_gap(ends, last, here, gap, at, stride);
            }
            vf longer = gap + vf_set1(1.0f);
            vm grows = vm_and(last_fluid, vf_le(here, vf_set1(SPLINE_EMPTY)));
            grows = vm_and(grows, vf_le(longer, vf_set1(SPLINE_HOLE) * width_of(s, orthographic, last)));
            gap = vf_keep(grows, longer);
            last = vf_select(grows, last, here);
        } else {
            last = here;
        }
    }
}

static void fill(const struct spline *spline, int axis, float *v, ptrdiff_t stride, int count)
{
    const struct solver s = solver_of(spline, axis);
    for (int line = 0; line < LINES; line += VLEN) {
        fill_lines(&s, spline->orthographic, v + line, stride, count);
    }
}

static struct depth_range leave(const struct spline *spline, const float *raw, float *v, ptrdiff_t stride)
{
    struct extent extent = extent_start();
    vf radius = vf_set1(spline->radius);
    for (int y = 0; y < BLOCK_HEIGHT; y++, raw += stride, v += stride) {
        for (int x = 0; x < BLOCK_WIDTH; x += VLEN) {
            struct pixels pixels = pixels_load(raw + x, 1);
            vf value = vf_load(v + x), depth = vf_either(spline->orthographic, -value * radius, radius * reciprocal(value));
            depth = vf_clamp(depth, vf_set1(SPLINE_LEAST), vf_set1(0.99f * DEPTH_LIMIT));
            pixels_store(&pixels, depth, v + x, &extent);
        }
    }
    return extent_range(&extent);
}

/* As in plain C. */
struct state {
    vf error, slope, value_variance, covariance, slope_variance, determinant;
    vm starts, bends;
    vf here;
    vm fluid; /* here */
};

SIMD struct state state_start(const float *at, float before)
{
    vf v = vf_load(at), zero = vf_zero();
    vm fluid = is_fluid(v);
    return (struct state){zero, zero, zero, zero, zero, zero, vf_le(zero, zero), vm_and(fluid, vf_lt(vf_set1(before), v)), v, fluid};
}

/* scratch: error, gain_value, gain_slope, LINES floats apart. */
SIMD void forward(const struct solver *s, bool orthographic, struct state *state, vf next, float *scratch)
{
    vf one = vf_set1(1.0f), v = state->here;
    vf inverse = vf_rcp(width_of(s, orthographic, v));
    vf cube = inverse * inverse * inverse;

    vf scale = vf_rcp(state->value_variance + one), error = state->error * scale;
    vf gain_value = state->value_variance * scale, gain_slope = state->covariance * scale;
    vf slope = vf_fma(gain_slope, state->error, state->slope), above = error;
    vf slope_variance = (state->slope_variance + state->determinant) * scale, determinant = state->determinant * scale;
    vf grows = cube * inverse;
    vf value_variance = gain_value, covariance = gain_slope;

    vm fluid_next = is_fluid(next);
    vm on = vm_and(vm_and(state->fluid, fluid_next), are_near(s, orthographic, v, next));

    if (vm_any(vm_or(state->starts, vm_not(on)))) {
        vf bend = vf_either(orthographic, s->bend * inverse, s->bend * inverse * (v * v)), bend_variance = vf_set1(SPLINE_BEND) * cube;
        vf known = vf_select(state->bends, bend_variance, vf_set1(SPLINE_NATURAL));
        gain_value = vf_select(state->starts, one, gain_value);
        gain_slope = vf_select(state->starts, vf_zero(), gain_slope);
        error = vf_select(state->starts, vf_zero(), error);
        above = error;
        slope = vf_select(state->starts, vf_keep(state->bends, bend), slope);
        value_variance = gain_value;
        covariance = gain_slope;
        slope_variance = vf_select(state->starts, known, slope_variance);
        determinant = vf_select(state->starts, known, determinant);
        grows = vf_select(state->starts, vf_zero(), grows);

        vm ends = vm_not(on), falls = vm_and(vm_and(state->fluid, ends), vf_lt(next, v));
        vf moment = vf_keep(falls, (-bend - slope) * vf_rcp(slope_variance + bend_variance));
        error = vf_fnma(gain_slope, moment, error);
        gain_value = vf_select(ends, -one, gain_value);
        gain_slope = vf_select(ends, moment, gain_slope);
        state->starts = ends;
        state->bends = vm_and(vm_and(ends, fluid_next), vf_lt(v, next));
    }
    vf_store(scratch, error);
    vf_store(scratch + LINES, gain_value);
    vf_store(scratch + 2 * LINES, gain_slope);

    state->slope_variance = slope_variance + grows;
    state->determinant = vf_fma(grows, value_variance, determinant);
    state->covariance = covariance + state->slope_variance;
    state->value_variance = value_variance + (covariance + state->covariance);
    state->error = (next - v) + (above - slope);
    state->slope = slope;
    state->here = next;
    state->fluid = fluid_next;
}

/* Sums of what is behind a pixel. */
struct residuals {
    vf force, moment;
};

SIMD void backward(struct residuals *sums, const float *scratch, float *at)
{
    vf v = vf_load(at), residual = vf_load(scratch), gain_value = vf_load(scratch + LINES), gain_slope = vf_load(scratch + 2 * LINES);
    vm on = vf_ge(gain_value, vf_zero());
    vf force = vf_keep(on, sums->force), moment = vf_keep(on, sums->moment);
    residual = vf_fnma(gain_value, force, residual);
    residual = vf_fnma(gain_slope, moment, residual);
    sums->force = force + residual;
    sums->moment = vf_select(on, moment, gain_slope) + sums->force;
    vf half = v * vf_set1(1 / SPLINE_SWING), twice = v * vf_set1(SPLINE_SWING);
    vf_store(at, vf_clamp(v - residual, vf_min(half, twice), vf_max(half, twice)));
}

SIMD void solve_pair(const struct solver *s, bool orthographic, float *v, ptrdiff_t stride, int count, float before, float after,
                     float *scratch)
{
    struct state first = state_start(v, before), second = state_start(v + VLEN, before);
    for (int i = 0; i < count; i++) {
        const float *next = v + (i + 1) * stride;
        float *out = scratch + (ptrdiff_t)i * 3 * LINES;
        simd_prefetch(v + (i + ROWS_AHEAD) * stride);
        simd_prefetch(v + (i + ROWS_AHEAD) * stride + PAIR - 1);
        bool last = i + 1 == count;
        forward(s, orthographic, &first, last ? vf_set1(after) : vf_load(next), out);
        forward(s, orthographic, &second, last ? vf_set1(after) : vf_load(next + VLEN), out + VLEN);
    }
    struct residuals first_sums = {vf_zero(), vf_zero()}, second_sums = first_sums;
    for (int i = count - 1; i >= 0; i--) {
        const float *in = scratch + (ptrdiff_t)i * 3 * LINES;
        backward(&first_sums, in, v + i * stride);
        backward(&second_sums, in + VLEN, v + i * stride + VLEN);
    }
}

static void solve(const struct spline *spline, int axis, float *v, ptrdiff_t stride, int count, float before, float after, float *scratch)
{
    const struct solver s = solver_of(spline, axis);
    for (int line = 0; line < LINES; line += PAIR) {
        if (spline->orthographic) {
            solve_pair(&s, true, v + line, stride, count, before, after, scratch + line);
        } else {
            solve_pair(&s, false, v + line, stride, count, before, after, scratch + line);
        }
    }
}

const struct spline_kernels SIMD_NAME(mns_spline_kernels) = {.enter = enter, .fill = fill, .solve = solve, .leave = leave};
