/* atomic_file.h: a file that appears whole or not at all: written beside its place under another name, then renamed. */
#ifndef MNS_IO_ATOMIC_FILE_H
#define MNS_IO_ATOMIC_FILE_H

#include <meniscus/common.h>

#include <stdbool.h>

struct atomic_file; /* opaque */

/* Starts a file that will stand at path. On failure *out is NULL and message (may be NULL) says "PATH: cannot be written: why". */
mns_result mns_atomic_begin(struct atomic_file **out, const char *path, struct mns_message *message);

/* Adds bytes. false: the disk is full or the like; what follows is ignored and mns_atomic_commit tells it. */
bool mns_atomic_write(struct atomic_file *file, const void *data, size_t size);

/* Bytes written so far. */
uint64_t mns_atomic_size(const struct atomic_file *file);

/* Ends the file and puts it in its place. On failure nothing is left behind and what stood at path still does. Frees file. */
mns_result mns_atomic_commit(struct atomic_file *file, struct mns_message *message);

/* Gives up: nothing is left behind. Frees file; NULL is fine. */
void mns_atomic_abort(struct atomic_file *file);

#endif
