/* Colour maps, values of particles by an expression, and the display that shows both. */
#include "io_test.h"

#include <meniscus/meniscus.h>

static double srgb_from_linear(double v) { return v <= 0.0031308 ? 12.92 * v : 1.055 * pow(v, 1 / 2.4) - 0.055; }

/* The colour of a value from 0 to 1, in sRGB of 255. */
static void color_at(const struct mns_colormap *map, double value, double out[3])
{
    float linear[3];
    mns_colormap_apply(map, &value, 1, 0, 1, linear);
    for (int c = 0; c < 3; c++) {
        out[c] = 255 * srgb_from_linear((double)linear[c]);
    }
}

static void assert_color(const struct mns_colormap *map, double value, double r, double g, double b, double most)
{
    const double wanted[3] = {r, g, b};
    double got[3];
    color_at(map, value, got);
    for (int c = 0; c < 3; c++) {
        if (fabs(got[c] - wanted[c]) > most) {
            fail_msg("at %g: channel %d is %g, not %g", value, c, got[c], wanted[c]);
        }
    }
}

/* Against values of the published tables of 256 colours, also between our knots. */
static void maps_are_the_published_ones(void **state)
{
    (void)state;
    struct mns_colormap map;
    static const struct {
        const char *name;
        double value;
        int color[3];
    } known[] = {{"viridis", 0, {68, 1, 84}},    {"viridis", 100 / 255.0, {42, 118, 142}}, {"viridis", 1, {253, 231, 37}},
                 {"plasma", 0, {13, 8, 135}},    {"plasma", 77 / 255.0, {145, 14, 163}},   {"plasma", 1, {240, 249, 33}},
                 {"turbo", 0, {48, 18, 59}},     {"turbo", 128 / 255.0, {164, 252, 60}},   {"turbo", 1, {122, 4, 3}},
                 {"coolwarm", 0, {59, 76, 192}}, {"coolwarm", 0.5, {221, 221, 221}},       {"coolwarm", 1, {180, 4, 38}}};
    for (size_t i = 0; i < sizeof(known) / sizeof(known[0]); i++) {
        assert_int_equal(mns_colormap_find(&map, known[i].name, NULL), MNS_OK);
        assert_color(&map, known[i].value, known[i].color[0], known[i].color[1], known[i].color[2], 3);
    }
    for (size_t i = 0; mns_colormap_name(i); i++) {
        assert_int_equal(mns_colormap_find(&map, mns_colormap_name(i), NULL), MNS_OK);
    }
    struct mns_message message;
    assert_int_equal(mns_colormap_find(&map, "viridus", &message), MNS_ERR_INVALID_ARGUMENT);
    assert_non_null(strstr(message.text, "did you mean 'viridis'"));
}

static void values_beyond_the_range_are_its_ends(void **state)
{
    (void)state;
    const float ends[2][3] = {{0, 0, 0}, {1, 1, 1}};
    struct mns_colormap map;
    assert_int_equal(mns_colormap_make(&map, ends[0], 2, NULL), MNS_OK);
    const double values[] = {-5, 0, 2, 4, 9, NAN, INFINITY, -INFINITY};
    const float up[] = {0, 0, 0.2140f, 1, 1, 0.2f, 1, 0}, down[] = {1, 1, 0.2140f, 0, 0, 0.2f, 0, 1};
    float out[8][3];
    mns_colormap_apply(&map, values, 8, 0, 4, out[0]);
    for (int i = 0; i < 8; i++) {
        assert_true(fabsf(out[i][1] - up[i]) < 1e-3f);
    }
    mns_colormap_apply(&map, values, 8, 4, 0, out[0]);
    for (int i = 0; i < 8; i++) {
        assert_true(fabsf(out[i][1] - down[i]) < 1e-3f);
    }
    mns_colormap_apply(&map, values, 3, 1, 1, out[0]); /* no range: the middle */
    assert_true(fabsf(out[0][0] - 0.2140f) < 1e-3f && fabsf(out[2][0] - 0.2140f) < 1e-3f);
    assert_int_equal(mns_colormap_make(&map, ends[0], 1, NULL), MNS_ERR_INVALID_ARGUMENT);
    const float bad[2][3] = {{0, 0, 0}, {1, NAN, 1}};
    struct mns_message message;
    assert_int_equal(mns_colormap_make(&map, bad[0], 2, &message), MNS_ERR_INVALID_ARGUMENT);
    assert_non_null(strstr(message.text, "colour 2"));
}

static mns_result read_map(struct mns_colormap *map, const char *text, struct mns_message *message)
{
    FILE *file = fopen("test_colormap.txt", "w");
    assert_non_null(file);
    fputs(text, file);
    fclose(file);
    mns_result result = mns_colormap_read(map, "test_colormap.txt", message);
    remove("test_colormap.txt");
    return result;
}

static void maps_are_read_from_text(void **state)
{
    (void)state;
    struct mns_colormap map;
    struct mns_message message;
    assert_int_equal(read_map(&map, "# bytes\n255 0 0\n\n0,255,0 # green\r\n0;0;255", &message), MNS_OK);
    assert_color(&map, 0, 255, 0, 0, 0.5);
    assert_color(&map, 0.5, 0, 255, 0, 0.5);
    assert_color(&map, 1, 0, 0, 255, 0.5);
    assert_int_equal(read_map(&map, "0.0  1 0.5 0\n1.0\t0 0 1\n", &message), MNS_OK);
    assert_color(&map, 0, 255, 127.5, 0, 0.5);
    static const char *const bad[] = {"1 2\n",       "red green blue\n", "0 0 0\n1 1 -1\n", "0 0 0\n1 1 nan\n", "0 0 0\n300 1 1\n",
                                      "1 1 1 1 1\n", "1 1 1x\n"};
    for (size_t i = 0; i < sizeof(bad) / sizeof(bad[0]); i++) {
        assert_int_equal(read_map(&map, bad[i], &message), MNS_ERR_BAD_DATA);
        assert_non_null(strstr(message.text, "test_colormap.txt: line "));
    }
    assert_int_equal(read_map(&map, "1 1 1\n", &message), MNS_ERR_BAD_DATA);
    assert_int_equal(read_map(&map, "", &message), MNS_ERR_BAD_DATA);
    assert_int_equal(mns_colormap_read(&map, "no_such_map.txt", &message), MNS_ERR_IO);
}

static void expressions_give_values(void **state)
{
    (void)state;
    mns_particle_set *set = read_text("x,y,z,vx,vy,vz,rho\n1,2,3,3.5,0.5,-2.5,1000\n7,8,9,1.5,2.5,3.5,nan\n", "a.csv", NULL);
    struct mns_message message;
    double values[2];
    assert_int_equal(mns_particle_set_evaluate(set, "a.csv", "velocity.y", values, &message), MNS_OK);
    assert_true(values[0] == 0.5 && values[1] == 2.5);
    assert_int_equal(mns_particle_set_evaluate(set, "a.csv", "velocity", values, &message), MNS_OK);
    assert_true(fabs(values[0] - sqrt(3.5 * 3.5 + 0.25 + 2.5 * 2.5)) < 1e-12);
    assert_int_equal(mns_particle_set_evaluate(set, "a.csv", "2 * x - z", values, &message), MNS_OK);
    assert_true(values[0] == -1 && values[1] == 5);
    assert_int_equal(mns_particle_set_evaluate(set, "a.csv", "density", values, &message), MNS_OK);
    assert_true(values[0] == 1000 && isnan(values[1]));
    assert_int_equal(mns_particle_set_evaluate(set, "a.csv", "pressure", values, &message), MNS_ERR_INVALID_ARGUMENT);
    assert_non_null(strstr(message.text, "a.csv: value 'pressure': column 1: no attribute 'pressure'; there is position[3]"));
    assert_int_equal(mns_particle_set_evaluate(set, NULL, "x +", values, NULL), MNS_ERR_INVALID_ARGUMENT);
    mns_particle_set_destroy(&set);
}

/* Wherever the fluid shows, the picture is its particles' colour times one light. */
static void the_display_shows_the_colours_themselves(void **state)
{
    (void)state;
    enum { SIDE = 12, COUNT = SIDE * SIDE * SIDE, W = 64, H = 48 };
    static float positions[COUNT][3], colors[COUNT][3], pixels[H * W * 4], depth[H * W];
    static const float own[3] = {0.1f, 0.62f, 0.34f};
    for (int i = 0; i < COUNT; i++) {
        for (int c = 0, rest = i; c < 3; c++, rest /= SIDE) {
            positions[i][c] = 0.1f * (float)(rest % SIDE);
            colors[i][c] = own[c];
        }
    }
    struct mns_particles particles;
    mns_particles_init(&particles);
    particles.count = COUNT;
    particles.position = (struct mns_attr){positions, 0, MNS_F32};
    particles.color = (struct mns_attr){colors, 0, MNS_F32};
    mns_renderer *renderer;
    struct mns_params params;
    struct mns_camera camera;
    struct mns_frame frame;
    const double low[3] = {0, 0, 0}, high[3] = {1.1, 1.1, 1.1};
    assert_int_equal(mns_renderer_create(&renderer, NULL, NULL), MNS_OK);
    assert_int_equal(mns_renderer_prepare(renderer, &particles), MNS_OK);
    mns_params_init(&params);
    params.display = MNS_DISPLAY_COLOR;
    mns_camera_init(&camera, W, H);
    assert_int_equal(mns_camera_frame(&camera, low, high, 0.05, 1, 45), MNS_OK);
    mns_frame_init(&frame);
    const struct mns_output outputs[] = {{MNS_LAYER_BEAUTY, {.data = pixels, .width = W, .height = H, .channels = 4}},
                                         {MNS_LAYER_DEPTH, {.data = depth, .width = W, .height = H, .channels = 1}}};
    frame.camera = &camera;
    frame.params = &params;
    frame.outputs = outputs;
    frame.output_count = 2;
    assert_int_equal(mns_renderer_draw(renderer, &frame), MNS_OK);
    int covered = 0;
    for (int i = 0; i < W * H; i++) {
        if (depth[i] < INFINITY) {
            float light = pixels[4 * i + 1] / own[1];
            assert_true(light >= 0.499f && light <= 1.001f);
            assert_true(fabsf(pixels[4 * i] - light * own[0]) < 1e-4f && fabsf(pixels[4 * i + 2] - light * own[2]) < 1e-4f);
            covered++;
        }
    }
    assert_true(covered > W * H / 10);
    mns_renderer_destroy(&renderer);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(maps_are_the_published_ones),
        cmocka_unit_test(values_beyond_the_range_are_its_ends),
        cmocka_unit_test(maps_are_read_from_text),
        cmocka_unit_test(expressions_give_values),
        cmocka_unit_test(the_display_shows_the_colours_themselves),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
