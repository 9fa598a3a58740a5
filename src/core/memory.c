/* memory.c: the caller's allocator with a running count. */
#include "core/memory.h"

#include "util/pages.h"

#include <stdlib.h>

enum { ALIGNMENT = 64 }; /* a cache line, and the widest vector */

static void *allocate_default(void *user, size_t size, size_t alignment)
{
    (void)user;
    size_t wanted = mns_pages_alignment(size);
    alignment = wanted > alignment ? wanted : alignment;
    if (size > SIZE_MAX - alignment) {
        return NULL;
    }
    void *block = aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
    if (block) {
        mns_pages_advise(block, size);
    }
    return block;
}

static void release_default(void *user, void *block, size_t size)
{
    (void)user;
    (void)size;
    free(block);
}

void mns_memory_init(struct memory *memory, const struct mns_allocator *allocator)
{
    *memory = (struct memory){.allocator = {.allocate = allocate_default, .release = release_default}};
    if (allocator && allocator->allocate && allocator->release) {
        memory->allocator = *allocator;
    }
}

void *mns_memory_get(struct memory *memory, size_t count, size_t size)
{
    if (size != 0 && count > (SIZE_MAX - ALIGNMENT) / size) {
        return NULL;
    }
    size_t bytes = count * size;
    void *block = memory->allocator.allocate(memory->allocator.user, bytes > 0 ? bytes : 1, ALIGNMENT);
    if (block) {
        memory->bytes += bytes;
        memory->peak_bytes = memory->bytes > memory->peak_bytes ? memory->bytes : memory->peak_bytes;
    }
    return block;
}

void mns_memory_put(struct memory *memory, void *block, size_t count, size_t size)
{
    if (block) {
        size_t bytes = count * size;
        memory->bytes -= bytes;
        memory->allocator.release(memory->allocator.user, block, bytes > 0 ? bytes : 1);
    }
}

void *mns_memory_reserve(struct memory *memory, void *block, size_t *capacity, size_t count, size_t size)
{
    if (block && *capacity >= count) {
        return block;
    }
    size_t grown = *capacity + *capacity / 2;
    size_t wanted = count > grown ? count : grown;
    mns_memory_put(memory, block, *capacity, size);
    block = mns_memory_get(memory, wanted, size);
    *capacity = block ? wanted : 0;
    return block;
}
