/* colormap.c: colour maps: tables from a few colours, interpolated in sRGB, and their use. */
#include <meniscus/colormap.h>

#include "core/message.h"
#include "core/names.h"

#include <math.h>
#include <string.h>

enum { KNOTS = 33 /* keep within 3 of 255 of the published tables */ };

/* 0xRRGGBB in sRGB. viridis and plasma: van der Walt and Smith 2015; turbo: Mikhailov 2019; coolwarm: Moreland 2009. */
static const struct {
    const char *name;
    unsigned knots[KNOTS];
} maps[] = {
    {"viridis", {0x440154, 0x470d60, 0x48186a, 0x482374, 0x472d7b, 0x453681, 0x424086, 0x3f4989, 0x3b528b, 0x375a8d, 0x33638d,
                 0x2f6a8e, 0x2c728e, 0x297a8e, 0x26818e, 0x23898e, 0x21908c, 0x1f988b, 0x1f9f88, 0x21a685, 0x28ae80, 0x31b57b,
                 0x3ebc74, 0x4cc26c, 0x5dc963, 0x6ece58, 0x82d34c, 0x96d83f, 0xabdc32, 0xc0df24, 0xd5e21a, 0xeae51a, 0xfde725}},
    {"plasma", {0x0d0887, 0x220690, 0x310596, 0x3f049c, 0x4c02a1, 0x5901a5, 0x6600a7, 0x7201a8, 0x7e03a8, 0x8909a6, 0x9511a2,
                0x9f1a9c, 0xa92396, 0xb22c8e, 0xbb3587, 0xc33e80, 0xcb4778, 0xd25071, 0xd9596a, 0xe06263, 0xe66c5c, 0xeb7555,
                0xf07f4f, 0xf48a48, 0xf89441, 0xfb9f3a, 0xfdab33, 0xfeb72d, 0xfdc328, 0xfcd025, 0xf9dd25, 0xf5eb27, 0xf0f921}},
    {"turbo", {0x30123b, 0x392a73, 0x4040a1, 0x4456c7, 0x466be3, 0x467ff6, 0x4293ff, 0x37a7fa, 0x29bbec, 0x1dcdd8, 0x18dcc3,
               0x1ee8b0, 0x31f299, 0x4cf97e, 0x6bfd64, 0x8aff4d, 0xa3fd3c, 0xb8f735, 0xcced34, 0xdee037, 0xedd03a, 0xf8c03a,
               0xfdae35, 0xfe982c, 0xfb8022, 0xf56817, 0xec520f, 0xe04009, 0xd23105, 0xc02302, 0xac1701, 0x950d01, 0x7a0403}},
    {"coolwarm", {0x3b4cc0, 0x445acc, 0x4d68d7, 0x5775e1, 0x6282ea, 0x6c8ef1, 0x779af7, 0x82a5fb, 0x8db0fe, 0x98b9ff, 0xa3c2ff,
                  0xaec9fd, 0xb8d0f9, 0xc2d5f4, 0xccd9ee, 0xd5dbe6, 0xdddddd, 0xe5d8d1, 0xecd3c5, 0xf1ccb9, 0xf5c4ad, 0xf7bba0,
                  0xf7b194, 0xf7a687, 0xf49a7b, 0xf18d6f, 0xec7f63, 0xe57058, 0xde604d, 0xd55042, 0xcb3e38, 0xc0282f, 0xb40426}},
};

enum { MAPS = sizeof(maps) / sizeof(maps[0]) };

const char *mns_colormap_name(size_t index) { return index < MAPS ? maps[index].name : NULL; }

/* sRGB code, 0 to 1, to linear. */
static float linear_from_srgb(float code) { return code <= 0.04045f ? code / 12.92f : powf((code + 0.055f) / 1.055f, 2.4f); }

mns_result mns_colormap_make(struct mns_colormap *out, const float *srgb, size_t count, struct mns_message *message)
{
    if (!out || !srgb || count < 2) {
        return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "mns_colormap_make: a colour map needs at least 2 colours");
    }
    for (size_t i = 0; i < 3 * count; i++) {
        if (!(srgb[i] >= 0 && srgb[i] <= 1)) {
            return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "colour %zu of the map has a channel of %g; they are 0 to 1", i / 3 + 1,
                            (double)srgb[i]);
        }
    }
    for (int i = 0; i < MNS_COLORMAP_SIZE; i++) {
        double at = (double)i * (double)(count - 1) / (MNS_COLORMAP_SIZE - 1);
        size_t knot = (size_t)at < count - 2 ? (size_t)at : count - 2;
        float part = (float)(at - (double)knot);
        for (size_t c = 0; c < 3; c++) {
            float below = srgb[3 * knot + c], above = srgb[3 * knot + 3 + c];
            out->linear[i][c] = linear_from_srgb(below + part * (above - below));
        }
    }
    return MNS_OK;
}

mns_result mns_colormap_find(struct mns_colormap *out, const char *name, struct mns_message *message)
{
    if (!out || !name) {
        return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "mns_colormap_find: out or name is NULL");
    }
    size_t nearest = 0;
    for (size_t i = 0; i < MAPS; i++) {
        if (!strcmp(maps[i].name, name)) {
            float srgb[KNOTS][3];
            for (int k = 0; k < KNOTS; k++) {
                for (int c = 0; c < 3; c++) {
                    srgb[k][c] = (float)(maps[i].knots[k] >> (16 - 8 * c) & 255) / 255;
                }
            }
            return mns_colormap_make(out, srgb[0], KNOTS, message);
        }
        nearest = mns_name_distance(name, maps[i].name) < mns_name_distance(name, maps[nearest].name) ? i : nearest;
    }
    return mns_fail(message, MNS_ERR_INVALID_ARGUMENT,
                    "there is no colour map '%s'; did you mean '%s'? There are viridis, plasma, turbo, coolwarm", name, maps[nearest].name);
}

void mns_colormap_apply(const struct mns_colormap *map, const double *values, size_t count, double low, double high, float *out)
{
    static const float grey = 0.2f; /* linear; sRGB 124 of 255 */
    double scale = high != low ? (MNS_COLORMAP_SIZE - 1) / (high - low) : 0;
    for (size_t i = 0; i < count; i++, out += 3) {
        double at = scale != 0 ? (values[i] - low) * scale : 0.5 * (MNS_COLORMAP_SIZE - 1);
        if (!(at == at) || !(values[i] == values[i])) {
            out[0] = out[1] = out[2] = grey;
            continue;
        }
        at = at > 0 ? at < MNS_COLORMAP_SIZE - 1 ? at : MNS_COLORMAP_SIZE - 1 : 0;
        size_t below = (size_t)at < MNS_COLORMAP_SIZE - 2 ? (size_t)at : MNS_COLORMAP_SIZE - 2;
        float part = (float)(at - (double)below);
        for (int c = 0; c < 3; c++) {
            out[c] = map->linear[below][c] + part * (map->linear[below + 1][c] - map->linear[below][c]);
        }
    }
}
