/* implicit_flow.c: the kernels of the implicit curvature flow over simd.h, with the arithmetic of cpu/scalar/implicit_flow.c. A lane is a
 * line. Each pixel waits for the reciprocal of the one before, so that two vectors of lines go side by side. */
#include "cpu/smooth/implicit_flow.h"

#include "cpu/simd.h"

enum {
    PAIR = 2 * VLEN,
    ROWS_AHEAD = 12 /* each row of a column is a cache line of its own, which the processor does not foresee */
};

_Static_assert(LINES % PAIR == 0, "lines are solved in pairs of vectors");

/* Of one axis. */
struct solver {
    vf slope, offset, apart, slant;
};

/* A pixel: p and 1 / p; whether it is fluid. */
struct pixel {
    vf z, inverse, p;
    vm fluid;
};

/* What a pixel hands to the next. */
struct state {
    struct pixel here;
    vf rest, d, before, difference;
};

SIMD struct pixel pixel_load(const struct solver *s, const float *at)
{
    vf z = vf_load(at), inverse = vf_fma(s->slope, z, s->offset);
    inverse = vf_clamp(inverse, vf_set1(1 / FLOW_P_MOST), vf_set1(FLOW_INVERSE_MOST));
    return (struct pixel){z, inverse, vf_rcp(inverse), vm_and(vf_gt(z, vf_zero()), vf_lt(z, vf_set1(DEPTH_LIMIT)))};
}

SIMD struct state state_start(const struct solver *s, const float *at)
{
    return (struct state){pixel_load(s, at), vf_set1(1.0f), vf_zero(), vf_zero(), vf_zero()};
}

SIMD void forward(const struct solver *s, struct state *state, const float *next_at, float *scratch)
{
    struct pixel next = pixel_load(s, next_at), here = state->here;
    vf difference = next.z - here.z, limit = vf_max(s->slant * vf_min(here.inverse, next.inverse), s->apart);
    vm holds = vm_and(vm_and(here.fluid, next.fluid), vf_le(vf_abs(difference), limit));
    vf after = vf_keep(holds, here.p * next.p);
    vf t = vf_fma(state->before, state->rest, vf_set1(1.0f)), m = vf_rcp(t + after);
    state->d = state->before * vf_fnma(state->rest, state->difference, state->d) * m;
    state->rest = t * m;
    vf_store(scratch, after * m);
    vf_store(scratch + LINES, state->d);
    state->here = next;
    state->before = after;
    state->difference = vf_keep(holds, difference);
}

/* after: the next pixel's result. */
SIMD vf backward(vf after, const float *scratch, float *at)
{
    vf z = vf_load(at), e = vf_load(scratch), to_next = vf_keep(vf_gt(e, vf_zero()), after - z);
    z = z + vf_fma(e, to_next, vf_load(scratch + LINES));
    vf_store(at, z);
    return z;
}

/* The last pixel of a line has nothing after it. */
static const _Alignas(64) float nothing[PAIR];

static void solve_pair(const struct solver *s, float *z, ptrdiff_t stride, int count, float *scratch)
{
    struct state first = state_start(s, z), second = state_start(s, z + VLEN);
    for (int i = 0; i < count; i++) {
        const float *next = i + 1 < count ? z + (i + 1) * stride : nothing;
        float *out = scratch + (ptrdiff_t)i * 2 * LINES;
        simd_prefetch(z + (i + ROWS_AHEAD) * stride);
        simd_prefetch(z + (i + ROWS_AHEAD) * stride + PAIR - 1);
        forward(s, &first, next, out);
        forward(s, &second, next + VLEN, out + VLEN);
    }
    vf after_first = vf_zero(), after_second = vf_zero();
    for (int i = count - 1; i >= 0; i--) {
        const float *in = scratch + (ptrdiff_t)i * 2 * LINES;
        after_first = backward(after_first, in, z + i * stride);
        after_second = backward(after_second, in + VLEN, z + i * stride + VLEN);
    }
}

static void solve(const struct implicit_flow *flow, int axis, float *z, ptrdiff_t stride, int count, float *scratch)
{
    const struct solver s = {vf_set1(flow->inverse[axis].slope), vf_set1(flow->inverse[axis].offset), vf_set1(flow->apart),
                             vf_set1(flow->slant)};
    for (int line = 0; line < LINES; line += PAIR) {
        solve_pair(&s, z + line, stride, count, scratch + line);
    }
}

const struct implicit_flow_kernels SIMD_NAME(mns_implicit_flow_kernels) = {.solve = solve};
