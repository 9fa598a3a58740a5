/* implicit_flow.c: the kernels of the implicit curvature flow in plain C. */
#include "cpu/smooth/implicit_flow.h"

#include "cpu/smooth/window.h"

#include <math.h>

/* 1 / p of a pixel; 0 where there is no fluid. */
static float inverse_of(const struct implicit_flow *flow, int axis, float z)
{
    if (!(z > 0 && z < DEPTH_LIMIT)) {
        return 0;
    }
    float inverse = flow->inverse[axis].slope * z + flow->inverse[axis].offset;
    return lesser(greater(inverse, 1 / FLOW_P_MOST), FLOW_INVERSE_MOST);
}

/* The edge between two pixels: what of a difference of depth passes. */
static float coefficient(const struct implicit_flow *flow, float z, float inverse, float next, float next_inverse)
{
    if (inverse == 0 || next_inverse == 0 || !(fabsf(next - z) <= greater(flow->apart, flow->slant * lesser(inverse, next_inverse)))) {
        return 0;
    }
    return 1 / inverse * (1 / next_inverse);
}

/* Gauss elimination of (1 + a + c) z'_i - a z'_before - c z'_after = z_i, with a and c the coefficients of the edges before and after. The sweep
 * forward leaves z'_i = z_i + d_i + e_i (z'_after - z_i), written with differences of depths throughout, so that the depth keeps its digits; rest =
 * 1 - e_i, kept by itself since a large c would cancel it. */
static void solve_line(const struct implicit_flow *flow, int axis, float *z, ptrdiff_t stride, int count, float *scratch)
{
    float rest = 1, d = 0, before = 0, here = inverse_of(flow, axis, z[0]), difference = 0;
    for (int i = 0; i < count; i++) {
        float after = 0, next = 0;
        if (i + 1 < count) {
            next = inverse_of(flow, axis, z[(i + 1) * stride]);
            after = coefficient(flow, z[i * stride], here, z[(i + 1) * stride], next);
        }
        float t = 1 + before * rest, m = 1 / (t + after);
        d = before * m * (d - rest * difference);
        rest = t * m;
        scratch[2 * i * LINES] = after * m;
        scratch[(2 * i + 1) * LINES] = d;
        before = after;
        difference = after > 0 ? z[(i + 1) * stride] - z[i * stride] : 0;
        here = next;
    }
    for (int i = count - 1; i >= 0; i--) {
        float e = scratch[2 * i * LINES], to_next = e > 0 ? z[(i + 1) * stride] - z[i * stride] : 0;
        z[i * stride] += scratch[(2 * i + 1) * LINES] + e * to_next;
    }
}

static void solve(const struct implicit_flow *flow, int axis, float *z, ptrdiff_t stride, int count, float *scratch)
{
    for (int line = 0; line < LINES; line++) {
        solve_line(flow, axis, z + line, stride, count, scratch + line);
    }
}

const struct implicit_flow_kernels mns_implicit_flow_kernels_scalar = {.solve = solve};
