#include "fuzz.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_BYTES = 32 << 20 };

struct failing {
    size_t left; /* allocations that still succeed */
    size_t bytes;
};

static void *failing_allocate(void *user, size_t size, size_t alignment)
{
    struct failing *state = user;
    if (state->left == 0) {
        return NULL;
    }
    state->left--;
    state->bytes += size;
    return aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
}

static void failing_release(void *user, void *memory, size_t size)
{
    struct failing *state = user;
    if (memory) {
        state->bytes -= size;
    }
    free(memory);
}

static void look_at(const mns_particle_set *set)
{
    const struct mns_particles *particles = mns_particle_set_particles(set);
    unsigned char sum = 0;
    assert(particles->count == 0 || particles->position.data);
    for (size_t i = 0; i < mns_particle_set_attribute_count(set); i++) {
        const struct mns_attribute *attribute = mns_particle_set_attribute(set, i);
        const unsigned char *bytes = attribute->data;
        size_t size = particles->count * (size_t)attribute->components * mns_type_size(attribute->type);
        for (size_t k = 0; k < size; k++) {
            sum = (unsigned char)(sum + bytes[k]);
        }
    }
    volatile unsigned char used = sum;
    (void)used;
}

static void read_once(const char *format, const char *where, const uint8_t *data, size_t size, size_t allocations)
{
    struct failing state = {allocations, 0};
    struct mns_read_params params;
    struct mns_message message;
    mns_particle_set *set;
    mns_read_params_init(&params);
    params.format = format;
    params.where = where;
    params.max_bytes = MOST_BYTES;
    params.allocator = (struct mns_allocator){failing_allocate, failing_release, &state};
    mns_result result = mns_particle_set_read_memory(&set, data, size, "input", &params, &message);
    assert((result == MNS_OK) == (set != NULL));
    if (set) {
        look_at(set);
    } else if (strncmp(message.text, "input: ", 7) != 0 || strchr(message.text, '\n')) {
        abort(); /* one line that names the file */
    }
    mns_particle_set_destroy(&set);
    assert(state.bytes == 0);
}

void fuzz_read(const char *format, const char *where, const uint8_t *data, size_t size)
{
    uint32_t hash = 2166136261u;
    for (size_t i = 0; i < size; i++) {
        hash = (hash ^ data[i]) * 16777619u;
    }
    read_once(format, where, data, size, SIZE_MAX);
    read_once(format, where, data, size, hash % 24);
}
