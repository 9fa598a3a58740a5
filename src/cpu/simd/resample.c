/* resample.c: the kernels of smoothing at half and quarter size over simd.h, with the arithmetic of cpu/scalar/resample.c. A lane is a texel: pixels
 * come and go by their places in it, so that texels are read as they lie. */
#include "cpu/smooth/resample.h"

#include "cpu/plane.h"
#include "cpu/simd.h"

enum { SCALE_MOST = 4 };

SIMD vm is_fluid(vf depth) { return vm_and(vf_gt(depth, vf_zero()), vf_lt(depth, vf_set1(DEPTH_LIMIT))); }

/* Vectors of pixels side by side -> their places 0, 1, ... in `scale` texels' vectors, and back. */
SIMD void apart(vf p[SCALE_MOST], int scale)
{
    vf_unzip(p);
    if (scale == 4) {
        vf_unzip(p + 2);
        vf even[2] = {p[0], p[2]}, odd[2] = {p[1], p[3]};
        vf_unzip(even);
        vf_unzip(odd);
        p[0] = even[0];
        p[1] = odd[0];
        p[2] = even[1];
        p[3] = odd[1];
    }
}

SIMD void together(vf p[SCALE_MOST], int scale)
{
    if (scale == 4) {
        vf even[2] = {p[0], p[2]}, odd[2] = {p[1], p[3]};
        vf_zip(even);
        vf_zip(odd);
        p[0] = even[0];
        p[1] = odd[0];
        p[2] = even[1];
        p[3] = odd[1];
        vf_zip(p + 2);
    }
    vf_zip(p);
}

SIMD void reduce_vector(const struct resample *resample, int scale, const float *depth, ptrdiff_t stride, int rows, float *out)
{
    vf nearest[SCALE_MOST], sum[SCALE_MOST], found[SCALE_MOST];
    for (int i = 0; i < scale; i++) {
        nearest[i] = vf_set1(DEPTH_EMPTY);
        sum[i] = found[i] = vf_zero();
        for (int y = 0; y < rows; y++) {
            vf z = vf_loadu(depth + y * stride + i * VLEN);
            nearest[i] = vf_mask_min(nearest[i], is_fluid(z), z);
        }
    }
    apart(nearest, scale);
    for (int i = 1; i < scale; i++) {
        nearest[0] = vf_min(nearest[0], nearest[i]);
    }
    vf of_texel = nearest[0];
    if (!vm_any(vf_lt(of_texel, vf_set1(DEPTH_LIMIT)))) {
        vf_storeu(out, vf_set1(DEPTH_EMPTY));
        return;
    }
    for (int i = 1; i < scale; i++) {
        nearest[i] = of_texel;
    }
    together(nearest, scale);
    for (int i = 0; i < scale; i++) {
        for (int y = 0; y < rows; y++) {
            vf z = vf_loadu(depth + y * stride + i * VLEN);
            vm counts = vm_and(is_fluid(z), vf_le(z - nearest[i], vf_set1(resample->edge)));
            vf part = nearest[i] * vf_rcp(vf_select(counts, z, vf_set1(1.0f)));
            sum[i] = vf_mask_add(sum[i], counts, vf_either(resample->orthographic, z, part));
            found[i] = vf_mask_add(found[i], counts, vf_set1(1.0f));
        }
    }
    apart(sum, scale);
    apart(found, scale);
    for (int i = 1; i < scale; i++) {
        sum[0] = sum[0] + sum[i];
        found[0] = found[0] + found[i];
    }
    vm full = vf_gt(found[0], vf_zero());
    vf over = vf_rcp(vf_select(full, vf_either(resample->orthographic, found[0], sum[0]), vf_set1(1.0f)));
    vf mean = vf_either(resample->orthographic, sum[0] * over, of_texel * (found[0] * over));
    vf_storeu(out, vf_select(full, mean, vf_set1(DEPTH_EMPTY)));
}

static void reduce(const struct resample *resample, const float *depth, ptrdiff_t stride, int rows, int width, int count, float *out)
{
    (void)width; /* pixels beyond it hold 0, which is no fluid */
    for (int t = 0; t < count; t += VLEN) {
        if (resample->scale == 2) {
            reduce_vector(resample, 2, depth + 2 * t, stride, rows, out + t);
        } else {
            reduce_vector(resample, 4, depth + 4 * t, stride, rows, out + t);
        }
    }
}

/* The reciprocal of DEPTH_EMPTY is denormal, which takes a hundred times as long. */
SIMD vf flat_of(const struct resample *resample, vf depth)
{
    vm fluid = is_fluid(depth);
    return vf_keep(fluid, vf_either(resample->orthographic, depth, vf_rcp(vf_select(fluid, depth, vf_set1(1.0f)))));
}

SIMD vf edge_of(const struct resample *resample, vf a, vf b)
{
    vf edge = vf_set1(resample->edge);
    return vf_either(resample->orthographic, edge, edge * a * b);
}

SIMD vf difference(const struct resample *resample, vf before, vf here, vf after, float slant)
{
    vf far = vf_set1(DEPTH_EMPTY), slope = vf_set1(slant);
    vf slant_back = vf_either(resample->orthographic, slope, slope * vf_min(before, here));
    vf slant_ahead = vf_either(resample->orthographic, slope, slope * vf_min(after, here));
    vf edge_back = edge_of(resample, before, here), edge_ahead = edge_of(resample, here, after);
    vf back = vf_abs(here - before), ahead = vf_abs(after - here);
    vm has_before = vf_gt(before, vf_zero()), has_after = vf_gt(after, vf_zero());
    vm both = vm_and(vm_and(has_before, has_after), vm_and(vf_le(back, edge_back), vf_le(ahead, edge_ahead)));
    back = vf_select(vm_and(has_before, vf_le(back, vf_max(edge_back, slant_back))), back, far);
    ahead = vf_select(vm_and(has_after, vf_le(ahead, vf_max(edge_ahead, slant_ahead))), ahead, far);
    vf one = vf_select(vf_le(back, ahead), vf_keep(vf_lt(back, far), here - before), after - here);
    return vf_select(both, vf_set1(0.5f) * (after - before), one);
}

static void tangents(const struct resample *resample, const float *depth, ptrdiff_t stride, int count, float *flat, float *slope_x,
                     float *slope_y)
{
    vf per_pixel = vf_set1(1 / (float)resample->scale);
    for (int t = 0; t < count; t += VLEN) {
        const float *at = depth + t;
        vf here = flat_of(resample, vf_loadu(at));
        vf x = difference(resample, flat_of(resample, vf_loadu(at - 1)), here, flat_of(resample, vf_loadu(at + 1)), resample->slant_x);
        vf y = difference(resample, flat_of(resample, vf_loadu(at - stride)), here, flat_of(resample, vf_loadu(at + stride)),
                          resample->slant_y);
        vm fluid = vf_gt(here, vf_zero());
        vf_storeu(flat + t, here);
        vf_storeu(slope_x + t, vf_keep(fluid, per_pixel * x));
        vf_storeu(slope_y + t, vf_keep(fluid, per_pixel * y));
    }
}

/* The pixels at one place of VLEN texels. */
SIMD vf interpolate_at(const struct resample *resample, const struct texel_row rows[3], int t, float dx, float dy, const float weights_x[3],
                       const float weights_y[3], vf raw)
{
    vm fluid = is_fluid(raw);
    vf own = flat_of(resample, raw), edge = edge_of(resample, own, own), sum = vf_zero(), total = vf_zero();
    vf edge_slope = vf_either(resample->orthographic, vf_zero(), vf_set1(resample->edge) * own);
    for (int j = 0; j < 3; j++) {
        vf away_y = vf_set1(dy - (float)((j - 1) * resample->scale));
        for (int i = 0; i < 3; i++) {
            vf flat = vf_loadu(rows[j].flat + t + i - 1), away_x = vf_set1(dx - (float)((i - 1) * resample->scale));
            vf value = vf_fma(vf_loadu(rows[j].slope_x + t + i - 1), away_x, flat - own);
            value = vf_fma(vf_loadu(rows[j].slope_y + t + i - 1), away_y, value);
            vm counts = vm_and(vf_gt(flat, vf_zero()), vf_le(vf_abs(value), vf_fma(edge_slope, value, edge)));
            vf weight = vf_set1(weights_y[j] * weights_x[i]);
            sum = vf_mask_fma(sum, counts, weight, value);
            total = vf_mask_add(total, counts, weight);
        }
    }
    vm found = vm_and(fluid, vf_gt(total, vf_zero()));
    vf result = vf_select(found, vf_fma(sum, vf_rcp(vf_select(found, total, vf_set1(1.0f))), own), vf_set1(1.0f));
    result = vf_either(resample->orthographic, result, vf_rcp(result));
    return vf_select(vm_and(found, is_fluid(result)), result, raw);
}

/* Weights and distances of a row of pixels. */
struct places {
    float dx[SCALE_MOST], dy, weights_x[SCALE_MOST][3], weights_y[3];
};

/* VLEN texels from texel t on, whose pixels begin at raw. */
SIMD void interpolate_vector(const struct resample *resample, int scale, const struct texel_row rows[3], const struct places *at, int t,
                             const float *raw, int count, float *out)
{
    vf p[SCALE_MOST];
    vm fluid = vf_lt(vf_zero(), vf_zero());
    for (int i = 0; i < scale; i++) {
        p[i] = vf_loadu(raw + i * VLEN);
        fluid = vm_or(fluid, is_fluid(p[i]));
    }
    if (vm_any(fluid)) {
        apart(p, scale);
        for (int i = 0; i < scale; i++) {
            p[i] = interpolate_at(resample, rows, t, at->dx[i], at->dy, at->weights_x[i], at->weights_y, p[i]);
        }
        together(p, scale);
    }
    float last[SCALE_MOST * VLEN], *to = count < scale * VLEN ? last : out;
    for (int i = 0; i < scale; i++) {
        vf_storeu(to + i * VLEN, p[i]);
    }
    for (int i = 0; to == last && i < count; i++) {
        out[i] = last[i];
    }
}

static void interpolate(const struct resample *resample, const struct texel_row rows[3], int row, const float *raw, int count, float *out)
{
    int scale = resample->scale;
    struct places at = {.dy = resample_place(scale, row)};
    resample_weights(scale, at.dy, at.weights_y);
    for (int i = 0; i < scale; i++) {
        at.dx[i] = resample_place(scale, i);
        resample_weights(scale, at.dx[i], at.weights_x[i]);
    }
    for (int x = 0; x < count; x += VLEN * scale) {
        if (scale == 2) {
            interpolate_vector(resample, 2, rows, &at, x / 2, raw + x, count - x, out + x);
        } else {
            interpolate_vector(resample, 4, rows, &at, x / 4, raw + x, count - x, out + x);
        }
    }
}

const struct resample_kernels SIMD_NAME(mns_resample_kernels) = {.reduce = reduce, .tangents = tangents, .interpolate = interpolate};
