/* writer.c: images to files and to memory; the list of formats. */
#include "io/writer.h"

#include "core/message.h"
#include "io/atomic_file.h"

#include <stdlib.h>
#include <string.h>

static const struct mns_writer *const writers[] = {
#ifdef MNS_HAVE_PNG
    &mns_writer_png,
#endif
#ifdef MNS_HAVE_EXR
    &mns_writer_exr,
#endif
    &mns_writer_npy,
};

enum { WRITERS = sizeof(writers) / sizeof(writers[0]), SIDE_MAX = 1 << 20 /* pixels; keeps every product far from overflow */ };

const char *mns_image_write_format(size_t index) { return index < WRITERS ? writers[index]->name : NULL; }

static char lower(char c) { return c >= 'A' && c <= 'Z' ? (char)(c - 'A' + 'a') : c; }

static bool same_word(const char *a, const char *b)
{
    while (*a && lower(*a) == lower(*b)) {
        a++;
        b++;
    }
    return !*a && !*b;
}

static const struct mns_writer *find(const char *format)
{
    for (size_t i = 0; i < WRITERS; i++) {
        if (same_word(writers[i]->name, format)) {
            return writers[i];
        }
    }
    return NULL;
}

/* What stands behind the last dot of the file's name; "" for none. */
static const char *extension_of(const char *path)
{
    const char *dot = strrchr(path, '.');
    return dot && dot != path && !strpbrk(dot, "/\\") ? dot + 1 : "";
}

static mns_result fail_format(const char *what, struct mns_message *message)
{
    char list[64] = "";
    for (size_t i = 0; i < WRITERS; i++) {
        size_t used = strlen(list);
        if (used + strlen(writers[i]->name) + 8 < sizeof(list)) {
            strcat(strcat(list, i == 0 ? "." : i + 1 < WRITERS ? ", ." : " and ."), writers[i]->name);
        }
    }
    return mns_fail(message, MNS_ERR_UNSUPPORTED, "%s: this build writes %s images", what, list);
}

mns_result mns_image_check(const char *what, const struct mns_image *image, struct mns_message *message)
{
    if (!image || !image->data) {
        return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "%s: there is no image to write", what);
    }
    if (image->width < 1 || image->height < 1 || image->width > SIDE_MAX || image->height > SIDE_MAX) {
        return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "%s: the image is %dx%d; each side must be 1 to %d pixels", what, image->width,
                        image->height, (int)SIDE_MAX);
    }
    if (image->channels < 1 || image->channels > 4) {
        return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "%s: the image has %d channels; it must have 1 to 4", what, image->channels);
    }
    if (image->pixel != MNS_PIXEL_F32 && image->pixel != MNS_PIXEL_U8 && image->pixel != MNS_PIXEL_U16) {
        return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "%s: pixels of an unknown type (%d)", what, (int)image->pixel);
    }
    size_t row = mns_image_pixel_size(image) * (size_t)image->width;
    if (image->stride != 0 && image->stride < row) {
        return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "%s: the image's stride is %zu bytes; a row takes %zu", what, image->stride,
                        row);
    }
    return MNS_OK;
}

static mns_result check(const char *what, const struct mns_writer *writer, const struct mns_image *image, struct mns_message *message)
{
    mns_result result = mns_image_check(what, image, message);
    return result == MNS_OK ? writer->check(what, image, message) : result;
}

static size_t stride_of(const struct mns_image *image)
{
    return image->stride ? image->stride : mns_image_pixel_size(image) * (size_t)image->width;
}

static bool to_file(void *user, const void *data, size_t size) { return mns_atomic_write(user, data, size); }

mns_result mns_image_write(const char *path, const struct mns_image *image, struct mns_message *message)
{
    if (!path) {
        return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "mns_image_write: path is NULL");
    }
    const struct mns_writer *writer = find(extension_of(path));
    if (!writer) {
        return fail_format(path, message);
    }
    mns_result result = check(path, writer, image, message);
    if (result != MNS_OK) {
        return result;
    }
    struct atomic_file *file;
    result = mns_atomic_begin(&file, path, message);
    if (result != MNS_OK) {
        return result;
    }
    struct image_sink sink = {.put = to_file, .user = file};
    result = writer->write(path, image, stride_of(image), &sink, message);
    if (result != MNS_OK && result != MNS_ERR_IO) {
        mns_atomic_abort(file);
        return result;
    }
    return mns_atomic_commit(file, message); /* tells what went wrong in writing */
}

struct growing {
    uint8_t *data;
    size_t size, capacity;
};

static bool to_memory(void *user, const void *data, size_t size)
{
    struct growing *growing = user;
    if (size > growing->capacity - growing->size) {
        size_t wanted = growing->capacity + growing->capacity / 2 + size;
        uint8_t *grown = wanted > growing->capacity ? realloc(growing->data, wanted) : NULL;
        if (!grown) {
            return false;
        }
        growing->data = grown;
        growing->capacity = wanted;
    }
    memcpy(growing->data + growing->size, data, size);
    growing->size += size;
    return true;
}

mns_result mns_image_encode(const char *format, const struct mns_image *image, void **data, size_t *size, struct mns_message *message)
{
    if (!format || !data || !size) {
        return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "mns_image_encode: format, data or size is NULL");
    }
    *data = NULL;
    *size = 0;
    const struct mns_writer *writer = find(format);
    if (!writer) {
        return fail_format(format, message);
    }
    mns_result result = check(format, writer, image, message);
    if (result != MNS_OK) {
        return result;
    }
    struct growing growing = {0};
    struct image_sink sink = {.put = to_memory, .user = &growing};
    result = writer->write(format, image, stride_of(image), &sink, message);
    if (result == MNS_ERR_IO) { /* memory takes no more */
        result = mns_fail(message, MNS_ERR_OUT_OF_MEMORY, "%s: out of memory", format);
    }
    if (result != MNS_OK) {
        free(growing.data);
        return result;
    }
    *data = growing.data;
    *size = growing.size;
    return MNS_OK;
}

void mns_memory_free(void *data) { free(data); }
