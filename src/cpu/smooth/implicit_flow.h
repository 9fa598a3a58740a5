/* implicit_flow.h: curvature flow in few implicit steps: what it solves, and its kernels.
 *
 * Based on: [LGS09] van der Laan, Green, Sainz, "Screen Space Fluid Rendering with Curvature Flow", 2009, which names implicit steps as future
 * work.
 *
 * The flow is a diffusion of depth, dz/dt = 1/2 [d/dx (g_x z_x) + d/dy (g_y z_y)], g_x = f_x / sqrt(D'), D' = f_x^2 z_x^2 + f_y^2 z_y^2 + z^2 (1 for
 * z^2 in a parallel view, where f is pixels per metre). A time per pixel T = s^2 f / z makes the smoothing of a surface that faces the eye a Gaussian
 * of standard deviation s in the world at every distance; over cos(theta) = z / sqrt(D') a slanted surface is smoothed as much. Edge ij, with
 * the mean of the two times and of the two depths, then has the coefficient
 *
 *   1/2 (T_i + T_j) / 2 * g / cos(theta) / N = p_i p_j,   p = s f / z / sqrt(2 N),
 *
 * where the roots have cancelled. So the flux is proportional to 1 / z_i - 1 / z_j: of a plane, whose 1 / z is linear in the pixels, it is the same
 * everywhere, and planes of any tilt stay as they are, in perspective too. What is left of the curvature's nonlinearity is where depth jumps.
 *
 * No flux crosses the picture's edge, a silhouette, or two neighbours that are apart. A slanted surface bends there towards facing the eye, by
 * sqrt(2 / pi) s tan(theta) at most. Going on as a plane there (no change along a line that lacks a neighbour) would keep it, but leaves the
 * bumps of the splats along every rim: measured on pictures, the worse of the two.
 *
 * A step solves (1 - L) z' = z along all rows, then along all columns (the next step the other way round), with the coefficients of the depth
 * before: each pixel becomes a mean of its line, whatever the step's size. */
#ifndef MNS_CPU_SMOOTH_IMPLICIT_FLOW_H
#define MNS_CPU_SMOOTH_IMPLICIT_FLOW_H

#include "cpu/smooth/lines.h"

struct implicit_flow {
    float apart; /* metres: neighbours whose depths differ by more are apart */
    float slant; /* metres: ... times 1 / p, for a surface as steep as FLOW_SLOPE_MAX */
    struct {
        float slope, offset; /* 1 / p = slope * depth + offset; one of the two is 0 */
    } inverse[2];            /* by axis */
};

/* p is at most this: its square, the coefficient, is far from where float would lose the differences of neighbours. */
#define FLOW_P_MOST 1000.0f
/* ... and 1 / p, so that its square is no denormal */
#define FLOW_INVERSE_MOST 1e18f

/* Lines lie side by side (lines.h): pixel i of line l at z[i * stride + l]. Fluid is where 0 < z < DEPTH_LIMIT; the rest, NaN too, stays as it is. Nothing passes
 * the ends of a line.
 *
 * Tolerance against plain C: 4e-7 of the depth (its own rounding) plus 1e-5, or 3e-7 p, of the range of the line's depths (reciprocals of 3e-7,
 * which add up over the p pixels that a pixel sees). A difference within rounding of the one that sets pixels apart may fall on its other
 * side. */
struct implicit_flow_kernels {
    /* One step along LINES lines, in place. scratch: 2 * count * LINES floats. z and scratch are 64-byte aligned, stride a multiple of 16. */
    void (*solve)(const struct implicit_flow *flow, int axis, float *z, ptrdiff_t stride, int count, float *scratch);
};

extern const struct implicit_flow_kernels mns_implicit_flow_kernels_scalar, mns_implicit_flow_kernels_sse2, mns_implicit_flow_kernels_avx2,
    mns_implicit_flow_kernels_avx512, mns_implicit_flow_kernels_neon;

#endif
