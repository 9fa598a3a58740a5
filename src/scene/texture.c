/* texture.c: pictures on meshes: read by stb_image, filtered by mip levels. */
#include "scene/texture.h"

#include "core/message.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <stb_image.h>

/* Pixels of the largest texture: 16k x 16k. */
static const double PIXELS_MAX = 1 << 28;

static float linear_from_srgb(int code)
{
    float c = (float)code / 255;
    return c <= 0.04045f ? c / 12.92f : powf((c + 0.055f) / 1.055f, 2.4f);
}

static int srgb_from_linear(float c)
{
    float code = c <= 0.0031308f ? 12.92f * c : 1.055f * powf(c, 1 / 2.4f) - 0.055f;
    return (int)(fminf(fmaxf(code, 0), 1) * 255 + 0.5f);
}

static unsigned char mean_of(int a, int b, int c, int d)
{
    if (a == b && c == d && a == c) {
        return (unsigned char)a;
    }
    return (unsigned char)srgb_from_linear(0.25f * (linear_from_srgb(a) + linear_from_srgb(b) + linear_from_srgb(c) + linear_from_srgb(d)));
}

static void halve(const struct texture *texture, int level)
{
    const unsigned char *from = texture->levels[level - 1];
    int from_width = texture->width[level - 1], from_height = texture->height[level - 1];
    int width = texture->width[level], height = texture->height[level];
    for (int y = 0; y < height; y++) {
        int top = 2 * y < from_height ? 2 * y : from_height - 1, bottom = 2 * y + 1 < from_height ? 2 * y + 1 : from_height - 1;
        for (int x = 0; x < width; x++) {
            int left = 2 * x < from_width ? 2 * x : from_width - 1, right = 2 * x + 1 < from_width ? 2 * x + 1 : from_width - 1;
            const unsigned char *a = from + 4 * ((size_t)top * (size_t)from_width), *b = from + 4 * ((size_t)bottom * (size_t)from_width);
            unsigned char *to = texture->levels[level] + 4 * ((size_t)y * (size_t)width + (size_t)x);
            for (int c = 0; c < 4; c++) {
                to[c] = mean_of(a[4 * left + c], a[4 * right + c], b[4 * left + c], b[4 * right + c]);
            }
        }
    }
}

mns_result mns_texture_take(struct texture *out, unsigned char *pixels, int width, int height, const char *name,
                            struct mns_message *message)
{
    *out = (struct texture){.levels = {pixels}, .width = {width}, .height = {height}, .count = 1};
    while (out->count < TEXTURE_LEVELS && (width > 1 || height > 1)) {
        int level = out->count;
        out->width[level] = width = width > 1 ? width / 2 : 1;
        out->height[level] = height = height > 1 ? height / 2 : 1;
        out->levels[level] = malloc(4 * (size_t)width * (size_t)height);
        if (!out->levels[level]) {
            mns_texture_free(out);
            return mns_fail(message, MNS_ERR_OUT_OF_MEMORY, "%s: out of memory", name);
        }
        halve(out, level);
        out->count++;
    }
    return MNS_OK;
}

mns_result mns_texture_read(struct texture *out, const char *path, const void *data, size_t size, const char *name,
                            struct mns_message *message)
{
    *out = (struct texture){.count = 0};
    FILE *file = data ? NULL : fopen(path, "rb");
    if (!data && !file) {
        return mns_fail(message, MNS_ERR_IO, "%s: texture %s cannot be opened: %s", name, path, strerror(errno));
    }
    int width = 0, height = 0, channels, known;
    known = file ? stbi_info_from_file(file, &width, &height, &channels)
                 : size <= 0x7fffffff && stbi_info_from_memory(data, (int)size, &width, &height, &channels);
    unsigned char *pixels = NULL;
    bool fits = known && (double)width * height <= PIXELS_MAX;
    if (fits) {
        pixels = file ? stbi_load_from_file(file, &width, &height, &channels, 4)
                      : stbi_load_from_memory(data, (int)size, &width, &height, &channels, 4);
    }
    if (file) {
        fclose(file);
    }
    if (known && !fits) {
        return mns_fail(message, MNS_ERR_BAD_DATA, "%s: texture %s has %d x %d pixels; at most %.0f are read", name, path, width, height,
                        PIXELS_MAX);
    }
    if (!pixels) {
        return mns_fail(message, MNS_ERR_BAD_DATA, "%s: texture %s cannot be read (%s); PNG, JPEG, BMP and TGA can", name, path,
                        stbi_failure_reason());
    }
    return mns_texture_take(out, pixels, width, height, name, message);
}

void mns_texture_free(struct texture *texture)
{
    for (int i = 0; i < texture->count; i++) {
        free(texture->levels[i]); /* stb_image allocates with malloc */
    }
    *texture = (struct texture){.count = 0};
}

static int wrap(int i, int size)
{
    i %= size;
    return i < 0 ? i + size : i;
}

static void sample_level(const struct texture *texture, int level, float u, float v, float out[3])
{
    int width = texture->width[level], height = texture->height[level];
    float x = u * (float)width - 0.5f, y = (1 - v) * (float)height - 0.5f, left = floorf(x), top = floorf(y), fx = x - left, fy = y - top;
    int columns[2] = {wrap((int)left, width), wrap((int)left + 1, width)}, rows[2] = {wrap((int)top, height), wrap((int)top + 1, height)};
    for (int c = 0; c < 3; c++) {
        out[c] = 0;
    }
    for (int k = 0; k < 4; k++) {
        float weight = (k & 1 ? fx : 1 - fx) * (k & 2 ? fy : 1 - fy);
        const unsigned char *texel = texture->levels[level] + 4 * ((size_t)rows[k >> 1] * (size_t)width + (size_t)columns[k & 1]);
        for (int c = 0; c < 3; c++) {
            out[c] += weight * linear_from_srgb(texel[c]);
        }
    }
}

void mns_texture_at(const struct texture *texture, float u, float v, float level, float out[3])
{
    u -= floorf(u);
    v -= floorf(v);
    u = u >= 0 && u <= 1 ? u : 0; /* not finite */
    v = v >= 0 && v <= 1 ? v : 0;
    level = level > 0 ? fminf(level, (float)(texture->count - 1)) : 0;
    int finer = (int)level;
    float between = level - (float)finer, coarse[3];
    sample_level(texture, finer, u, v, out);
    if (between > 0) {
        sample_level(texture, finer + 1, u, v, coarse);
        for (int c = 0; c < 3; c++) {
            out[c] += between * (coarse[c] - out[c]);
        }
    }
}
