/* whole.c: whether a picture that is there was finished. */
#include "whole.h"

#include "inputs.h"

#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

bool whole_file(const char *path)
{
    struct stat status;
    return stat(path, &status) == 0 && S_ISREG(status.st_mode) && status.st_size > 0;
}

/* size bytes at an offset, from the end where it is below 0. */
static bool read_at(FILE *file, long offset, unsigned char *out, size_t size)
{
    return fseek(file, offset, offset < 0 ? SEEK_END : SEEK_SET) == 0 && fread(out, 1, size, file) == size;
}

static bool whole_png(FILE *file, const struct mns_image *shape)
{
    static const unsigned char last[12] = {0, 0, 0, 0, 'I', 'E', 'N', 'D', 0xae, 0x42, 0x60, 0x82};
    unsigned char head[24], tail[12];
    if (!read_at(file, 0, head, sizeof(head)) || !read_at(file, -(long)sizeof(tail), tail, sizeof(tail))) {
        return false;
    }
    unsigned long width = 0, height = 0;
    for (int i = 0; i < 4; i++) {
        width = width << 8 | head[16 + i];
        height = height << 8 | head[20 + i];
    }
    return !memcmp(head + 1, "PNG", 3) && !memcmp(tail, last, sizeof(last)) && width == (unsigned long)shape->width &&
           height == (unsigned long)shape->height;
}

static bool whole_npy(FILE *file, const struct mns_image *shape)
{
    unsigned char head[10];
    size_t bytes = (size_t)shape->width * (size_t)shape->height * (size_t)shape->channels * sizeof(float);
    return read_at(file, 0, head, sizeof(head)) && !memcmp(head + 1, "NUMPY", 5) && fseek(file, 0, SEEK_END) == 0 &&
           ftell(file) == (long)(sizeof(head) + head[8] + 256U * head[9] + bytes);
}

bool whole_picture(const char *path, const struct mns_image *shape)
{
    FILE *file = whole_file(path) ? fopen(path, "rb") : NULL;
    bool whole = file && (name_has_extension(path, ".png")   ? whole_png(file, shape)
                          : name_has_extension(path, ".npy") ? whole_npy(file, shape)
                                                             : true);
    if (file) {
        fclose(file);
    }
    return whole;
}
