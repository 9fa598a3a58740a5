/* memory.h: the caller's allocator with a running count, and 64-byte alignment for everything. */
#ifndef MNS_CORE_MEMORY_H
#define MNS_CORE_MEMORY_H

#include <meniscus/common.h>

struct memory {
    struct mns_allocator allocator;
    size_t bytes, peak_bytes; /* held now, and at most */
};

void mns_memory_init(struct memory *memory, const struct mns_allocator *allocator); /* NULL or empty: the C library's */
void *mns_memory_get(struct memory *memory, size_t count, size_t size);             /* NULL: out of memory or overflow. Not cleared */
void mns_memory_put(struct memory *memory, void *block, size_t count, size_t size); /* block NULL is fine */

/* block, or in its place a new one that holds at least count elements of size bytes: *capacity (elements) grows by half steps, contents are
 * lost. NULL: out of memory, block given back and *capacity 0. */
void *mns_memory_reserve(struct memory *memory, void *block, size_t *capacity, size_t count, size_t size);

#endif
