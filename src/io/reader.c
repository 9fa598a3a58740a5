/* reader.c: from a path or bytes to a finished particle set: loads, unpacks gzip, finds the format, runs its reader, applies roles, `where`. */
#ifndef _WIN32
#define _POSIX_C_SOURCE   200809L
#define _FILE_OFFSET_BITS 64
#endif

#include "io/reader.h"

#include "core/message.h"
#include "io/set.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

#ifdef _WIN32
#define file_seek _fseeki64
#define file_tell _ftelli64
#else
#include <sys/stat.h>
#define file_seek fseeko
#define file_tell ftello
#endif

enum { HEAD_MAX = 65536, NEST_MAX = 4 };

static const char *path_of(const struct read_context *context) { return context->path ? context->path : "(memory)"; }

/* Messages are one line, whatever a file has for names. */
static void print_line(char *text, size_t size, const char *format, va_list arguments)
{
    vsnprintf(text, size, format, arguments);
    for (char *p = text; *p; p++) {
        if ((unsigned char)*p < 32 || *p == 127) {
            *p = '?';
        }
    }
}

mns_result mns_read_fail(struct read_context *context, mns_result code, const char *format, ...)
{
    char text[sizeof(context->message->text)];
    va_list arguments;
    va_start(arguments, format);
    print_line(text, sizeof(text), format, arguments);
    va_end(arguments);
    context->set->fault = code;
    return mns_fail(context->message, code, "%s: %s", path_of(context), text);
}

void mns_read_warn(struct read_context *context, const char *format, ...)
{
    const struct mns_log *log = &context->params->log;
    if (!log->message) {
        return;
    }
    struct mns_message line;
    char text[sizeof(line.text)];
    va_list arguments;
    va_start(arguments, format);
    print_line(text, sizeof(text), format, arguments);
    va_end(arguments);
    mns_fail(&line, MNS_OK, "%s: %s", path_of(context), text);
    log->message(log->user, MNS_LOG_WARNING, line.text);
}

void *mns_read_alloc(struct read_context *context, size_t count, size_t size)
{
    struct memory *memory = &context->set->memory;
    size_t limit = context->params->max_bytes;
    if (size != 0 && count > SIZE_MAX / 2 / size) {
        mns_read_fail(context, MNS_ERR_BAD_DATA, "%zu elements of %zu bytes are more than any memory holds", count, size);
        return NULL;
    }
    size_t bytes = count * size != 0 ? count * size : 1;
    if (limit != 0 && (memory->bytes > limit || bytes > limit - memory->bytes)) {
        mns_read_fail(context, MNS_ERR_OUT_OF_MEMORY, "needs %zu bytes more where %zu of the allowed %zu are taken (max_bytes)", bytes,
                      memory->bytes, limit);
        return NULL;
    }
    void *block = mns_memory_get(memory, bytes, 1);
    if (!block) {
        mns_read_fail(context, MNS_ERR_OUT_OF_MEMORY, "out of memory: %zu bytes were wanted", bytes);
    }
    return block;
}

void mns_read_free(struct read_context *context, void *memory, size_t count, size_t size)
{
    mns_memory_put(&context->set->memory, memory, count * size != 0 ? count * size : 1, 1);
}

/* ---- loading ---- */

/* A pipe, or a file that says it has no size: read to its end in growing steps. */
static mns_result read_stream(struct read_context *context, FILE *file, struct bytes *out)
{
    size_t capacity = (size_t)1 << 16, size = 0;
    uint8_t *data = mns_read_alloc(context, capacity, 1);
    while (data) {
        size += fread(data + size, 1, capacity - size, file);
        if (size < capacity) {
            break;
        }
        uint8_t *larger = mns_read_alloc(context, 2 * capacity, 1);
        if (larger) {
            memcpy(larger, data, size);
        }
        mns_read_free(context, data, capacity, 1);
        data = larger;
        capacity *= 2;
    }
    if (!data) {
        return MNS_ERR_OUT_OF_MEMORY;
    }
    uint8_t *exact = NULL;
    mns_result result = MNS_OK;
    if (ferror(file)) {
        result = mns_read_fail(context, MNS_ERR_IO, "cannot be read: %s", strerror(errno));
    } else if (!(exact = mns_read_alloc(context, size, 1))) {
        result = MNS_ERR_OUT_OF_MEMORY;
    } else {
        memcpy(exact, data, size);
    }
    mns_read_free(context, data, capacity, 1);
    *out = (struct bytes){exact, size};
    return result;
}

static mns_result read_sized(struct read_context *context, FILE *file, size_t size, struct bytes *out)
{
    uint8_t *data = mns_read_alloc(context, size, 1);
    if (!data) {
        return MNS_ERR_OUT_OF_MEMORY;
    }
    size_t got = fread(data, 1, size, file);
    if (got == size) {
        *out = (struct bytes){data, size};
        return MNS_OK;
    }
    mns_read_free(context, data, size, 1);
    if (ferror(file)) {
        return mns_read_fail(context, MNS_ERR_IO, "cannot be read: %s", strerror(errno));
    }
    return mns_read_fail(context, MNS_ERR_IO, "became shorter while it was read: %zu bytes of %zu", got, size);
}

static bool is_directory(FILE *file)
{
#ifdef _WIN32
    (void)file; /* fopen refuses directories there */
    return false;
#else
    struct stat status;
    return fstat(fileno(file), &status) == 0 && S_ISDIR(status.st_mode);
#endif
}

mns_result mns_read_file(struct read_context *context, const char *path, struct bytes *out)
{
    *out = (struct bytes){NULL, 0};
    FILE *file = fopen(path, "rb");
    if (!file) {
        return mns_read_fail(context, MNS_ERR_IO, "cannot be opened: %s", strerror(errno));
    }
    mns_result result;
    long long size = -1;
    setvbuf(file, NULL, _IONBF, 0); /* one large read into place */
    if (is_directory(file)) {
        result = mns_read_fail(context, MNS_ERR_IO, "is a directory, not a particle file");
        goto done;
    }
    if (file_seek(file, 0, SEEK_END) == 0) {
        size = (long long)file_tell(file);
        file_seek(file, 0, SEEK_SET);
    }
    if (size > 0 && (unsigned long long)size > SIZE_MAX / 2) {
        result = mns_read_fail(context, MNS_ERR_IO, "is too large for this machine: %lld bytes", size);
    } else if (size > 0) {
        result = read_sized(context, file, (size_t)size, out);
    } else {
        result = read_stream(context, file, out);
    }
done:
    fclose(file);
    return result;
}

/* ---- finding the format ---- */

static char lower(char c) { return c >= 'A' && c <= 'Z' ? (char)(c - 'A' + 'a') : c; }

static bool equal_nocase(const char *a, const char *b, size_t length)
{
    for (size_t i = 0; i < length; i++) {
        if (lower(a[i]) != lower(b[i])) {
            return false;
        }
    }
    return true;
}

/* Whether path ends in one of the space-separated extensions, with or without .gz behind it. */
static bool has_extension(const char *path, const char *extensions)
{
    size_t length = path ? strlen(path) : 0;
    if (length > 3 && equal_nocase(path + length - 3, ".gz", 3)) {
        length -= 3;
    }
    for (const char *e = extensions; *e;) {
        size_t n = strcspn(e, " ");
        if (length > n && path[length - n - 1] == '.' && equal_nocase(path + length - n, e, n)) {
            return true;
        }
        e += n;
        e += strspn(e, " ");
    }
    return false;
}

static void list_formats(char *text, size_t size)
{
    size_t used = 0;
    text[0] = '\0';
    for (size_t i = 0; mns_readers[i] && used < size; i++) {
        int n = snprintf(text + used, size - used, "%s%s", i ? ", " : "", mns_readers[i]->name);
        used += n > 0 ? (size_t)n : 0;
    }
}

static const struct mns_reader *find_reader(struct read_context *context, struct bytes file)
{
    const char *wanted = context->depth == 0 ? context->params->format : NULL;
    const struct mns_reader *named = NULL, *perhaps = NULL, *named_perhaps = NULL;
    struct bytes head = {file.data, file.size < HEAD_MAX ? file.size : HEAD_MAX};
    for (size_t i = 0; mns_readers[i]; i++) {
        const struct mns_reader *reader = mns_readers[i];
        if (wanted) {
            if (strcmp(wanted, reader->name) == 0) {
                return reader;
            }
            continue;
        }
        int sure = reader->probe(head);
        if (sure == 2) {
            return reader;
        }
        bool extension = has_extension(context->path, reader->extensions);
        if (extension && !named) {
            named = reader;
        }
        if (sure == 1 && !perhaps) {
            perhaps = reader;
        }
        if (sure == 1 && extension && !named_perhaps) {
            named_perhaps = reader;
        }
    }
    for (size_t i = 0; mns_missing_readers[i] && !wanted; i++) {
        if (mns_missing_readers[i]->probe(head) == 2) {
            return mns_missing_readers[i];
        }
    }
    if (named_perhaps || (perhaps && !named)) {
        return named_perhaps ? named_perhaps : perhaps;
    }
    char formats[256];
    list_formats(formats, sizeof(formats));
    if (wanted) {
        mns_read_fail(context, MNS_ERR_UNSUPPORTED, "cannot be read as '%s': this build reads %s", wanted, formats);
    } else if (named) {
        mns_read_fail(context, MNS_ERR_BAD_DATA,
                      "is no %s file, though its name says so: its first bytes are of no format that this build "
                      "reads (%s)",
                      named->name, formats);
    } else {
        mns_read_fail(context, MNS_ERR_BAD_DATA, "is of no format that this build reads (%s)", formats);
    }
    return NULL;
}

/* ---- reading ---- */

/* Reads a file's bytes into the set. Takes the bytes over when context->file_is_ours. */
static mns_result read_bytes(struct read_context *context, struct bytes file)
{
    mns_result result = MNS_OK;
    const struct mns_reader *reader = NULL;
    context->file_stays = false;
    if (file.size == 0) {
        result = mns_read_fail(context, MNS_ERR_BAD_DATA, "is empty");
        goto done;
    }
    if (file.size >= 2 && file.data[0] == 0x1f && file.data[1] == 0x8b) {
        uint8_t *unpacked;
        size_t size;
        result = mns_gunzip(context, file, &unpacked, &size);
        if (result != MNS_OK) {
            goto done;
        }
        if (context->file_is_ours) {
            mns_read_free(context, (void *)(uintptr_t)file.data, file.size, 1);
        }
        file = (struct bytes){unpacked, size};
        context->file_is_ours = true;
    }
    reader = find_reader(context, file);
    if (!reader) {
        result = context->params->format && context->depth == 0 ? MNS_ERR_UNSUPPORTED : MNS_ERR_BAD_DATA;
        goto done;
    }
    if (!context->set->format) {
        context->set->format = reader->name;
    }
    result = reader->read(context, file);
done:
    if (context->file_stays && mns_set_keep_file(context, file)) {
        return result;
    }
    if (context->file_stays && result == MNS_OK) {
        result = mns_read_fail(context, MNS_ERR_OUT_OF_MEMORY, "out of memory");
    }
    if (context->file_is_ours) {
        mns_read_free(context, (void *)(uintptr_t)file.data, file.size, 1);
    }
    return result;
}

char *mns_read_beside(struct read_context *context, const char *reference)
{
    size_t folder = 0;
    if (reference[0] != '/') {
        for (size_t i = 0; context->path && context->path[i]; i++) {
            if (context->path[i] == '/') {
                folder = i + 1;
            }
        }
    }
    size_t size = folder + strlen(reference) + 1;
    char *path = mns_read_alloc(context, size, 1);
    if (!path) {
        return NULL;
    }
    if (folder > 0) {
        memcpy(path, context->path, folder);
    }
    memcpy(path + folder, reference, size - folder);
    return path;
}

mns_result mns_read_referenced(struct read_context *context, const char *reference)
{
    if (!context->may_open) {
        return mns_read_fail(context, MNS_ERR_UNSUPPORTED, "names another file (%s), which reading from memory does not open", reference);
    }
    if (context->depth >= NEST_MAX) {
        return mns_read_fail(context, MNS_ERR_BAD_DATA, "is nested more than %d files deep", (int)NEST_MAX);
    }
    char *path = mns_read_beside(context, reference);
    if (!path) {
        return MNS_ERR_OUT_OF_MEMORY;
    }
    struct read_context inner = *context;
    inner.path = path;
    inner.depth = context->depth + 1;
    inner.file_is_ours = true;
    struct bytes file;
    mns_result result = mns_read_file(&inner, path, &file);
    if (result == MNS_OK) {
        result = read_bytes(&inner, file);
    }
    mns_read_free(context, path, strlen(path) + 1, 1);
    return result;
}

/* Whether a value is NaN or infinite: all bits of its exponent are set. */
static inline bool is_odd32(uint32_t bits) { return (bits & 0x7f800000u) == 0x7f800000u; }

static inline bool is_odd64(uint64_t bits) { return (bits & 0x7ff0000000000000u) == 0x7ff0000000000000u; }

static inline uint32_t bits32(const uint8_t *p)
{
    uint32_t bits;
    memcpy(&bits, p, sizeof(bits));
    return bits;
}

static inline uint64_t bits64(const uint8_t *p)
{
    uint64_t bits;
    memcpy(&bits, p, sizeof(bits));
    return bits;
}

static bool all_finite(const uint8_t *values, size_t count, enum mns_type type)
{
    unsigned odd = 0;
    if (type == MNS_F32) {
        for (size_t i = 0; i < count; i++) {
            odd |= is_odd32(bits32(values + 4 * i));
        }
    } else {
        for (size_t i = 0; i < count; i++) {
            odd |= is_odd64(bits64(values + 8 * i));
        }
    }
    return odd == 0;
}

/* Clears keep[i] where position i is not finite, and counts where that changed something. */
static size_t clear_not_finite(const uint8_t *position, size_t count, enum mns_type type, uint8_t *keep)
{
    size_t dropped = 0, bytes = 3 * mns_type_size(type);
    for (size_t i = 0; i < count; i++) {
        if (!keep[i]) {
            continue;
        }
        keep[i] = all_finite(position + i * bytes, 3, type);
        dropped += !keep[i];
    }
    return dropped;
}

static const struct attribute *find_role(const mns_particle_set *set, enum mns_role role)
{
    for (size_t i = 0; i < set->listed_count; i++) {
        if (set->attributes[i].is.role == role) {
            return &set->attributes[i];
        }
    }
    return NULL;
}

/* Applies `where` and drops positions that are not finite. */
static mns_result select_particles(struct read_context *context)
{
    mns_particle_set *set = context->set;
    const char *where = context->params->where;
    size_t count = set->count;
    const struct attribute *position = find_role(set, MNS_ROLE_POSITION);
    bool finite = !position || all_finite(position->data, 3 * count, position->is.type);
    if (finite && !where) {
        return MNS_OK;
    }
    uint8_t *keep = mns_read_alloc(context, count, 1);
    if (!keep) {
        return MNS_ERR_OUT_OF_MEMORY;
    }
    memset(keep, 1, count);
    mns_result result = where ? mns_where(context, where, keep) : MNS_OK;
    if (result == MNS_OK && !finite) {
        set->dropped = clear_not_finite(position->data, count, position->is.type, keep);
    }
    if (result == MNS_OK && set->dropped > 0) {
        mns_read_warn(context, "dropped %zu of %zu particles, whose position is NaN or infinite", set->dropped, count);
    }
    if (result == MNS_OK) {
        mns_set_compact(set, keep);
    }
    mns_read_free(context, keep, count, 1);
    return result;
}

static mns_result finish(struct read_context *context)
{
    mns_particle_set *set = context->set;
    mns_set_end(context);
    set->file_count = set->count;
    mns_result result = mns_roles_assign(context);
    if (result == MNS_OK && set->count > 0 && !find_role(set, MNS_ROLE_POSITION)) {
        char names[512];
        mns_set_list(set, names, sizeof(names));
        result = mns_read_fail(context, MNS_ERR_BAD_DATA, "has no positions; it has %s", names);
    }
    if (result == MNS_OK) {
        result = select_particles(context);
    }
    if (result == MNS_OK) {
        result = mns_roles_views(context);
    }
    return result;
}

static struct mns_read_params complete(const struct mns_read_params *given)
{
    struct mns_read_params params;
    mns_read_params_init(&params);
    if (given) {
        memcpy(&params, given, given->struct_size < sizeof(params) ? given->struct_size : sizeof(params));
        params.struct_size = sizeof(params);
    }
    return params;
}

/* path or bytes, whichever is not NULL; name: for messages. */
static mns_result read_set(mns_particle_set **out, const char *path, const struct bytes *bytes, const char *name,
                           const struct mns_read_params *given, struct mns_message *message)
{
    struct mns_message unread;
    struct mns_read_params params = complete(given);
    struct memory memory;
    if (!message) {
        message = &unread;
    }
    message->text[0] = '\0';
    mns_memory_init(&memory, &params.allocator);
    mns_particle_set *set = mns_memory_get(&memory, 1, sizeof(*set));
    if (!set) {
        return mns_fail(message, MNS_ERR_OUT_OF_MEMORY, "%s: out of memory", name ? name : "(memory)");
    }
    *set = (mns_particle_set){.memory = memory};
    mns_particles_init(&set->particles);

    struct read_context context = {
        .path = name, .may_open = path != NULL, .params = &params, .message = message, .set = set, .file_is_ours = path != NULL};
    struct bytes file = {NULL, 0};
    mns_result result = MNS_OK;
    if (path) {
        result = mns_read_file(&context, path, &file);
    } else {
        file = *bytes;
    }
    if (result == MNS_OK) {
        result = read_bytes(&context, file);
    }
    if (result == MNS_OK) {
        result = finish(&context);
    }
    if (result != MNS_OK && set->fault != MNS_OK) {
        result = set->fault; /* a reader that got NULL from mns_set_add cannot know why: the message does */
    }
    if (result != MNS_OK) {
        mns_particle_set_destroy(&set);
    }
    *out = set;
    return result;
}

mns_result mns_particle_set_read(mns_particle_set **out, const char *path, const struct mns_read_params *params,
                                 struct mns_message *message)
{
    if (!out) {
        return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "mns_particle_set_read: out is NULL");
    }
    *out = NULL;
    if (!path) {
        return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "mns_particle_set_read: path is NULL");
    }
    return read_set(out, path, NULL, path, params, message);
}

mns_result mns_particle_set_read_memory(mns_particle_set **out, const void *data, size_t size, const char *name,
                                        const struct mns_read_params *params, struct mns_message *message)
{
    if (!out) {
        return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "mns_particle_set_read_memory: out is NULL");
    }
    *out = NULL;
    if (!data && size > 0) {
        return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "mns_particle_set_read_memory: data is NULL");
    }
    const struct bytes bytes = {data, size};
    return read_set(out, NULL, &bytes, name, params, message);
}

void mns_read_params_init_sized(struct mns_read_params *params, size_t size)
{
    const struct mns_read_params defaults = {.struct_size = size};
    memset(params, 0, size);
    memcpy(params, &defaults, size < sizeof(defaults) ? size : sizeof(defaults));
}
