/* splat_test.h: stages bin and splat run by themselves, and what they should give, in double precision from the formulas. */
#ifndef MNS_TESTS_SPLAT_TEST_H
#define MNS_TESTS_SPLAT_TEST_H

#include "cpu/cpu.h"
#include "util/pool.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A backend with one particle set. */
struct stage_test {
    struct memory memory;
    struct mns_message message;
    struct pool *pool;
    struct backend_host host;
    struct backend *cpu;
    struct particle_facts facts;
    struct mns_params params;
    struct mns_camera camera;
    struct frame frame;
};

static inline void stage_test_run(void *user, void (*job)(void *context, int index), void *context, int count)
{
    mns_pool_run(user, job, context, count);
}

static inline void stage_test_open(struct stage_test *t, enum mns_isa isa, int threads, const struct mns_particles *particles)
{
    memset(t, 0, sizeof(*t));
    mns_memory_init(&t->memory, NULL);
    t->pool = mns_pool_create(threads, NULL);
    t->host = (struct backend_host){.memory = &t->memory, .threads = threads, .message = &t->message};
    t->host.parallel = (struct mns_parallel){.run = stage_test_run, .user = t->pool};
    struct mns_renderer_params params;
    mns_renderer_params_init(&params);
    params.isa = isa;
    struct mns_measure measure;
    assert_int_equal(mns_backend_cpu.create(&t->cpu, &t->host, &params), MNS_OK);
    assert_int_equal(mns_backend_cpu.prepare(t->cpu, particles, &measure, &t->facts), MNS_OK);
    mns_params_init(&t->params);
    t->params.radius_scale = 1;
}

/* Draws with t->camera and t->params. */
static inline void stage_test_draw(struct stage_test *t)
{
    struct mns_frame frame;
    mns_frame_init(&frame);
    frame.camera = &t->camera;
    frame.params = &t->params;
    assert_int_equal(mns_frame_resolve(&t->frame, &frame, &t->facts, &t->message), MNS_OK);
    assert_int_equal(mns_cpu_bin(t->cpu, &t->frame), MNS_OK);
    assert_int_equal(mns_cpu_splat(t->cpu, &t->frame), MNS_OK);
}

static inline void stage_test_close(struct stage_test *t)
{
    mns_plane_free(&t->cpu->scene.depth, &t->memory); /* a test may have put one there */
    mns_backend_cpu.destroy(t->cpu);
    mns_pool_destroy(t->pool);
    assert_int_equal(t->memory.bytes, 0);
}

static inline float depth_at(const struct stage_test *t, int x, int y)
{
    return t->cpu->depth_raw.plane.data[y * t->cpu->depth_raw.plane.stride + x];
}

static inline float thickness_at(const struct stage_test *t, int x, int y)
{
    return t->cpu->raw.thickness.data[y * t->cpu->raw.thickness.stride + x];
}

/* Uniform in [0, 1). */
static inline double random_unit(uint64_t *state)
{
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return (double)(*state >> 11) * 0x1p-53;
}

/* A pixel's ray in view space: from origin along direction, whose component along the view axis is 1, so that lengths along it are depths. */
struct test_ray {
    double origin[2], direction[2], length;
};

static inline struct test_ray ray_of(const struct mns_camera *camera, double x, double y)
{
    const double *p = camera->projection;
    double u = 2 * x / camera->width - 1, v = 1 - 2 * y / camera->height;
    bool orthographic = p[15] == 1;
    struct test_ray ray = {{0}, {0}, 1};
    double *to = orthographic ? ray.origin : ray.direction;
    to[0] = orthographic ? (u - p[12]) / p[0] : (u + p[8]) / p[0];
    to[1] = orthographic ? (v - p[13]) / p[5] : (v + p[9]) / p[5];
    ray.length = sqrt(1 + ray.direction[0] * ray.direction[0] + ray.direction[1] * ray.direction[1]);
    return ray;
}

/* Depths where the ray enters and leaves a sphere, and half the way inside relative to its radius. Negative: it misses, and comes that
 * near to it at the depth in both. */
static inline double meet_sphere(const struct mns_camera *camera, const struct test_ray *ray, const float world[3], double radius,
                                 double *enter, double *leave)
{
    double c[3];
    for (int row = 0; row < 3; row++) {
        c[row] = camera->view[12 + row];
        for (int k = 0; k < 3; k++) {
            c[row] += camera->view[4 * k + row] * (double)world[k];
        }
    }
    double x = ray->origin[0] - c[0], y = ray->origin[1] - c[1], dx = ray->direction[0], dy = ray->direction[1];
    /* (x + t dx)^2 + (y + t dy)^2 + (t - depth)^2 = R^2 */
    double depth = -c[2], a = dx * dx + dy * dy + 1, b = x * dx + y * dy - depth, q = x * x + y * y + depth * depth - radius * radius;
    double square = b * b - a * q;
    if (!(square > 0)) {
        *enter = *leave = -b / a;
        return -sqrt(-square / a) / radius;
    }
    *enter = (-b - sqrt(square)) / a;
    *leave = (-b + sqrt(square)) / a;
    return sqrt(square / a) / radius;
}

/* Instruction sets that this machine runs. */
static inline int test_isas(enum mns_isa out[6])
{
    int count = 0;
    for (int isa = MNS_ISA_SCALAR; isa <= MNS_ISA_NEON; isa++) {
        if (mns_kernels_get((enum mns_isa)isa)) {
            out[count++] = (enum mns_isa)isa;
        }
    }
    return count;
}

#endif
