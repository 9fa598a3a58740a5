/* narrow_range.c: the narrow-range filter over simd.h. The arithmetic is that of cpu/scalar/narrow_range.c, with these
 * differences: samples are relative to depth + mu, not to depth, so that a clamped sample is 0, every bound has one sign, and a masked
 * sample (0) widens nothing; all lanes go as far as the widest kernel of the block, with weight 0 beyond their own; several rows are
 * filtered together, since one alone leaves the processor waiting for its results. */
#include "cpu/smooth/narrow_range.h"

#include "cpu/simd/window.h"

/* What a block needs of the filter; each combination is compiled by itself. */
enum need {
    NEED_NEAR = 1,   /* some sample may be too near */
    NEED_FAR = 2,    /* some sample may be too far */
    NEED_FLOOR = 4,  /* at_lens */
    NEED_SINGLE = 8, /* no bias correction */
    NEED_ALL_PAIRS = NEED_NEAR | NEED_FAR | NEED_FLOOR,
    NEED_ALL_SINGLE = NEED_ALL_PAIRS | NEED_SINGLE
};

/* Calls function(..., need) with a need that is a constant there. */
#define FOR_NEED(filter, block, function, ...)                                                                                             \
    switch (need_of(filter, block)) {                                                                                                      \
    case 0: return function(__VA_ARGS__, 0);                                                                                               \
    case NEED_NEAR: return function(__VA_ARGS__, NEED_NEAR);                                                                               \
    case NEED_FAR: return function(__VA_ARGS__, NEED_FAR);                                                                                 \
    case NEED_NEAR | NEED_FAR: return function(__VA_ARGS__, NEED_NEAR | NEED_FAR);                                                         \
    case NEED_ALL_PAIRS: return function(__VA_ARGS__, NEED_ALL_PAIRS);                                                                     \
    default: return function(__VA_ARGS__, NEED_ALL_SINGLE);                                                                                \
    }

SIMD int need_of(const struct window_filter *filter, const struct depth_block *block)
{
    if (!filter->bias_correction || filter->at_lens) {
        return filter->bias_correction ? NEED_ALL_PAIRS : NEED_ALL_SINGLE;
    }
    int far = block->around.max > block->range.min + filter->delta ? NEED_FAR : 0;
    return block->around.min < farthest_fluid(block) - filter->delta ? far | NEED_NEAR : far;
}

/* What does not change from pixel to pixel. */
struct constants {
    vf grow, weight_cut;
    int need;
};

SIMD struct constants constants_of(const struct window_filter *filter, int need)
{
    return (struct constants){vf_set1(filter->grow), vf_set1(filter->weight_cut), need};
}

SIMD vf cut_weight(vf weight, const struct constants *constants) { return vf_max(weight - constants->weight_cut, vf_zero()); }

/* What samples are compared with, relative to depth + mu. Nearer than floor is outside the picture: -base is depth 0. */
struct centre {
    vf depth, base, floor;
};

SIMD struct centre centre_of(const struct window_filter *filter, vf depth)
{
    vf base = depth + vf_set1(filter->mu);
    return (struct centre){depth, base, base * vf_set1(-0.999999f)};
}

/* [TY18] eq. 7. */
struct bounds {
    vf near, far;
};

SIMD struct bounds bounds_start(const struct window_filter *filter, const struct centre *centre)
{
    return (struct bounds){vf_max(vf_set1(-filter->delta - filter->mu), centre->floor), vf_set1(filter->delta - filter->mu)};
}

/* A sample, and whether it is beyond neither bound. */
struct sample {
    vf value;
    vm above_near, below_far;
};

SIMD struct sample sample_take(const float *at, const struct centre *centre, const struct bounds *bounds)
{
    vf value = vf_loadu(at) - centre->base;
    return (struct sample){value, vf_ge(value, bounds->near), vf_le(value, bounds->far)};
}

/* Eq. 8, 9. A sample too near is always less than far - grow and one too far more than near + grow: one test for each bound is enough. */
SIMD void bounds_widen(struct bounds *bounds, const struct sample *s, const struct centre *centre, const struct constants *constants)
{
    if (constants->need & NEED_NEAR) {
        bounds->near = vf_min(bounds->near, vf_keep(s->above_near, s->value - constants->grow));
    }
    if (constants->need & NEED_FLOOR) {
        bounds->near = vf_max(bounds->near, centre->floor);
    }
    if (constants->need & NEED_FAR) {
        bounds->far = vf_max(bounds->far, vf_keep(s->below_far, s->value + constants->grow));
    }
}

/* Eq. 1: its numerator relative to depth + mu, and half of its denominator without the pixel itself. */
struct mean {
    vf sum, weights;
};

SIMD void mean_add(struct mean *mean, vf weight, const struct sample *a, const struct sample *b, const struct centre *centre,
                   const struct constants *constants)
{
    if (constants->need & NEED_SINGLE) { /* eq. 3; outside the picture the pair is dropped all the same */
        vm keep_a = vm_and(a->above_near, vf_ge(b->value, centre->floor)), keep_b = vm_and(b->above_near, vf_ge(a->value, centre->floor));
        vf half = weight * vf_set1(0.5f);
        mean->sum = vf_mask_fma(mean->sum, vm_and(keep_a, a->below_far), a->value, weight);
        mean->sum = vf_mask_fma(mean->sum, vm_and(keep_b, b->below_far), b->value, weight);
        mean->weights = vf_mask_add(vf_mask_add(mean->weights, keep_a, half), keep_b, half);
        return;
    }
    vf value = a->value + b->value;
    if (constants->need & NEED_FAR) { /* eq. 2 */
        value = vf_mask_add(vf_keep(a->below_far, a->value), b->below_far, b->value);
    }
    if (constants->need & NEED_NEAR) { /* eq. 6 */
        vm both = vm_and(a->above_near, b->above_near);
        mean->sum = vf_mask_fma(mean->sum, both, value, weight);
        mean->weights = vf_mask_add(mean->weights, both, weight);
    } else {
        mean->sum = vf_fma(value, weight, mean->sum);
        mean->weights = mean->weights + weight;
    }
}

SIMD vf mean_result(const struct mean *mean, const struct centre *centre, float own_weight)
{
    vf twice = mean->weights + mean->weights;
    return vf_fma(vf_fma(twice, centre->base - centre->depth, mean->sum), vf_rcp(vf_set1(own_weight) + twice), centre->depth);
}

/* Pixels on their way along a line of taps. */
struct line {
    const float *at;
    struct centre centre;
    struct bounds ahead, behind;
    struct mean mean;
    struct gaussian g;
};

SIMD struct line line_start(const struct window_filter *filter, vf depth, const float *at, int axis)
{
    struct centre centre = centre_of(filter, depth);
    struct bounds bounds = bounds_start(filter, &centre);
    return (struct line){at, centre, bounds, bounds, {vf_zero(), vf_zero()}, gaussian_start(exponent(filter, axis, depth))};
}

SIMD void line_tap(struct line *line, ptrdiff_t tap, const struct constants *constants)
{
    struct sample a = sample_take(line->at + tap, &line->centre, &line->ahead);
    struct sample b = sample_take(line->at - tap, &line->centre, &line->behind);
    mean_add(&line->mean, cut_weight(line->g.weight, constants), &a, &b, &line->centre, constants);
    bounds_widen(&line->ahead, &a, &line->centre, constants);
    bounds_widen(&line->behind, &b, &line->centre, constants);
    gaussian_step(&line->g);
}

/* Two rows at once where their state fits the registers. */
SIMD struct depth_range line_block(const struct window_filter *filter, const struct depth_block *block, int axis, int need)
{
    enum { ROWS = VLEN == 16 ? 2 : 1 };
    struct constants constants = constants_of(filter, need);
    struct extent extent = extent_start();
    ptrdiff_t stride = block->stride, step = axis == AXIS_X ? 1 : stride;
    ptrdiff_t reach = window_reach(filter, axis, block->range.min) * step;
    float own_weight = 1.0f - filter->weight_cut;
    for (int y = 0; y < BLOCK_HEIGHT; y += ROWS) {
        for (int x = 0; x < BLOCK_WIDTH; x += VLEN) {
            ptrdiff_t at = y * stride + x, next = at + (ROWS - 1) * stride;
            struct pixels pixels = pixels_load(block->in + at, block->range.min), pixels2 = pixels_load(block->in + next, block->range.min);
            struct line line = line_start(filter, pixels.depth, block->in + at, axis);
            struct line line2 = line_start(filter, pixels2.depth, block->in + next, axis);
            ptrdiff_t end = vm_any(vm_or(pixels.fluid, pixels2.fluid)) ? reach : 0;
            for (ptrdiff_t tap = step; tap <= end; tap += step) {
                line_tap(&line, tap, &constants);
                if (ROWS == 2) {
                    line_tap(&line2, tap, &constants);
                }
            }
            pixels_store(&pixels, mean_result(&line.mean, &line.centre, own_weight), block->out + at, &extent);
            if (ROWS == 2) {
                pixels_store(&pixels2, mean_result(&line2.mean, &line2.centre, own_weight), block->out + next, &extent);
            }
        }
    }
    return extent_range(&extent);
}

static struct depth_range line(const struct window_filter *filter, const struct depth_block *block, int axis)
{
    FOR_NEED(filter, block, line_block, filter, block, axis)
}

/* In a plain block weights hardly change from pixel to pixel: with a the block's middle exponent and x = i^2 (pixel's exponent - a),
 *   exp(-i^2 exponent) = exp(-a i^2) (1 - x + x^2 / 2), the rest at most exp(-v) (v PLAIN_SPREAD)^3 / 6 < 5e-5 for any v = a i^2,
 * so that sums over the taps need no weight of each pixel, only three coefficients of the block. */
struct expansion {
    float exponent;                       /* a */
    int whole, reach;                     /* taps that no pixel's kernel ends before; that some pixel's kernel reaches */
    float weight[3][PLANE_BORDER + VLEN]; /* [power of the pixel's exponent - a][i - 1], the weight at the cut subtracted */
    float total[3];                       /* sums of weight over whole */
};

SIMD void expansion_of(const struct window_filter *filter, const struct depth_block *block, int axis, struct expansion *e)
{
    float widest = window_sigma(filter, axis, block->range.min), narrowest = window_sigma(filter, axis, block->range.max);
    e->exponent = 0.25f / (widest * widest) + 0.25f / (narrowest * narrowest);
    e->reach = window_reach(filter, axis, block->range.min);
    int whole = (int)(0.999f * filter->cut * narrowest); /* 0.999: clear of rounding */
    e->whole = whole < e->reach ? whole : e->reach;
    vf total0 = vf_zero(), total1 = total0, total2 = total0;
    for (int i = 0; i < e->reach; i += VLEN) {
        vf tap = vf_iota() + vf_set1((float)(i + 1)), square = tap * tap;
        vf gaussian = vf_exp(square * vf_set1(-e->exponent));
        vf weight0 = gaussian - vf_set1(filter->weight_cut), weight1 = -square * gaussian, weight2 = weight1 * square * vf_set1(-0.5f);
        vm whole_tap = vm_first(e->whole - i);
        total0 = vf_mask_add(total0, whole_tap, weight0);
        total1 = vf_mask_add(total1, whole_tap, weight1);
        total2 = vf_mask_add(total2, whole_tap, weight2);
        vf_storeu(e->weight[0] + i, weight0);
        vf_storeu(e->weight[1] + i, weight1);
        vf_storeu(e->weight[2] + i, weight2);
    }
    e->total[0] = vf_reduce_add(total0);
    e->total[1] = vf_reduce_add(total1);
    e->total[2] = vf_reduce_add(total2);
}

/* Sums of samples times the three coefficients. */
struct plain_line {
    const float *at;
    vf twice_depth, sum0, sum1, sum2;
};

SIMD struct plain_line plain_line_start(const float *at)
{
    vf depth = vf_load(at);
    return (struct plain_line){at, depth + depth, vf_zero(), vf_zero(), vf_zero()};
}

SIMD vf plain_pair(const struct plain_line *line, ptrdiff_t tap)
{
    return (vf_loadu(line->at + tap) + vf_loadu(line->at - tap)) - line->twice_depth;
}

SIMD void plain_line_tap(struct plain_line *line, ptrdiff_t tap, vf weight0, vf weight1, vf weight2)
{
    vf pair = plain_pair(line, tap);
    line->sum0 = vf_fma(pair, weight0, line->sum0);
    line->sum1 = vf_fma(pair, weight1, line->sum1);
    line->sum2 = vf_fma(pair, weight2, line->sum2);
}

/* The taps at which some kernels end, and the mean. */
SIMD vf plain_line_end(const struct window_filter *filter, const struct plain_line *line, const struct expansion *e, ptrdiff_t step,
                       int axis)
{
    vf depth = line->twice_depth * vf_set1(0.5f), off = exponent(filter, axis, depth) - vf_set1(e->exponent);
    vf sum = vf_fma(vf_fma(line->sum2, off, line->sum1), off, line->sum0);
    vf weights = vf_fma(vf_fma(vf_set1(e->total[2]), off, vf_set1(e->total[1])), off, vf_set1(e->total[0]));
    for (int i = e->whole; i < e->reach; i++) {
        vf weight = vf_fma(vf_fma(vf_set1(e->weight[2][i]), off, vf_set1(e->weight[1][i])), off, vf_set1(e->weight[0][i]));
        weight = vf_max(weight, vf_zero());
        sum = vf_fma(plain_pair(line, (i + 1) * step), weight, sum);
        weights = weights + weight;
    }
    return vf_fma(sum, vf_rcp(vf_set1(1.0f - filter->weight_cut) + weights + weights), depth);
}

SIMD void plain_line_store(const struct window_filter *filter, const struct plain_line *line, const struct expansion *e, ptrdiff_t step,
                           int axis, float *out, struct extent *extent)
{
    vf result = plain_line_end(filter, line, e, step, axis);
    vf_store(out, result);
    extent->min = vf_min(extent->min, result);
    extent->max = vf_max(extent->max, result);
}

/* Four rows at once where their state fits the registers, else two: they share the loads of the coefficients. */
static struct depth_range line_plain(const struct window_filter *filter, const struct depth_block *block, int axis)
{
    enum { ROWS = VLEN == 16 ? 4 : 2 };
    struct expansion e;
    expansion_of(filter, block, axis, &e);
    struct extent extent = extent_start();
    ptrdiff_t stride = block->stride, step = axis == AXIS_X ? 1 : stride;
    for (int y = 0; y < BLOCK_HEIGHT; y += ROWS) {
        for (int x = 0; x < BLOCK_WIDTH; x += VLEN) {
            const float *in = block->in + y * stride + x;
            float *out = block->out + y * stride + x;
            struct plain_line line0 = plain_line_start(in), line1 = plain_line_start(in + stride), line2 = line0, line3 = line0;
            if (ROWS == 4) {
                line2 = plain_line_start(in + 2 * stride);
                line3 = plain_line_start(in + 3 * stride);
            }
            for (int i = 0; i < e.whole; i++) {
                vf weight0 = vf_set1(e.weight[0][i]), weight1 = vf_set1(e.weight[1][i]), weight2 = vf_set1(e.weight[2][i]);
                plain_line_tap(&line0, (i + 1) * step, weight0, weight1, weight2);
                plain_line_tap(&line1, (i + 1) * step, weight0, weight1, weight2);
                if (ROWS == 4) {
                    plain_line_tap(&line2, (i + 1) * step, weight0, weight1, weight2);
                    plain_line_tap(&line3, (i + 1) * step, weight0, weight1, weight2);
                }
            }
            plain_line_store(filter, &line0, &e, step, axis, out, &extent);
            plain_line_store(filter, &line1, &e, step, axis, out + stride, &extent);
            if (ROWS == 4) {
                plain_line_store(filter, &line2, &e, step, axis, out + 2 * stride, &extent);
                plain_line_store(filter, &line3, &e, step, axis, out + 3 * stride, &extent);
            }
        }
    }
    return extent_range(&extent);
}

/* One pair of bounds for both samples; tested against what the ring before left, gathered for the next ring. */
struct disc {
    const float *at;
    struct centre centre;
    struct bounds bounds, next;
    struct mean mean;
};

SIMD struct disc disc_start(const struct window_filter *filter, vf depth, const float *at)
{
    struct centre centre = centre_of(filter, depth);
    struct bounds bounds = bounds_start(filter, &centre);
    return (struct disc){at, centre, bounds, bounds, {vf_zero(), vf_zero()}};
}

/* last: no ring follows that the bounds would matter to. */
SIMD void disc_tap(struct disc *disc, vf weight, ptrdiff_t tap, bool last, const struct constants *constants)
{
    struct sample a = sample_take(disc->at + tap, &disc->centre, &disc->bounds);
    struct sample b = sample_take(disc->at - tap, &disc->centre, &disc->bounds);
    mean_add(&disc->mean, weight, &a, &b, &disc->centre, constants);
    if (!last) {
        bounds_widen(&disc->next, &a, &disc->centre, constants);
        bounds_widen(&disc->next, &b, &disc->centre, constants);
    }
}

SIMD vf disc_pixels(const struct window_filter *filter, vf depth, const float *at, ptrdiff_t stride, int reach, int need)
{
    struct constants constants = constants_of(filter, need);
    vf along_x[PLANE_BORDER], along_y[PLANE_BORDER];
    gaussian_table(exponent(filter, AXIS_X, depth), reach, along_x);
    gaussian_table(exponent(filter, AXIS_Y, depth), reach, along_y);
    struct disc disc = disc_start(filter, depth, at);
    for (int ring = 1; ring <= reach; ring++) {
        for (int x = -ring; x <= ring; x++) {
            disc_tap(&disc, cut_weight(along_x[absolute(x)] * along_y[ring], &constants), ring * stride + x, false, &constants);
        }
        for (int y = 1 - ring; y < ring; y++) {
            disc_tap(&disc, cut_weight(along_x[ring] * along_y[absolute(y)], &constants), y * stride + ring, false, &constants);
        }
        disc.bounds = disc.next;
    }
    return mean_result(&disc.mean, &disc.centre, 1.0f - filter->weight_cut);
}

SIMD vf disc_plain_pixels(const struct window_filter *filter, vf depth, const float *at, ptrdiff_t stride, int reach)
{
    struct constants constants = constants_of(filter, 0);
    vf along_x[PLANE_BORDER], along_y[PLANE_BORDER];
    gaussian_table(exponent(filter, AXIS_X, depth), reach, along_x);
    gaussian_table(exponent(filter, AXIS_Y, depth), reach, along_y);
    vf twice_depth = depth + depth, sum = vf_zero(), weights = vf_zero();
    for (int y = 0; y <= reach; y++) {
        for (int x = y ? -reach : 1; x <= reach; x++) { /* half of the taps; their mirrors are the others */
            ptrdiff_t tap = y * stride + x;
            vf weight = cut_weight(along_x[absolute(x)] * along_y[y], &constants);
            sum = vf_fma((vf_loadu(at + tap) + vf_loadu(at - tap)) - twice_depth, weight, sum);
            weights = weights + weight;
        }
    }
    return vf_fma(sum, vf_rcp(vf_set1(1.0f - filter->weight_cut) + weights + weights), depth);
}

SIMD vf square_pixels(const struct window_filter *filter, vf depth, const float *at, ptrdiff_t stride, int need)
{
    struct constants constants = constants_of(filter, need);
    struct disc disc = disc_start(filter, depth, at);
    for (int ring = 1; ring <= 2; ring++) {
        for (int x = -ring; x <= ring; x++) {
            disc_tap(&disc, vf_set1(filter->square[ring][absolute(x)]), ring * stride + x, ring == 2, &constants);
        }
        for (int y = 1 - ring; y < ring; y++) {
            disc_tap(&disc, vf_set1(filter->square[absolute(y)][ring]), y * stride + ring, ring == 2, &constants);
        }
        disc.bounds = disc.next;
    }
    return mean_result(&disc.mean, &disc.centre, filter->square[0][0]);
}

SIMD vf square_plain_pixels(const struct window_filter *filter, vf depth, const float *at, ptrdiff_t stride)
{
    vf twice_depth = depth + depth, sum = vf_zero();
    float weights = filter->square[0][0];
    for (int y = 0; y <= 2; y++) {
        for (int x = y ? -2 : 1; x <= 2; x++) {
            float weight = filter->square[y][absolute(x)];
            ptrdiff_t tap = y * stride + x;
            sum = vf_fma((vf_loadu(at + tap) + vf_loadu(at - tap)) - twice_depth, vf_set1(weight), sum);
            weights += 2 * weight;
        }
    }
    return vf_fma(sum, vf_set1(1.0f / weights), depth);
}

enum kind { DISC, DISC_PLAIN, SQUARE, SQUARE_PLAIN };

/* kind and need are constants where this is inlined. */
SIMD struct depth_range disc_block(const struct window_filter *filter, const struct depth_block *block, enum kind kind, int need)
{
    struct extent extent = extent_start();
    ptrdiff_t stride = block->stride;
    int reach = disc_reach(filter, block->range.min);
    for (int y = 0; y < BLOCK_HEIGHT; y++) {
        for (int x = 0; x < BLOCK_WIDTH; x += VLEN) {
            const float *at = block->in + y * stride + x;
            struct pixels pixels = pixels_load(at, block->range.min);
            vf result = pixels.depth;
            switch (vm_any(pixels.fluid) ? (int)kind : -1) {
            case DISC: result = disc_pixels(filter, pixels.depth, at, stride, reach, need); break;
            case DISC_PLAIN: result = disc_plain_pixels(filter, pixels.depth, at, stride, reach); break;
            case SQUARE: result = square_pixels(filter, pixels.depth, at, stride, need); break;
            case SQUARE_PLAIN: result = square_plain_pixels(filter, pixels.depth, at, stride); break;
            default: break;
            }
            pixels_store(&pixels, result, block->out + y * stride + x, &extent);
        }
    }
    return extent_range(&extent);
}

static struct depth_range disc(const struct window_filter *filter, const struct depth_block *block, int axis)
{
    (void)axis;
    FOR_NEED(filter, block, disc_block, filter, block, DISC)
}

static struct depth_range disc_plain(const struct window_filter *filter, const struct depth_block *block, int axis)
{
    (void)axis;
    return disc_block(filter, block, DISC_PLAIN, 0);
}

static struct depth_range square(const struct window_filter *filter, const struct depth_block *block, int axis)
{
    (void)axis;
    FOR_NEED(filter, block, disc_block, filter, block, SQUARE)
}

static struct depth_range square_plain(const struct window_filter *filter, const struct depth_block *block, int axis)
{
    (void)axis;
    return disc_block(filter, block, SQUARE_PLAIN, 0);
}

const struct narrow_range_kernels SIMD_NAME(mns_narrow_range_kernels) = {
    .line = line, .line_plain = line_plain, .disc = disc, .disc_plain = disc_plain, .square = square, .square_plain = square_plain};
