/* flow.c: the explicit scheme of curvature flow in plain C. */
#include "cpu/smooth/flow.h"

#include <math.h>

static float lesser(float a, float b) { return a < b ? a : b; } /* b where a is NaN */
static float greater(float a, float b) { return a > b ? a : b; }

/* The difference to a neighbour, 0 where they are apart. axis: 0 in a row, 1 in a column. */
static float edge(const struct flow *flow, int axis, float a, float b)
{
    float nearer = lesser(a, b), steep = flow->slope[axis] * (flow->orthographic ? 1 : nearer), difference = b - a;
    return fabsf(difference) <= lesser(greater(steep, flow->apart), nearer) ? difference : 0;
}

/* Of this step, by the steps that a pixel takes. */
static float part(const struct flow *flow, float start, int step)
{
    if (flow->count == 0) {
        return 1;
    }
    float steps = flow->orthographic ? flow->count : flow->count / start;
    return greater(lesser(steps - (float)step, 1), 0);
}

static void speed(const struct flow *flow, const float *depth, const float *below, const float *start, int step, const float *above,
                  int count, const struct flow_row *out)
{
    float behind = edge(flow, 0, depth[-1], depth[0]);
    for (int i = 0; i < count; i++) {
        float ahead = edge(flow, 0, depth[i], depth[i + 1]), down = edge(flow, 1, depth[i], below[i]);
        float x = 0.5f * flow->focal_square[0] * (ahead * ahead + behind * behind);
        float y = 0.5f * flow->focal_square[1] * (down * down + above[i] * above[i]);
        float square = x + y + (flow->orthographic ? 1 : depth[i] * depth[i]); /* [LGS09] eq. 5 */
        out->speed[i] = part(flow, start[i], step) / sqrtf(greater(lesser(square, FLOW_SQUARE_MOST), FLOW_SQUARE_LEAST));
        out->across[i] = ahead;
        out->down[i] = down;
        behind = ahead;
    }
}

/* What passes an edge in a step. */
static float flux_of(float rate, float speed, float other_speed, float difference)
{
    return lesser(0.5f * rate * (speed + other_speed), FLOW_LIMIT) * difference;
}

static void step(const struct flow *flow, const float *depth, const struct flow_row *row, const float *below, int count, float *flux,
                 float *out)
{
    const float *own = row->speed;
    float behind = flux_of(flow->rate[0], own[-1], own[0], row->across[-1]);
    for (int i = 0; i < count; i++) {
        float ahead = flux_of(flow->rate[0], own[i], own[i + 1], row->across[i]);
        float down = flux_of(flow->rate[1], own[i], below[i], row->down[i]);
        out[i] = depth[i] + ((ahead - behind) + (down - flux[i]));
        flux[i] = down;
        behind = ahead;
    }
}

const struct flow_kernels mns_flow_kernels_scalar = {.speed = speed, .step = step};
