/* Images written and decoded again; what cannot be written is refused and leaves nothing behind. */
#define _POSIX_C_SOURCE 200809L

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <dirent.h>
#include <meniscus/io.h>
#include <sys/stat.h>
#include <unistd.h>
#ifdef MNS_HAVE_PNG
#include <spng.h>
#endif

enum { WIDTH = 13, HEIGHT = 7, PADDING = 5 };

static char folder[64];

static int make_folder(void **state)
{
    (void)state;
    strcpy(folder, "test_image_write.XXXXXX");
    return mkdtemp(folder) ? 0 : -1;
}

static const char *in_folder(const char *name)
{
    static char path[128];
    snprintf(path, sizeof(path), "%s/%s", folder, name);
    return path;
}

static int files_in_folder(void)
{
    DIR *directory = opendir(folder);
    assert_non_null(directory);
    int count = 0;
    for (const struct dirent *entry; (entry = readdir(directory));) {
        count += strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0;
    }
    closedir(directory);
    return count;
}

static int remove_folder(void **state)
{
    (void)state;
    int left = files_in_folder();
    return rmdir(folder) == 0 && left == 0 ? 0 : -1;
}

/* An image of noise whose rows have bytes between them. */
static struct mns_image noise(int channels, enum mns_pixel pixel)
{
    size_t sample = pixel == MNS_PIXEL_F32 ? 4 : pixel == MNS_PIXEL_U16 ? 2 : 1;
    struct mns_image image = {.width = WIDTH, .height = HEIGHT, .channels = channels, .pixel = pixel};
    image.stride = sample * (size_t)(channels * WIDTH) + PADDING * 4;
    uint8_t *bytes = malloc(image.stride * HEIGHT);
    assert_non_null(bytes);
    uint32_t seed = 1;
    for (size_t i = 0; i < image.stride * HEIGHT; i++) {
        seed = seed * 1664525u + 1013904223u;
        bytes[i] = pixel == MNS_PIXEL_F32 && i % 4 == 3 ? 0x3f : (uint8_t)(seed >> 24); /* no NaN */
    }
    image.data = bytes;
    return image;
}

static uint8_t *load(const char *path, size_t *size)
{
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    uint8_t *data = malloc(1 << 16);
    assert_non_null(data);
    *size = fread(data, 1, 1 << 16, file);
    fclose(file);
    return data;
}

/* Writes to a file and to memory, which must agree, and gives the bytes. */
static uint8_t *encoded(const char *format, const struct mns_image *image, size_t *size)
{
    struct mns_message message = {""};
    char name[32];
    void *data = NULL;
    snprintf(name, sizeof(name), "image.%s", format);
    const char *path = in_folder(name);
    if (mns_image_write(path, image, &message) != MNS_OK || mns_image_encode(format, image, &data, size, &message) != MNS_OK) {
        fail_msg("%s", message.text);
    }
    size_t file_size;
    uint8_t *file = load(path, &file_size);
    assert_int_equal(remove(path), 0);
    assert_int_equal(file_size, *size);
    assert_memory_equal(file, data, file_size);
    mns_memory_free(data);
    return file;
}

#ifdef MNS_HAVE_PNG
static void png_holds_the_pixels(void **state)
{
    (void)state;
    static const int color_types[] = {0, 4, 2, 6};
    for (int i = 0; i < 8; i++) {
        int channels = i / 2 + 1, sample = i % 2 + 1;
        struct mns_image image = noise(channels, sample == 2 ? MNS_PIXEL_U16 : MNS_PIXEL_U8);
        size_t size, decoded_size, row = (size_t)(channels * sample * WIDTH);
        uint8_t *file = encoded("png", &image, &size), decoded[WIDTH * HEIGHT * 8], intent;
        spng_ctx *png = spng_ctx_new(0);
        struct spng_ihdr header;
        assert_int_equal(spng_set_png_buffer(png, file, size), 0);
        assert_int_equal(spng_get_ihdr(png, &header), 0);
        assert_int_equal(header.width, WIDTH);
        assert_int_equal(header.height, HEIGHT);
        assert_int_equal(header.bit_depth, 8 * sample);
        assert_int_equal(header.color_type, color_types[channels - 1]);
        assert_int_equal(spng_get_srgb(png, &intent), 0);
        assert_int_equal(spng_decoded_image_size(png, SPNG_FMT_PNG, &decoded_size), 0);
        assert_int_equal(decoded_size, row * HEIGHT);
        assert_int_equal(spng_decode_image(png, decoded, decoded_size, SPNG_FMT_PNG, 0), 0);
        for (size_t y = 0; y < HEIGHT; y++) {
            assert_memory_equal(decoded + y * row, (uint8_t *)image.data + y * image.stride, row);
        }
        spng_ctx_free(png);
        free(file);
        free(image.data);
    }
}

static void png_takes_no_floats(void **state)
{
    (void)state;
    struct mns_image image = noise(3, MNS_PIXEL_F32);
    struct mns_message message;
    assert_int_equal(mns_image_write(in_folder("a.png"), &image, &message), MNS_ERR_INVALID_ARGUMENT);
    assert_non_null(strstr(message.text, "8 or 16 bits"));
    assert_int_equal(files_in_folder(), 0);
    free(image.data);
}

/* The format follows the extension in any case; a file that is there is replaced. */
static void extension_picks_the_format(void **state)
{
    (void)state;
    struct mns_image image = noise(3, MNS_PIXEL_U8);
    char path[128];
    strcpy(path, in_folder("A.b.PNG"));
    for (int i = 0; i < 2; i++) {
        assert_int_equal(mns_image_write(path, &image, NULL), MNS_OK);
        size_t size;
        uint8_t *file = load(path, &size);
        assert_memory_equal(file, "\x89PNG\r\n\x1a\n", 8);
        free(file);
    }
    assert_int_equal(files_in_folder(), 1);
    assert_int_equal(remove(path), 0);
    free(image.data);
}
#endif

static void npy_holds_the_pixels(void **state)
{
    (void)state;
    static const char *const shapes[] = {"'shape': (7, 13), }", "'shape': (7, 13, 2), }", "'shape': (7, 13, 3), }",
                                         "'shape': (7, 13, 4), }"};
    for (int channels = 1; channels <= 4; channels++) {
        struct mns_image image = noise(channels, MNS_PIXEL_F32);
        size_t size, row = (size_t)channels * WIDTH * 4;
        uint8_t *file = encoded("npy", &image, &size);
        assert_int_equal(size, 128 + row * HEIGHT);
        assert_memory_equal(file, "\x93NUMPY\1\0", 8);
        assert_int_equal(file[127], '\n');
        file[127] = '\0';
        assert_non_null(strstr((const char *)file + 10, shapes[channels - 1]));
        assert_non_null(strstr((const char *)file + 10, "f4', 'fortran_order': False"));
        for (size_t y = 0; y < HEIGHT; y++) {
            assert_memory_equal(file + 128 + y * row, (uint8_t *)image.data + y * image.stride, row);
        }
        free(file);
        free(image.data);
    }
}

static void refuse(const char *path, struct mns_image image, mns_result code, const char *words)
{
    struct mns_message message = {""};
    mns_result result = mns_image_write(path, &image, &message);
    if (result != code || !strstr(message.text, words) || strncmp(message.text, path, strlen(path)) != 0 || strchr(message.text, '\n')) {
        fail_msg("wanted code %d with '%s', got %d: '%s'", code, words, result, message.text);
    }
    assert_int_equal(files_in_folder(), 0);
}

static void bad_images_are_refused(void **state)
{
    (void)state;
    struct mns_image good = noise(1, MNS_PIXEL_F32), bad = good;
    const char *path = in_folder("a.npy");
    bad.width = 0;
    refuse(path, bad, MNS_ERR_INVALID_ARGUMENT, "0x7");
    bad = good;
    bad.height = 2000000000;
    refuse(path, bad, MNS_ERR_INVALID_ARGUMENT, "1 to");
    bad = good;
    bad.channels = 5;
    refuse(path, bad, MNS_ERR_INVALID_ARGUMENT, "5 channels");
    bad = good;
    bad.stride = WIDTH;
    refuse(path, bad, MNS_ERR_INVALID_ARGUMENT, "stride");
    bad = good;
    bad.pixel = MNS_PIXEL_U8;
    refuse(path, bad, MNS_ERR_INVALID_ARGUMENT, "float32");
    bad = good;
    bad.data = NULL;
    refuse(path, bad, MNS_ERR_INVALID_ARGUMENT, "no image");
    free(good.data);
}

static void bad_places_are_refused(void **state)
{
    (void)state;
    struct mns_image image = noise(4, MNS_PIXEL_F32);
    refuse(in_folder("a.jpg"), image, MNS_ERR_UNSUPPORTED, ".npy");
    refuse(in_folder("npy"), image, MNS_ERR_UNSUPPORTED, ".npy");
    refuse(in_folder("missing/a.npy"), image, MNS_ERR_IO, "No such file");
    char path[128];
    strcpy(path, in_folder("folder.npy"));
    assert_int_equal(mkdir(path, 0700), 0);
    struct mns_message message;
    assert_int_equal(mns_image_write(path, &image, &message), MNS_ERR_IO);
    assert_non_null(strstr(message.text, "is a folder"));
    assert_int_equal(rmdir(path), 0);
    void *data;
    size_t size;
    assert_int_equal(mns_image_encode("tiff", &image, &data, &size, &message), MNS_ERR_UNSUPPORTED);
    assert_null(data);
    free(image.data);
}

static void full_disk_is_told(void **state)
{
    (void)state;
    for (size_t i = 0; mns_image_write_format(i); i++) {
        char path[128];
        snprintf(path, sizeof(path), "%s/full.%s", folder, mns_image_write_format(i));
        if (access("/dev/full", W_OK) != 0 || symlink("/dev/full", path) != 0) {
            skip();
        }
        struct mns_image image = noise(4, !strcmp(mns_image_write_format(i), "png") ? MNS_PIXEL_U8 : MNS_PIXEL_F32);
        struct mns_message message;
        assert_int_equal(mns_image_write(path, &image, &message), MNS_ERR_IO);
        assert_non_null(strstr(message.text, "No space left"));
        assert_int_equal(remove(path), 0);
        assert_int_equal(files_in_folder(), 0);
        free(image.data);
    }
}

static void formats_are_listed(void **state)
{
    (void)state;
    int npy = 0, png = 0;
    for (size_t i = 0; mns_image_write_format(i); i++) {
        npy += !strcmp(mns_image_write_format(i), "npy");
        png += !strcmp(mns_image_write_format(i), "png");
    }
    assert_int_equal(npy, 1);
#ifdef MNS_HAVE_PNG
    assert_int_equal(png, 1);
#else
    assert_int_equal(png, 0);
#endif
}

int main(void)
{
    const struct CMUnitTest tests[] = {
#ifdef MNS_HAVE_PNG
        cmocka_unit_test(png_holds_the_pixels), cmocka_unit_test(png_takes_no_floats),    cmocka_unit_test(extension_picks_the_format),
#endif
        cmocka_unit_test(npy_holds_the_pixels), cmocka_unit_test(bad_images_are_refused), cmocka_unit_test(bad_places_are_refused),
        cmocka_unit_test(full_disk_is_told),    cmocka_unit_test(formats_are_listed),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
