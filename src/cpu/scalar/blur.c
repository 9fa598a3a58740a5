/* blur.c: the kernels of stage blur in plain C. */
#include "cpu/blur.h"

#include "cpu/plane.h"

#include <math.h>

static float nearest_around(const float *depth, ptrdiff_t stride)
{
    float nearest = depth[0];
    for (int i = 0; i < 9 && depth[0] >= DEPTH_LIMIT; i++) {
        nearest = fminf(nearest, depth[(i / 3 - 1) * stride + i % 3 - 1]);
    }
    return nearest;
}

static void decay(const struct blur_sigma *sigma, const float *depth, ptrdiff_t stride, int count, float *out)
{
    for (int i = 0; i < count; i++) {
        float z = nearest_around(depth + i, stride);
        if (z >= DEPTH_LIMIT) {
            out[i] = -1;
            continue;
        }
        float s = fminf(fmaxf(sigma->orthographic ? sigma->scale : sigma->scale / z, sigma->least), BLUR_SIGMA_MAX);
        out[i] = expf(-fminf(0.5f / (s * s), 80)); /* 80: e^-80 is nothing, and still a normal number */
    }
}

static float blur_texel(const struct blur_line *line, int i)
{
    float decay = line->decay[i];
    if (decay < 0) {
        return 0;
    }
    int before = line->before + line->slope * i, after = line->after - line->slope * i;
    const float *in = line->in + i;
    float weight = 1 - BLUR_FLOOR, sum = weight * in[0], weights = weight;
    float gauss = decay, ratio = decay, ratio_step = decay * decay; /* decay^(i^2) by its ratios decay^(2 i + 1) */
    for (int tap = 1; gauss > BLUR_FLOOR; tap++) {
        weight = gauss - BLUR_FLOOR;
        if (tap <= before) {
            sum += weight * in[-tap * line->step];
            weights += weight;
        }
        if (tap <= after) {
            sum += weight * in[tap * line->step];
            weights += weight;
        }
        ratio *= ratio_step;
        gauss *= ratio;
    }
    return sum / weights;
}

static void line(const struct blur_line *line)
{
    for (int i = 0; i < line->count; i++) {
        line->out[i] = blur_texel(line, i);
    }
}

static void upsample(const float *top, const float *bottom, float weight_bottom, int scale, int x, int count, float *out)
{
    for (int i = 0; i < count; i++) {
        int texel;
        float weight = blur_rows_of(x + i, scale, &texel);
        float a = top[texel] + weight_bottom * (bottom[texel] - top[texel]);
        float b = top[texel + 1] + weight_bottom * (bottom[texel + 1] - top[texel + 1]);
        out[i] = a + weight * (b - a);
    }
}

const struct blur_kernels mns_blur_kernels_scalar = {.decay = decay, .line = line, .upsample = upsample};
