/* resample.c: the kernels of smoothing at half and quarter size in plain C. */
#include "cpu/smooth/resample.h"

#include "cpu/plane.h"

#include <math.h>

static bool is_fluid(float depth) { return depth > 0 && depth < DEPTH_LIMIT; }

static void reduce(const struct resample *resample, const float *depth, ptrdiff_t stride, int rows, int width, int count, float *out)
{
    int scale = resample->scale;
    for (int t = 0; t < count; t++) {
        int left = t * scale, right = left + scale < width ? left + scale : width;
        float nearest = DEPTH_EMPTY, sum = 0, found = 0;
        for (int y = 0; y < rows; y++) {
            for (int x = left; x < right; x++) {
                float z = depth[y * stride + x];
                nearest = is_fluid(z) && z < nearest ? z : nearest;
            }
        }
        for (int y = 0; y < rows; y++) {
            for (int x = left; x < right; x++) {
                float z = depth[y * stride + x];
                if (is_fluid(z) && z - nearest <= resample->edge) {
                    sum += resample->orthographic ? z : nearest / z; /* over the nearest: within float at any depth */
                    found++;
                }
            }
        }
        out[t] = found == 0 ? DEPTH_EMPTY : resample->orthographic ? sum / found : nearest * (found / sum);
    }
}

static float flat_of(const struct resample *resample, float depth)
{
    return !is_fluid(depth) ? 0 : resample->orthographic ? depth : 1 / depth;
}

/* How far two flat depths of one surface are apart at most. */
static float edge_of(const struct resample *resample, float a, float b)
{
    return resample->orthographic ? resample->edge : resample->edge * a * b;
}

/* Difference of flat depth from texel to texel. */
static float difference(const struct resample *resample, float before, float here, float after, float slant)
{
    float nearer = before > 0 ? fminf(before, here) : 0, farther = after > 0 ? fminf(after, here) : 0;
    float slant_back = resample->orthographic ? slant : slant * nearer, slant_ahead = resample->orthographic ? slant : slant * farther;
    float edge_back = edge_of(resample, before, here), edge_ahead = edge_of(resample, here, after);
    float back = fabsf(here - before), ahead = fabsf(after - here);
    if (before > 0 && after > 0 && back <= edge_back && ahead <= edge_ahead) {
        return 0.5f * (after - before);
    }
    back = before > 0 && back <= fmaxf(edge_back, slant_back) ? back : INFINITY;
    ahead = after > 0 && ahead <= fmaxf(edge_ahead, slant_ahead) ? ahead : INFINITY;
    return back <= ahead ? (back < INFINITY ? here - before : 0) : after - here;
}

static void tangents(const struct resample *resample, const float *depth, ptrdiff_t stride, int count, float *flat, float *slope_x,
                     float *slope_y)
{
    float per_pixel = 1 / (float)resample->scale;
    for (int t = 0; t < count; t++) {
        const float *at = depth + t;
        float here = flat_of(resample, *at);
        flat[t] = here;
        slope_x[t] = slope_y[t] = 0;
        if (here > 0) {
            slope_x[t] = per_pixel * difference(resample, flat_of(resample, at[-1]), here, flat_of(resample, at[1]), resample->slant_x);
            slope_y[t] =
                per_pixel * difference(resample, flat_of(resample, at[-stride]), here, flat_of(resample, at[stride]), resample->slant_y);
        }
    }
}

static void interpolate(const struct resample *resample, const struct texel_row rows[3], int row, const float *raw, int count, float *out)
{
    int scale = resample->scale;
    float dy = resample_place(scale, row), weights_x[3], weights_y[3];
    resample_weights(scale, dy, weights_y);
    for (int x = 0; x < count; x++) {
        if (!is_fluid(raw[x])) {
            out[x] = raw[x];
            continue;
        }
        int t = x / scale;
        float own = flat_of(resample, raw[x]), dx = resample_place(scale, x - t * scale);
        float sum = 0, total = 0;
        resample_weights(scale, dx, weights_x);
        for (int j = 0; j < 3; j++) {
            for (int i = 0; i < 3; i++) {
                float flat = rows[j].flat[t + i - 1], away_x = dx - (float)((i - 1) * scale), away_y = dy - (float)((j - 1) * scale);
                float value = flat + rows[j].slope_x[t + i - 1] * away_x + rows[j].slope_y[t + i - 1] * away_y;
                if (flat > 0 && fabsf(value - own) <= edge_of(resample, own, value)) {
                    sum += weights_y[j] * weights_x[i] * (value - own);
                    total += weights_y[j] * weights_x[i];
                }
            }
        }
        float result = total > 0 ? own + sum / total : own;
        result = resample->orthographic ? result : 1 / result;
        out[x] = total > 0 && is_fluid(result) ? result : raw[x];
    }
}

const struct resample_kernels mns_resample_kernels_scalar = {.reduce = reduce, .tangents = tangents, .interpolate = interpolate};
