/* picture_test.h: what the tests of whole pictures share: particle scenes made here, drawn through the public headers, read as layers. */
#ifndef MNS_TESTS_PICTURE_TEST_H
#define MNS_TESTS_PICTURE_TEST_H

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include <meniscus/meniscus.h>

/* Particles of a scene. */
struct cloud {
    float (*position)[3];
    size_t count, capacity;
};

static inline void cloud_add(struct cloud *cloud, double x, double y, double z)
{
    if (cloud->count == cloud->capacity) {
        cloud->capacity = cloud->capacity ? 2 * cloud->capacity : 1024;
        cloud->position = realloc(cloud->position, cloud->capacity * sizeof(*cloud->position));
        assert_non_null(cloud->position);
    }
    cloud->position[cloud->count][0] = (float)x;
    cloud->position[cloud->count][1] = (float)y;
    cloud->position[cloud->count][2] = (float)z;
    cloud->count++;
}

static inline void cloud_free(struct cloud *cloud)
{
    free(cloud->position);
    *cloud = (struct cloud){0};
}

/* Uniform in [-1, 1), the same on every machine. */
static inline double noise(uint64_t *state)
{
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return (double)(*state >> 40) / (double)(1 << 23) - 1;
}

/* A box of nx * ny * nz particles with its lower corner at `low`, each moved by up to `jitter` spacings along every axis. */
static inline void cloud_box(struct cloud *cloud, const double low[3], const int n[3], double spacing, double jitter, uint64_t seed)
{
    for (int z = 0; z < n[2]; z++) {
        for (int y = 0; y < n[1]; y++) {
            for (int x = 0; x < n[0]; x++) {
                double jx = jitter * noise(&seed), jy = jitter * noise(&seed), jz = jitter * noise(&seed);
                cloud_add(cloud, low[0] + spacing * (x + 0.5 + jx), low[1] + spacing * (y + 0.5 + jy), low[2] + spacing * (z + 0.5 + jz));
            }
        }
    }
}

static inline struct mns_particles cloud_particles(const struct cloud *cloud)
{
    struct mns_particles particles;
    mns_particles_init(&particles);
    particles.count = cloud->count;
    particles.position = (struct mns_attr){.data = cloud->position, .type = MNS_F32};
    return particles;
}

/* What a test draws. isa, threads: 0 for the renderer's choice. */
struct shot {
    struct mns_camera camera;
    struct mns_params params;
    enum mns_isa isa;
    int threads;
};

static inline struct shot shot_of(int width, int height)
{
    struct shot shot = {.threads = 2};
    mns_camera_init(&shot.camera, width, height);
    mns_params_init(&shot.params);
    return shot;
}

static inline float *layer_alloc(const struct shot *shot, enum mns_layer layer)
{
    size_t pixels = (size_t)shot->camera.width * (size_t)shot->camera.height;
    float *data = calloc(pixels * (size_t)mns_layer_channels(layer), sizeof(float));
    assert_non_null(data);
    return data;
}

/* Draws the particles into layers [count], which the caller frees. */
static inline void draw_layers(const struct shot *shot, const struct mns_particles *particles, const enum mns_layer *layers, float **data,
                               size_t count)
{
    struct mns_renderer_params params;
    mns_renderer_params_init(&params);
    params.isa = shot->isa;
    params.threads = shot->threads;
    params.passes = 1; /* every layer may be asked for */
    struct mns_output outputs[MNS_LAYER_COUNT];
    for (size_t i = 0; i < count; i++) {
        data[i] = layer_alloc(shot, layers[i]);
        outputs[i] = (struct mns_output){layers[i],
                                         {.data = data[i],
                                          .width = shot->camera.width,
                                          .height = shot->camera.height,
                                          .channels = mns_layer_channels(layers[i]),
                                          .pixel = MNS_PIXEL_F32}};
    }
    mns_renderer *renderer;
    struct mns_message message;
    if (mns_renderer_create(&renderer, &params, &message) != MNS_OK) {
        fail_msg("%s", message.text);
    }
    struct mns_frame frame;
    mns_frame_init(&frame);
    frame.camera = &shot->camera;
    frame.params = &shot->params;
    frame.outputs = outputs;
    frame.output_count = count;
    if (mns_renderer_prepare(renderer, particles) != MNS_OK || mns_renderer_draw(renderer, &frame) != MNS_OK) {
        fail_msg("%s", mns_renderer_message(renderer));
    }
    mns_renderer_destroy(&renderer);
}

static inline float *draw_layer(const struct shot *shot, const struct mns_particles *particles, enum mns_layer layer)
{
    float *data;
    draw_layers(shot, particles, &layer, &data, 1);
    return data;
}

enum { POOL_WIDTH = 320, POOL_HEIGHT = 180 };

/* A pool with waves, droplets above it and a bowl in the middle: something of everything. */
static inline void pool(struct cloud *cloud, double size)
{
    uint64_t seed = 11;
    double spacing = 0.05 * size;
    for (int z = 0; z < 40; z++) {
        for (int x = 0; x < 60; x++) {
            double px = (x - 30) * 0.05, pz = (z - 20) * 0.05, r = hypot(px, pz);
            int layers = 6 + (int)(2 * sin(4 * px) * cos(3 * pz) + 6 * exp(-12 * (r - 0.4) * (r - 0.4)) - 5 * exp(-20 * r * r));
            for (int y = 0; y < layers; y++) {
                double jx = 0.2 * noise(&seed), jy = 0.2 * noise(&seed), jz = 0.2 * noise(&seed);
                cloud_add(cloud, spacing * (x - 30 + jx), spacing * (y + jy), spacing * (z - 20 + jz));
            }
        }
    }
    for (int i = 0; i < 60; i++) {
        double px = noise(&seed), py = 1 + 0.4 * noise(&seed), pz = 0.8 * noise(&seed); /* in this order with every compiler */
        cloud_add(cloud, px * size, py * size, pz * size);
    }
}

static inline struct shot pool_shot(double size)
{
    struct shot shot = shot_of(POOL_WIDTH, POOL_HEIGHT);
    const double low[3] = {-1.5 * size, 0, -1 * size}, high[3] = {1.5 * size, 1.2 * size, 1 * size};
    assert_int_equal(mns_camera_frame(&shot.camera, low, high, 0, MNS_AXIS_Y, 45), MNS_OK);
    return shot;
}

/* How two layers differ: the largest difference, the mean difference, and the part of the values that differ by more than `apart`;
 * of values beyond 1 (far depths) in parts of the value. Equal infinities do not differ. */
struct difference {
    double largest, mean, part;
};

static inline struct difference compare(const float *a, const float *b, size_t count, double apart)
{
    struct difference d = {0};
    for (size_t i = 0; i < count; i++) {
        double difference = a[i] == b[i] ? 0 : fabs((double)a[i] - (double)b[i]) / fmax(1, fabs((double)a[i]));
        if (!isfinite(difference)) {
            difference = INFINITY; /* NaN too: never close */
        }
        d.largest = fmax(d.largest, difference);
        d.mean += isfinite(difference) ? difference / (double)count : 0;
        d.part += difference > apart ? 1.0 / (double)count : 0;
    }
    return d;
}

#endif
