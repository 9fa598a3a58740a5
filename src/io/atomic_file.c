/* atomic_file.c: writing beside and renaming. */
#ifndef _WIN32
#define _POSIX_C_SOURCE   200809L
#define _FILE_OFFSET_BITS 64
#endif

#include "io/atomic_file.h"

#include "core/message.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifdef _WIN32
#include <process.h>
#define process_id _getpid
#else
#include <sys/stat.h>
#include <unistd.h>
#define process_id getpid
#endif

enum { TRIES = 100 };

struct atomic_file {
    FILE *stream;
    uint64_t size;
    int error;     /* errno of the first failure; 0: none */
    bool in_place; /* path is no plain file (/dev/stdout, a pipe): written to directly */
    char *path, *temporary;
};

static void free_file(struct atomic_file *file)
{
    free(file->path);
    free(file->temporary);
    free(file);
}

static mns_result fail(struct mns_message *message, const char *path, int error)
{
    return mns_fail(message, MNS_ERR_IO, "%s: cannot be written: %s", path, error ? strerror(error) : "unknown error");
}

/* Whether path names something that exists and is neither a file nor a folder: renaming onto a device would replace it. */
static bool is_special(const char *path)
{
#ifdef _WIN32
    (void)path;
    return false;
#else
    struct stat status;
    return stat(path, &status) == 0 && !S_ISREG(status.st_mode) && !S_ISDIR(status.st_mode);
#endif
}

static bool is_folder(const char *path)
{
#ifdef _WIN32
    (void)path;
    return false; /* renaming onto it fails */
#else
    struct stat status;
    return stat(path, &status) == 0 && S_ISDIR(status.st_mode);
#endif
}

/* Opens a new file beside path: PATH.tmp-PID-N. */
static FILE *open_beside(struct atomic_file *file)
{
    size_t size = strlen(file->path) + 48;
    file->temporary = malloc(size);
    if (!file->temporary) {
        errno = ENOMEM;
        return NULL;
    }
    FILE *stream = NULL;
    for (int i = 0; !stream && i < TRIES; i++) {
        snprintf(file->temporary, size, "%s.tmp-%ld-%d", file->path, (long)process_id(), i);
        stream = fopen(file->temporary, "wbx");
        if (!stream && errno != EEXIST) {
            break;
        }
    }
    return stream;
}

mns_result mns_atomic_begin(struct atomic_file **out, const char *path, struct mns_message *message)
{
    *out = NULL;
    if (is_folder(path)) {
        return mns_fail(message, MNS_ERR_IO, "%s: cannot be written: it is a folder", path);
    }
    struct atomic_file *file = calloc(1, sizeof(*file));
    if (!file) {
        return mns_fail(message, MNS_ERR_OUT_OF_MEMORY, "%s: out of memory", path);
    }
    file->path = malloc(strlen(path) + 1);
    if (!file->path) {
        free_file(file);
        return mns_fail(message, MNS_ERR_OUT_OF_MEMORY, "%s: out of memory", path);
    }
    memcpy(file->path, path, strlen(path) + 1);
    file->in_place = is_special(path);
    file->stream = file->in_place ? fopen(path, "wb") : open_beside(file);
    if (!file->stream) {
        mns_result result = fail(message, path, errno);
        free_file(file);
        return result;
    }
    *out = file;
    return MNS_OK;
}

bool mns_atomic_write(struct atomic_file *file, const void *data, size_t size)
{
    if (file->error) {
        return false;
    }
    errno = 0;
    if (size > 0 && fwrite(data, 1, size, file->stream) != size) {
        file->error = errno ? errno : EIO;
        return false;
    }
    file->size += size;
    return true;
}

uint64_t mns_atomic_size(const struct atomic_file *file) { return file->size; }

static int replace(const char *from, const char *to)
{
#ifdef _WIN32
    remove(to); /* rename does not replace there */
#endif
    return rename(from, to);
}

mns_result mns_atomic_commit(struct atomic_file *file, struct mns_message *message)
{
    errno = 0;
    if (fclose(file->stream) != 0 && !file->error) { /* buffered bytes may find the disk full only now */
        file->error = errno ? errno : EIO;
    }
    if (!file->error && !file->in_place && replace(file->temporary, file->path) != 0) {
        file->error = errno ? errno : EIO;
    }
    mns_result result = MNS_OK;
    if (file->error) {
        if (!file->in_place) {
            remove(file->temporary);
        }
        result = fail(message, file->path, file->error);
    }
    free_file(file);
    return result;
}

void mns_atomic_abort(struct atomic_file *file)
{
    if (!file) {
        return;
    }
    fclose(file->stream);
    if (!file->in_place) {
        remove(file->temporary);
    }
    free_file(file);
}
