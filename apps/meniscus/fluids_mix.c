/* fluids_mix.c: the images of several fluids put into one. */
#include "fluids_mix.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

static size_t pixels(const struct mix *mix) { return (size_t)mix->width * (size_t)mix->height; }

static float *plane(const struct mix *mix, size_t channels) { return malloc(pixels(mix) * channels * sizeof(float)); }

bool mix_create(struct mix *mix, size_t count, int width, int height)
{
    *mix = (struct mix){.count = count, .width = width, .height = height};
    mix->beauty = calloc(count, sizeof(*mix->beauty));
    mix->depth = calloc(count, sizeof(*mix->depth));
    mix->rank = calloc(count, sizeof(*mix->rank));
    bool good = mix->beauty && mix->depth && mix->rank;
    for (size_t i = 0; good && i < count; i++) {
        mix->beauty[i] = plane(mix, 4);
        mix->depth[i] = plane(mix, 1);
        mix->rank[i] = malloc(pixels(mix));
        good = mix->beauty[i] && mix->depth[i] && mix->rank[i];
    }
    mix->behind[0] = plane(mix, 4);
    mix->behind[1] = plane(mix, 4);
    mix->open = plane(mix, 3);
    mix->shaded = plane(mix, 3);
    mix->scene_depth = plane(mix, 1);
    mix->nearest = plane(mix, 1);
    return good && mix->behind[0] && mix->behind[1] && mix->open && mix->shaded && mix->scene_depth && mix->nearest;
}

void mix_destroy(struct mix *mix)
{
    for (size_t i = 0; mix->beauty && mix->depth && mix->rank && i < mix->count; i++) {
        free(mix->beauty[i]);
        free(mix->depth[i]);
        free(mix->rank[i]);
    }
    for (int i = 0; i < MNS_LAYER_COUNT; i++) {
        free(mix->layer[i]);
    }
    free(mix->beauty);
    free(mix->depth);
    free(mix->rank);
    free(mix->behind[0]);
    free(mix->behind[1]);
    free(mix->open);
    free(mix->shaded);
    free(mix->scene_depth);
    free(mix->nearest);
    *mix = (struct mix){0};
}

static struct mns_image image_of(const struct mix *mix, float *data, int channels)
{
    return (struct mns_image){.data = data, .width = mix->width, .height = mix->height, .channels = channels, .pixel = MNS_PIXEL_F32};
}

/* ---- the scene ---- */

void mix_scene_outputs(struct mix *mix, struct mns_output outputs[2])
{
    outputs[0] = (struct mns_output){MNS_LAYER_SCENE_COLOR, image_of(mix, mix->open, 3)};
    outputs[1] = (struct mns_output){MNS_LAYER_SCENE_DEPTH, image_of(mix, mix->scene_depth, 1)};
}

void mix_begin(struct mix *mix)
{
    for (size_t p = 0; p < pixels(mix); p++) {
        memcpy(mix->behind[0] + 4 * p, mix->open + 3 * p, 3 * sizeof(float));
        mix->behind[0][4 * p + 3] = 1;
        mix->nearest[p] = INFINITY;
    }
}

const struct mns_output *mix_shadow_output(struct mix *mix, struct mns_output *out)
{
    *out = (struct mns_output){MNS_LAYER_SCENE_COLOR, image_of(mix, mix->shaded, 3)};
    return out;
}

void mix_add_shadow(struct mix *mix)
{
    for (size_t p = 0; p < pixels(mix); p++) {
        for (size_t c = 0; c < 3; c++) {
            float open = mix->open[3 * p + c];
            mix->behind[0][4 * p + c] *= open > 0 ? fminf(mix->shaded[3 * p + c] / open, 1) : 1;
        }
    }
}

struct mns_scene mix_scene(struct mix *mix)
{
    return (struct mns_scene){.color = image_of(mix, mix->behind[0], 4), .depth = image_of(mix, mix->scene_depth, 1)};
}

/* ---- layers ---- */

bool mix_takes(enum mns_layer layer) { return layer <= MNS_LAYER_SCENE_DEPTH; /* those behind it are foam's and single particles' */ }

static bool is_scene(enum mns_layer layer) { return layer == MNS_LAYER_SCENE_COLOR || layer == MNS_LAYER_SCENE_DEPTH; }

/* A row of the caller's float32 image. */
static float *row_of(const struct mns_image *image, int y)
{
    size_t stride = image->stride ? image->stride : (size_t)image->width * (size_t)image->channels * sizeof(float);
    return (float *)(void *)((char *)image->data + stride * (size_t)y);
}

static const struct mns_image *find(const struct mns_output *outputs, size_t count, enum mns_layer layer)
{
    for (size_t i = 0; i < count; i++) {
        if (outputs[i].layer == layer) {
            return &outputs[i].image;
        }
    }
    return NULL;
}

static bool add_output(struct mix *mix, enum mns_layer layer, struct mns_output *outputs, size_t *count)
{
    if (find(outputs, *count, layer)) {
        return true;
    }
    int channels = mns_layer_channels(layer);
    mix->layer[layer] = mix->layer[layer] ? mix->layer[layer] : plane(mix, (size_t)channels);
    outputs[(*count)++] = (struct mns_output){layer, image_of(mix, mix->layer[layer], channels)};
    return mix->layer[layer] != NULL;
}

size_t mix_outputs(struct mix *mix, size_t i, const struct mns_output *images, size_t image_count, struct mns_output outputs[MIX_OUTPUTS])
{
    size_t count = 2;
    outputs[0] = (struct mns_output){MNS_LAYER_DEPTH, image_of(mix, mix->depth[i], 1)};
    outputs[1] = mix_beauty(mix, i);
    for (size_t k = 0; k < image_count; k++) {
        enum mns_layer layer = images[k].layer == MNS_LAYER_ALPHA ? MNS_LAYER_TRANSMITTANCE : images[k].layer;
        if (!is_scene(layer) && !add_output(mix, layer, outputs, &count)) {
            return 0;
        }
    }
    return count;
}

/* One layer of fluid i into that of all, a value at a time; nearer: it is nearer than those before. */
static float combine(enum mns_layer layer, bool first, bool nearer, float all, float one)
{
    switch (layer) {
    case MNS_LAYER_DEPTH:
    case MNS_LAYER_DEPTH_RAW: return first || one < all ? one : all;
    case MNS_LAYER_THICKNESS:
    case MNS_LAYER_THICKNESS_RAW: return first ? one : all + one;
    case MNS_LAYER_TRANSMITTANCE: return first ? one : all * one;
    default: return first || nearer ? one : all;
    }
}

static void add_layer(struct mix *mix, size_t i, enum mns_layer layer, const struct mns_image *one, const struct mns_image *all)
{
    size_t channels = (size_t)one->channels;
    for (int y = 0; y < mix->height; y++) {
        const float *from = row_of(one, y), *depth = mix->depth[i] + (size_t)y * (size_t)mix->width;
        const float *nearest = mix->nearest + (size_t)y * (size_t)mix->width;
        float *to = row_of(all, y);
        for (size_t k = 0; k < (size_t)mix->width * channels; k++) {
            to[k] = combine(layer, i == 0, depth[k / channels] < nearest[k / channels], to[k], from[k]);
        }
    }
}

void mix_add_layers(struct mix *mix, size_t i, const struct mns_output *outputs, size_t count, const struct mns_output *images,
                    size_t image_count)
{
    for (size_t k = 0; k < count; k++) {
        enum mns_layer layer = outputs[k].layer;
        const struct mns_image *all = find(images, image_count, layer), through = image_of(mix, mix->open, 3);
        if (layer == MNS_LAYER_TRANSMITTANCE) { /* the scene without shadows is not needed any more */
            add_layer(mix, i, layer, &outputs[k].image, &through);
        } else if (all && layer != MNS_LAYER_BEAUTY) {
            add_layer(mix, i, layer, &outputs[k].image, all);
        }
    }
    for (size_t p = 0; p < pixels(mix); p++) {
        mix->nearest[p] = fminf(mix->nearest[p], mix->depth[i][p]);
    }
}

void mix_end_layers(struct mix *mix, const struct mns_output *images, size_t image_count)
{
    const struct mns_image *transmittance = find(images, image_count, MNS_LAYER_TRANSMITTANCE);
    const struct mns_image *alpha = find(images, image_count, MNS_LAYER_ALPHA), *color = find(images, image_count, MNS_LAYER_SCENE_COLOR);
    const struct mns_image *depth = find(images, image_count, MNS_LAYER_SCENE_DEPTH);
    size_t width = (size_t)mix->width;
    for (int y = 0; y < mix->height; y++) {
        const float *through = mix->open + 3 * (size_t)y * width, *behind = mix->behind[0] + 4 * (size_t)y * width;
        if (transmittance) {
            memcpy(row_of(transmittance, y), through, 3 * width * sizeof(float));
        }
        if (depth) {
            memcpy(row_of(depth, y), mix->scene_depth + (size_t)y * width, width * sizeof(float));
        }
        for (size_t x = 0; alpha && x < width; x++) {
            row_of(alpha, y)[x] = 1 - (through[3 * x] + through[3 * x + 1] + through[3 * x + 2]) / 3;
        }
        for (size_t x = 0; color && x < width; x++) {
            memcpy(row_of(color, y) + 3 * x, behind + 4 * x, 3 * sizeof(float));
        }
    }
}

/* ---- colours ---- */

/* The depth of fluid i at a pixel, or beside it. */
static float depth_about(const struct mix *mix, size_t i, int x, int y)
{
    const float *at = mix->depth[i] + (size_t)y * (size_t)mix->width + (size_t)x;
    float depth = *at;
    if (!isfinite(depth)) {
        depth = x > 0 ? fminf(depth, at[-1]) : depth;
        depth = x + 1 < mix->width ? fminf(depth, at[1]) : depth;
        depth = y > 0 ? fminf(depth, at[-mix->width]) : depth;
        depth = y + 1 < mix->height ? fminf(depth, at[mix->width]) : depth;
    }
    return depth;
}

static int rank_at(const struct mix *mix, size_t i, int x, int y)
{
    float depth = depth_about(mix, i, x, y);
    int rank = 1;
    for (size_t k = 0; k < mix->count && isfinite(depth); k++) {
        float other = k == i ? INFINITY : depth_about(mix, k, x, y);
        rank += isfinite(other) && (other > depth || (!(other < depth) && k > i));
    }
    return isfinite(depth) ? rank : 0;
}

void mix_order(struct mix *mix)
{
    for (size_t i = 0; i < mix->count; i++) {
        for (int y = 0; y < mix->height; y++) {
            for (int x = 0; x < mix->width; x++) {
                mix->rank[i][(size_t)y * (size_t)mix->width + (size_t)x] = (unsigned char)rank_at(mix, i, x, y);
            }
        }
    }
    memcpy(mix->behind[1], mix->behind[0], 4 * pixels(mix) * sizeof(float));
}

bool mix_has_rank(const struct mix *mix, size_t i, int rank) { return memchr(mix->rank[i], rank, pixels(mix)) != NULL; }

struct mns_output mix_beauty(struct mix *mix, size_t i) { return (struct mns_output){MNS_LAYER_BEAUTY, image_of(mix, mix->beauty[i], 4)}; }

void mix_take(struct mix *mix, size_t i, int rank)
{
    for (size_t p = 0; p < pixels(mix); p++) {
        if (mix->rank[i][p] == rank) {
            memcpy(mix->behind[1] + 4 * p, mix->beauty[i] + 4 * p, 4 * sizeof(float));
        }
    }
}

void mix_next(struct mix *mix) { memcpy(mix->behind[0], mix->behind[1], 4 * pixels(mix) * sizeof(float)); }

void mix_pile(struct mix *mix)
{
    mix_order(mix);
    memset(mix->behind[0], 0, 4 * pixels(mix) * sizeof(float));
    for (int rank = 1; rank <= (int)mix->count; rank++) {
        for (size_t i = 0; i < mix->count; i++) {
            for (size_t p = 0; p < pixels(mix); p++) {
                float *to = mix->behind[0] + 4 * p, *from = mix->beauty[i] + 4 * p;
                for (int c = 0; c < 4 && mix->rank[i][p] == rank; c++) {
                    to[c] = (c < 3 ? from[c] * from[3] : from[3]) + to[c] * (1 - from[3]);
                }
            }
        }
    }
    for (size_t p = 0; p < pixels(mix); p++) { /* straight again */
        float *to = mix->behind[0] + 4 * p;
        for (int c = 0; c < 3; c++) {
            to[c] = to[3] > 0 ? to[c] / to[3] : 0;
        }
    }
}

void mix_write_alpha(const struct mix *mix, const struct mns_image *image)
{
    size_t size = image->pixel == MNS_PIXEL_F32 ? 4 : image->pixel == MNS_PIXEL_U16 ? 2 : 1;
    size_t stride = image->stride ? image->stride : (size_t)image->width * (size_t)image->channels * size;
    for (size_t p = 0; image->channels == 4 && p < pixels(mix); p++) {
        char *row = (char *)image->data + stride * (p / (size_t)mix->width);
        size_t at = 4 * (p % (size_t)mix->width) + 3;
        float alpha = fminf(fmaxf(mix->behind[0][4 * p + 3], 0), 1);
        if (image->pixel == MNS_PIXEL_F32) {
            ((float *)(void *)row)[at] = alpha;
        } else if (image->pixel == MNS_PIXEL_U16) {
            ((uint16_t *)(void *)row)[at] = (uint16_t)lrintf(65535 * alpha);
        } else {
            ((uint8_t *)row)[at] = (uint8_t)lrintf(255 * alpha);
        }
    }
}
