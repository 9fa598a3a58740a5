/* sink.c: pictures on their way to their files. */
#include "sink.h"

#include "crew.h"
#include "program.h"

#include <stdatomic.h>
#include <stdlib.h>

/* Files are packed by one core each, so two at a time; a stream has one end. One picture more is drawn, and one waits. */
enum { WRITERS = 2, PICTURES = WRITERS + 2 };

/* Bytes of a picture beyond which no more than two are in memory. */
static const size_t LARGE = (size_t)256 << 20;

struct sink {
    const struct outputs *outputs;
    void (*report)(void *user, const struct picture *picture);
    void *user;
    struct crew *crew;
    struct picture *idle[PICTURES];
    size_t idle_count, made, most; /* pictures: idle, that have memory, that may */
    atomic_bool failed;            /* what comes later is not written */
    struct picture pictures[PICTURES];
};

static void write_picture(void *context, void *item)
{
    struct sink *sink = context;
    struct picture *picture = item;
    picture->failed = atomic_load(&sink->failed);
    picture->message.text[0] = '\0';
    if (picture->failed) {
        return;
    }
    double start = program_seconds();
    picture->failed = !outputs_write(sink->outputs, picture->images, picture->number, &picture->camera, &picture->message);
    picture->times.write_ms = 1e3 * (program_seconds() - start);
    if (picture->failed) {
        atomic_store(&sink->failed, true);
    }
}

struct sink *sink_start(const struct outputs *outputs, size_t count, void (*report)(void *user, const struct picture *picture), void *user)
{
    struct sink *sink = calloc(1, sizeof(*sink));
    int writers = outputs_in_order(outputs) ? 1 : WRITERS;
    if (sink) {
        sink->outputs = outputs;
        sink->report = report;
        sink->user = user;
        sink->most = outputs_bytes(outputs) > LARGE ? 2 : (size_t)writers + 2;
        sink->most = count < sink->most ? count : sink->most;
        sink->crew = crew_start(writers, PICTURES, write_picture, sink);
    }
    if (!sink || !sink->crew) {
        free(sink);
        program_fail("out of memory");
        return NULL;
    }
    return sink;
}

/* Takes back the oldest picture put, and reports it. */
static bool collect_one(struct sink *sink, bool wait)
{
    struct picture *picture = crew_take(sink->crew, wait);
    if (picture) {
        sink->report(sink->user, picture);
        sink->idle[sink->idle_count++] = picture;
    }
    return picture != NULL;
}

void sink_collect(struct sink *sink, bool wait)
{
    while (collect_one(sink, wait)) {
    }
}

struct picture *sink_take(struct sink *sink)
{
    sink_collect(sink, false);
    if (sink->idle_count == 0 && sink->made < sink->most) {
        struct picture *picture = &sink->pictures[sink->made++];
        return outputs_images(sink->outputs, picture->images) == STATUS_DONE ? picture : NULL;
    }
    if (sink->idle_count == 0) {
        collect_one(sink, true);
    }
    return sink->idle[--sink->idle_count];
}

void sink_put(struct sink *sink, struct picture *picture) { crew_put(sink->crew, picture); }

void sink_drop(struct sink *sink, struct picture *picture) { sink->idle[sink->idle_count++] = picture; }

void sink_stop(struct sink *sink)
{
    if (!sink) {
        return;
    }
    sink_collect(sink, true);
    crew_stop(sink->crew);
    for (size_t i = 0; i < sink->made; i++) {
        outputs_free_images(sink->outputs, sink->pictures[i].images);
    }
    free(sink);
}
