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
    return mns_renderer_create(out, &params, &message) == MNS_OK ? STATUS_DONE : program_fail("%s", message.text);
}

/* Warnings wait until the file has been read: a file that is refused gets its one line. */
struct held {
    const struct options *options;
    size_t count;
    struct mns_message first[8];
};

enum { HELD = sizeof(((struct held *)0)->first) / sizeof(struct mns_message) };

static void hold(void *user, enum mns_log_level level, const char *text)
{
    struct held *held = user;
    if (level != MNS_LOG_WARNING) {
        tell((void *)held->options, level, text);
    } else if (held->count++ < HELD) {
        struct mns_message *message = &held->first[held->count - 1];
        snprintf(message->text, sizeof(message->text), "%s", text);
    }
}

static void tell_held(const struct held *held, const char *path)
{
    for (size_t i = 0; i < held->count && i < HELD && !held->options->quiet; i++) {
        program_warn("%s", held->first[i].text);
    }
    if (held->count > HELD && !held->options->quiet) {
        program_warn("%s: and %zu warnings more", path, held->count - HELD);
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

mns_result load_particles(mns_particle_set **out, const char *path, const struct options *options, struct mns_message *message)
{
    *out = NULL;
    struct mns_read_params params;
    mns_read_params_init(&params);
    params.format = options->format;
    params.roles = options->roles;
    params.role_count = options->role_count;
    params.where = options->where;
    struct held held = {.options = options};
    params.log = (struct mns_log){.message = hold, .user = &held};
    mns_result result = MNS_ERR_IO;
    if (strcmp(path, "-") != 0) {
        result = mns_particle_set_read(out, path, &params, message);
    } else {
        size_t size;
        void *data = read_standard_input(&size, message);
        if (data) {
            result = mns_particle_set_read_memory(out, data, size, "standard input", &params, message);
        }
        free(data);
    }
    if (result == MNS_OK) {
        tell_held(&held, path);
    }
    return result;
}
