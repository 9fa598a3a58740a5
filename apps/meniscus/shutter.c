/* shutter.c: the light of several pictures in one. */
#include "shutter.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct shutter {
    int width, height;
    size_t samples;
    float *sample, *sum; /* [height][width][4]; sum: colours times alpha, and alpha */
    float step[256];     /* the linear light from which on a byte is at least i; step[0] is 0 */
};

/* [IEC 61966-2-1] */
static double linear_of(double srgb) { return srgb <= 0.04045 ? srgb / 12.92 : pow((srgb + 0.055) / 1.055, 2.4); }

static double srgb_of(double linear) { return linear <= 0.0031308 ? 12.92 * linear : 1.055 * pow(linear, 1 / 2.4) - 0.055; }

struct shutter *shutter_create(int width, int height)
{
    struct shutter *shutter = calloc(1, sizeof(*shutter));
    size_t bytes = 4 * (size_t)width * (size_t)height * sizeof(float);
    if (shutter) {
        *shutter = (struct shutter){.width = width, .height = height, .sample = malloc(bytes), .sum = malloc(bytes)};
    }
    if (!shutter || !shutter->sample || !shutter->sum) {
        shutter_destroy(shutter);
        return NULL;
    }
    for (int i = 1; i < 256; i++) {
        shutter->step[i] = (float)linear_of((i - 0.5) / 255);
    }
    return shutter;
}

void shutter_destroy(struct shutter *shutter)
{
    if (shutter) {
        free(shutter->sample);
        free(shutter->sum);
        free(shutter);
    }
}

static size_t pixels(const struct shutter *shutter) { return (size_t)shutter->width * (size_t)shutter->height; }

void shutter_open(struct shutter *shutter)
{
    shutter->samples = 0;
    memset(shutter->sum, 0, 4 * pixels(shutter) * sizeof(float));
}

struct mns_image shutter_image(struct shutter *shutter)
{
    return (struct mns_image){
        .data = shutter->sample, .width = shutter->width, .height = shutter->height, .channels = 4, .pixel = MNS_PIXEL_F32};
}

void shutter_add(struct shutter *shutter, float white)
{
    const float *in = shutter->sample;
    float *sum = shutter->sum;
    for (size_t i = 0; i < 4 * pixels(shutter); i += 4) {
        float alpha = in[i + 3];
        for (size_t c = i; c < i + 3; c++) {
            sum[c] += alpha * (in[c] < white ? in[c] : white);
        }
        sum[i + 3] += alpha;
    }
    shutter->samples++;
}

static uint8_t byte_of(const struct shutter *shutter, float linear)
{
    float held = linear > 0 ? (linear < 1 ? linear : 1) : 0;
    int code = (int)(255 * sqrtf(held)); /* near it */
    while (code < 255 && held >= shutter->step[code + 1]) {
        code++;
    }
    while (held < shutter->step[code]) {
        code--;
    }
    return (uint8_t)code;
}

static void store(const struct shutter *shutter, const struct mns_image *out, char *row, size_t at, float value, int is_alpha)
{
    double held = fmin(fmax((double)value, 0), 1);
    if (out->pixel == MNS_PIXEL_F32) {
        ((float *)(void *)row)[at] = value;
    } else if (out->pixel == MNS_PIXEL_U16) {
        ((uint16_t *)(void *)row)[at] = (uint16_t)lrint(65535 * (is_alpha ? held : srgb_of(held)));
    } else {
        ((uint8_t *)row)[at] = is_alpha ? (uint8_t)lrint(255 * held) : byte_of(shutter, value);
    }
}

void shutter_close(struct shutter *shutter, const struct mns_image *out)
{
    size_t channels = (size_t)out->channels, size = out->pixel == MNS_PIXEL_F32 ? 4 : out->pixel == MNS_PIXEL_U16 ? 2 : 1;
    size_t stride = out->stride ? out->stride : channels * size * (size_t)out->width;
    for (int y = 0; y < out->height; y++) {
        const float *in = shutter->sum + 4 * (size_t)y * (size_t)shutter->width;
        char *row = (char *)out->data + (size_t)y * stride;
        for (size_t x = 0; x < (size_t)out->width; x++, in += 4) {
            for (size_t c = 0; c < channels; c++) {
                float value = c == 3 ? in[3] / (float)shutter->samples : in[3] > 0 ? in[c] / in[3] : 0;
                store(shutter, out, row, x * channels + c, value, c == 3);
            }
        }
    }
}
