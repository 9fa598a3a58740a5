/* load.c: particles from a file or from standard input, as the options say. */
#include "load.h"

#include "program.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

static void tell(void *user, enum mns_log_level level, const char *text)
{
    const struct options *options = user;
    if (level == MNS_LOG_WARNING && !options->quiet) {
        program_warn("%s", text);
    } else if (level > MNS_LOG_WARNING && options->verbose) {
        program_say("%s", text);
    } /* errors come back as messages */
}

struct mns_log program_log(const struct options *options) { return (struct mns_log){.message = tell, .user = (void *)options}; }

int program_renderer(mns_renderer **out, const struct options *options)
{
    struct mns_renderer_params params;
    struct mns_message message;
    mns_renderer_params_init(&params);
    params.backend = options->backend;
    params.isa = options->isa;
    params.threads = options->threads;
    params.log = program_log(options);
    for (size_t i = 0; i < options->layer_count; i++) {
        enum mns_layer layer = options->layers[i].layer;
        params.passes |= layer == MNS_LAYER_VELOCITY || layer == MNS_LAYER_MOTION || layer == MNS_LAYER_ID;
    }
    return mns_renderer_create(out, &params, &message) == MNS_OK ? STATUS_DONE : program_fail("%s", message.text);
}

int program_classifier(mns_classifier **out, const struct options *options)
{
    struct mns_classifier_params params;
    struct mns_message message;
    mns_classifier_params_init(&params);
    params.threads = options->threads;
    params.log = program_log(options);
    return mns_classifier_create(out, &params, &message) == MNS_OK ? STATUS_DONE : program_fail("%s", message.text);
}

int program_anisotropy(mns_anisotropy **out, const struct options *options)
{
    struct mns_anisotropy_params params;
    struct mns_message message;
    *out = NULL;
    if (!options->params.anisotropy) {
        return STATUS_DONE;
    }
    mns_anisotropy_params_init(&params);
    params.isa = options->isa;
    params.threads = options->threads;
    params.log = program_log(options);
    return mns_anisotropy_create(out, &params, &message) == MNS_OK ? STATUS_DONE : program_fail("%s", message.text);
}

enum { KEPT = sizeof(((struct load_notes *)0)->first) / sizeof(struct load_note) };

static void keep(void *user, enum mns_log_level level, const char *text)
{
    struct load_notes *notes = user;
    if (notes->count++ < KEPT) {
        struct load_note *note = &notes->first[notes->count - 1];
        note->level = level;
        snprintf(note->message.text, sizeof(note->message.text), "%s", text);
    }
}

void load_tell(const struct load_notes *notes, const char *path, const struct options *options)
{
    for (size_t i = 0; i < notes->count && i < KEPT; i++) {
        tell((void *)options, notes->first[i].level, notes->first[i].message.text);
    }
    if (notes->count > KEPT && !options->quiet) {
        program_warn("%s: and %zu warnings more", path, notes->count - KEPT);
    }
}

/* All of standard input; NULL: message says why. */
static void *read_standard_input(size_t *size, struct mns_message *message)
{
    char *data = NULL;
    size_t capacity = 0, used = 0, got;
    do {
        size_t wanted = capacity ? 2 * capacity : 1 << 20;
        char *grown = wanted > capacity ? realloc(data, wanted) : NULL;
        if (!grown) {
            free(data);
            snprintf(message->text, sizeof(message->text), "standard input: out of memory after %zu bytes", used);
            return NULL;
        }
        data = grown;
        capacity = wanted;
        errno = 0;
        got = fread(data + used, 1, capacity - used, stdin);
        used += got;
    } while (used == capacity);
    if (ferror(stdin)) {
        free(data);
        snprintf(message->text, sizeof(message->text), "standard input: cannot be read: %s", strerror(errno ? errno : EIO));
        return NULL;
    }
    *size = used;
    return data;
}

mns_result load_particles_quietly(mns_particle_set **out, const char *path, const struct options *options, struct load_notes *notes,
                                  struct mns_message *message)
{
    *out = NULL;
    notes->count = 0;
    struct mns_read_params params;
    mns_read_params_init(&params);
    params.format = options->format;
    params.roles = options->roles;
    params.role_count = options->role_count;
    params.where = options->where;
    params.log = (struct mns_log){.message = keep, .user = notes};
    if (strcmp(path, "-") != 0) {
        return mns_particle_set_read(out, path, &params, message);
    }
    size_t size;
    void *data = read_standard_input(&size, message);
    mns_result result = data ? mns_particle_set_read_memory(out, data, size, "standard input", &params, message) : MNS_ERR_IO;
    free(data);
    return result;
}

mns_result load_particles(mns_particle_set **out, const char *path, const struct options *options, struct mns_message *message)
{
    struct load_notes notes;
    mns_result result = load_particles_quietly(out, path, options, &notes, message);
    if (result == MNS_OK) {
        load_tell(&notes, path, options);
    }
    return result;
}
