/* ids.c: ids in an open hash table that keeps runs of ids side by side, as simulators number their particles. */
#include "particles/ids.h"

#include "core/attr.h"
#include "util/prefetch.h"

enum { LOOKUP = 16384, AHEAD = 16, BITS_LEAST = 10 };

struct id_entry {
    int64_t id;
    uint32_t index; /* in the set of that number */
    uint32_t set;   /* 0: the entry is free */
};

struct lookup {
    const struct ids *ids;
    const struct mns_attr *id;
    size_t count;
    uint32_t *slots, *from;
};

/* Ids that are no integers are cut; what no integer can hold is -1. */
static inline int64_t id_of(const struct mns_attr *id, size_t i)
{
    if (id->type == MNS_I64 || id->type == MNS_U64) {
        int64_t value;
        memcpy(&value, (const char *)id->data + i * (id->stride ? id->stride : sizeof(value)), sizeof(value));
        return value;
    }
    double value = mns_attr_get(id, id->type, 1, i, 0);
    return value > -9e18 && value < 9e18 ? (int64_t)value : -1;
}

/* Neighbours stay neighbours, which is kind to the cache; ids further apart than the table is long are spread. */
static inline size_t home_of(const struct ids *ids, int64_t id)
{
    uint64_t key = (uint64_t)id;
    return (size_t)(key + ((key >> ids->bits) * 0x9e3779b97f4a7c15u >> (64 - ids->bits))) & (ids->capacity - 1);
}

/* The id's entry, or the free one where it belongs. The table is never full. */
static inline size_t find(const struct ids *ids, int64_t id)
{
    size_t at = home_of(ids, id);
    while (ids->entries[at].set != 0 && ids->entries[at].id != id) {
        at = (at + 1) & (ids->capacity - 1);
    }
    return at;
}

/* Reads the table only, so that any number may run at once. */
static void lookup_job(void *context, int job)
{
    const struct lookup *lookup = context;
    const struct ids *ids = lookup->ids;
    size_t end = ((size_t)job + 1) * LOOKUP < lookup->count ? ((size_t)job + 1) * LOOKUP : lookup->count;
    for (size_t i = (size_t)job * LOOKUP; i < end; i++) {
        if (i + AHEAD < end) {
            mns_prefetch(&ids->entries[home_of(ids, id_of(lookup->id, i + AHEAD))]);
        }
        size_t at = find(ids, id_of(lookup->id, i));
        const struct id_entry *entry = &ids->entries[at];
        lookup->slots[i] = entry->set ? (uint32_t)at : ID_NONE;
        lookup->from[i] = entry->set == ids->set && entry->set ? entry->index : ID_NONE;
    }
}

/* A table with room for `fresh` ids more, at most half full, of the last set's ids only. */
static bool rebuild(struct ids *ids, struct memory *memory, size_t fresh)
{
    struct ids grown = {.bits = BITS_LEAST, .capacity = (size_t)1 << BITS_LEAST};
    while (grown.capacity / 3 < ids->distinct + fresh) { /* a third full, so that it lasts a while */
        grown.bits++;
        grown.capacity *= 2;
    }
    grown.entries = grown.bits < 32 ? mns_memory_get(memory, grown.capacity, sizeof(*grown.entries)) : NULL;
    if (!grown.entries) {
        return false;
    }
    memset(grown.entries, 0, grown.capacity * sizeof(*grown.entries));
    for (size_t i = 0; i < ids->capacity; i++) {
        const struct id_entry *entry = &ids->entries[i];
        if (entry->set == ids->set && entry->set) {
            grown.entries[find(&grown, entry->id)] = *entry;
        }
    }
    mns_memory_put(memory, ids->entries, ids->capacity, sizeof(*ids->entries));
    ids->entries = grown.entries;
    ids->capacity = grown.capacity;
    ids->bits = grown.bits;
    ids->used = ids->distinct;
    return true;
}

static void look_up(struct lookup *lookup, const struct mns_parallel *parallel)
{
    parallel->run(parallel->user, lookup_job, lookup, (int)((lookup->count + LOOKUP - 1) / LOOKUP));
}

/* Writes the new set into the table, in order. */
static void enter(struct ids *ids, const struct lookup *lookup, struct id_news *news)
{
    uint32_t set = ids->set + 1;
    size_t distinct = 0, matched = 0;
    for (size_t i = 0; i < lookup->count; i++) {
        bool known = lookup->slots[i] != ID_NONE;
        struct id_entry *entry = &ids->entries[known ? lookup->slots[i] : find(ids, id_of(lookup->id, i))];
        int64_t id = known || entry->set ? entry->id : id_of(lookup->id, i);
        if (entry->set == set) {
            news->first_repeated = news->repeated++ ? news->first_repeated : id;
            continue;
        }
        if (entry->set == 0) {
            ids->used++;
            news->appeared++;
        } else if (entry->set == ids->set) {
            matched++;
        } else {
            news->first_returned = news->returned++ ? news->first_returned : id;
            news->appeared++;
        }
        *entry = (struct id_entry){.id = id, .index = (uint32_t)i, .set = set};
        distinct++;
    }
    news->vanished = ids->distinct - matched;
    ids->distinct = distinct;
    ids->set = set;
}

bool mns_ids_match(struct ids *ids, struct memory *memory, const struct mns_parallel *parallel, const struct mns_attr *id, size_t count,
                   uint32_t *from, struct id_news *news)
{
    *news = (struct id_news){0};
    ids->slots = mns_memory_reserve(memory, ids->slots, &ids->slots_room, count, sizeof(*ids->slots));
    if (!ids->slots || (ids->capacity == 0 && !rebuild(ids, memory, count))) {
        return false;
    }
    struct lookup lookup = {.ids = ids, .id = id, .count = count, .slots = ids->slots, .from = from};
    look_up(&lookup, parallel);
    size_t fresh = 0;
    for (size_t i = 0; i < count; i++) {
        fresh += ids->slots[i] == ID_NONE;
    }
    if (ids->used + fresh > ids->capacity / 2) {
        if (!rebuild(ids, memory, fresh)) {
            return false;
        }
        look_up(&lookup, parallel);
    }
    enter(ids, &lookup, news);
    return true;
}

void mns_ids_forget(struct ids *ids)
{
    if (ids->entries) {
        memset(ids->entries, 0, ids->capacity * sizeof(*ids->entries));
    }
    ids->used = ids->distinct = 0;
    ids->set = 0;
}

void mns_ids_free(struct ids *ids, struct memory *memory)
{
    mns_memory_put(memory, ids->entries, ids->capacity, sizeof(*ids->entries));
    mns_memory_put(memory, ids->slots, ids->slots_room, sizeof(*ids->slots));
    *ids = (struct ids){0};
}
