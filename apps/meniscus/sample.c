/* sample.c: `meniscus sample`: finds the spacing at which a shape holds as many particles as are wanted, and writes them. */
#include "sample.h"

#include "convert.h"

#include "options.h"
#include "program.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Halvings, after which the spacing is as exact as a double; and growths by a quarter to get beyond the spacing sought, which a shape of
 * one particle never does. */
enum { SEARCH_STEPS = 60, GROWTHS = 24 };

enum { BYTES = 32 /* of a particle: position, velocity, density, id */ };

double sample_hash(uint64_t a, uint64_t b, uint64_t c)
{
    uint64_t x = a * 0x9e3779b97f4a7c15u ^ (b + 0x632be59bd9b4e019u) * 0xbf58476d1ce4e5b9u ^ (c + 1) * 0x94d049bb133111ebu;
    x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9u; /* the finisher of SplitMix64 */
    x = (x ^ x >> 27) * 0x94d049bb133111ebu;
    return (double)((x ^ x >> 31) >> 11) * 0x1p-53;
}

void sample_count(struct sample_sink *sink, size_t inside, size_t outside)
{
    sink->inside += inside;
    sink->outside += outside;
}

void sample_put(struct sample_sink *sink, const double position[3], const double velocity[3], double density, bool inside)
{
    if (sink->counting) {
        sample_count(sink, inside, !inside);
        return;
    }
    if (inside || sink->thin_all) { /* evenly spread over the candidates */
        double share = (double)sink->surplus / (double)sink->of, c = (double)sink->seen++;
        if (floor((c + 1) * share) > floor(c * share) && sink->surplus > 0) {
            return;
        }
    }
    size_t i = sink->kept++;
    for (int k = 0; k < 3; k++) {
        sink->position[3 * i + (size_t)k] = (float)position[k];
        sink->velocity[3 * i + (size_t)k] = (float)velocity[k];
    }
    sink->density[i] = (float)density;
}

static struct sample_sink count_at(const struct sample_shape *shape, double spacing)
{
    struct sample_sink sink = {.counting = true};
    shape->place(&sink, spacing);
    return sink;
}

static size_t total_at(const struct sample_shape *shape, double spacing)
{
    struct sample_sink sink = count_at(shape, spacing);
    return sink.inside + sink.outside;
}

/* The largest spacing found that gives at least `wanted` particles, with few to spare. */
static double find_spacing(const struct sample_shape *shape, size_t wanted, struct sample_sink *counted)
{
    double guess = cbrt(shape->volume / (double)wanted), fine = guess, coarse = guess;
    while (*counted = count_at(shape, fine), counted->inside + counted->outside < wanted && !program_signal()) {
        coarse = fine;
        fine *= 0.8;
    }
    for (int i = 0; i < GROWTHS && !program_signal() && (coarse <= fine || total_at(shape, coarse) >= wanted); i++) {
        coarse = fmax(coarse, fine) * 1.25;
    }
    *counted = count_at(shape, fine);
    for (int i = 0; i < SEARCH_STEPS && counted->inside + counted->outside > wanted + wanted / 2000 && !program_signal(); i++) {
        double middle = 0.5 * (fine + coarse);
        struct sample_sink there = count_at(shape, middle);
        if (there.inside + there.outside >= wanted) {
            fine = middle;
            *counted = there;
        } else {
            coarse = middle;
        }
    }
    return fine;
}

static bool get_memory(struct sample_sink *sink, size_t count)
{
    sink->position = malloc(count * 3 * sizeof(float));
    sink->velocity = malloc(count * 3 * sizeof(float));
    sink->density = malloc(count * sizeof(float));
    return sink->position && sink->velocity && sink->density;
}

const struct sample_shape *sample_find(const char *name)
{
    const struct sample_shape *shape = sample_shapes;
    while (shape->name && strcmp(shape->name, name) != 0) {
        shape++;
    }
    return shape->name ? shape : NULL;
}

int sample_fill(struct sample_sink *sink, const struct sample_shape *shape, size_t count, const char *name)
{
    struct sample_sink counted;
    *sink = (struct sample_sink){0};
    double spacing = find_spacing(shape, count, &counted);
    if (program_signal()) {
        return program_stopped();
    }
    sink->surplus = counted.inside + counted.outside - count;
    sink->thin_all = counted.inside < sink->surplus;
    sink->of = sink->thin_all ? counted.inside + counted.outside : counted.inside;
    if (!get_memory(sink, count)) {
        return program_fail("%s: out of memory for %zu particles of %d bytes", name, count, (int)BYTES);
    }
    shape->place(sink, spacing);
    return program_signal() ? program_stopped() : STATUS_DONE;
}

void sample_free(struct sample_sink *sink)
{
    free(sink->position);
    free(sink->velocity);
    free(sink->density);
    *sink = (struct sample_sink){0};
}

static int write_sample(const char *path, const struct sample_sink *sink)
{
    uint32_t *ids = malloc(sink->kept * sizeof(*ids));
    if (!ids) {
        return program_fail("%s: out of memory for %zu particles of %d bytes", path, sink->kept, (int)BYTES);
    }
    for (size_t i = 0; i < sink->kept; i++) {
        ids[i] = (uint32_t)i;
    }
    struct mns_particles particles;
    struct mns_message message;
    mns_particles_init(&particles);
    particles.count = sink->kept;
    particles.position = (struct mns_attr){.data = sink->position, .type = MNS_F32};
    particles.velocity = (struct mns_attr){.data = sink->velocity, .type = MNS_F32};
    particles.density = (struct mns_attr){.data = sink->density, .type = MNS_F32};
    particles.id = (struct mns_attr){.data = ids, .type = MNS_U32};
    mns_result result = mns_particles_write(path, &particles, &message);
    free(ids);
    return result == MNS_OK ? STATUS_DONE : program_fail("%s", message.text);
}

static int make(const struct sample_shape *shape, size_t count, const char *path)
{
    struct sample_sink sink;
    int status = sample_fill(&sink, shape, count, path);
    status = status == STATUS_DONE ? write_sample(path, &sink) : status;
    sample_free(&sink);
    return status;
}

int command_sample(struct options *options)
{
    if (options->input_count != 1 || !options->particles || !options->output) {
        return program_usage("sample needs a name, a number and a file: meniscus sample NAME --particles N -o FILE");
    }
    const char *name = options->inputs[0];
    if (convert_check_format(options->output) != STATUS_DONE) {
        return STATUS_USAGE;
    }
    const struct sample_shape *shape = sample_find(name);
    if (shape) {
        int status = program_check_place(options->output);
        status = status == STATUS_DONE ? program_check_memory(options->output, BYTES * (double)options->particles) : status;
        program_catch_interrupts();
        return status == STATUS_DONE ? make(shape, (size_t)options->particles, options->output) : status;
    }
    char list[128] = "";
    for (shape = sample_shapes; shape->name; shape++) {
        size_t used = strlen(list);
        snprintf(list + used, sizeof(list) - used, "%s%s", used ? ", " : "", shape->name);
    }
    return program_usage("there is no sample '%s'; there are %s", name, list);
}
