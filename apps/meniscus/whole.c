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

static unsigned long little_endian(const unsigned char *at, int bytes)
{
    unsigned long value = 0;
    for (int i = 0; i < bytes; i++) {
        value |= (unsigned long)at[i] << 8 * i;
    }
    return value;
}

/* A word of an OpenEXR header, of at most 255 bytes and a NUL. */
static bool read_word(FILE *file, char out[256])
{
    for (int i = 0; i < 256; i++) {
        int c = getc(file);
        if (c == EOF) {
            return false;
        }
        out[i] = (char)c;
        if (c == 0) {
            return true;
        }
    }
    return false;
}

/* Reads attributes (name, type, size, value) up to the empty name that ends them. window: xmin, ymin, xmax, ymax of the picture. */
static bool read_exr_header(FILE *file, unsigned char window[16])
{
    char name[256], type[256];
    unsigned char size[4];
    for (;;) {
        if (!read_word(file, name)) {
            return false;
        }
        if (!*name) {
            return true;
        }
        if (!read_word(file, type) || fread(size, 1, 4, file) != 4) {
            return false;
        }
        long value = ftell(file), bytes = (long)little_endian(size, 4);
        if (!strcmp(name, "dataWindow") && (bytes != 16 || fread(window, 1, 16, file) != 16)) {
            return false;
        }
        if (fseek(file, value + bytes, SEEK_SET) != 0) {
            return false;
        }
    }
}

/* Behind the header of an OpenEXR file stands the table of its blocks: row, size and data. The file ends with the last one. */
static bool whole_exr(FILE *file, const struct mns_image *shape)
{
    enum { BLOCK = 16 /* rows, as we write them */ };
    static const unsigned char magic[4] = {0x76, 0x2f, 0x31, 0x01};
    unsigned char head[8], window[16] = {0}, entry[8], block[8];
    bool good = read_at(file, 0, head, sizeof(head)) && !memcmp(head, magic, sizeof(magic)) && read_exr_header(file, window) &&
                little_endian(window + 8, 4) + 1 == (unsigned long)shape->width &&
                little_endian(window + 12, 4) + 1 == (unsigned long)shape->height;
    long last = (shape->height - 1) / BLOCK * (long)sizeof(entry);
    good = good && fseek(file, last, SEEK_CUR) == 0 && fread(entry, 1, sizeof(entry), file) == sizeof(entry);
    long at = good ? (long)little_endian(entry, 8) : 0;
    return at > 0 && read_at(file, at, block, sizeof(block)) && fseek(file, 0, SEEK_END) == 0 &&
           ftell(file) == at + (long)sizeof(block) + (long)little_endian(block + 4, 4);
}

bool whole_picture(const char *path, const struct mns_image *shape)
{
    FILE *file = whole_file(path) ? fopen(path, "rb") : NULL;
    bool whole = file && (name_has_extension(path, ".png")   ? whole_png(file, shape)
                          : name_has_extension(path, ".npy") ? whole_npy(file, shape)
                          : name_has_extension(path, ".exr") ? whole_exr(file, shape)
                                                             : true);
    if (file) {
        fclose(file);
    }
    return whole;
}
