/* write_npy.c: float32 images as numpy saves them, shape [h][w] or [h][w][channels]; the header of all .npy files we write. */
#include "io/npy.h"
#include "io/writer.h"

#include "core/message.h"

#include <stdio.h>
#include <string.h>

void mns_npy_header(uint8_t out[NPY_HEADER_SIZE], enum mns_type type, int dimensions, const size_t shape[])
{
    static const char *const codes[] = {"f4", "f8", "i1", "u1", "i2", "u2", "i4", "u4", "i8", "u8"};
    char text[NPY_HEADER_SIZE - 10 + 1];
    char order = mns_type_size(type) == 1 ? '|' : mns_big_endian() ? '>' : '<';
    int length = snprintf(text, sizeof(text), "{'descr': '%c%s', 'fortran_order': False, 'shape': (", order, codes[type]);
    for (int i = 0; i < dimensions; i++) { /* a tuple of one has its comma behind it */
        length += snprintf(text + length, sizeof(text) - (size_t)length,
                           i + 1 < dimensions ? "%zu, "
                           : dimensions == 1  ? "%zu,"
                                              : "%zu",
                           shape[i]);
    }
    length += snprintf(text + length, sizeof(text) - (size_t)length, "), }");
    memset(text + length, ' ', sizeof(text) - 1 - (size_t)length);
    text[sizeof(text) - 2] = '\n';
    memcpy(out, "\x93NUMPY\1\0", 8);
    out[8] = NPY_HEADER_SIZE - 10;
    out[9] = 0;
    memcpy(out + 10, text, NPY_HEADER_SIZE - 10);
}

static mns_result check_npy(const char *what, const struct mns_image *image, struct mns_message *message)
{
    if (image->pixel != MNS_PIXEL_F32) {
        return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "%s: an .npy image holds float32; .png holds 8 and 16 bits", what);
    }
    return MNS_OK;
}

static mns_result write_npy(const char *what, const struct mns_image *image, size_t stride, struct image_sink *sink,
                            struct mns_message *message)
{
    (void)what;
    (void)message;
    uint8_t header[NPY_HEADER_SIZE];
    const size_t shape[] = {(size_t)image->height, (size_t)image->width, (size_t)image->channels};
    mns_npy_header(header, MNS_F32, image->channels > 1 ? 3 : 2, shape);
    bool good = sink->put(sink->user, header, sizeof(header));
    const uint8_t *row = image->data;
    size_t row_size = mns_image_pixel_size(image) * (size_t)image->width;
    for (int y = 0; good && y < image->height; y++, row += stride) {
        good = sink->put(sink->user, row, row_size);
    }
    return good ? MNS_OK : MNS_ERR_IO;
}

const struct mns_writer mns_writer_npy = {.name = "npy", .check = check_npy, .write = write_npy};
