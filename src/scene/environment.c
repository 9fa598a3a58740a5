/* environment.c: environments from files: equirectangular pictures, or the six faces of a cube. */
#include "scene/environment.h"

#include "core/message.h"

#include <meniscus/scene.h>

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include <stb_image.h>

static const double PI = 3.14159265358979;
/* Pixels of the largest picture; as mns_environment_create takes. */
static const double PIXELS_MAX = 1 << 26;

/* Faces of a cube: where they lie, which way they go right and down, seen from inside with y up; and the names of their files. */
struct face {
    float middle[3], right[3], down[3];
    const char *names[2];
};

enum { FACES = 6 };
static const struct face faces[FACES] = {
    {{1, 0, 0}, {0, 0, -1}, {0, -1, 0}, {"px", "posx"}}, {{-1, 0, 0}, {0, 0, 1}, {0, -1, 0}, {"nx", "negx"}},
    {{0, 1, 0}, {1, 0, 0}, {0, 0, 1}, {"py", "posy"}},   {{0, -1, 0}, {1, 0, 0}, {0, 0, -1}, {"ny", "negy"}},
    {{0, 0, 1}, {1, 0, 0}, {0, -1, 0}, {"pz", "posz"}},  {{0, 0, -1}, {-1, 0, 0}, {0, -1, 0}, {"nz", "negz"}},
};

static bool ends_with(const char *path, const char *extension)
{
    size_t length = strlen(path), tail = strlen(extension);
    return length > tail && strcasecmp(path + length - tail, extension) == 0;
}

mns_result mns_light_read(struct mns_image *out, const char *path, struct mns_message *message)
{
    *out = (struct mns_image){.data = NULL};
    if (ends_with(path, ".exr")) {
        return mns_light_read_exr(out, path, message);
    }
    FILE *file = fopen(path, "rb");
    if (!file) {
        return mns_fail(message, MNS_ERR_IO, "%s: cannot be read: %s", path, strerror(errno));
    }
    int width = 0, height = 0, channels;
    bool known = stbi_info_from_file(file, &width, &height, &channels), fits = known && (double)width * height <= PIXELS_MAX;
    float *pixels = fits ? stbi_loadf_from_file(file, &width, &height, &channels, 3) : NULL; /* what is not .hdr: by the power of 2.2 */
    fclose(file);
    if (known && !fits) {
        return mns_fail(message, MNS_ERR_BAD_DATA, "%s: has %d x %d pixels; at most %.0f are read", path, width, height, PIXELS_MAX);
    }
    if (!pixels) {
        return mns_fail(message, MNS_ERR_BAD_DATA, "%s: cannot be read (%s); .hdr, .exr, .png and .jpg can", path, stbi_failure_reason());
    }
    *out = (struct mns_image){.data = pixels, .width = width, .height = height, .channels = 3, .pixel = MNS_PIXEL_F32};
    return MNS_OK;
}

/* ---- cubes ---- */

/* The pattern with %s replaced; NULL: out of memory. */
static char *face_name(const char *pattern, const char *name)
{
    const char *at = strstr(pattern, "%s");
    size_t size = strlen(pattern) + strlen(name) + 1;
    char *out = malloc(size);
    if (out) {
        snprintf(out, size, "%.*s%s%s", (int)(at - pattern), pattern, name, at + 2);
    }
    return out;
}

static mns_result read_face(struct mns_image *out, const char *pattern, int face, struct mns_message *message)
{
    mns_result result = MNS_ERR_IO;
    for (int k = 1; k >= 0 && result == MNS_ERR_IO; k--) { /* the first name last: a missing file is told by it */
        char *path = face_name(pattern, faces[face].names[k]);
        result = path ? mns_light_read(out, path, message) : mns_fail(message, MNS_ERR_OUT_OF_MEMORY, "%s: out of memory", pattern);
        free(path);
    }
    if (result == MNS_OK && out->width != out->height) {
        mns_fail(message, MNS_ERR_BAD_DATA, "%s: face %s has %d x %d pixels; it must be a square", pattern, faces[face].names[0],
                 out->width, out->height);
        free(out->data);
        out->data = NULL;
        return MNS_ERR_BAD_DATA;
    }
    return result;
}

static float dot(const float a[3], const float b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* Radiance of the cube in a direction: bilinear in its face. */
static void cube_at(const struct mns_image images[FACES], const float d[3], float out[3])
{
    int face = 0;
    for (int i = 1; i < FACES; i++) {
        face = dot(d, faces[i].middle) > dot(d, faces[face].middle) ? i : face;
    }
    const struct mns_image *image = &images[face];
    int size = image->width;
    float scale = 0.5f / dot(d, faces[face].middle), last = (float)(size - 1);
    float x = fminf(fmaxf((0.5f + scale * dot(d, faces[face].right)) * (float)size - 0.5f, 0), last);
    float y = fminf(fmaxf((0.5f + scale * dot(d, faces[face].down)) * (float)size - 0.5f, 0), last);
    int left = (int)x, top = (int)y, right = left + 1 < size ? left + 1 : left, below = top + 1 < size ? top + 1 : top;
    const float *data = image->data, *a = data + 3 * ((size_t)top * (size_t)size), *b = data + 3 * ((size_t)below * (size_t)size);
    for (int c = 0; c < 3; c++) {
        float upper = a[3 * left + c] + (x - (float)left) * (a[3 * right + c] - a[3 * left + c]);
        float lower = b[3 * left + c] + (x - (float)left) * (b[3 * right + c] - b[3 * left + c]);
        out[c] = upper + (y - (float)top) * (lower - upper);
    }
}

/* The cube as an equirectangular picture of the same fineness: what a viewer faces who looks along -z is in the middle. */
static mns_result unfold(struct mns_image *out, const struct mns_image images[FACES], const char *pattern, struct mns_message *message)
{
    int size = images[0].width < 2048 ? images[0].width : 2048;
    *out = (struct mns_image){.width = 4 * size, .height = 2 * size, .channels = 3, .pixel = MNS_PIXEL_F32};
    float *pixels = malloc(3 * sizeof(float) * (size_t)out->width * (size_t)out->height);
    out->data = pixels;
    if (!pixels) {
        return mns_fail(message, MNS_ERR_OUT_OF_MEMORY, "%s: out of memory", pattern);
    }
    for (int y = 0; y < out->height; y++) {
        double fall = PI * (y + 0.5) / out->height;
        for (int x = 0; x < out->width; x++, pixels += 3) {
            double turn = 2 * PI * ((x + 0.5) / out->width - 0.5);
            const float d[3] = {(float)(sin(fall) * sin(turn)), (float)cos(fall), (float)(-sin(fall) * cos(turn))};
            cube_at(images, d, pixels);
        }
    }
    return MNS_OK;
}

static mns_result read_cube(struct mns_image *out, const char *pattern, struct mns_message *message)
{
    struct mns_image images[FACES] = {{.data = NULL}};
    mns_result result = MNS_OK;
    for (int i = 0; i < FACES && result == MNS_OK; i++) {
        result = read_face(&images[i], pattern, i, message);
    }
    result = result == MNS_OK ? unfold(out, images, pattern, message) : result;
    for (int i = 0; i < FACES; i++) {
        free(images[i].data);
    }
    return result;
}

mns_result mns_environment_read(mns_environment **out, const char *path, struct mns_message *message)
{
    struct mns_image image = {.data = NULL};
    *out = NULL;
    mns_result result = strstr(path, "%s") ? read_cube(&image, path, message) : mns_light_read(&image, path, message);
    result = result == MNS_OK ? mns_environment_create(out, &image, message) : result;
    free(image.data);
    return result;
}
