/* texture.h: pictures on meshes. */
#ifndef MNS_SCENE_TEXTURE_H
#define MNS_SCENE_TEXTURE_H

#include <meniscus/common.h>

enum { TEXTURE_LEVELS = 16 };

/* sRGB with mip levels: level k is [height >> k][width >> k][4], at least 1 each way. */
struct texture {
    unsigned char *levels[TEXTURE_LEVELS];
    int width[TEXTURE_LEVELS], height[TEXTURE_LEVELS], count;
};

/* Reads a PNG, JPEG, BMP, TGA, ... from a file, or from memory where data is not NULL; name is for messages. On failure *out is empty. */
mns_result mns_texture_read(struct texture *out, const char *path, const void *data, size_t size, const char *name,
                            struct mns_message *message);

/* Takes pixels [height][width][4], sRGB, from malloc, which become the texture's, also on failure. */
mns_result mns_texture_take(struct texture *out, unsigned char *pixels, int width, int height, const char *name,
                            struct mns_message *message);

void mns_texture_free(struct texture *texture);

/* Linear colour at u to the right and v up, repeated, at a footprint of 2^level texels: bilinear, between two levels. */
void mns_texture_at(const struct texture *texture, float u, float v, float level, float out[3]);

#endif
