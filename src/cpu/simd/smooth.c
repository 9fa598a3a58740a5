/* smooth.c: the kernels of stage smooth over simd.h: the narrow-range filter. The arithmetic is that of cpu/scalar/smooth.c, with these
 * differences: samples are relative to depth + mu, not to depth, so that a clamped sample is 0, every bound has one sign, and a masked
 * sample (0) widens nothing; all lanes go as far as the widest kernel among them, with weight 0 beyond their own. */
#include "cpu/smooth.h"

#include "cpu/simd.h"

/* What does not change from pixel to pixel. */
struct constants {
    vf mu, grow, weight_cut;
};

SIMD struct constants constants_of(const struct narrow_range *filter)
{
    return (struct constants){vf_set1(filter->mu), vf_set1(filter->grow), vf_set1(filter->weight_cut)};
}

/* A row of VLEN pixels; lanes without fluid run along with some depth. */
struct pixels {
    vf input, depth;
    vm fluid;
};

SIMD struct pixels pixels_load(const float *in)
{
    vf input = vf_load(in);
    vm fluid = vm_and(vf_gt(input, vf_zero()), vf_lt(input, vf_set1(DEPTH_LIMIT)));
    return (struct pixels){input, vf_select(fluid, input, vf_set1(1.0f)), fluid};
}

/* Least and greatest of what was written to a block. */
struct extent {
    vf min, max;
};

SIMD struct extent extent_start(void) { return (struct extent){vf_set1(DEPTH_EMPTY), vf_zero()}; }

SIMD void pixels_store(const struct pixels *pixels, vf result, float *out, struct extent *extent)
{
    result = vf_select(pixels->fluid, result, pixels->input);
    vf_store(out, result);
    extent->min = vf_mask_min(extent->min, vf_gt(pixels->input, vf_zero()), result);
    extent->max = vf_max(extent->max, result);
}

SIMD struct depth_range extent_range(const struct extent *extent)
{
    return (struct depth_range){vf_reduce_min(extent->min), vf_reduce_max(extent->max)};
}

/* 1 / sigma in pixels: 1 / narrow_range_sigma. Bounded so that its square and its reciprocal are finite. */
SIMD vf inverse_sigma(const struct narrow_range *filter, int axis, vf depth)
{
    vf inverse = vf_fma(depth, vf_set1(filter->inverse[axis].slope), vf_set1(filter->inverse[axis].offset));
    vf sigma_max = vf_set1(filter->sigma_max), bend = sigma_max * inverse;
    vf bent = vf_rcp(vf_fnma(sigma_max * bend, vf_set1(0.25f), sigma_max));
    return vf_min(vf_select(vf_lt(bend, vf_set1(2.0f)), bent, inverse), vf_set1(1e18f));
}

/* Taps that the widest kernel of the pixels reaches. */
SIMD int reach_of(const struct narrow_range *filter, const struct pixels *pixels, vf inverse)
{
    float widest = vf_reduce_max(vf_keep(pixels->fluid, vf_rcp(inverse))) * filter->cut;
    int reach = (int)ceilf(widest);
    return reach < PLANE_BORDER ? reach : PLANE_BORDER - 1;
}

/* The Gaussian at 1, 2, 3 ... pixels, as in plain C. */
struct gaussian {
    vf weight, ratio, fall;
};

SIMD struct gaussian gaussian_start(vf inverse)
{
    vf one = vf_set1(1.0f), h = -vf_expm1(inverse * inverse * vf_set1(-0.5f));
    vf fall = h * (vf_set1(2.0f) - h);
    return (struct gaussian){.weight = one - h, .ratio = (one - h) * (one - fall), .fall = fall};
}

SIMD void gaussian_step(struct gaussian *g)
{
    g->weight = g->weight * g->ratio;
    g->ratio = vf_fnma(g->ratio, g->fall, g->ratio);
}

SIMD vf cut_weight(vf weight, const struct constants *constants) { return vf_max(weight - constants->weight_cut, vf_zero()); }

/* [TY18] eq. 7, relative to depth + mu. */
struct bounds {
    vf near, far;
};

SIMD struct bounds bounds_start(const struct narrow_range *filter, vf floor)
{
    return (struct bounds){vf_max(vf_set1(-filter->delta - filter->mu), floor), vf_set1(filter->delta - filter->mu)};
}

/* A sample and what became of it. */
struct sample {
    vf value;
    vm far_enough, near_enough;
};

SIMD struct sample sample_take(vf depth, vf base, const struct bounds *bounds)
{
    vf value = depth - base;
    return (struct sample){value, vf_ge(value, bounds->near), vf_le(value, bounds->far)};
}

/* Eq. 8, 9. A sample too near is always less than far - grow and one too far more than near + grow: one test for each bound is enough. */
SIMD void bounds_widen(struct bounds *bounds, const struct sample *s, vf floor, const struct constants *constants)
{
    bounds->near = vf_max(vf_min(bounds->near, vf_keep(s->far_enough, s->value - constants->grow)), floor);
    bounds->far = vf_max(bounds->far, vf_keep(s->near_enough, s->value + constants->grow));
}

/* Eq. 1: its numerator relative to depth + mu, and half of its denominator without the pixel itself. */
struct mean {
    vf sum, weights;
};

/* bias_correction is a constant where this is inlined. */
SIMD void mean_add(struct mean *mean, vf weight, const struct sample *a, const struct sample *b, vf floor, bool bias_correction)
{
    if (bias_correction) { /* eq. 6 */
        vm both = vm_and(a->far_enough, b->far_enough);
        vf value = vf_mask_add(vf_keep(a->near_enough, a->value), b->near_enough, b->value);
        mean->sum = vf_mask_fma(mean->sum, both, value, weight);
        mean->weights = vf_mask_add(mean->weights, both, weight);
    } else { /* eq. 3; outside the picture the pair is dropped all the same */
        vm keep_a = vm_and(a->far_enough, vf_ge(b->value, floor)), keep_b = vm_and(b->far_enough, vf_ge(a->value, floor));
        vf half = weight * vf_set1(0.5f);
        mean->sum = vf_mask_fma(mean->sum, vm_and(keep_a, a->near_enough), a->value, weight);
        mean->sum = vf_mask_fma(mean->sum, vm_and(keep_b, b->near_enough), b->value, weight);
        mean->weights = vf_mask_add(vf_mask_add(mean->weights, keep_a, half), keep_b, half);
    }
}

/* base: depth + mu. */
SIMD vf mean_result(const struct mean *mean, vf depth, vf base, vf own_weight)
{
    vf twice = mean->weights + mean->weights;
    return vf_fma(vf_fma(twice, base - depth, mean->sum), vf_rcp(own_weight + twice), depth);
}

/* Nearer than this is outside the picture: -base is depth 0. */
SIMD vf floor_of(vf base) { return base * vf_set1(-0.999999f); }

SIMD vf line_pixels(const struct narrow_range *filter, const struct pixels *pixels, const float *in, ptrdiff_t step, int axis, bool bias)
{
    struct constants constants = constants_of(filter);
    vf base = pixels->depth + constants.mu, floor = floor_of(base);
    vf inverse = inverse_sigma(filter, axis, pixels->depth);
    int reach = reach_of(filter, pixels, inverse);
    struct gaussian g = gaussian_start(inverse);
    struct bounds ahead = bounds_start(filter, floor), behind = ahead;
    struct mean mean = {vf_zero(), vf_zero()};
    const float *p = in, *m = in;
    for (int i = 1; i <= reach; i++, gaussian_step(&g)) {
        p += step;
        m -= step;
        struct sample a = sample_take(vf_loadu(p), base, &ahead), b = sample_take(vf_loadu(m), base, &behind);
        mean_add(&mean, cut_weight(g.weight, &constants), &a, &b, floor, bias);
        bounds_widen(&ahead, &a, floor, &constants);
        bounds_widen(&behind, &b, floor, &constants);
    }
    return mean_result(&mean, pixels->depth, base, vf_set1(1.0f - filter->weight_cut));
}

SIMD vf line_plain_pixels(const struct narrow_range *filter, const struct pixels *pixels, const float *in, ptrdiff_t step, int axis)
{
    struct constants constants = constants_of(filter);
    vf depth = pixels->depth, twice_depth = depth + depth;
    vf inverse = inverse_sigma(filter, axis, depth);
    int reach = reach_of(filter, pixels, inverse);
    struct gaussian g = gaussian_start(inverse);
    vf sum = vf_zero(), weights = vf_zero();
    const float *p = in, *m = in;
    for (int i = 1; i <= reach; i++, gaussian_step(&g)) {
        p += step;
        m -= step;
        vf weight = cut_weight(g.weight, &constants);
        sum = vf_fma((vf_loadu(p) + vf_loadu(m)) - twice_depth, weight, sum);
        weights = weights + weight;
    }
    return vf_fma(sum, vf_rcp(vf_set1(1.0f - filter->weight_cut) + weights + weights), depth);
}

/* One pair of bounds for both samples; tested against what the ring before left, gathered for the next ring. */
struct disc {
    vf depth, base, floor;
    struct bounds bounds, next;
    struct mean mean;
};

SIMD struct disc disc_start(const struct narrow_range *filter, vf depth)
{
    vf base = depth + vf_set1(filter->mu), floor = floor_of(base);
    struct bounds bounds = bounds_start(filter, floor);
    return (struct disc){depth, base, floor, bounds, bounds, {vf_zero(), vf_zero()}};
}

SIMD void disc_add(struct disc *disc, vf weight, const float *at, ptrdiff_t tap, const struct constants *constants, bool bias)
{
    struct sample a = sample_take(vf_loadu(at + tap), disc->base, &disc->bounds);
    struct sample b = sample_take(vf_loadu(at - tap), disc->base, &disc->bounds);
    mean_add(&disc->mean, weight, &a, &b, disc->floor, bias);
    bounds_widen(&disc->next, &a, disc->floor, constants);
    bounds_widen(&disc->next, &b, disc->floor, constants);
}

static inline int absolute(int a) { return a < 0 ? -a : a; }

/* exp(-i^2 / (2 sigma^2)), i from 0 to reach. */
SIMD void gaussian_table(vf inverse, int reach, vf table[PLANE_BORDER])
{
    struct gaussian g = gaussian_start(inverse);
    table[0] = vf_set1(1.0f);
    for (int i = 1; i <= reach; i++, gaussian_step(&g)) {
        table[i] = g.weight;
    }
}

/* The tables of both axes; returns the reach of the wider one. */
SIMD int disc_tables(const struct narrow_range *filter, const struct pixels *pixels, vf along_x[PLANE_BORDER], vf along_y[PLANE_BORDER])
{
    vf inverse_x = inverse_sigma(filter, AXIS_X, pixels->depth), inverse_y = inverse_sigma(filter, AXIS_Y, pixels->depth);
    int reach = reach_of(filter, pixels, vf_min(inverse_x, inverse_y));
    gaussian_table(inverse_x, reach, along_x);
    gaussian_table(inverse_y, reach, along_y);
    return reach;
}

SIMD vf disc_pixels(const struct narrow_range *filter, const struct pixels *pixels, const float *in, ptrdiff_t stride, bool bias)
{
    struct constants constants = constants_of(filter);
    vf along_x[PLANE_BORDER], along_y[PLANE_BORDER];
    int reach = disc_tables(filter, pixels, along_x, along_y);
    struct disc disc = disc_start(filter, pixels->depth);
    for (int ring = 1; ring <= reach; ring++) {
        for (int x = -ring; x <= ring; x++) {
            disc_add(&disc, cut_weight(along_x[absolute(x)] * along_y[ring], &constants), in, ring * stride + x, &constants, bias);
        }
        for (int y = 1 - ring; y < ring; y++) {
            disc_add(&disc, cut_weight(along_x[ring] * along_y[absolute(y)], &constants), in, y * stride + ring, &constants, bias);
        }
        disc.bounds = disc.next;
    }
    return mean_result(&disc.mean, disc.depth, disc.base, vf_set1(1.0f - filter->weight_cut));
}

SIMD vf disc_plain_pixels(const struct narrow_range *filter, const struct pixels *pixels, const float *in, ptrdiff_t stride)
{
    struct constants constants = constants_of(filter);
    vf along_x[PLANE_BORDER], along_y[PLANE_BORDER];
    int reach = disc_tables(filter, pixels, along_x, along_y);
    vf depth = pixels->depth, twice_depth = depth + depth, sum = vf_zero(), weights = vf_zero();
    for (int y = 0; y <= reach; y++) {
        for (int x = y ? -reach : 1; x <= reach; x++) { /* half of the taps; their mirrors are the others */
            ptrdiff_t tap = y * stride + x;
            vf weight = cut_weight(along_x[absolute(x)] * along_y[y], &constants);
            sum = vf_fma((vf_loadu(in + tap) + vf_loadu(in - tap)) - twice_depth, weight, sum);
            weights = weights + weight;
        }
    }
    return vf_fma(sum, vf_rcp(vf_set1(1.0f - filter->weight_cut) + weights + weights), depth);
}

SIMD vf square_pixels(const struct narrow_range *filter, const struct pixels *pixels, const float *in, ptrdiff_t stride, bool bias)
{
    struct constants constants = constants_of(filter);
    struct disc disc = disc_start(filter, pixels->depth);
    for (int ring = 1; ring <= 2; ring++) {
        for (int x = -ring; x <= ring; x++) {
            disc_add(&disc, vf_set1(filter->square[ring][absolute(x)]), in, ring * stride + x, &constants, bias);
        }
        for (int y = 1 - ring; y < ring; y++) {
            disc_add(&disc, vf_set1(filter->square[absolute(y)][ring]), in, y * stride + ring, &constants, bias);
        }
        disc.bounds = disc.next;
    }
    return mean_result(&disc.mean, disc.depth, disc.base, vf_set1(filter->square[0][0]));
}

SIMD vf square_plain_pixels(const struct narrow_range *filter, const struct pixels *pixels, const float *in, ptrdiff_t stride)
{
    vf depth = pixels->depth, twice_depth = depth + depth, sum = vf_zero();
    float weights = filter->square[0][0];
    for (int y = 0; y <= 2; y++) {
        for (int x = y ? -2 : 1; x <= 2; x++) {
            float weight = filter->square[y][absolute(x)];
            ptrdiff_t tap = y * stride + x;
            sum = vf_fma((vf_loadu(in + tap) + vf_loadu(in - tap)) - twice_depth, vf_set1(weight), sum);
            weights += 2 * weight;
        }
    }
    return vf_fma(sum, vf_set1(1.0f / weights), depth);
}

enum kind { LINE, LINE_PLAIN, DISC, DISC_PLAIN, SQUARE, SQUARE_PLAIN };

/* kind and bias are constants where this is inlined. */
SIMD struct depth_range block(const struct narrow_range *filter, const float *in, float *out, ptrdiff_t stride, int axis, enum kind kind,
                              bool bias)
{
    struct extent extent = extent_start();
    ptrdiff_t step = axis == AXIS_X ? 1 : stride;
    for (int y = 0; y < BLOCK_HEIGHT; y++, in += stride, out += stride) {
        for (int x = 0; x < BLOCK_WIDTH; x += VLEN) {
            struct pixels pixels = pixels_load(in + x);
            vf result = pixels.depth;
            switch (vm_any(pixels.fluid) ? (int)kind : -1) {
            case LINE: result = line_pixels(filter, &pixels, in + x, step, axis, bias); break;
            case LINE_PLAIN: result = line_plain_pixels(filter, &pixels, in + x, step, axis); break;
            case DISC: result = disc_pixels(filter, &pixels, in + x, stride, bias); break;
            case DISC_PLAIN: result = disc_plain_pixels(filter, &pixels, in + x, stride); break;
            case SQUARE: result = square_pixels(filter, &pixels, in + x, stride, bias); break;
            case SQUARE_PLAIN: result = square_plain_pixels(filter, &pixels, in + x, stride); break;
            default: break;
            }
            pixels_store(&pixels, result, out + x, &extent);
        }
    }
    return extent_range(&extent);
}

static struct depth_range line(const struct narrow_range *filter, const float *in, float *out, ptrdiff_t stride, int axis)
{
    return filter->bias_correction ? block(filter, in, out, stride, axis, LINE, true) : block(filter, in, out, stride, axis, LINE, false);
}

static struct depth_range line_plain(const struct narrow_range *filter, const float *in, float *out, ptrdiff_t stride, int axis)
{
    return block(filter, in, out, stride, axis, LINE_PLAIN, true);
}

static struct depth_range disc(const struct narrow_range *filter, const float *in, float *out, ptrdiff_t stride, int axis)
{
    return filter->bias_correction ? block(filter, in, out, stride, axis, DISC, true) : block(filter, in, out, stride, axis, DISC, false);
}

static struct depth_range disc_plain(const struct narrow_range *filter, const float *in, float *out, ptrdiff_t stride, int axis)
{
    return block(filter, in, out, stride, axis, DISC_PLAIN, true);
}

static struct depth_range square(const struct narrow_range *filter, const float *in, float *out, ptrdiff_t stride, int axis)
{
    return filter->bias_correction ? block(filter, in, out, stride, axis, SQUARE, true) : block(filter, in, out, stride, axis, SQUARE, false);
}

static struct depth_range square_plain(const struct narrow_range *filter, const float *in, float *out, ptrdiff_t stride, int axis)
{
    return block(filter, in, out, stride, axis, SQUARE_PLAIN, true);
}

const struct smooth_kernels SIMD_NAME(mns_smooth_kernels) = {.line = line,
                                                             .line_plain = line_plain,
                                                             .disc = disc,
                                                             .disc_plain = disc_plain,
                                                             .square = square,
                                                             .square_plain = square_plain};
