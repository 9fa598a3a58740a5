/* The kernels of stage shade: every instruction set against plain C, on smooth and on broken surfaces, in every mode. */
#include "kernels/kernel_test.h"

#include "cpu/plane.h"

enum {
    WIDTH = 200,
    HEIGHT = 24,
    BORDER = 32,
    STRIDE = WIDTH + 2 * BORDER + 16,
    SCENE_STRIDE = 208,
    COLORS = 4 * SCENE_STRIDE * (HEIGHT + 1)
};

static float depth_block[(HEIGHT + 2 * BORDER) * STRIDE], scene[COLORS], scene_depth[SCENE_STRIDE * (HEIGHT + 1)];
static float *const depth = depth_block + BORDER * STRIDE + BORDER;

/* kind 0: waves; 1: waves with holes, steps and things before them; 2: nearly nothing. */
static void fill(int kind, float scale)
{
    memset(depth_block, 0, sizeof(depth_block));
    for (int y = 0; y < HEIGHT; y++) {
        for (int x = 0; x < WIDTH; x++) {
            float z = 4 + 0.3f * sinf(0.11f * (float)x + 0.3f * (float)y) + 0.02f * (float)y + (kind == 1 && uniform(0, 1) < 0.1f ? 1 : 0);
            depth[y * STRIDE + x] = uniform(0, 1) < (kind == 0 ? 0 : kind == 1 ? 0.2f : 0.99f) ? DEPTH_EMPTY : scale * z;
        }
    }
    for (int i = 0; i < SCENE_STRIDE * (HEIGHT + 1); i++) {
        scene_depth[i] = kind == 1 && uniform(0, 1) < 0.05f ? 3 * scale : uniform(0, 1) < 0.3f ? DEPTH_EMPTY : 8 * scale;
    }
    for (int i = 0; i < COLORS; i++) {
        scene[i] = uniform(0, 1.5f);
    }
}

static struct shade_optics optics_of(int mode, float scale)
{
    bool orthographic = mode & 1;
    struct shade_optics o = {.orthographic = orthographic,
                             .fx = orthographic ? 40 / scale : 160,
                             .fy = orthographic ? 45 / scale : 150,
                             .cx = 90,
                             .cy = 13,
                             .edge = 0.1f * scale,
                             .one_sided = (mode & 8) != 0,
                             .schlick = (mode & 2) != 0,
                             .index = mode & 16 ? 1 : 1.333f,
                             .refraction = 1,
                             .absorption = {2 / scale, 0.5f / scale, 0.2f / scale},
                             .absorption_mean = 0.9f / scale,
                             .scatter = {0.01f, 0.05f, 0.1f},
                             .scatter_light = {0.4f, 0.5f, 0.5f},
                             .reflection = 1,
                             .specular = 1,
                             .shininess = 300,
                             .opaque = {0.1f, 0.3f, 0.6f},
                             .grey = {0.7f, 0.75f, 0.8f},
                             .foam_front = {0.9f, 0.9f, 1},
                             .foam_back = {0.2f, 0.3f, 0.3f},
                             .foam_extinction = 3 / scale,
                             .foam_range_extinction = 5 / scale,
                             .foam_blend = 0.3f * scale,
                             .scene = scene,
                             .scene_stride = SCENE_STRIDE,
                             .scene_depth = mode & 4 ? scene_depth : NULL,
                             .scene_depth_stride = SCENE_STRIDE,
                             .width = WIDTH,
                             .height = HEIGHT,
                             .transparent = (mode & 32) != 0};
    o.step_x = 1 / o.fx;
    o.step_y = 1 / o.fy;
    o.sky = (struct sky){.up = {0, -0.8f, -0.6f},
                         .sun = {0.48f, -0.64f, -0.6f},
                         .zenith = {0.1f, 0.2f, 0.5f},
                         .horizon = {0.6f, 0.7f, 0.8f},
                         .ground = {0.3f, 0.3f, 0.2f},
                         .glow_wide = {0.2f, 0.2f, 0.1f},
                         .glow_narrow = {1, 1, 1},
                         .sun_light = {1.9f, 1.7f, 1.5f},
                         .sky_light = {0.2f, 0.3f, 0.5f}};
    return o;
}

/* Plain C's results up to the fetch. */
static void prepare(const struct shade_optics *o, bool has_color, struct shade_row *row, int y)
{
    const struct shade_kernels *scalar = mns_kernels_get(MNS_ISA_SCALAR)->shade;
    memset(row, 0, sizeof(*row));
    row->y = y;
    row->count = WIDTH - 3;
    scalar->normals(o, depth + y * STRIDE, STRIDE, o->scene_depth ? scene_depth + y * SCENE_STRIDE : NULL, 0, y, row->count, row->nx,
                    row->ny, row->nz);
    memcpy(row->depth, depth + y * STRIDE, sizeof(float) * (size_t)row->count);
    for (int i = 0; i < row->count; i++) {
        row->thickness[i] = (uniform(0, 1) < 0.1f ? 0 : uniform(0, 3)) / o->absorption[0];
        row->foam[i] = (uniform(0, 1) < 0.5f ? 0 : uniform(0, 2)) / o->foam_extinction;
        row->foam_range[i] = row->foam[i] * uniform(0, 1);
        row->foam_depth[i] = row->foam[i] > 0 ? row->depth[i] + uniform(-1, 1) * o->foam_blend : DEPTH_EMPTY;
        row->before[i] = row->thickness[i] * uniform(-0.1f, 1.1f);
        for (int c = 0; c < 3; c++) {
            row->color[c][i] = uniform(-0.2f, 1.2f);
        }
    }
    scalar->optics(o, has_color, row);
    scalar->fetch(o, row);
}

static void compare_normals(const struct shade_optics *o, const struct shade_kernels *vector, const struct shade_row *row)
{
    float n[3][WIDTH + 16];
    const float *before = o->scene_depth ? scene_depth + row->y * SCENE_STRIDE : NULL;
    int found = vector->normals(o, depth + row->y * STRIDE, STRIDE, before, 0, row->y, row->count, n[0], n[1], n[2]), expected = 0;
    for (int i = 0; i < row->count; i++) {
        expected += row->nz[i] != 0;
    }
    assert_int_equal(found, expected);
    assert_near(n[0], row->nx, row->count, 4e-6f);
    assert_near(n[1], row->ny, row->count, 4e-6f);
    assert_near(n[2], row->nz, row->count, 4e-6f);
}

static void compare_curvature(const struct shade_optics *o, const struct shade_kernels *vector, int y)
{
    const struct shade_kernels *scalar = mns_kernels_get(MNS_ISA_SCALAR)->shade;
    float n[3][3][WIDTH + 32], expected[WIDTH + 16], got[WIDTH + 16];
    struct shade_normals rows;
    for (int r = 0; r < 3; r++) {
        scalar->normals(o, depth + (y + r - 1) * STRIDE - 16, STRIDE, NULL, -16, y + r - 1, WIDTH + 16, n[r][0], n[r][1], n[r][2]);
        for (int c = 0; c < 3; c++) {
            rows.n[r][c] = n[r][c] + 16;
        }
    }
    scalar->curvature(o, &rows, depth + y * STRIDE, STRIDE, 0, y, WIDTH - 16, expected);
    vector->curvature(o, &rows, depth + y * STRIDE, STRIDE, 0, y, WIDTH - 16, got);
    float footprint = o->step_x * (o->orthographic ? 1 : 4 * o->edge / 0.1f);
    assert_near(got, expected, WIDTH - 16, 1e-4f / footprint);
}

static void compare_optics(const struct shade_optics *o, const struct shade_kernels *vector, bool has_color, const struct shade_row *row)
{
    struct shade_row got = *row;
    vector->optics(o, has_color, &got);
    for (int i = 0; i < row->count; i++) {
        if (row->nz[i] != 0) {
            assert_near(got.fresnel + i, row->fresnel + i, 1, 1e-5f);
            assert_near(got.look_x + i, row->look_x + i, 1, 1e-3f);
            assert_near(got.look_y + i, row->look_y + i, 1, 1e-3f);
            for (int c = 0; c < 3; c++) {
                assert_near(got.transmittance[c] + i, row->transmittance[c] + i, 1, 4e-6f);
            }
        }
    }
    got = *row;
    memset(got.behind, 0, sizeof(got.behind));
    vector->fetch(o, &got);
    for (int i = 0; i < row->count; i++) {
        if (row->nz[i] != 0) {
            assert_near(got.behind + 4 * i, row->behind + 4 * i, 4, 2e-6f);
        }
    }
}

static void compare_out(const struct shade_row *got, const struct shade_row *expected)
{
    for (int i = 0; i < 4 * got->count; i++) { /* over nothing colours are divided by what may be a small alpha */
        const float *right = expected->out[i % 4] + i / 4;
        assert_near(got->out[i % 4] + i / 4, right, 1, 2e-4f * (1 + fabsf(*right)));
    }
}

static void compare_colors(const struct shade_optics *o, const struct shade_kernels *vector, bool has_color, const struct shade_row *row)
{
    const struct shade_kernels *scalar = mns_kernels_get(MNS_ISA_SCALAR)->shade;
    struct shade_row expected = *row, got = *row;
    scalar->water(o, has_color, &expected);
    vector->water(o, has_color, &got);
    compare_out(&got, &expected);
    scalar->veil(o, &expected);
    vector->veil(o, &got);
    assert_near(got.veil, expected.veil, row->count, 4e-6f);
    scalar->layered(o, has_color, &expected);
    vector->layered(o, has_color, &got);
    compare_out(&got, &expected);
    scalar->opaque(o, has_color, &expected);
    vector->opaque(o, has_color, &got);
    compare_out(&got, &expected);
    for (int i = 0; i < row->count; i++) {
        expected.grey[i] = got.grey[i] = i % 3 == 0 ? 0 : uniform(0, 1);
    }
    scalar->grey(o, &expected);
    vector->grey(o, &got);
    compare_out(&got, &expected);
}

static void test_rows(void **state)
{
    (void)state;
    static const float scales[] = {1, 1e-3f, 1e3f};
    const struct kernels *vector;
    for (int mode = 0; mode < 64; mode++) {
        float scale = scales[mode % 3];
        struct shade_optics o = optics_of(mode, scale);
        fill(mode / 2 % 3, scale);
        for (int y = 0; y < HEIGHT; y += 5) {
            static struct shade_row row;
            bool has_color = (mode / 4 + y) % 2;
            prepare(&o, has_color, &row, y);
            int index = 0;
            while ((vector = vector_kernels(&index))) {
                compare_normals(&o, vector->shade, &row);
                compare_curvature(&o, vector->shade, y);
                compare_optics(&o, vector->shade, has_color, &row);
                compare_colors(&o, vector->shade, has_color, &row);
            }
        }
    }
}

static void encode(const struct shade_kernels *kernels, const float *rgba, int count, float gain, enum pixel_meaning meaning,
                   enum mns_pixel pixel, int channels, void *out)
{
    static float planes[4][SHADE_SPAN];
    kernels->split(rgba, count, planes);
    kernels->encode(planes, count, gain, meaning, pixel, channels, out);
}

static double code_of(double value, enum pixel_meaning meaning)
{
    value = value > 0 ? value < 1 ? value : 1 : 0;
    return meaning == PIXEL_CODE ? value : value <= 0.0031308 ? 12.92 * value : 1.055 * pow(value, 1 / 2.4) - 0.055;
}

/* Integers are the nearest to the exact curve, or the other side where it is next to halfway. */
static void check_codes(const struct shade_kernels *kernels, const float *rgba, int count, enum pixel_meaning meaning, enum mns_pixel pixel,
                        int channels)
{
    uint8_t bytes[2 * 4 * 300 + 2];
    memset(bytes, 0xa5, sizeof(bytes));
    int size = pixel == MNS_PIXEL_U8 ? 1 : 2, top = pixel == MNS_PIXEL_U8 ? 255 : 65535;
    encode(kernels, rgba, count, 1.25f, meaning, pixel, channels, bytes);
    for (int i = 0; i < count * channels; i++) {
        int channel = i % channels;
        double value = (double)rgba[4 * (i / channels) + channel] * (channel < 3 ? 1.25 : 1);
        double exact = top * code_of(value, channel < 3 ? meaning : PIXEL_CODE);
        uint16_t word;
        memcpy(&word, bytes + i * size, sizeof(word));
        int got = size == 1 ? bytes[i] : word;
        assert_true(fabs(got - exact) <= 0.5 + (size == 1 ? 0.01 : 0.4));
    }
    assert_int_equal(bytes[size * count * channels], 0xa5);
}

static void test_encode(void **state)
{
    (void)state;
    static float rgba[4 * 300];
    for (int i = 0; i < 4 * 300; i++) {
        rgba[i] = i % 7 == 0 ? uniform(0, 0.005f) : uniform(-0.2f, 1.3f);
    }
    rgba[0] = NAN;
    rgba[1] = INFINITY;
    rgba[2] = -INFINITY;
    rgba[3] = 1e-42f;
    const struct kernels *vector = mns_kernels_get(MNS_ISA_SCALAR);
    int index = 0;
    for (; vector; vector = vector_kernels(&index)) {
        float copy[4 * 300];
        memcpy(copy, rgba, sizeof(copy));
        uint8_t first[4];
        encode(vector->shade, copy, 1, 1, PIXEL_COLOR, MNS_PIXEL_U8, 4, first);
        assert_true(first[0] == 0 && first[1] == 255 && first[2] == 0 && first[3] == 0);
        copy[0] = copy[1] = copy[2] = 0.5f;
        for (int kind = 0; kind < 8; kind++) {
            for (int count = 1; count < 300; count += 61) {
                check_codes(vector->shade, copy, count, kind & 1 ? PIXEL_CODE : PIXEL_COLOR, kind & 2 ? MNS_PIXEL_U16 : MNS_PIXEL_U8,
                            kind & 4 ? 3 : 4);
            }
        }
        float floats[3 * 20];
        encode(vector->shade, copy, 20, 2, PIXEL_COLOR, MNS_PIXEL_F32, 3, floats);
        for (int i = 0; i < 60; i++) {
            assert_true(floats[i] == 2 * copy[i / 3 * 4 + i % 3]);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_rows), cmocka_unit_test(test_encode)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
