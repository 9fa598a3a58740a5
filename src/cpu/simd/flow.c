/* flow.c: the explicit scheme of curvature flow over simd.h. */
#include "cpu/smooth/flow.h"

#include "cpu/simd.h"

/* What a difference is compared with along an axis. */
struct apart {
    vf fixed, slope;
    bool orthographic;
};

SIMD struct apart apart_of(const struct flow *flow, int axis)
{
    return (struct apart){vf_set1(flow->apart), vf_set1(flow->slope[axis]), flow->orthographic};
}

SIMD vf edge(const struct apart *apart, vf a, vf b)
{
    vf nearer = vf_min(a, b), steep = vf_either(apart->orthographic, apart->slope, apart->slope * nearer), difference = b - a;
    return vf_keep(vf_le(vf_abs(difference), vf_min(vf_max(steep, apart->fixed), nearer)), difference);
}

SIMD vf part(const struct flow *flow, vf start, int step)
{
    vf steps = vf_set1(flow->count);
    steps = vf_either(flow->orthographic, steps, steps * vf_rcp(start));
    return vf_max(vf_min(steps - vf_set1((float)step), vf_set1(1.0f)), vf_zero());
}

/* orthographic and adaptive are constants where this is inlined. */
SIMD void speeds(const struct flow *flow, const float *depth, const float *below, const float *start, int step, const float *above,
                 int count, const struct flow_row *out, bool orthographic, bool adaptive)
{
    struct apart in_row = apart_of(flow, 0), in_column = apart_of(flow, 1);
    in_row.orthographic = in_column.orthographic = orthographic;
    vf half_x = vf_set1(0.5f * flow->focal_square[0]), half_y = vf_set1(0.5f * flow->focal_square[1]), least = vf_set1(FLOW_SQUARE_LEAST),
       most = vf_set1(FLOW_SQUARE_MOST);
    float *across = out->across, *downs = out->down, *speed = out->speed;
    vf before = edge(&in_row, vf_load(depth - VLEN), vf_loadu(depth - VLEN + 1));
    for (int i = 0; i < count; i += VLEN) {
        vf here = vf_load(depth + i), over = vf_load(above + i);
        vf ahead = edge(&in_row, here, vf_loadu(depth + i + 1)), down = edge(&in_column, here, vf_load(below + i));
        vf behind = vf_slide(before, ahead);
        vf sum = vf_fma(half_x, vf_fma(ahead, ahead, behind * behind), vf_either(orthographic, vf_set1(1.0f), here * here));
        sum = vf_fma(half_y, vf_fma(down, down, over * over), sum);
        vf result = vf_rsqrt(vf_max(vf_min(sum, most), least));
        if (adaptive) {
            result = result * part(flow, vf_load(start + i), step);
        }
        vf_store(speed + i, result);
        vf_store(across + i, ahead);
        vf_store(downs + i, down);
        before = ahead;
    }
}

static void speed(const struct flow *flow, const float *depth, const float *below, const float *start, int step, const float *above,
                  int count, const struct flow_row *out)
{
    if (flow->orthographic) {
        speeds(flow, depth, below, start, step, above, count, out, true, flow->count != 0);
    } else if (flow->count != 0) {
        speeds(flow, depth, below, start, step, above, count, out, false, true);
    } else {
        speeds(flow, depth, below, start, step, above, count, out, false, false);
    }
}

SIMD vf flux_of(vf rate, vf speed, vf other_speed, vf difference)
{
    return vf_min(rate * (speed + other_speed), vf_set1(FLOW_LIMIT)) * difference;
}

static void step(const struct flow *flow, const float *depth, const struct flow_row *row, const float *below, int count, float *flux,
                 float *out)
{
    vf rate_x = vf_set1(0.5f * flow->rate[0]), rate_y = vf_set1(0.5f * flow->rate[1]);
    const float *across = row->across, *downs = row->down, *speed = row->speed;
    vf before = flux_of(rate_x, vf_load(speed - VLEN), vf_loadu(speed - VLEN + 1), vf_load(across - VLEN));
    for (int i = 0; i < count; i += VLEN) {
        vf own = vf_load(speed + i), ahead = flux_of(rate_x, own, vf_loadu(speed + i + 1), vf_load(across + i));
        vf down = flux_of(rate_y, own, vf_load(below + i), vf_load(downs + i));
        vf change = (ahead - vf_slide(before, ahead)) + (down - vf_load(flux + i));
        vf_store(out + i, vf_load(depth + i) + change);
        vf_store(flux + i, down);
        before = ahead;
    }
}

const struct flow_kernels SIMD_NAME(mns_flow_kernels) = {.speed = speed, .step = step};
