/* source.c: the frames of a sequence, read ahead while others are drawn. */
#include "source.h"

#include "crew.h"
#include "program.h"

#include <stdlib.h>

/* Two at a time, since reading is unpacking on one core; no more ahead than that, since frames are large. */
enum { READERS = 2, AHEAD = 2, HELD = 2, FRAMES = AHEAD + HELD };

struct source {
    const struct inputs *inputs;
    const bool *wanted;
    const struct options *options;
    const struct coloring *coloring;
    size_t next; /* input to ask for */
    struct crew *crew;
    struct source_frame *idle[FRAMES];
    size_t idle_count;
    struct source_frame frames[FRAMES];
};

static void read_frame(void *context, void *item)
{
    const struct source *source = context;
    struct source_frame *frame = item;
    const char *path = source->inputs->list[frame->input].path;
    double start = program_seconds();
    mns_result result = load_particles_quietly(&frame->set, path, source->options, &frame->notes, &frame->message);
    if (result == MNS_OK) {
        frame->particles = *mns_particle_set_particles(frame->set);
    }
    if (result == MNS_OK && source->coloring) {
        result = coloring_paint(source->coloring, frame->set, path, &frame->painted, &frame->particles, &frame->message);
    }
    if (result != MNS_OK) {
        mns_particle_set_destroy(&frame->set);
    }
    frame->read_ms = 1e3 * (program_seconds() - start);
}

/* Asks for frames until as many are on their way as may be. */
static void ask(struct source *source)
{
    while (source->idle_count > 0 && crew_count(source->crew) < AHEAD) {
        while (source->next < source->inputs->count && !source->wanted[source->next]) {
            source->next++;
        }
        if (source->next == source->inputs->count) {
            return;
        }
        struct source_frame *frame = source->idle[--source->idle_count];
        frame->input = source->next++;
        crew_put(source->crew, frame);
    }
}

struct source *source_start(const struct inputs *inputs, const bool *wanted, const struct options *options, const struct coloring *coloring)
{
    struct source *source = calloc(1, sizeof(*source));
    if (source) {
        *source = (struct source){.inputs = inputs, .wanted = wanted, .options = options, .coloring = coloring};
        source->crew = crew_start(READERS, AHEAD, read_frame, source);
    }
    if (!source || !source->crew) {
        free(source);
        program_fail("out of memory");
        return NULL;
    }
    for (size_t i = 0; i < FRAMES; i++) {
        source->idle[source->idle_count++] = &source->frames[i];
    }
    ask(source);
    return source;
}

struct source_frame *source_next(struct source *source)
{
    ask(source);
    struct source_frame *frame = crew_take(source->crew, true);
    ask(source);
    return frame;
}

void source_release(struct source *source, struct source_frame *frame)
{
    if (frame) {
        painted_free(&frame->painted);
        mns_particle_set_destroy(&frame->set);
        source->idle[source->idle_count++] = frame;
    }
}

void source_stop(struct source *source)
{
    if (!source) {
        return;
    }
    crew_stop(source->crew);
    for (size_t i = 0; i < FRAMES; i++) {
        painted_free(&source->frames[i].painted);
        mns_particle_set_destroy(&source->frames[i].set);
    }
    free(source);
}
