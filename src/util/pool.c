/* pool.c: a fixed set of worker threads over POSIX threads. Linux-only: the affinity mask (sched_getaffinity). */
#if defined(__linux__)
#define _GNU_SOURCE
#else
#define _POSIX_C_SOURCE 200809L
#endif

#include "util/pool.h"

#include "core/memory.h"

#include <pthread.h>
#include <sched.h>
#include <stdbool.h>
#include <unistd.h>

/* Of each thread: jobs hold rows of pixels on it, and some systems give as little as 128 KiB. The sanitizers want more. */
enum { STACK_SIZE = 4 << 20 };

struct pool {
    struct memory memory;
    pthread_t *threads;
    int thread_count; /* workers that run */
    int capacity;
    pthread_mutex_t mutex;
    pthread_cond_t work, done;
    void (*job)(void *context, int index);
    void *context;
    int next, count, running; /* of the job in hand; indices [next, count) are not taken yet */
    bool quit;
};

int mns_processor_count(void)
{
#if defined(__linux__)
    cpu_set_t set;
    if (sched_getaffinity(0, sizeof(set), &set) == 0 && CPU_COUNT(&set) > 0) {
        return CPU_COUNT(&set);
    }
#endif
#ifdef _SC_NPROCESSORS_ONLN
    long online = sysconf(_SC_NPROCESSORS_ONLN);
    if (online > 0) {
        return (int)online;
    }
#endif
    return 1;
}

/* With the mutex held: runs indices of the job in hand until none is left. */
static void run_some(struct pool *pool)
{
    while (pool->next < pool->count) {
        int index = pool->next++;
        pool->running++;
        void (*job)(void *, int) = pool->job;
        void *context = pool->context;
        pthread_mutex_unlock(&pool->mutex);
        job(context, index);
        pthread_mutex_lock(&pool->mutex);
        pool->running--;
    }
}

static void *work(void *argument)
{
    struct pool *pool = argument;
    pthread_mutex_lock(&pool->mutex);
    while (!pool->quit) {
        run_some(pool);
        if (pool->running == 0) {
            pthread_cond_signal(&pool->done);
        }
        pthread_cond_wait(&pool->work, &pool->mutex);
    }
    pthread_mutex_unlock(&pool->mutex);
    return NULL;
}

struct pool *mns_pool_create(int threads, const struct mns_allocator *allocator)
{
    struct memory memory;
    mns_memory_init(&memory, allocator);
    struct pool *pool = mns_memory_get(&memory, 1, sizeof(*pool));
    if (!pool) {
        return NULL;
    }
    *pool = (struct pool){.capacity = threads > 1 ? threads - 1 : 0};
    pool->memory = memory;
    if (pthread_mutex_init(&pool->mutex, NULL)) {
        goto fail_mutex;
    }
    if (pthread_cond_init(&pool->work, NULL)) {
        goto fail_work;
    }
    if (pthread_cond_init(&pool->done, NULL)) {
        goto fail_done;
    }
    pool->threads = mns_memory_get(&pool->memory, (size_t)pool->capacity, sizeof(pthread_t));
    if (!pool->threads) {
        goto fail_threads;
    }
    pthread_attr_t attributes;
    if (pthread_attr_init(&attributes)) {
        mns_pool_destroy(pool);
        return NULL;
    }
    pthread_attr_setstacksize(&attributes, STACK_SIZE); /* where it is refused the system's own size must do */
    while (pool->thread_count < pool->capacity) {
        if (pthread_create(&pool->threads[pool->thread_count], &attributes, work, pool)) {
            pthread_attr_destroy(&attributes);
            mns_pool_destroy(pool);
            return NULL;
        }
        pool->thread_count++;
    }
    pthread_attr_destroy(&attributes);
    return pool;

fail_threads:
    pthread_cond_destroy(&pool->done);
fail_done:
    pthread_cond_destroy(&pool->work);
fail_work:
    pthread_mutex_destroy(&pool->mutex);
fail_mutex:
    memory = pool->memory;
    mns_memory_put(&memory, pool, 1, sizeof(*pool));
    return NULL;
}

void mns_pool_destroy(struct pool *pool)
{
    if (!pool) {
        return;
    }
    pthread_mutex_lock(&pool->mutex);
    pool->quit = true;
    pthread_cond_broadcast(&pool->work);
    pthread_mutex_unlock(&pool->mutex);
    for (int i = 0; i < pool->thread_count; i++) {
        pthread_join(pool->threads[i], NULL);
    }
    pthread_cond_destroy(&pool->done);
    pthread_cond_destroy(&pool->work);
    pthread_mutex_destroy(&pool->mutex);
    mns_memory_put(&pool->memory, pool->threads, (size_t)pool->capacity, sizeof(pthread_t));
    struct memory memory = pool->memory;
    mns_memory_put(&memory, pool, 1, sizeof(*pool));
}

void mns_pool_run(struct pool *pool, void (*job)(void *context, int index), void *context, int count)
{
    if (count <= 0) {
        return;
    }
    pthread_mutex_lock(&pool->mutex);
    pool->job = job;
    pool->context = context;
    pool->next = 0;
    pool->count = count;
    if (count > 1) {
        pthread_cond_broadcast(&pool->work);
    }
    run_some(pool);
    while (pool->running > 0) {
        pthread_cond_wait(&pool->done, &pool->mutex);
    }
    pthread_mutex_unlock(&pool->mutex);
}
