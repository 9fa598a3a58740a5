/* The renderer as a caller sees it: objects, memory, threads, messages. */
#include <math.h>
#include <pthread.h>
#include <stdbool.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include <meniscus/meniscus.h>

enum { WIDTH = 160, HEIGHT = 90, COUNT = 4000 };

/* A block of particles on a jittered grid. */
static void fill_block(float positions[COUNT][3])
{
    uint32_t random = 1;
    for (int i = 0; i < COUNT; i++) {
        const int cell[3] = {i % 20, i / 20 % 10, i / 200};
        for (int k = 0; k < 3; k++) {
            random = random * 1664525u + 1013904223u;
            positions[i][k] = 0.1f * ((float)cell[k] + 0.5f * (float)(random >> 8) / 16777216.0f);
        }
    }
}

static struct mns_particles particles_of(float positions[COUNT][3])
{
    struct mns_particles particles;
    mns_particles_init(&particles);
    particles.count = COUNT;
    particles.position = (struct mns_attr){.data = positions, .type = MNS_F32};
    return particles;
}

static struct mns_camera camera_of(void)
{
    struct mns_camera camera;
    mns_camera_init(&camera, WIDTH, HEIGHT);
    const double low[3] = {0, 0, 0}, high[3] = {2, 1, 2};
    assert_int_equal(mns_camera_frame(&camera, low, high, 0.05, MNS_AXIS_Y, 45), MNS_OK);
    return camera;
}

static mns_result draw(mns_renderer *renderer, uint8_t *pixels)
{
    struct mns_camera camera = camera_of();
    struct mns_output output = {MNS_LAYER_BEAUTY, {.data = pixels, .width = WIDTH, .height = HEIGHT, .channels = 4, .pixel = MNS_PIXEL_U8}};
    struct mns_frame frame;
    mns_frame_init(&frame);
    frame.camera = &camera;
    frame.outputs = &output;
    frame.output_count = 1;
    return mns_renderer_draw(renderer, &frame);
}

/* An allocator that counts what it gave, and says no from the wanted call on. */
struct counting {
    size_t calls, held, refuse_at; /* refuse_at 0: never */
};

static void *count_allocate(void *user, size_t size, size_t alignment)
{
    struct counting *counting = user;
    counting->calls++;
    if (counting->refuse_at != 0 && counting->calls >= counting->refuse_at) {
        return NULL;
    }
    void *block = aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
    counting->held += block ? size : 0;
    return block;
}

static void count_release(void *user, void *memory, size_t size)
{
    struct counting *counting = user;
    counting->held -= memory ? size : 0;
    free(memory);
}

/* One renderer's whole life; whether it got to the end. */
static bool live(struct counting *counting, float positions[COUNT][3], uint8_t *pixels)
{
    struct mns_renderer_params params;
    mns_renderer_params_init(&params);
    params.threads = 2;
    params.allocator = (struct mns_allocator){.allocate = count_allocate, .release = count_release, .user = counting};
    struct mns_message message = {""};
    mns_renderer *renderer = NULL;
    mns_result result = mns_renderer_create(&renderer, &params, &message);
    if (result != MNS_OK) {
        assert_null(renderer);
        assert_int_equal(result, MNS_ERR_OUT_OF_MEMORY);
        assert_true(message.text[0] != '\0');
        return false;
    }
    struct mns_particles particles = particles_of(positions);
    result = mns_renderer_prepare(renderer, &particles);
    if (result == MNS_OK) {
        result = draw(renderer, pixels);
    }
    if (result != MNS_OK) {
        assert_int_equal(result, MNS_ERR_OUT_OF_MEMORY);
        assert_true(strstr(mns_renderer_message(renderer), "memory") != NULL);
    }
    mns_renderer_destroy(&renderer);
    assert_null(renderer);
    return result == MNS_OK;
}

static void memory_that_runs_out_anywhere_is_an_error_and_no_leak(void **state)
{
    (void)state;
    static float positions[COUNT][3];
    static uint8_t pixels[WIDTH * HEIGHT * 4];
    fill_block(positions);
    struct counting counting = {0};
    assert_true(live(&counting, positions, pixels));
    assert_int_equal(counting.held, 0);
    size_t calls = counting.calls;
    assert_true(calls > 10);
    for (size_t refuse_at = 1; refuse_at <= calls; refuse_at++) {
        counting = (struct counting){.refuse_at = refuse_at};
        assert_false(live(&counting, positions, pixels));
        assert_int_equal(counting.held, 0);
    }
}

static void a_frame_like_the_last_asks_for_no_memory(void **state)
{
    (void)state;
    static float positions[COUNT][3];
    static uint8_t pixels[WIDTH * HEIGHT * 4];
    fill_block(positions);
    struct counting counting = {0};
    struct mns_renderer_params params;
    mns_renderer_params_init(&params);
    params.allocator = (struct mns_allocator){.allocate = count_allocate, .release = count_release, .user = &counting};
    mns_renderer *renderer;
    assert_int_equal(mns_renderer_create(&renderer, &params, NULL), MNS_OK);
    struct mns_particles particles = particles_of(positions);
    assert_int_equal(mns_renderer_prepare(renderer, &particles), MNS_OK);
    assert_int_equal(draw(renderer, pixels), MNS_OK);
    size_t calls = counting.calls;
    assert_int_equal(draw(renderer, pixels), MNS_OK);
    assert_int_equal(counting.calls, calls);
    struct mns_stats stats;
    mns_stats_init(&stats);
    mns_renderer_stats(renderer, &stats);
    assert_true(stats.bytes > 0 && stats.bytes <= counting.held && stats.peak_bytes >= stats.bytes);
    mns_renderer_destroy(&renderer);
    assert_int_equal(counting.held, 0);
}

/* Runs jobs last to first, on the calling thread. */
static void run_backwards(void *user, void (*job)(void *context, int index), void *context, int count)
{
    *(int *)user += count;
    for (int i = count - 1; i >= 0; i--) {
        job(context, i);
    }
}

static void threads_and_their_order_change_no_byte(void **state)
{
    (void)state;
    static float positions[COUNT][3];
    static uint8_t first[WIDTH * HEIGHT * 4], pixels[WIDTH * HEIGHT * 4];
    fill_block(positions);
    struct mns_particles particles = particles_of(positions);
    static const int threads[] = {1, 2, 7, 5};
    int jobs = 0;
    for (int i = 0; i < 4; i++) {
        struct mns_renderer_params params;
        mns_renderer_params_init(&params);
        params.threads = threads[i];
        if (i == 3) {
            params.parallel = (struct mns_parallel){.run = run_backwards, .user = &jobs};
        }
        mns_renderer *renderer;
        assert_int_equal(mns_renderer_create(&renderer, &params, NULL), MNS_OK);
        assert_int_equal(mns_renderer_prepare(renderer, &particles), MNS_OK);
        assert_int_equal(draw(renderer, i == 0 ? first : pixels), MNS_OK);
        if (i > 0) {
            assert_memory_equal(first, pixels, sizeof(pixels));
        }
        mns_renderer_destroy(&renderer);
    }
    assert_true(jobs > 0);
}

enum { RENDERERS = 3 };

struct life {
    float (*positions)[3];
    uint8_t pixels[WIDTH * HEIGHT * 4];
    bool done;
};

static void *live_alone(void *context)
{
    struct life *life = context;
    struct counting counting = {0};
    life->done = live(&counting, life->positions, life->pixels);
    return NULL;
}

static void renderers_in_threads_of_their_own_do_not_meet(void **state)
{
    (void)state;
    static float positions[COUNT][3];
    static struct life lives[RENDERERS];
    fill_block(positions);
    pthread_t threads[RENDERERS];
    for (int i = 0; i < RENDERERS; i++) {
        lives[i].positions = positions;
        assert_int_equal(pthread_create(&threads[i], NULL, live_alone, &lives[i]), 0);
    }
    static struct life alone;
    alone.positions = positions;
    live_alone(&alone);
    for (int i = 0; i < RENDERERS; i++) {
        assert_int_equal(pthread_join(threads[i], NULL), 0);
        assert_true(lives[i].done);
        assert_memory_equal(lives[i].pixels, alone.pixels, sizeof(alone.pixels));
    }
}

struct heard {
    int errors, warnings;
    char last[1024];
};

static void hear(void *user, enum mns_log_level level, const char *text)
{
    struct heard *heard = user;
    heard->errors += level == MNS_LOG_ERROR;
    heard->warnings += level == MNS_LOG_WARNING;
    strncpy(heard->last, text, sizeof(heard->last) - 1);
}

static void faults_are_told_and_the_renderer_lives_on(void **state)
{
    (void)state;
    static float positions[COUNT][3];
    static uint8_t pixels[WIDTH * HEIGHT * 4];
    fill_block(positions);
    struct heard heard = {0};
    struct mns_renderer_params params;
    mns_renderer_params_init(&params);
    params.log = (struct mns_log){.message = hear, .user = &heard};
    struct mns_message message;
    mns_renderer *renderer;
    params.threads = -1;
    assert_int_equal(mns_renderer_create(&renderer, &params, &message), MNS_ERR_INVALID_ARGUMENT);
    assert_non_null(strstr(message.text, "threads is -1"));
    params.threads = 0;
    params.isa = (enum mns_isa)77;
    assert_int_equal(mns_renderer_create(&renderer, &params, &message), MNS_ERR_UNSUPPORTED);
    params.isa = MNS_ISA_AUTO;
    assert_int_equal(mns_renderer_create(&renderer, &params, &message), MNS_OK);

    assert_int_equal(draw(renderer, pixels), MNS_OK); /* nothing prepared: the background */
    struct mns_particles particles = particles_of(positions);
    particles.position.type = MNS_I32;
    assert_int_equal(mns_renderer_prepare(renderer, &particles), MNS_ERR_INVALID_ARGUMENT);
    assert_non_null(strstr(mns_renderer_message(renderer), "float32 or float64"));
    assert_int_equal(heard.errors, 1);
    assert_string_equal(heard.last, mns_renderer_message(renderer));
    assert_int_equal(draw(renderer, pixels), MNS_OK);

    particles = particles_of(positions);
    positions[7][1] = NAN;
    positions[9][2] = INFINITY;
    assert_int_equal(mns_renderer_prepare(renderer, &particles), MNS_OK);
    assert_string_equal(mns_renderer_message(renderer), "");
    assert_int_equal(heard.warnings, 1);
    struct mns_stats stats;
    mns_stats_init(&stats);
    mns_renderer_stats(renderer, &stats);
    assert_int_equal(stats.measure.dropped, 2);
    assert_int_equal(stats.measure.count, COUNT - 2);
    assert_int_equal(draw(renderer, pixels), MNS_OK);
    mns_renderer_destroy(&renderer);
    mns_renderer_destroy(&renderer);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(memory_that_runs_out_anywhere_is_an_error_and_no_leak),
        cmocka_unit_test(a_frame_like_the_last_asks_for_no_memory),
        cmocka_unit_test(threads_and_their_order_change_no_byte),
        cmocka_unit_test(renderers_in_threads_of_their_own_do_not_meet),
        cmocka_unit_test(faults_are_told_and_the_renderer_lives_on),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
