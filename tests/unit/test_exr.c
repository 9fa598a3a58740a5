/* OpenEXR files, read back by OpenEXR. */
#include "io_test.h"

#include <openexr.h>
#include <stdbool.h>

enum { W = 37, H = 21 /* more than a block of 16 rows, and no multiple */ };

/* One channel of a file as float; type: what the file holds. */
static float *read_channel(const char *path, const char *name, exr_pixel_type_t *type)
{
    exr_context_t exr;
    exr_decode_pipeline_t decoder = EXR_DECODE_PIPELINE_INITIALIZER;
    exr_context_initializer_t setup = EXR_DEFAULT_CONTEXT_INITIALIZER;
    float *out = calloc(W * (H + 16), sizeof(*out)), *scratch = calloc(W * 16, sizeof(*scratch));
    bool found = false;
    assert_int_equal(exr_start_read(&exr, path, &setup), EXR_ERR_SUCCESS);
    for (int y = 0; y < H; y += 16) {
        exr_chunk_info_t block;
        assert_int_equal(exr_read_scanline_chunk_info(exr, 0, y, &block), EXR_ERR_SUCCESS);
        assert_int_equal(y == 0 ? exr_decoding_initialize(exr, 0, &block, &decoder) : exr_decoding_update(exr, 0, &block, &decoder),
                         EXR_ERR_SUCCESS);
        for (int c = 0; c < decoder.channel_count; c++) {
            exr_coding_channel_info_t *info = &decoder.channels[c];
            bool wanted = !strcmp(info->channel_name, name);
            if (wanted) {
                *type = (exr_pixel_type_t)info->data_type;
                found = true;
            }
            info->decode_to_ptr = (uint8_t *)(wanted ? out + y * W : scratch);
            info->user_bytes_per_element = 4;
            info->user_data_type = EXR_PIXEL_FLOAT;
            info->user_pixel_stride = 4;
            info->user_line_stride = 4 * W;
        }
        if (y == 0) {
            assert_int_equal(exr_decoding_choose_default_routines(exr, 0, &decoder), EXR_ERR_SUCCESS);
        }
        assert_int_equal(exr_decoding_run(exr, 0, &decoder), EXR_ERR_SUCCESS);
    }
    exr_decoding_destroy(exr, &decoder);
    exr_finish(&exr);
    free(scratch);
    assert_true(found);
    return out;
}

static void assert_channel(const char *path, const char *name, exr_pixel_type_t type, const float *wanted, double relative)
{
    exr_pixel_type_t got_type = EXR_PIXEL_LAST_TYPE;
    float *got = read_channel(path, name, &got_type);
    assert_int_equal(got_type, type);
    for (int i = 0; i < W * H; i++) {
        bool same = got[i] == wanted[i] || fabs((double)got[i] - (double)wanted[i]) <= relative * fabs((double)wanted[i]);
        if (!same) {
            fail_msg("%s of pixel %d is %g, not %g", name, i, (double)got[i], (double)wanted[i]);
        }
    }
    free(got);
}

/* A picture with a stride, a vector and a depth. */
struct pictures {
    float rgba[H][W + 3][4], normal[H][W][3], depth[H][W];
    struct mns_image images[3];
};

static void fill(struct pictures *p)
{
    for (int i = 0; i < H * W; i++) {
        int y = i / W, x = i % W;
        for (int c = 0; c < 4; c++) {
            p->rgba[y][x][c] = c == 3 ? (float)(x % 5) / 4 : (float)(i * (c + 1)) / 100;
        }
        for (int c = 0; c < 3; c++) {
            p->normal[y][x][c] = (float)sin(i + c);
        }
        p->depth[y][x] = i % 7 ? 3.0f + 1e-5f * (float)i : INFINITY;
    }
    p->rgba[3][4][0] = 1e9f; /* more than a half float holds */
    p->images[0] = (struct mns_image){p->rgba, sizeof(p->rgba[0]), W, H, 4, MNS_PIXEL_F32};
    p->images[1] = (struct mns_image){p->normal, 0, W, H, 3, MNS_PIXEL_F32};
    p->images[2] = (struct mns_image){p->depth, 0, W, H, 1, MNS_PIXEL_F32};
}

static void layers_come_back(void **state)
{
    (void)state;
    static struct pictures p;
    static float wanted[W * H];
    struct mns_message message;
    struct mns_camera camera;
    fill(&p);
    mns_camera_init(&camera, W, H);
    const double eye[3] = {1, 2, 3}, target[3] = {0, 0, 0}, up[3] = {0, 1, 0};
    mns_camera_look_at(&camera, eye, target, up);
    const struct mns_exr_layer layers[] = {{"", "RGBA", &p.images[0]}, {"normal", "XYZ", &p.images[1]}, {"depth", "Z", &p.images[2]}};
    const struct mns_exr_note notes[] = {{"meniscus.look", "{\"x\":1}"}};
    struct mns_exr_params params;
    mns_exr_params_init(&params);
    params.camera = &camera;
    params.notes = notes;
    params.note_count = 1;
    for (int half = 0; half < 2; half++) {
        params.half = half;
        if (mns_exr_write("test_exr.exr", layers, 3, &params, &message) != MNS_OK) {
            fail_msg("%s", message.text);
        }
        for (int c = 0; c < 4; c++) {
            static const char *const names[] = {"R", "G", "B", "A"};
            for (int i = 0; i < W * H; i++) {
                const float *pixel = p.rgba[i / W][i % W];
                wanted[i] = c == 3 ? pixel[3] : pixel[c] * pixel[3];
                wanted[i] = half && wanted[i] > 65504 ? 65504 : wanted[i];
            }
            assert_channel("test_exr.exr", names[c], half ? EXR_PIXEL_HALF : EXR_PIXEL_FLOAT, wanted, half ? 1.0 / 2048 : 0);
        }
        for (int i = 0; i < W * H; i++) {
            wanted[i] = p.normal[i / W][i % W][1];
        }
        assert_channel("test_exr.exr", "normal.Y", EXR_PIXEL_FLOAT, wanted, 0);
        assert_channel("test_exr.exr", "depth.Z", EXR_PIXEL_FLOAT, p.depth[0], 0);
    }
    exr_context_t exr;
    exr_context_initializer_t setup = EXR_DEFAULT_CONTEXT_INITIALIZER;
    int32_t length;
    const char *text;
    exr_attr_m44f_t view;
    assert_int_equal(exr_start_read(&exr, "test_exr.exr", &setup), EXR_ERR_SUCCESS);
    assert_int_equal(exr_attr_get_string(exr, 0, "meniscus.look", &length, &text), EXR_ERR_SUCCESS);
    assert_int_equal(length, 7);
    assert_memory_equal(text, "{\"x\":1}", 7);
    assert_int_equal(exr_attr_get_m44f(exr, 0, "worldToCamera", &view), EXR_ERR_SUCCESS);
    for (int c = 0; c < 3; c++) { /* the eye, as a row from the left, is the view's origin */
        float at = view.m[c] + 2 * view.m[4 + c] + 3 * view.m[8 + c] + view.m[12 + c];
        assert_true(fabsf(at) < 1e-5f);
    }
    exr_finish(&exr);
    remove("test_exr.exr");
}

static void a_single_image_is_written(void **state)
{
    (void)state;
    static struct pictures p;
    struct mns_message message;
    fill(&p);
    assert_int_equal(mns_image_write("test_exr.exr", &p.images[2], &message), MNS_OK);
    assert_channel("test_exr.exr", "Y", EXR_PIXEL_FLOAT, p.depth[0], 0);
    void *data;
    size_t size;
    assert_int_equal(mns_image_encode("exr", &p.images[2], &data, &size, &message), MNS_OK);
    FILE *file = fopen("test_exr.exr", "rb");
    fseek(file, 0, SEEK_END);
    assert_int_equal(ftell(file), size);
    fclose(file);
    mns_memory_free(data);
    remove("test_exr.exr");
}

static void what_cannot_be_written_is_told(void **state)
{
    (void)state;
    static struct pictures p;
    struct mns_message message;
    fill(&p);
    struct mns_image bytes = p.images[0], small = p.images[2];
    bytes.pixel = MNS_PIXEL_U8;
    small.width--;
    const struct mns_exr_layer twice[] = {{"a", "Z", &p.images[2]}, {"a", "Z", &p.images[2]}}, wrong[] = {{"a", "XY", &p.images[2]}},
                               eight[] = {{"", "RGBA", &bytes}}, sizes[] = {{"a", "Z", &p.images[2]}, {"b", "Z", &small}},
                               none[] = {{"a", "Z", NULL}}, good[] = {{"a", "Z", &p.images[2]}};
    assert_int_equal(mns_exr_write("a.exr", twice, 2, NULL, &message), MNS_ERR_INVALID_ARGUMENT);
    assert_non_null(strstr(message.text, "two layers have a channel 'a.Z'"));
    assert_int_equal(mns_exr_write("a.exr", wrong, 1, NULL, &message), MNS_ERR_INVALID_ARGUMENT);
    assert_int_equal(mns_exr_write("a.exr", eight, 1, NULL, &message), MNS_ERR_INVALID_ARGUMENT);
    assert_int_equal(mns_exr_write("a.exr", sizes, 2, NULL, &message), MNS_ERR_INVALID_ARGUMENT);
    assert_int_equal(mns_exr_write("a.exr", none, 1, NULL, &message), MNS_ERR_INVALID_ARGUMENT);
    assert_int_equal(mns_exr_write("a.exr", good, 0, NULL, &message), MNS_ERR_INVALID_ARGUMENT);
    assert_int_equal(mns_exr_write("no/such/folder/a.exr", good, 1, NULL, &message), MNS_ERR_IO);
    assert_non_null(strstr(message.text, "no/such/folder/a.exr: cannot be written"));
    assert_int_equal(mns_image_write("a.exr", &bytes, &message), MNS_ERR_INVALID_ARGUMENT);
    assert_null(fopen("a.exr", "rb"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(layers_come_back),
        cmocka_unit_test(a_single_image_is_written),
        cmocka_unit_test(what_cannot_be_written_is_told),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
