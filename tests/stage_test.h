/* stage_test.h: a CPU backend whose stages a test calls one by one, on depths and thicknesses of its own. */
#ifndef MNS_TESTS_STAGE_TEST_H
#define MNS_TESTS_STAGE_TEST_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <meniscus/meniscus.h>

#include "cpu/cpu.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct stage_test {
    struct memory memory;
    struct mns_message message;
    struct backend *cpu;
    struct particle_facts facts;
    struct mns_camera camera;
    struct mns_params params;
    struct frame frame;
};

static inline void run_backwards(void *user, void (*job)(void *context, int index), void *context, int count)
{
    (void)user;
    for (int i = count - 1; i >= 0; i--) {
        job(context, i);
    }
}

/* A backend with `count` particles; threads jobs, run last to first. */
static inline void stage_test_begin(struct stage_test *test, enum mns_isa isa, int threads, const float *positions, size_t count)
{
    memset(test, 0, sizeof(*test));
    mns_memory_init(&test->memory, NULL);
    const struct backend_host host = {
        .memory = &test->memory, .parallel = {.run = run_backwards}, .threads = threads, .message = &test->message};
    struct mns_renderer_params params;
    mns_renderer_params_init(&params);
    params.isa = isa;
    assert_int_equal(mns_backend_cpu.create(&test->cpu, &host, &params), MNS_OK);
    struct mns_particles particles;
    mns_particles_init(&particles);
    particles.count = count;
    particles.position = (struct mns_attr){.data = positions, .type = MNS_F32};
    struct mns_measure measure;
    assert_int_equal(mns_backend_cpu.prepare(test->cpu, &particles, &measure, &test->facts), MNS_OK);
    mns_params_init(&test->params);
    mns_camera_init(&test->camera, 64, 48);
}

static inline void stage_test_end(struct stage_test *test)
{
    mns_backend_cpu.destroy(test->cpu);
    assert_int_equal(test->memory.bytes, 0);
}

/* Resolves the frame and gives the planes before blur their size, empty. */
static inline void stage_test_frame(struct stage_test *test, const struct mns_scene *scene, const struct mns_output *outputs, size_t count,
                                    int scale)
{
    struct mns_frame frame;
    mns_frame_init(&frame);
    frame.camera = &test->camera;
    frame.params = &test->params;
    frame.scene = scene;
    frame.outputs = outputs;
    frame.output_count = count;
    assert_int_equal(mns_frame_resolve(&test->frame, &frame, &test->facts, &test->message), MNS_OK);
    struct backend *cpu = test->cpu;
    int width = test->camera.width, height = test->camera.height;
    cpu->raw.scale = scale;
    cpu->raw.has_color = false;
    cpu->smoothed = &cpu->depth_raw;
    assert_true(mns_depth_plane_resize(&cpu->depth_raw, &test->memory, width, height));
    assert_true(
        mns_plane_resize(&cpu->raw.thickness, &test->memory, (width + scale - 1) / scale, (height + scale - 1) / scale, PLANE_BORDER));
    for (int y = 0; y < height; y++) {
        for (int x = 0; x < width; x++) {
            cpu->depth_raw.plane.data[y * cpu->depth_raw.plane.stride + x] = DEPTH_EMPTY;
        }
    }
    memset(cpu->raw.thickness.block, 0, cpu->raw.thickness.floats * sizeof(float));
}

static inline float *depth_at(struct stage_test *test, int x, int y)
{
    return test->cpu->depth_raw.plane.data + y * test->cpu->depth_raw.plane.stride + x;
}

static inline float *thickness_at(struct stage_test *test, int x, int y)
{
    return test->cpu->raw.thickness.data + y * test->cpu->raw.thickness.stride + x;
}

static inline struct mns_image image_of(const struct stage_test *test, void *data, int channels, enum mns_pixel pixel)
{
    return (struct mns_image){
        .data = data, .width = test->camera.width, .height = test->camera.height, .channels = channels, .pixel = pixel};
}

#endif
