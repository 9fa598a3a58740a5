/* environment.c: mip levels of an equirectangular picture, and the light it sheds. */
#include "core/environment.h"

#include "core/message.h"
#include "cpu/pixels.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

static const double PI = 3.14159265358979;
static const double PIXELS_MAX = 1 << 26;
/* Radiance from which on a pixel is the sun's own, which the parameters of the sun draw: it adds no more to the sky's light. Sunlit white has 1.6. */
static const float SUN = 20;
/* Sine of the height over and under the horizon that its mean covers. */
static const double HORIZON = 0.05;

static mns_result check(const struct mns_image *image, struct mns_message *message)
{
    if (!image->data || image->width < 1 || image->height < 1 || (double)image->width * image->height > PIXELS_MAX) {
        return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "the environment is %d x %d pixels; it must have 1 to %.0f", image->width,
                        image->height, PIXELS_MAX);
    }
    if ((image->channels != 3 && image->channels != 4) || (unsigned)image->pixel > MNS_PIXEL_U16) {
        return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "the environment has %d channels of pixel type %d; it must have 3 or 4",
                        image->channels, (int)image->pixel);
    }
    return MNS_OK;
}

static bool copy(struct mns_environment *out, const struct mns_image *image)
{
    struct srgb_decoder decoder;
    size_t width = (size_t)image->width;
    float *row = malloc(4 * sizeof(float) * width);
    out->levels[0] = malloc(3 * sizeof(float) * width * (size_t)image->height);
    mns_srgb_decoder_init(&decoder, image->pixel);
    for (int y = 0; row && out->levels[0] && y < image->height; y++) {
        mns_pixels_decode(&decoder, image, y, row);
        for (size_t i = 0; i < 3 * width; i++) {
            out->levels[0][3 * width * (size_t)y + i] = fmaxf(row[4 * (i / 3) + i % 3], 0);
        }
    }
    bool done = row && out->levels[0];
    free(row);
    out->width[0] = image->width;
    out->height[0] = image->height;
    out->count = out->levels[0] ? 1 : 0;
    return done;
}

static bool halve(struct mns_environment *out)
{
    int level = out->count, from_width = out->width[level - 1], from_height = out->height[level - 1];
    int width = from_width > 1 ? from_width / 2 : 1, height = from_height > 1 ? from_height / 2 : 1;
    const float *from = out->levels[level - 1];
    float *to = malloc(3 * sizeof(float) * (size_t)width * (size_t)height);
    for (int y = 0; to && y < height; y++) {
        for (int x = 0; x < width; x++) {
            int right = 2 * x + 1 < from_width ? 2 * x + 1 : from_width - 1, below = 2 * y + 1 < from_height ? 2 * y + 1 : from_height - 1;
            const float *a = from + 3 * ((size_t)(2 * y) * (size_t)from_width), *b = from + 3 * ((size_t)below * (size_t)from_width);
            for (int c = 0; c < 3; c++) {
                to[3 * ((size_t)y * (size_t)width + (size_t)x) + (size_t)c] =
                    0.25f * (a[6 * x + c] + a[3 * right + c] + b[6 * x + c] + b[3 * right + c]);
            }
        }
    }
    out->levels[level] = to;
    out->width[level] = width;
    out->height[level] = height;
    out->count += to != NULL;
    return to != NULL;
}

/* Sums over the sphere, each row by its solid angle. */
static void gather_light(struct mns_environment *out)
{
    double light[2][3] = {{0}}, weights[2] = {0}, horizon[3] = {0}, horizon_weight = 0;
    int width = out->width[0], height = out->height[0];
    for (int y = 0; y < height; y++) {
        double angle = PI * (y + 0.5) / height, up = cos(angle), weight = sin(angle) * fabs(up);
        double near_horizon = fabs(up) < HORIZON || height < 16 ? sin(angle) : 0, row[3] = {0};
        for (int i = 0; i < 3 * width; i++) {
            float value = out->levels[0][3 * (size_t)width * (size_t)y + (size_t)i];
            row[i % 3] += (double)fminf(value, SUN) / width;
        }
        int side = up < 0;
        for (int c = 0; c < 3; c++) {
            light[side][c] += weight * row[c];
            horizon[c] += near_horizon * row[c];
        }
        weights[side] += weight;
        horizon_weight += near_horizon;
    }
    for (int c = 0; c < 3; c++) {
        out->sky_light[c] = (float)(weights[0] > 0 ? light[0][c] / weights[0] : 0);
        out->ground_light[c] = (float)(weights[1] > 0 ? light[1][c] / weights[1] : 0);
        out->horizon[c] = (float)(horizon_weight > 0 ? horizon[c] / horizon_weight : 0);
    }
}

mns_result mns_environment_create(mns_environment **out, const struct mns_image *image, struct mns_message *message)
{
    *out = NULL;
    mns_result result = check(image, message);
    if (result != MNS_OK) {
        return result;
    }
    struct mns_environment *environment = calloc(1, sizeof(*environment));
    bool done = environment && copy(environment, image);
    while (done && environment->count < ENVIRONMENT_LEVELS &&
           (environment->width[environment->count - 1] > 1 || environment->height[environment->count - 1] > 1)) {
        done = halve(environment);
    }
    if (!done) {
        mns_environment_destroy(&environment);
        return mns_fail(message, MNS_ERR_OUT_OF_MEMORY, "out of memory for an environment of %d x %d pixels", image->width, image->height);
    }
    gather_light(environment);
    *out = environment;
    return MNS_OK;
}

void mns_environment_destroy(mns_environment **environment)
{
    struct mns_environment *e = *environment;
    *environment = NULL;
    for (int i = 0; e && i < ENVIRONMENT_LEVELS; i++) {
        free(e->levels[i]);
    }
    free(e);
}
