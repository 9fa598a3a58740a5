/* writer.h: what an image format is. A new format is one file write_<format>.c and a line in writer.c's list. */
#ifndef MNS_IO_WRITER_H
#define MNS_IO_WRITER_H

#include <meniscus/io.h>

#include <stdbool.h>

/* Where encoded bytes go, in order. false: no more can be taken, and whoever made the sink knows why. */
struct image_sink {
    bool (*put)(void *user, const void *data, size_t size);
    void *user;
};

struct mns_writer {
    const char *name; /* "png": also the extension */
    /* Whether the format holds such an image, whose size, channels and pixel are known to be valid. what: the file's name, for messages. */
    mns_result (*check)(const char *what, const struct mns_image *image, struct mns_message *message);
    /* Encodes a checked image with this stride. */
    mns_result (*write)(const char *what, const struct mns_image *image, size_t stride, struct image_sink *sink,
                        struct mns_message *message);
};

extern const struct mns_writer mns_writer_png;
extern const struct mns_writer mns_writer_exr;
extern const struct mns_writer mns_writer_npy;

/* Size, channels, pixel and stride. */
mns_result mns_image_check(const char *what, const struct mns_image *image, struct mns_message *message);

/* Bytes of one pixel. */
static inline size_t mns_image_pixel_size(const struct mns_image *image)
{
    size_t sample = image->pixel == MNS_PIXEL_F32 ? 4 : image->pixel == MNS_PIXEL_U16 ? 2 : 1;
    return sample * (size_t)image->channels;
}

#endif
