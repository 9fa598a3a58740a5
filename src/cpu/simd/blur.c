/* blur.c: the kernels of stage blur over simd.h. */
#include "cpu/blur.h"

#include "cpu/plane.h"
#include "cpu/simd.h"

static void decay(const struct blur_sigma *sigma, const float *depth, ptrdiff_t stride, int count, float *out)
{
    vf limit = vf_set1(DEPTH_LIMIT), scale = vf_set1(sigma->scale);
    for (int i = 0; i < count; i += VLEN) {
        vf own = vf_loadu(depth + i), z = own;
        if (!vm_all(vf_lt(own, limit))) {
            for (int k = 0; k < 9; k++) {
                z = vf_min(z, vf_loadu(depth + i + (k / 3 - 1) * stride + k % 3 - 1));
            }
            z = vf_select(vf_lt(own, limit), own, z);
        }
        vf s = vf_either(sigma->orthographic, scale, scale * vf_rcp(z));
        s = vf_clamp(s, vf_set1(sigma->least), vf_set1(BLUR_SIGMA_MAX));
        vf fall = vf_min(vf_set1(0.5f) * vf_rcp(s * s), vf_set1(80.0f));
        vf_storeu(out + i, vf_select(vf_lt(z, limit), vf_exp(vf_zero() - fall), vf_set1(-1.0f)));
    }
}

/* VLEN texels from texel i on. */
SIMD vf blur_texels(const struct blur_line *line, int i, vf decay)
{
    const float *in = line->in + i;
    vf least = vf_set1(BLUR_FLOOR), weights = vf_set1(1 - BLUR_FLOOR), sum = weights * vf_loadu(in), column = vf_iota() + vf_set1((float)i);
    vf before = vf_fma(vf_set1((float)line->slope), column, vf_set1((float)line->before));
    vf after = vf_fnma(vf_set1((float)line->slope), column, vf_set1((float)line->after));
    vf gauss = vf_max(decay, vf_zero()), ratio = gauss, ratio_step = gauss * gauss;
    for (int tap = 1; vm_any(vf_gt(gauss, least)); tap++) {
        vf weight = vf_max(gauss - least, vf_zero()), number = vf_set1((float)tap);
        vf back = vf_keep(vf_le(number, before), weight), ahead = vf_keep(vf_le(number, after), weight);
        sum = vf_fma(back, vf_loadu(in - tap * line->step), sum);
        sum = vf_fma(ahead, vf_loadu(in + tap * line->step), sum);
        weights = weights + (back + ahead);
        ratio = ratio * ratio_step;
        gauss = gauss * ratio;
    }
    return sum * vf_rcp(weights);
}

static void line(const struct blur_line *line)
{
    for (int i = 0; i < line->count; i += VLEN) {
        vf decay = vf_loadu(line->decay + i);
        vm shows = vm_and(vf_ge(decay, vf_zero()), vm_first(line->count - i));
        vf out = vf_zero();
        if (vm_any(shows)) {
            out = vf_keep(shows, blur_texels(line, i, vf_select(shows, decay, vf_set1(-1.0f))));
        }
        vf_storeu(line->out + i, out);
    }
}

enum { PIECE = 256, SLACK = 16 };

/* Texels of `scale` pixels, each lerped between the rows: between[0] is texel first - 1. Rows may be read a vector beyond. */
SIMD void lerp_rows(const float *top, const float *bottom, float weight_bottom, int first, int count, float *between)
{
    vf weight = vf_set1(weight_bottom);
    for (int i = 0; i < count; i += VLEN) {
        vf a = vf_loadu(top + first + i);
        vf_storeu(between + i, vf_fma(weight, vf_loadu(bottom + first + i) - a, a));
    }
}

/* Four pixels per texel: 4 k + 2 to 4 k + 5 lie between texels k and k + 1. */
static void upsample_4(const float *top, const float *bottom, float weight_bottom, int x, int count, float *out)
{
    float between[PIECE / 4 + 2 + SLACK], wide[PIECE + 8 + SLACK];
    const v4 weights = {0.125f, 0.375f, 0.625f, 0.875f};
    int texels = (count + 3) / 4;
    lerp_rows(top, bottom, weight_bottom, x / 4 - 1, texels + 2, between);
    for (int k = 0; k <= texels; k++) { /* wide[0] is pixel x - 2 */
        v4_storeu(wide + 4 * k, between[k] + weights * (between[k + 1] - between[k]));
    }
    for (int i = 0; i < count; i += VLEN) {
        vf_storeu(out + i, vf_loadu(wide + 2 + i));
    }
}

static void upsample_2(const float *top, const float *bottom, float weight_bottom, int x, int count, float *out)
{
    float between[PIECE / 2 + 2 + SLACK];
    int texels = (count + 1) / 2;
    lerp_rows(top, bottom, weight_bottom, x / 2 - 1, texels + 2, between);
    for (int k = 0; k < texels; k++) {
        float before = between[k], here = between[k + 1], after = between[k + 2];
        out[2 * k] = here + 0.25f * (before - here);
        out[2 * k + 1] = here + 0.25f * (after - here);
    }
}

static void upsample(const float *top, const float *bottom, float weight_bottom, int scale, int x, int count, float *out)
{
    if (scale == 1) {
        lerp_rows(top, bottom, weight_bottom, x, count, out);
        return;
    }
    for (int i = 0; i < count; i += PIECE) {
        int piece = count - i < PIECE ? count - i : PIECE;
        if (scale == 4) {
            upsample_4(top, bottom, weight_bottom, x + i, piece, out + i);
        } else {
            upsample_2(top, bottom, weight_bottom, x + i, piece, out + i);
        }
    }
}

const struct blur_kernels SIMD_NAME(mns_blur_kernels) = {.decay = decay, .line = line, .upsample = upsample};
