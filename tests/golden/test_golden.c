/* Golden pictures: small scenes against pictures that were looked at when they were made, with a measured bound.
 *
 *     build/tests/test_golden tests/golden             compares; what differs is written to the working folder as NAME_is.png
 *     build/tests/test_golden tests/golden --update    makes them anew: look at each before it is committed
 */
#include "unit/picture_test.h"

#include <meniscus/io.h>

#include <spng.h>
#include <stdio.h>

/* Instruction sets differ in rounding, which moves a rim by a pixel here and there: measured, a mean of 0.05 and 0.1 % of the values.
 * What a person would see as another picture is a mean of 1 and more. */
static const double MEAN_LIMIT = 0.25;  /* of 255 */
static const double PART_LIMIT = 0.005; /* of the values, that differ by more than PART_STEP of 255 */
static const double PART_STEP = 16;

static const char *folder;
static bool update;

static const struct golden {
    const char *name;
    const char *settings[4][2]; /* parameter, value */
} goldens[] = {
    {"beauty", {{NULL}}},
    {"opaque", {{"display", "opaque"}}},
    {"spheres", {{"display", "spheres"}}},
    {"normal", {{"display", "normal"}}},
    {"depth", {{"display", "depth"}}},
    {"thickness", {{"display", "thickness"}}},
    {"curvature", {{"display", "curvature"}}},
    {"narrow_range_2d", {{"filter", "narrow-range"}}},
    {"narrow_range_1d", {{"filter", "narrow-range-1d"}}},
    {"narrow_range_1d_cleanup", {{"filter", "narrow-range-1d-cleanup"}}},
    {"unsmoothed", {{"filter", "none"}}},
    {"transparent", {{"background", "transparent"}}},
    {"evening", {{"sun_elevation", "8"}, {"sun_azimuth", "200"}, {"exposure", "0.5"}}},
};

static void *read_file(const char *path, size_t *size)
{
    FILE *file = fopen(path, "rb");
    if (!file) {
        fail_msg("%s cannot be opened", path);
    }
    fseek(file, 0, SEEK_END);
    *size = (size_t)ftell(file);
    rewind(file);
    void *data = malloc(*size);
    assert_non_null(data);
    assert_int_equal(fread(data, 1, *size, file), *size);
    fclose(file);
    return data;
}

static void read_png(const char *path, uint8_t *out, size_t size)
{
    size_t bytes, decoded;
    void *data = read_file(path, &bytes);
    spng_ctx *ctx = spng_ctx_new(0);
    assert_non_null(ctx);
    assert_int_equal(spng_set_png_buffer(ctx, data, bytes), 0);
    assert_int_equal(spng_decoded_image_size(ctx, SPNG_FMT_RGBA8, &decoded), 0);
    assert_int_equal(decoded, size);
    assert_int_equal(spng_decode_image(ctx, out, size, SPNG_FMT_RGBA8, 0), 0);
    spng_ctx_free(ctx);
    free(data);
}

static void write_png(const char *path, uint8_t *pixels)
{
    struct mns_image image = {.data = pixels, .width = POOL_WIDTH, .height = POOL_HEIGHT, .channels = 4, .pixel = MNS_PIXEL_U8};
    struct mns_message message;
    if (mns_image_write(path, &image, &message) != MNS_OK) {
        fail_msg("%s", message.text);
    }
}

static void draw_golden(const struct golden *golden, enum mns_isa isa, uint8_t *pixels)
{
    struct cloud cloud = {0};
    pool(&cloud, 1);
    struct shot shot = pool_shot(1);
    for (int i = 0; i < 4 && golden->settings[i][0]; i++) {
        assert_int_equal(mns_params_set(&shot.params, golden->settings[i][0], golden->settings[i][1], NULL), MNS_OK);
    }
    struct mns_renderer_params params;
    mns_renderer_params_init(&params);
    params.isa = isa;
    mns_renderer *renderer;
    assert_int_equal(mns_renderer_create(&renderer, &params, NULL), MNS_OK);
    struct mns_particles particles = cloud_particles(&cloud);
    struct mns_output output = {MNS_LAYER_BEAUTY,
                                {.data = pixels, .width = POOL_WIDTH, .height = POOL_HEIGHT, .channels = 4, .pixel = MNS_PIXEL_U8}};
    struct mns_frame frame;
    mns_frame_init(&frame);
    frame.camera = &shot.camera;
    frame.params = &shot.params;
    frame.outputs = &output;
    frame.output_count = 1;
    assert_int_equal(mns_renderer_prepare(renderer, &particles), MNS_OK);
    assert_int_equal(mns_renderer_draw(renderer, &frame), MNS_OK);
    mns_renderer_destroy(&renderer);
    cloud_free(&cloud);
}

static void pictures_are_as_they_were(void **state)
{
    (void)state;
    enum { BYTES = POOL_WIDTH * POOL_HEIGHT * 4 };
    static uint8_t is[BYTES], was[BYTES];
    int wrong = 0;
    for (size_t i = 0; i < sizeof(goldens) / sizeof(goldens[0]); i++) {
        char path[1024];
        snprintf(path, sizeof(path), "%s/%s.png", folder, goldens[i].name);
        if (update) {
            draw_golden(&goldens[i], MNS_ISA_AUTO, is);
            write_png(path, is);
            continue;
        }
        read_png(path, was, BYTES);
        for (int isa = MNS_ISA_SCALAR; isa <= MNS_ISA_NEON; isa++) {
            if (!mns_isa_available((enum mns_isa)isa)) {
                continue;
            }
            draw_golden(&goldens[i], (enum mns_isa)isa, is);
            double mean = 0, part = 0;
            for (size_t p = 0; p < BYTES; p++) {
                double difference = fabs((double)is[p] - (double)was[p]);
                mean += difference / BYTES;
                part += difference > PART_STEP ? 1.0 / BYTES : 0;
            }
            if (mean > MEAN_LIMIT || part > PART_LIMIT) {
                print_error("%s, %s: mean difference %.3f of 255, %.3f %% of the values by more than %g\n", goldens[i].name,
                            mns_isa_name((enum mns_isa)isa), mean, 100 * part, PART_STEP);
                snprintf(path, sizeof(path), "%s_is.png", goldens[i].name);
                write_png(path, is);
                wrong++;
            }
        }
    }
    assert_int_equal(wrong, 0);
}

int main(int argc, char **argv)
{
    if (argc < 2) {
        fprintf(stderr, "usage: test_golden FOLDER [--update]\n");
        return 2;
    }
    folder = argv[1];
    update = argc > 2 && !strcmp(argv[2], "--update");
    const struct CMUnitTest tests[] = {cmocka_unit_test(pictures_are_as_they_were)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
