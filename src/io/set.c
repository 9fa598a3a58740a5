/* set.c: the arrays of a particle set: adding pieces, compaction, access. */
#include "io/set.h"

#include <stdio.h>
#include <string.h>

static size_t element_bytes(const struct attribute *attribute)
{
    return mns_type_size(attribute->is.type) * (size_t)attribute->is.components;
}

static void free_attribute(struct memory *memory, struct attribute *attribute)
{
    size_t bytes = attribute->capacity * element_bytes(attribute);
    if (attribute->capacity > 0) {
        mns_memory_put(memory, attribute->data, bytes, 1);
    }
    mns_memory_put(memory, (void *)(uintptr_t)attribute->is.name, strlen(attribute->is.name) + 1, 1);
}

struct attribute *mns_set_find(const mns_particle_set *set, const char *name, size_t length)
{
    for (size_t i = 0; i < set->attribute_count; i++) {
        struct attribute *attribute = &set->attributes[i];
        if (!attribute->dropped && !attribute->hidden && strlen(attribute->is.name) == length &&
            memcmp(attribute->is.name, name, length) == 0) {
            return attribute;
        }
    }
    return NULL;
}

void mns_set_list(const mns_particle_set *set, char *text, size_t size)
{
    size_t used = 0;
    snprintf(text, size, "nothing");
    for (size_t i = 0; i < set->attribute_count; i++) {
        const struct attribute *attribute = &set->attributes[i];
        char item[160];
        if (attribute->dropped || attribute->hidden) {
            continue;
        }
        if (attribute->is.components > 1) {
            snprintf(item, sizeof(item), "%s%.120s[%d]", used ? ", " : "", attribute->is.name, attribute->is.components);
        } else {
            snprintf(item, sizeof(item), "%s%.120s", used ? ", " : "", attribute->is.name);
        }
        if (used + strlen(item) + sizeof(", ...") > size) {
            snprintf(text + used, size - used, ", ...");
            return;
        }
        memcpy(text + used, item, strlen(item) + 1);
        used += strlen(item);
    }
}

/* ---- filling ---- */

/* Ends the piece in hand: an attribute that it or an earlier one lacks goes. */
void mns_set_end(struct read_context *context)
{
    mns_particle_set *set = context->set;
    size_t kept = 0;
    for (size_t i = 0; i < set->attribute_count; i++) {
        struct attribute *attribute = &set->attributes[i];
        bool lacking = attribute->filled != set->count;
        if (lacking && !attribute->dropped) {
            mns_read_warn(context, "'%s' is left out: not all pieces have it", attribute->is.name);
        }
        if (lacking || attribute->dropped) {
            free_attribute(&set->memory, attribute);
        } else {
            set->attributes[kept++] = *attribute;
        }
    }
    set->attribute_count = set->listed_count = kept;
    set->piece_count = 0;
}

mns_result mns_set_begin(struct read_context *context, size_t count)
{
    mns_particle_set *set = context->set;
    if (set->count > 0 || set->attribute_count > 0) {
        mns_set_end(context);
    }
    if (count > SIZE_MAX / 16 - set->count) {
        return mns_read_fail(context, MNS_ERR_BAD_DATA, "says that it holds %zu particles, which no memory holds", count);
    }
    set->piece_count = count;
    set->count += count;
    return MNS_OK;
}

static struct attribute *new_attribute(struct read_context *context, const char *name, enum mns_type type, int components)
{
    mns_particle_set *set = context->set;
    if (set->attribute_count >= ATTRIBUTE_MAX) {
        mns_read_fail(context, MNS_ERR_BAD_DATA, "has more than %d attributes", (int)ATTRIBUTE_MAX);
        return NULL;
    }
    if (set->attribute_count == set->attribute_capacity) {
        size_t capacity = set->attribute_capacity ? 2 * set->attribute_capacity : 16;
        struct attribute *larger = mns_read_alloc(context, capacity, sizeof(*larger));
        if (!larger) {
            return NULL;
        }
        if (set->attribute_count > 0) {
            memcpy(larger, set->attributes, set->attribute_count * sizeof(*larger));
        }
        if (set->attribute_capacity > 0) {
            mns_read_free(context, set->attributes, set->attribute_capacity, sizeof(*larger));
        }
        set->attributes = larger;
        set->attribute_capacity = capacity;
    }
    size_t size = strlen(name) + 1;
    char *copy = mns_read_alloc(context, size, 1);
    if (!copy) {
        return NULL;
    }
    memcpy(copy, name, size);
    struct attribute *attribute = &set->attributes[set->attribute_count++];
    *attribute = (struct attribute){.is = {.name = copy, .type = type, .components = components}};
    return attribute;
}

/* Gives an attribute room for `particles`, contents kept. */
static bool grow(struct read_context *context, struct attribute *attribute, size_t particles)
{
    size_t bytes = element_bytes(attribute), capacity = attribute->capacity + attribute->capacity / 2;
    if (capacity < particles) {
        capacity = particles;
    }
    if (capacity == 0) {
        capacity = 1;
    }
    uint8_t *data = mns_read_alloc(context, capacity, bytes);
    if (!data) {
        return false;
    }
    if (attribute->filled > 0) {
        memcpy(data, attribute->data, attribute->filled * bytes);
    }
    if (attribute->capacity > 0) {
        mns_read_free(context, attribute->data, attribute->capacity, bytes);
    }
    attribute->data = data;
    attribute->is.data = data;
    attribute->capacity = capacity;
    return true;
}

/* The attribute that the piece in hand adds to, with its first particle at `filled`. One that cannot be kept is marked dropped, and gets an
 * array of its own so that the reader may fill it all the same. */
static struct attribute *attribute_for(struct read_context *context, const char *name, enum mns_type type, int components)
{
    mns_particle_set *set = context->set;
    size_t before = set->count - set->piece_count;
    struct attribute *attribute = mns_set_find(set, name, strlen(name));
    if (components < 1 || components > 1 << 20 || mns_type_size(type) == 0) {
        mns_read_fail(context, MNS_ERR_BAD_DATA, "'%s' has %d components per particle", name, components);
        return NULL;
    }
    if (!attribute) {
        attribute = new_attribute(context, name, type, components);
        if (attribute && before > 0) {
            if (set->piece_count > 0) {
                mns_read_warn(context, "'%s' is left out: not all pieces have it", name);
            }
            attribute->dropped = true;
        }
        return attribute;
    }
    bool same = attribute->is.type == type && attribute->is.components == components;
    if (attribute->filled == before && same) {
        return attribute;
    }
    if (attribute->filled == before && before == 0) { /* so far only empty pieces had it */
        mns_read_free(context, attribute->data, attribute->capacity, element_bytes(attribute));
        attribute->capacity = 0;
        attribute->is.type = type;
        attribute->is.components = components;
        return attribute;
    }
    if (set->piece_count > 0) {
        bool twice = attribute->filled != before;
        mns_read_warn(context, twice ? "'%s' is there twice: the first is used" : "'%s' is left out: its type differs between pieces",
                      name);
        attribute->dropped = !twice;
    }
    attribute = new_attribute(context, name, type, components);
    if (attribute) {
        attribute->dropped = true;
    }
    return attribute;
}

void *mns_set_add(struct read_context *context, const char *name, enum mns_type type, int components)
{
    mns_particle_set *set = context->set;
    struct attribute *attribute = attribute_for(context, name, type, components);
    if (!attribute) {
        return NULL;
    }
    size_t start = attribute->dropped ? 0 : attribute->filled;
    size_t end = start + set->piece_count;
    if ((attribute->capacity < end || attribute->capacity == 0) && !grow(context, attribute, end)) {
        return NULL;
    }
    attribute->filled = end;
    return attribute->data + start * element_bytes(attribute);
}

struct attribute *mns_set_extra(struct read_context *context, const char *name, enum mns_type type, int components, bool hidden)
{
    mns_particle_set *set = context->set;
    struct attribute *attribute = new_attribute(context, name, type, components);
    if (!attribute || !grow(context, attribute, set->count)) {
        return NULL;
    }
    attribute->filled = set->count;
    attribute->hidden = hidden;
    if (!hidden) {
        set->listed_count = set->attribute_count;
    }
    return attribute;
}

bool mns_set_view(struct read_context *context, const char *name, enum mns_type type, int components, const uint8_t *data)
{
    mns_particle_set *set = context->set;
    bool aligned = (uintptr_t)data % mns_type_size(type) == 0;
    if (context->file_is_ours && aligned && set->count == set->piece_count && set->count > 0 && !mns_set_find(set, name, strlen(name))) {
        struct attribute *attribute = new_attribute(context, name, type, components);
        if (!attribute) {
            return false;
        }
        attribute->data = (uint8_t *)(uintptr_t)data; /* ours: compaction may write to it */
        attribute->is.data = data;
        attribute->filled = set->count;
        context->file_stays = true;
        return true;
    }
    void *copy = mns_set_add(context, name, type, components);
    if (copy && set->piece_count > 0) {
        memcpy(copy, data, set->piece_count * (size_t)components * mns_type_size(type));
    }
    return copy != NULL;
}

bool mns_set_keep_file(struct read_context *context, struct bytes file)
{
    mns_particle_set *set = context->set;
    if (set->file_blocks == set->file_capacity) {
        size_t capacity = set->file_capacity ? 2 * set->file_capacity : 4;
        struct block *larger = mns_read_alloc(context, capacity, sizeof(*larger));
        if (!larger) {
            return false;
        }
        if (set->file_capacity > 0) {
            memcpy(larger, set->files, set->file_blocks * sizeof(*larger));
            mns_read_free(context, set->files, set->file_capacity, sizeof(*larger));
        }
        set->files = larger;
        set->file_capacity = capacity;
    }
    set->files[set->file_blocks++] = (struct block){(void *)(uintptr_t)file.data, file.size};
    return true;
}

/* ---- compaction ---- */

/* Moves the runs of kept particles together. */
static void compact(uint8_t *data, size_t bytes, const uint8_t *keep, size_t count)
{
    size_t out = 0;
    for (size_t i = 0; i < count;) {
        if (!keep[i]) {
            i++;
            continue;
        }
        const uint8_t *end = memchr(keep + i, 0, count - i);
        size_t run = (end ? (size_t)(end - keep) : count) - i;
        memmove(data + out * bytes, data + i * bytes, run * bytes);
        out += run;
        i += run;
    }
}

void mns_set_compact(mns_particle_set *set, const uint8_t *keep)
{
    size_t kept = 0;
    for (size_t i = 0; i < set->count; i++) {
        kept += keep[i] != 0;
    }
    if (kept == set->count) {
        return;
    }
    for (size_t i = 0; i < set->attribute_count; i++) {
        compact(set->attributes[i].data, element_bytes(&set->attributes[i]), keep, set->count);
    }
    set->count = kept;
}

/* ---- access ---- */

void mns_set_free(mns_particle_set *set)
{
    struct memory *memory = &set->memory;
    for (size_t i = 0; i < set->attribute_count; i++) {
        free_attribute(memory, &set->attributes[i]);
    }
    if (set->attribute_capacity > 0) {
        mns_memory_put(memory, set->attributes, set->attribute_capacity * sizeof(*set->attributes), 1);
    }
    for (size_t i = 0; i < set->file_blocks; i++) {
        mns_memory_put(memory, set->files[i].data, set->files[i].size, 1);
    }
    if (set->file_capacity > 0) {
        mns_memory_put(memory, set->files, set->file_capacity * sizeof(*set->files), 1);
    }
}

void mns_particle_set_destroy(mns_particle_set **set)
{
    if (!set || !*set) {
        return;
    }
    mns_set_free(*set);
    struct memory memory = (*set)->memory;
    mns_memory_put(&memory, *set, 1, sizeof(**set));
    *set = NULL;
}

const struct mns_particles *mns_particle_set_particles(const mns_particle_set *set) { return &set->particles; }

const char *mns_particle_set_format(const mns_particle_set *set) { return set->format; }

size_t mns_particle_set_file_count(const mns_particle_set *set) { return set->file_count; }

size_t mns_particle_set_dropped(const mns_particle_set *set) { return set->dropped; }

size_t mns_particle_set_attribute_count(const mns_particle_set *set) { return set->listed_count; }

const struct mns_attribute *mns_particle_set_attribute(const mns_particle_set *set, size_t index)
{
    return index < set->listed_count ? &set->attributes[index].is : NULL;
}
