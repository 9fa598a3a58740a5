/* smooth_test.h: stage smooth by itself, and depth images known in closed form. Included after cmocka.h. */
#ifndef MNS_TESTS_SMOOTH_TEST_H
#define MNS_TESTS_SMOOTH_TEST_H

#include "cpu/cpu.h"
#include "cpu/smooth/filter.h"
#include "util/pool.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Splat radius and the depth at the picture's middle. With FOCAL a radius is 10 pixels there, sigma 7, the kernel's reach 14. */
static const float R = 0.02f, MIDDLE = 2;
static const float FOCAL = 1000;

/* Every filter but none. */
enum { FILTERS = MNS_FILTER_SMOOTHING_SPLINE };
static const enum mns_filter all_filters[FILTERS] = {MNS_FILTER_NARROW_RANGE,
                                                     MNS_FILTER_NARROW_RANGE_1D,
                                                     MNS_FILTER_NARROW_RANGE_1D_CLEANUP,
                                                     MNS_FILTER_GAUSSIAN,
                                                     MNS_FILTER_BILATERAL,
                                                     MNS_FILTER_BILATERAL_1D,
                                                     MNS_FILTER_PLANE_FIT,
                                                     MNS_FILTER_CURVATURE_FLOW,
                                                     MNS_FILTER_ADAPTIVE_CURVATURE_FLOW,
                                                     MNS_FILTER_IMPLICIT_CURVATURE_FLOW,
                                                     MNS_FILTER_SMOOTHING_SPLINE};

static uint32_t test_random;

static inline float uniform(void) /* in [0, 1) */
{
    test_random = test_random * 1664525u + 1013904223u;
    return (float)(test_random >> 8) / 16777216.0f;
}

/* A backend with what the stage needs, and a frame. */
struct fixture {
    struct backend cpu;
    struct memory memory;
    struct mns_message message;
    struct pool *pool;
    struct frame frame;
    struct kernels kernels;
    struct smooth_kernels smooth;
    struct narrow_range_kernels narrow_range;
};

static inline void run_jobs(void *user, void (*job)(void *context, int index), void *context, int count)
{
    mns_pool_run(user, job, context, count);
}

static inline struct fixture *fixture_create(int width, int height, enum mns_isa isa, int threads)
{
    struct fixture *fixture = calloc(1, sizeof(*fixture));
    assert_non_null(fixture);
    mns_memory_init(&fixture->memory, NULL);
    fixture->pool = mns_pool_create(threads, NULL);
    assert_non_null(fixture->pool);
    assert_non_null(mns_kernels_get(isa));
    fixture->smooth = *mns_kernels_get(isa)->smooth;
    fixture->narrow_range = *fixture->smooth.narrow_range;
    fixture->smooth.narrow_range = &fixture->narrow_range;
    fixture->kernels.smooth = &fixture->smooth;
    fixture->kernels.shade = mns_kernels_get(isa)->shade;
    fixture->cpu.kernels = &fixture->kernels;
    fixture->cpu.host = (struct backend_host){
        .memory = &fixture->memory, .parallel = {run_jobs, fixture->pool}, .threads = threads, .message = &fixture->message};
    mns_params_init(&fixture->frame.params);
    fixture->frame.params.filter = MNS_FILTER_NARROW_RANGE_1D_CLEANUP;
    fixture->frame.params.iterations = 3;
    fixture->frame.params.sigma = 0.7f; /* what the scenes here are worked out for */
    fixture->frame.splat_radius = R;
    fixture->frame.depth_reference = MIDDLE;
    fixture->frame.view =
        (struct view){.width = width, .height = height, .fx = FOCAL, .fy = FOCAL, .cx = 0.5f * (float)width, .cy = 0.5f * (float)height};
    assert_true(mns_depth_plane_resize(&fixture->cpu.depth_raw, &fixture->memory, width, height));
    return fixture;
}

static inline void fixture_destroy(struct fixture *fixture)
{
    mns_depth_plane_free(&fixture->cpu.depth_raw, &fixture->memory);
    mns_depth_plane_free(&fixture->cpu.depth[0], &fixture->memory);
    mns_depth_plane_free(&fixture->cpu.depth[1], &fixture->memory);
    mns_memory_put(&fixture->memory, fixture->cpu.block_values, fixture->cpu.block_values_capacity, sizeof(float));
    for (int i = 0; i < 3; i++) {
        mns_plane_free(&fixture->cpu.depth_normal[i], &fixture->memory);
    }
    mns_resample_destroy(&fixture->cpu);
    mns_memory_put(&fixture->memory, fixture->cpu.line_scratch, fixture->cpu.line_scratch_capacity, sizeof(float));
    assert_int_equal(fixture->memory.bytes, 0);
    mns_pool_destroy(fixture->pool);
    free(fixture);
}

/* A parallel view in which a pixel at any depth is what it is in the middle of the perspective one. */
static inline void use_orthographic(struct fixture *fixture)
{
    fixture->frame.view.orthographic = true;
    fixture->frame.view.fx = fixture->frame.view.fy = FOCAL / MIDDLE;
}

static inline float *pixel(const struct depth_plane *plane, int x, int y) { return plane->plane.data + y * plane->plane.stride + x; }

static inline struct depth_range range_of(const struct depth_plane *plane, int bx, int by)
{
    struct depth_range range = {DEPTH_EMPTY, 0};
    for (int y = by * BLOCK_HEIGHT; y < (by + 1) * BLOCK_HEIGHT && y < plane->plane.height; y++) {
        for (int x = bx * BLOCK_WIDTH; x < (bx + 1) * BLOCK_WIDTH && x < plane->plane.width; x++) {
            range.min = fminf(range.min, *pixel(plane, x, y));
            range.max = fmaxf(range.max, *pixel(plane, x, y));
        }
    }
    return range;
}

typedef float depth_function(const struct fixture *fixture, int x, int y);

static inline void fill(struct fixture *fixture, depth_function *depth)
{
    struct depth_plane *raw = &fixture->cpu.depth_raw;
    test_random = 7;
    for (int y = 0; y < raw->plane.height; y++) {
        for (int x = 0; x < raw->plane.width; x++) {
            *pixel(raw, x, y) = depth(fixture, x, y);
        }
    }
    for (int by = 0; by < raw->blocks_y; by++) {
        for (int bx = 0; bx < raw->blocks_x; bx++) {
            raw->ranges[by * raw->blocks_x + bx] = range_of(raw, bx, by);
        }
    }
}

static inline const struct depth_plane *run(struct fixture *fixture)
{
    assert_int_equal(mns_cpu_smooth(&fixture->cpu, &fixture->frame), MNS_OK);
    return fixture->cpu.smoothed;
}

/* Depths of a plane through (0, 0, MIDDLE) whose depth grows by slope along y (down) per metre. */
static inline float slanted(const struct fixture *fixture, int y, float slope)
{
    const struct view *view = &fixture->frame.view;
    float v = ((float)y + 0.5f - 0.5f * (float)view->height) / view->fy;
    return view->orthographic ? MIDDLE + slope * v : MIDDLE / (1 - slope * v);
}

static float slope_of_tilt; /* of the depth functions below */

static inline float tilted(const struct fixture *fixture, int x, int y)
{
    (void)x;
    return slanted(fixture, y, slope_of_tilt);
}

/* Spheres on a plane, drops before it, and holes: everything that the filter meets. */
static inline float splashes(const struct fixture *fixture, int x, int y)
{
    float u = (float)x / 10, v = (float)y / 10; /* a sphere each 10 pixels */
    float du = u - floorf(u) - 0.5f, dv = v - floorf(v) - 0.5f;
    float bump = R * sqrtf(fmaxf(0, 1 - 2 * (du * du + dv * dv)));
    uint32_t cell = ((uint32_t)u * 7919u + (uint32_t)v * 104729u) * 2654435761u;
    float depth = slanted(fixture, y, 1) - bump + 0.5f * R * (float)(cell >> 24) / 256;
    switch (cell >> 20 & 15) {
    case 0: return DEPTH_EMPTY;
    case 1: return depth - 30 * R;
    case 2: return depth - 8 * R;
    default: return depth;
    }
}

static inline void assert_near(double a, double b, double tolerance)
{
    if (!(fabs(a - b) <= tolerance)) {
        fail_msg("%.9g, expected %.9g within %.3g", a, b, tolerance);
    }
}

static inline float drop_before_plane(const struct fixture *fixture, int x, int y)
{
    float dx = (float)x - 63.5f, dy = (float)y - 63.5f, square = 30 * 30 - dx * dx - dy * dy;
    return square > 0 ? MIDDLE - 50 * R - 0.1f * R * sqrtf(square) : slanted(fixture, y, slope_of_tilt);
}

static inline float step(const struct fixture *fixture, int x, int y)
{
    (void)fixture;
    (void)y;
    return x < 50 ? MIDDLE : MIDDLE + 50 * R;
}

/* Pixels of two results that are more than a tolerance (of R) apart; empty ones must be the same. */
static inline int pixels_apart(const struct depth_plane *a, const struct depth_plane *b, double tolerance)
{
    int apart = 0;
    for (int y = 0; y < a->plane.height; y++) {
        for (int x = 0; x < a->plane.width; x++) {
            apart += fabs((double)*pixel(a, x, y) - (double)*pixel(b, x, y)) > tolerance * R;
        }
    }
    return apart;
}

#endif
