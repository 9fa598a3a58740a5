/* crew.c: threads that work on items as they come and hand them back in the same order (POSIX threads). */
#include "crew.h"

#include <pthread.h>
#include <signal.h>
#include <stdlib.h>

struct place {
    void *item;
    bool done;
};

struct crew {
    void (*work)(void *context, void *item);
    void *context;
    pthread_mutex_t mutex;
    pthread_cond_t put, done;
    pthread_t *threads;
    int thread_count;
    bool quit;
    size_t capacity;
    size_t first, next, end; /* item i stands at places[i % capacity]: [first, next) are worked on or done, [next, end) wait */
    struct place places[];
};

static void *run(void *user)
{
    struct crew *crew = user;
    pthread_mutex_lock(&crew->mutex);
    for (;;) {
        while (crew->next == crew->end && !crew->quit) {
            pthread_cond_wait(&crew->put, &crew->mutex);
        }
        if (crew->next == crew->end) {
            break;
        }
        struct place *place = &crew->places[crew->next++ % crew->capacity];
        pthread_mutex_unlock(&crew->mutex);
        crew->work(crew->context, place->item);
        pthread_mutex_lock(&crew->mutex);
        place->done = true;
        pthread_cond_signal(&crew->done);
    }
    pthread_mutex_unlock(&crew->mutex);
    return NULL;
}

/* Signals are the main thread's: these threads are started with all of them blocked. */
static void start_threads(struct crew *crew, int count)
{
    sigset_t all, before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    while (crew->thread_count < count && pthread_create(&crew->threads[crew->thread_count], NULL, run, crew) == 0) {
        crew->thread_count++;
    }
    pthread_sigmask(SIG_SETMASK, &before, NULL);
}

struct crew *crew_start(int threads, size_t capacity, void (*work)(void *context, void *item), void *context)
{
    struct crew *crew = calloc(1, sizeof(*crew) + capacity * sizeof(crew->places[0]));
    if (!crew) {
        return NULL;
    }
    crew->threads = calloc((size_t)threads, sizeof(*crew->threads));
    if (!crew->threads) {
        free(crew);
        return NULL;
    }
    crew->work = work;
    crew->context = context;
    crew->capacity = capacity;
    pthread_mutex_init(&crew->mutex, NULL);
    pthread_cond_init(&crew->put, NULL);
    pthread_cond_init(&crew->done, NULL);
    start_threads(crew, threads);
    return crew;
}

size_t crew_count(const struct crew *crew) { return crew->end - crew->first; }

void crew_put(struct crew *crew, void *item)
{
    if (crew->thread_count == 0) {
        crew->work(crew->context, item);
    }
    pthread_mutex_lock(&crew->mutex);
    crew->places[crew->end++ % crew->capacity] = (struct place){.item = item, .done = crew->thread_count == 0};
    pthread_cond_signal(&crew->put);
    pthread_mutex_unlock(&crew->mutex);
}

void *crew_take(struct crew *crew, bool wait)
{
    if (crew_count(crew) == 0) {
        return NULL;
    }
    pthread_mutex_lock(&crew->mutex);
    struct place *place = &crew->places[crew->first % crew->capacity];
    while (wait && !place->done) {
        pthread_cond_wait(&crew->done, &crew->mutex);
    }
    void *item = place->done ? place->item : NULL;
    crew->first += item != NULL;
    pthread_mutex_unlock(&crew->mutex);
    return item;
}

void crew_stop(struct crew *crew)
{
    if (!crew) {
        return;
    }
    pthread_mutex_lock(&crew->mutex);
    crew->quit = true;
    pthread_cond_broadcast(&crew->put);
    pthread_mutex_unlock(&crew->mutex);
    for (int i = 0; i < crew->thread_count; i++) {
        pthread_join(crew->threads[i], NULL);
    }
    pthread_cond_destroy(&crew->done);
    pthread_cond_destroy(&crew->put);
    pthread_mutex_destroy(&crew->mutex);
    free(crew->threads);
    free(crew);
}
