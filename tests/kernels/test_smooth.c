/* The kernels of stage smooth: every instruction set against plain C, on random depths and on the worst ones. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "cpu/kernels.h"
#include "cpu/plane.h"

#include <math.h>

enum { WIDTH = 32, HEIGHT = 16 };

static uint32_t random_state = 1;

static float uniform(void) /* in [0, 1) */
{
    random_state = random_state * 1664525u + 1013904223u;
    return (float)(random_state >> 8) / 16777216.0f;
}

/* Depths of a case: kind 0 noise within delta; 1 noise, steps and holes; 2 much nearer than delta; 3 a steep plane; 4 nearly all empty;
 * 5 the ends of what is fluid; 6 a chess board of blocks, where samples are only too near or only too far. */
static float depth_of(int kind, int x, int y, float delta)
{
    float noise = delta * uniform(), choice = uniform();
    switch (kind) {
    case 0: return 3 + noise;
    case 1: return choice < 0.1f ? DEPTH_EMPTY : choice < 0.2f ? 3 + noise - 3 * delta : 3 + noise;
    case 2: return 0.01f * delta + noise;
    case 3: return 2 + 0.3f * delta * (float)y + 0.3f * noise;
    case 4: return choice < 0.98f ? DEPTH_EMPTY : 3 + noise;
    case 6: return 3 + 0.5f * noise + ((x & BLOCK_WIDTH) || (y & BLOCK_HEIGHT) ? 0 : 3 * delta);
    default: return choice < 0.3f ? 1e-4f * delta : choice < 0.6f ? 1e36f : DEPTH_EMPTY;
    }
}

/* sigma: pixels at a depth of 3. */
static struct window_filter filter_of(float delta, float sigma, bool orthographic, bool at_lens, int mode)
{
    float cut = mode & 4 ? 3 : 2, inverse = orthographic ? 1 / sigma : 1 / (3 * sigma);
    struct window_filter filter = {.delta = delta,
                                   .mu = mode & 8 ? 0 : 0.1f * delta,
                                   .grow = mode & 1 ? delta : -RANGE_FIXED,
                                   .cut = cut,
                                   .weight_cut = expf(-0.5f * cut * cut),
                                   .sigma_max = (float)(PLANE_BORDER - 1) / cut,
                                   .bias_correction = (mode & 2) != 0,
                                   .at_lens = at_lens};
    for (int axis = 0; axis < 2; axis++) { /* pixels that are no squares */
        filter.inverse[axis].slope = orthographic ? 0 : inverse * (axis ? 1.1f : 1);
        filter.inverse[axis].offset = orthographic ? inverse * (axis ? 1.1f : 1) : 0;
    }
    for (int i = 0; i < 9; i++) {
        filter.square[i / 3][i % 3] = expf(-0.25f * (float)(i / 3 * (i / 3) + i % 3 * (i % 3))) - 0.1f;
    }
    return filter;
}

struct planes {
    struct depth_plane in, expected, got;
    struct depth_range around; /* of all depths and the border */
    struct plane normal[3];
    struct memory memory;
};

static int setup(void **state)
{
    static struct planes planes;
    mns_memory_init(&planes.memory, NULL);
    *state = &planes;
    for (int c = 0; c < 3; c++) {
        if (!mns_plane_resize(&planes.normal[c], &planes.memory, WIDTH, HEIGHT, PLANE_BORDER)) {
            return 1;
        }
    }
    return !(mns_depth_plane_resize(&planes.in, &planes.memory, WIDTH, HEIGHT) &&
             mns_depth_plane_resize(&planes.expected, &planes.memory, WIDTH, HEIGHT) &&
             mns_depth_plane_resize(&planes.got, &planes.memory, WIDTH, HEIGHT));
}

static int teardown(void **state)
{
    struct planes *planes = *state;
    mns_depth_plane_free(&planes->in, &planes->memory);
    mns_depth_plane_free(&planes->expected, &planes->memory);
    mns_depth_plane_free(&planes->got, &planes->memory);
    for (int c = 0; c < 3; c++) {
        mns_plane_free(&planes->normal[c], &planes->memory);
    }
    return planes->memory.bytes != 0;
}

/* fluid_border: as if the picture went on, else the border holds 0. */
static void fill(struct planes *planes, int kind, float delta, bool fluid_border)
{
    planes->around = fluid_border ? (struct depth_range){DEPTH_EMPTY, 0} : (struct depth_range){0, DEPTH_EMPTY};
    for (int y = -PLANE_BORDER; y < HEIGHT + PLANE_BORDER; y++) {
        for (int x = -PLANE_BORDER; x < WIDTH + PLANE_BORDER; x++) {
            bool inside = x >= 0 && x < WIDTH && y >= 0 && y < HEIGHT;
            float depth = inside || fluid_border ? depth_of(kind, x, y, delta) : 0;
            planes->in.plane.data[y * planes->in.plane.stride + x] = depth;
            planes->around.min = fminf(planes->around.min, depth);
            planes->around.max = fmaxf(planes->around.max, depth);
        }
    }
}

static struct depth_range range_of(const float *in, ptrdiff_t stride)
{
    struct depth_range range = {DEPTH_EMPTY, 0};
    for (int i = 0; i < BLOCK_WIDTH * BLOCK_HEIGHT; i++) {
        float depth = in[i / BLOCK_WIDTH * stride + i % BLOCK_WIDTH];
        range.min = fminf(range.min, depth);
        range.max = fmaxf(range.max, depth);
    }
    return range;
}

/* Runs both on all blocks; returns how many pixels are out of tolerance: 4e-7 of the depth plus spread (cpu/smooth). */
static int compare_within(struct planes *planes, window_function *expected, window_function *got, const struct window_filter *filter,
                          int axis, float spread)
{
    int apart = 0;
    ptrdiff_t stride = planes->in.plane.stride;
    for (int by = 0; by < HEIGHT / BLOCK_HEIGHT; by++) {
        for (int bx = 0; bx < WIDTH / BLOCK_WIDTH; bx++) {
            ptrdiff_t at = by * BLOCK_HEIGHT * stride + bx * BLOCK_WIDTH;
            const float *in = planes->in.plane.data + at;
            float *a = planes->expected.plane.data + at, *b = planes->got.plane.data + at;
            struct depth_range own = range_of(in, stride), range = {DEPTH_EMPTY, 0};
            if (own.min >= DEPTH_LIMIT) { /* no kernel is called for these */
                continue;
            }
            struct depth_block block = {in, a, stride, own, planes->around, bx * BLOCK_WIDTH, by * BLOCK_HEIGHT};
            struct depth_range range_a = expected(filter, &block, axis);
            block.out = b;
            struct depth_range range_b = got(filter, &block, axis);
            for (int i = 0; i < BLOCK_WIDTH * BLOCK_HEIGHT; i++) {
                ptrdiff_t p = i / BLOCK_WIDTH * stride + i % BLOCK_WIDTH;
                bool fluid = in[p] < DEPTH_LIMIT;
                assert_true(fluid || (a[p] == in[p] && b[p] == in[p]));
                apart += !(fabsf(a[p] - b[p]) <= 4e-7f * a[p] + spread);
                range.min = fminf(range.min, b[p]);
                range.max = fmaxf(range.max, b[p]);
            }
            assert_true(range.min == range_b.min && range.max == range_b.max);
            assert_true((range_a.max >= DEPTH_LIMIT) == (range_b.max >= DEPTH_LIMIT));
        }
    }
    return apart;
}

static int compare(struct planes *planes, window_function *expected, window_function *got, const struct window_filter *filter, int axis)
{
    return compare_within(planes, expected, got, filter, axis, 1e-4f * filter->delta);
}

static void compare_all(struct planes *planes, const struct narrow_range_kernels *a, const struct narrow_range_kernels *b,
                        const struct window_filter *filter, bool plain)
{
    /* samples within rounding of a bound: less than one in 10000 pixels */
    int allowed = WIDTH * HEIGHT / 10000 + 1;
    assert_true(compare(planes, a->line, b->line, filter, AXIS_X) <= allowed);
    assert_true(compare(planes, a->line, b->line, filter, AXIS_Y) <= allowed);
    assert_true(compare(planes, a->disc, b->disc, filter, AXIS_X) <= allowed);
    assert_true(compare(planes, a->square, b->square, filter, AXIS_X) <= allowed);
    if (plain) {
        assert_int_equal(compare(planes, a->line_plain, b->line_plain, filter, AXIS_X), 0);
        assert_int_equal(compare(planes, a->line_plain, b->line_plain, filter, AXIS_Y), 0);
        assert_int_equal(compare(planes, a->disc_plain, b->disc_plain, filter, AXIS_X), 0);
        assert_int_equal(compare(planes, a->square_plain, b->square_plain, filter, AXIS_X), 0);
    }
}

static float fluid_range(const struct planes *planes)
{
    float min = DEPTH_EMPTY, max = 0;
    for (int y = -PLANE_BORDER; y < HEIGHT + PLANE_BORDER; y++) {
        for (int x = -PLANE_BORDER; x < WIDTH + PLANE_BORDER; x++) {
            float depth = planes->in.plane.data[y * planes->in.plane.stride + x];
            bool fluid = depth > 0 && depth < DEPTH_LIMIT;
            min = fluid ? fminf(min, depth) : min;
            max = fluid ? fmaxf(max, depth) : max;
        }
    }
    return fmaxf(max - min, 0);
}

/* A view, and normals up to 80 degrees off the view axis. */
static struct plane_fit planes_fit(struct planes *planes, bool orthographic)
{
    struct plane_fit fit = {
        .step_x = 0.002f, .step_y = 0.0022f, .cx = 0.5f * WIDTH + 80, .cy = 0.5f * HEIGHT, .orthographic = orthographic};
    for (int c = 0; c < 3; c++) {
        fit.normal[c] = planes->normal[c].data;
    }
    for (int y = -PLANE_BORDER; y < HEIGHT + PLANE_BORDER; y++) {
        for (int x = -PLANE_BORDER; x < WIDTH + PLANE_BORDER; x++) {
            float a = 4 * uniform() - 1, b = 4 * uniform() - 2, scale = 1 / sqrtf(a * a + b * b + 1);
            const float normal[3] = {a * scale, b * scale, -scale};
            for (int c = 0; c < 3; c++) {
                planes->normal[c].data[y * planes->normal[c].stride + x] = normal[c];
            }
        }
    }
    return fit;
}

static void compare_means(struct planes *planes, const struct smooth_kernels *a, const struct smooth_kernels *b,
                          const struct window_filter *filter, bool orthographic, bool plain)
{
    float spread = 1e-5f * fluid_range(planes);
    assert_int_equal(compare_within(planes, a->gaussian->line, b->gaussian->line, filter, AXIS_X, spread), 0);
    assert_int_equal(compare_within(planes, a->gaussian->line, b->gaussian->line, filter, AXIS_Y, spread), 0);
    assert_int_equal(compare_within(planes, a->bilateral->line, b->bilateral->line, filter, AXIS_X, 1e-5f * filter->delta), 0);
    assert_int_equal(compare_within(planes, a->bilateral->line, b->bilateral->line, filter, AXIS_Y, 1e-5f * filter->delta), 0);
    assert_int_equal(compare_within(planes, a->bilateral->disc, b->bilateral->disc, filter, AXIS_X, 1e-5f * filter->delta), 0);
    struct plane_fit fit = planes_fit(planes, orthographic);
    struct window_filter fitting = *filter;
    fitting.fit = &fit;
    assert_true(compare(planes, a->plane_fit->disc, b->plane_fit->disc, &fitting, AXIS_X) <= 1);
    if (plain) {
        assert_int_equal(compare(planes, a->plane_fit->disc, b->plane_fit->disc_plain, &fitting, AXIS_X), 0);
        assert_int_equal(compare_within(planes, a->bilateral->line, b->bilateral->line_plain, filter, AXIS_X, 1e-5f * filter->delta), 0);
        assert_int_equal(compare_within(planes, a->bilateral->line, b->bilateral->line_plain, filter, AXIS_Y, 1e-5f * filter->delta), 0);
        assert_int_equal(compare_within(planes, a->bilateral->disc, b->bilateral->disc_plain, filter, AXIS_X, 1e-5f * filter->delta), 0);
        assert_int_equal(compare(planes, a->gaussian->line, b->narrow_range->line_plain, filter, AXIS_X), 0);
    }
}

static void test_every_instruction_set_is_plain_c(void **state)
{
    const struct smooth_kernels *scalar = mns_kernels_get(MNS_ISA_SCALAR)->smooth;
    static const float sigmas[] = {0.2f, 0.9f, 3.7f, 12.0f, 500.0f};
    for (int isa = MNS_ISA_SSE2; isa <= MNS_ISA_NEON; isa++) {
        const struct kernels *kernels = mns_kernels_get((enum mns_isa)isa);
        for (int i = 0; kernels && i < 56; i++) {
            float delta = i % 3 ? 0.1f : 0.7f;
            int kind = i % 7; /* with another sigma and mode each time */
            fill(*state, kind, delta, kind == 6 || i >= 28);
            struct window_filter filter = filter_of(delta, sigmas[i % 5], i & 16, kind == 2 || kind == 5, i % 16);
            compare_all(*state, scalar->narrow_range, kernels->smooth->narrow_range, &filter, false);
            compare_means(*state, scalar, kernels->smooth, &filter, i & 16, false);
        }
    }
}

/* Blocks in the middle of noise within delta: no tap is out of range, and the plain kernels must do what the others do. */
static void test_plain_kernels_are_the_others_where_they_apply(void **state)
{
    struct planes *planes = *state;
    fill(planes, 0, 0.1f, true);
    for (int isa = MNS_ISA_SCALAR; isa <= MNS_ISA_NEON; isa++) {
        const struct kernels *kernels = mns_kernels_get((enum mns_isa)isa);
        for (int i = 0; kernels && i < 8; i++) {
            struct window_filter filter = filter_of(0.1f, i & 4 ? 25.0f : 4.3f, i & 2, false, 1 | (i & 1) << 1 | (i & 4));
            const struct narrow_range_kernels *vector = kernels->smooth->narrow_range;
            assert_int_equal(compare(planes, vector->line, vector->line_plain, &filter, AXIS_X), 0);
            assert_int_equal(compare(planes, vector->line, vector->line_plain, &filter, AXIS_Y), 0);
            assert_int_equal(compare(planes, vector->disc, vector->disc_plain, &filter, AXIS_X), 0);
            assert_int_equal(compare(planes, vector->square, vector->square_plain, &filter, AXIS_X), 0);
            compare_all(planes, mns_kernels_get(MNS_ISA_SCALAR)->smooth->narrow_range, vector, &filter, true);
            compare_means(planes, mns_kernels_get(MNS_ISA_SCALAR)->smooth, kernels->smooth, &filter, i & 2, true);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_every_instruction_set_is_plain_c, setup, teardown),
        cmocka_unit_test_setup_teardown(test_plain_kernels_are_the_others_where_they_apply, setup, teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
