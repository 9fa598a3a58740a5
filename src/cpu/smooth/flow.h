/* flow.h: curvature flow as a diffusion of depth: its lengths, and the kernels of the explicit scheme.
 *
 * Based on: [LGS09] van der Laan, Green, Sainz, "Screen Space Fluid Rendering with Curvature Flow", 2009; [BSW10] Bagar, Scherzer, Wimmer,
 * "A Layered Particle-Based Fluid Model for Real-Time Rendering of Water", 2010.
 *
 * The unit normal of eq. 4 is a flux of depth, so that the flow of eq. 1, 2 is dz/dt = 1/2 [d/dx (g_x z_x) + d/dy (g_y z_y)] with
 * g_x = C_y / sqrt(D), g_y = C_x / sqrt(D). With f = V F / 2 = 1 / C in pixels that is g_x = f_x / sqrt(D'), D' = D f_x^2 f_y^2 =
 * f_x^2 z_x^2 + f_y^2 z_y^2 + z^2; in a parallel view z^2 is 1 and f pixels per metre. Written with fluxes on pixel edges what one pixel gains its
 * neighbour loses, and a bump shrinks (depth grows away from the eye: z <- z - dt H).
 *
 * No flux crosses the picture's edge, a silhouette, or two neighbours that are apart; [LGS09] stops all smoothing there, zero flux lets a side smooth
 * along itself. */
#ifndef MNS_CPU_SMOOTH_FLOW_H
#define MNS_CPU_SMOOTH_FLOW_H

#include "core/frame.h"
#include "cpu/plane.h"

#include <stdbool.h>

struct flow {
    float focal_square[2]; /* f_x^2, f_y^2: pixels^2, or (pixels per metre)^2 */
    float apart;           /* metres: neighbours whose depths differ by more are apart */
    float slope[2];        /* ... but for a surface this steep: metres per pixel, times the nearer depth unless orthographic */
    float rate[2];         /* an edge's coefficient dt g / 2 is rate * the mean of its pixels' speeds, at most FLOW_LIMIT */
    float count;           /* [BSW10] eq. 4: steps that a pixel takes, times its depth unless orthographic; 0: every step */
    bool orthographic;
};

/* Neighbours are always held together where their depths differ by less than this many footprints: a plane seen at 3 degrees, as in shading. */
#define FLOW_SLOPE_MAX 20.0f

/* With it a pixel becomes a mean of itself and its four neighbours, with weights from 0 to 1: no value leaves the range of the depths there
 * were, whatever the step. */
#define FLOW_LIMIT 0.25f

/* D' is held between these, so that its root and reciprocal are finite. */
#define FLOW_SQUARE_LEAST 1e-36f
#define FLOW_SQUARE_MOST  1e37f

/* A row between two of its steps. */
struct flow_row {
    float *across, *down; /* differences of depth to the next pixel in the row and in the column, metres; 0 where no flux passes */
    float *speed;         /* part / sqrt(D') */
};

/* count pixels of a row, a multiple of BLOCK_WIDTH, 64-byte aligned; what is read beside them may be anything, and makes what is written there
 * anything. Fluid is where 0 < depth < DEPTH_LIMIT; what is NaN is not, and keeps its depth as all that is no fluid.
 *
 * Tolerance against plain C, for one step on equal input: 4e-7 of the depth plus 1e-6 of the largest difference to a neighbour (the reciprocal
 * root's 3e-7 in each of four coefficients). A difference within rounding of the one that sets pixels apart may fall on its other side. */
struct flow_kernels {
    /* Neighbours are apart where their depths differ by more than flow->apart and the steepest slope, or more than the nearer one.
     * z_x^2 and z_y^2 in D' are the means of the squared differences to both sides: what is steep on both sides of a crease is steep. below: depth of the row
     * below; above: down of the row above. start: depth before the first step, which decides about a pixel's part of this step, 0 to 1: the last step of
     * a pixel is a fraction, so that no ring is seen where the number of steps changes. */
    void (*speed)(const struct flow *flow, const float *depth, const float *below, const float *start, int step, const float *above,
                  int count, const struct flow_row *out);

    /* out: depth after a step. below: speed of the row below. flux: what passed from the row above into this one, and then from this one into
     * the next. */
    void (*step)(const struct flow *flow, const float *depth, const struct flow_row *row, const float *below, int count, float *flux,
                 float *out);
};

extern const struct flow_kernels mns_flow_kernels_scalar, mns_flow_kernels_sse2, mns_flow_kernels_avx2, mns_flow_kernels_avx512,
    mns_flow_kernels_neon;

#endif
