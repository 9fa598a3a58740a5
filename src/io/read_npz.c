/* read_npz.c: several arrays of numpy in a zip file: position [n][3] and any number of [n] and [n][c] beside it. */
#include "io/npy.h"
#include "io/set.h"

#include <stdio.h>
#include <string.h>

enum { END_SIZE = 22, END64_SIZE = 56, LOCATOR_SIZE = 20, ENTRY_SIZE = 46, LOCAL_SIZE = 30, COMMENT_MAX = 65535, NAME_LENGTH = 256 };
enum { METHOD_STORED = 0, METHOD_DEFLATED = 8 };

struct member {
    char name[NAME_LENGTH]; /* without .npy */
    uint32_t method, flags;
    uint64_t packed, size, offset; /* bytes, bytes, of the local header */
};

static uint64_t little(const uint8_t *p, int bytes)
{
    uint64_t value = 0;
    for (int i = 0; i < bytes; i++) {
        value |= (uint64_t)p[i] << (8 * i);
    }
    return value;
}

static int probe(struct bytes head)
{
    return head.size >= 4 && (memcmp(head.data, "PK\3\4", 4) == 0 || memcmp(head.data, "PK\5\6", 4) == 0) ? 2 : 0;
}

/* Finds the central directory from the end of the file. */
static mns_result find_directory(struct read_context *context, struct bytes file, struct cursor *directory, uint64_t *entries)
{
    size_t lowest = file.size > END_SIZE + COMMENT_MAX ? file.size - END_SIZE - COMMENT_MAX : 0;
    size_t at = file.size < END_SIZE ? 0 : file.size - END_SIZE + 1;
    const uint8_t *end = NULL;
    while (at > lowest && !end) {
        if (memcmp(file.data + --at, "PK\5\6", 4) == 0) {
            end = file.data + at;
        }
    }
    if (!end) {
        return mns_read_fail(context, MNS_ERR_BAD_DATA, "ends early: the zip file's directory, which stands last, is missing");
    }
    *entries = little(end + 10, 2);
    uint64_t size = little(end + 12, 4), offset = little(end + 16, 4);
    if (at >= LOCATOR_SIZE && memcmp(end - LOCATOR_SIZE, "PK\6\7", 4) == 0) {
        uint64_t end64 = little(end - LOCATOR_SIZE + 8, 8);
        if (file.size < END64_SIZE || end64 > file.size - END64_SIZE || memcmp(file.data + end64, "PK\6\6", 4) != 0) {
            return mns_read_fail(context, MNS_ERR_BAD_DATA, "the zip file's 64-bit directory is not where it should be");
        }
        *entries = little(file.data + end64 + 32, 8);
        size = little(file.data + end64 + 40, 8);
        offset = little(file.data + end64 + 48, 8);
    }
    if (offset > file.size || size > file.size - offset) {
        return mns_read_fail(context, MNS_ERR_BAD_DATA, "the zip file's directory should stand at byte %llu, beyond the end",
                             (unsigned long long)offset);
    }
    *directory = (struct cursor){{file.data + offset, (size_t)size}, 0};
    return MNS_OK;
}

/* Sizes that do not fit 32 bits stand in extra field 1, in this order. */
static void apply_zip64(struct cursor extra, struct member *member)
{
    const uint8_t *head, *body;
    while (mns_take(&extra, 4, &head)) {
        size_t size = (size_t)little(head + 2, 2);
        if (!mns_take(&extra, size, &body)) {
            return;
        }
        if (little(head, 2) != 1) {
            continue;
        }
        uint64_t *const fields[] = {&member->size, &member->packed, &member->offset};
        for (int i = 0; i < 3; i++) {
            if (*fields[i] != UINT32_MAX) {
                continue;
            }
            if (size < 8) {
                return;
            }
            *fields[i] = little(body, 8);
            body += 8;
            size -= 8;
        }
    }
}

/* Takes the next entry of the directory; false: there is none, or it is cut. */
static bool take_member(struct cursor *directory, struct member *member)
{
    const uint8_t *entry, *name, *extra, *comment;
    if (!mns_take(directory, ENTRY_SIZE, &entry) || memcmp(entry, "PK\1\2", 4) != 0) {
        return false;
    }
    size_t name_size = (size_t)little(entry + 28, 2), extra_size = (size_t)little(entry + 30, 2),
           comment_size = (size_t)little(entry + 32, 2);
    if (!mns_take(directory, name_size, &name) || !mns_take(directory, extra_size, &extra) ||
        !mns_take(directory, comment_size, &comment)) {
        return false;
    }
    if (name_size > 4 && memcmp(name + name_size - 4, ".npy", 4) == 0) {
        name_size -= 4;
    }
    if (name_size >= NAME_LENGTH) {
        name_size = NAME_LENGTH - 1;
    }
    *member = (struct member){.method = (uint32_t)little(entry + 10, 2),
                              .flags = (uint32_t)little(entry + 8, 2),
                              .packed = little(entry + 20, 4),
                              .size = little(entry + 24, 4),
                              .offset = little(entry + 42, 4)};
    memcpy(member->name, name, name_size);
    apply_zip64((struct cursor){{extra, extra_size}, 0}, member);
    return true;
}

/* A member's bytes: in the file, or unpacked into memory that the caller frees (*unpacked, size bytes). */
static mns_result open_member(struct read_context *context, struct bytes file, const struct member *member, struct bytes *out,
                              uint8_t **unpacked)
{
    const uint8_t *local;
    const uint64_t deflate_most = 1032; /* no deflate stream grows more */
    *unpacked = NULL;
    if (member->flags & 1) {
        return mns_read_fail(context, MNS_ERR_UNSUPPORTED, "member '%s' is encrypted", member->name);
    }
    if (member->method != METHOD_STORED && member->method != METHOD_DEFLATED) {
        return mns_read_fail(context, MNS_ERR_UNSUPPORTED, "member '%s' is packed by method %u; stored and deflated ones are read",
                             member->name, (unsigned)member->method);
    }
    if (file.size < LOCAL_SIZE || member->offset > file.size - LOCAL_SIZE || memcmp(local = file.data + member->offset, "PK\3\4", 4) != 0) {
        return mns_read_fail(context, MNS_ERR_BAD_DATA, "member '%s' is not at byte %llu, where it should be", member->name,
                             (unsigned long long)member->offset);
    }
    size_t skip = LOCAL_SIZE + (size_t)little(local + 26, 2) + (size_t)little(local + 28, 2), left = file.size - (size_t)member->offset;
    bool stored = member->method == METHOD_STORED;
    if (skip > left || member->packed > left - skip || (stored && member->packed != member->size) ||
        (!stored && member->size / deflate_most > member->packed + 1)) {
        return mns_read_fail(context, MNS_ERR_BAD_DATA,
                             "member '%s' says that it has %llu bytes, in %llu packed ones, which the file does not hold", member->name,
                             (unsigned long long)member->size, (unsigned long long)member->packed);
    }
    if (!stored && mns_is_bomb(context, (size_t)member->packed, (size_t)member->size)) {
        return mns_read_fail(context, MNS_ERR_BAD_DATA,
                             "member '%s' unpacks to %llu bytes from %llu, which no particles do; "
                             "set max_bytes if it is meant so",
                             member->name, (unsigned long long)member->size, (unsigned long long)member->packed);
    }
    struct bytes packed = {local + skip, (size_t)member->packed};
    *out = packed;
    if (stored) {
        return MNS_OK;
    }
    *unpacked = mns_read_alloc(context, (size_t)member->size, 1);
    if (!*unpacked) {
        return MNS_ERR_OUT_OF_MEMORY;
    }
    mns_result result = mns_inflate_raw(context, packed, *unpacked, (size_t)member->size);
    if (result != MNS_OK) {
        mns_read_free(context, *unpacked, (size_t)member->size, 1);
        *unpacked = NULL;
    }
    *out = (struct bytes){*unpacked, (size_t)member->size};
    return result;
}

static bool is_position(const char *name)
{
    static const char *const names[] = {"position", "positions", "pos", "points", "P", "x", "xyz", "coordinates", "arr_0"};
    for (size_t i = 0; i < sizeof(names) / sizeof(names[0]); i++) {
        if (strcmp(name, names[i]) == 0) {
            return true;
        }
    }
    return false;
}

static mns_result add_positions(struct read_context *context, const struct member *member, const struct npy *array, bool stays)
{
    if (array->dimensions != 2 || array->shape[1] != 3 || (array->type != MNS_F32 && array->type != MNS_F64)) {
        return mns_read_fail(context, MNS_ERR_BAD_DATA, "member '%s' is %s [%zu][%zu]; positions are float32 or float64 [n][3]",
                             member->name, mns_type_name(array->type), array->shape[0], array->shape[1]);
    }
    mns_result result = mns_set_begin(context, array->shape[0]);
    return result == MNS_OK ? mns_npy_add(context, "position", array, stays) : result;
}

/* What is no array of one row per particle (a time, a box) is left out. */
static mns_result add_other(struct read_context *context, const struct member *member, const struct npy *array, bool stays, size_t count)
{
    if (array->dimensions == 0 || array->shape[0] != count || array->shape[1] == 0) {
        mns_read_warn(context, "member '%s' is left out: it has not %zu rows, one per particle", member->name, count);
        return MNS_OK;
    }
    return mns_npy_add(context, member->name, array, stays);
}

/* Reads one member. count NULL: the positions. */
static mns_result read_member(struct read_context *context, struct bytes file, const struct member *member, size_t *count, bool positions)
{
    struct bytes bytes;
    uint8_t *unpacked;
    struct npy array;
    char what[NAME_LENGTH + 16];
    mns_result result = open_member(context, file, member, &bytes, &unpacked);
    if (result != MNS_OK) {
        return result;
    }
    snprintf(what, sizeof(what), "member '%s' ", member->name);
    result = mns_npy_parse(context, what, bytes, &array);
    if (result == MNS_OK && positions) {
        result = add_positions(context, member, &array, !unpacked);
        *count = array.shape[0];
    } else if (result == MNS_OK) {
        result = add_other(context, member, &array, !unpacked, *count);
    } else if (result == MNS_ERR_UNSUPPORTED && !positions) {
        mns_read_warn(context, "member '%s' is left out: it is no array of numbers with one row per particle", member->name);
        context->message->text[0] = '\0';
        context->set->fault = MNS_OK;
        result = MNS_OK;
    }
    if (unpacked) {
        mns_read_free(context, unpacked, bytes.size, 1);
    }
    return result;
}

static mns_result no_positions(struct read_context *context, struct cursor directory)
{
    char names[512] = "nothing";
    size_t used = 0;
    struct member member;
    while (take_member(&directory, &member) && used + strlen(member.name) + 8 < sizeof(names)) {
        used += (size_t)snprintf(names + used, sizeof(names) - used, "%s%s", used ? ", " : "", member.name);
    }
    return mns_read_fail(context, MNS_ERR_BAD_DATA, "has no member 'position'; it has %s", names);
}

static mns_result read_npz(struct read_context *context, struct bytes file)
{
    struct cursor directory, cursor;
    uint64_t entries = 0, seen = 0;
    struct member member, positions = {.name = ""};
    mns_result result = find_directory(context, file, &directory, &entries);
    if (result != MNS_OK) {
        return result;
    }
    if (entries > ATTRIBUTE_MAX) {
        return mns_read_fail(context, MNS_ERR_BAD_DATA, "the zip file has %llu members; at most %d are read", (unsigned long long)entries,
                             (int)ATTRIBUTE_MAX);
    }
    for (cursor = directory; seen < entries && take_member(&cursor, &member); seen++) {
        if (is_position(member.name) && (positions.name[0] == '\0' || strcmp(member.name, "position") == 0)) {
            positions = member;
        }
    }
    if (seen < entries) {
        return mns_read_fail(context, MNS_ERR_BAD_DATA, "the zip file's directory is corrupt at entry %llu of %llu",
                             (unsigned long long)seen + 1, (unsigned long long)entries);
    }
    if (positions.name[0] == '\0') {
        return no_positions(context, directory);
    }
    size_t count = 0;
    result = read_member(context, file, &positions, &count, true);
    cursor = directory;
    for (seen = 0; seen < entries && result == MNS_OK && take_member(&cursor, &member); seen++) {
        if (member.offset != positions.offset) {
            result = read_member(context, file, &member, &count, false);
        }
    }
    return result;
}

const struct mns_reader mns_reader_npz = {"npz", "npz", probe, read_npz};
