/* read_bgeo.c: Houdini's .bgeo version 5, as Partio writes it (SPlisHSPlasH and others): big-endian, points as records of 32-bit words.
 *
 * Only points are read: groups, vertices and primitives stand behind them in the file. A string attribute is kept as the index of its string. */
#include "io/set.h"

#include <string.h>

enum { KIND_FLOAT = 0, KIND_INT = 1, KIND_INDEXED_STRING = 4, KIND_VECTOR = 5 };
enum { POSITION_WORDS = 4, BLOCK = 256 /* points that stay in the cache while their attributes are taken apart */ };

struct column {
    uint8_t *out;
    size_t first, words; /* of a point's record */
};

static int probe(struct bytes head)
{
    bool classic = head.size >= 5 && memcmp(head.data, "BgeoV", 5) == 0;
    bool json = head.size >= 5 && memcmp(head.data, "\x7fNSJb", 5) == 0;
    return classic || json ? 2 : 0;
}

struct header {
    uint32_t version, points, primitives, point_groups, primitive_groups, point_attributes, vertex_attributes, primitive_attributes,
        attributes;
};

static mns_result read_header(struct read_context *context, struct cursor *cursor, struct header *header)
{
    uint32_t *const fields[] = {
        &header->version,          &header->points,           &header->primitives,        &header->point_groups,
        &header->primitive_groups, &header->point_attributes, &header->vertex_attributes, &header->primitive_attributes,
        &header->attributes};
    const uint8_t *magic;
    if (!mns_take(cursor, 5, &magic)) {
        return mns_read_fail(context, MNS_ERR_BAD_DATA, "ends in the header, after %zu bytes", cursor->bytes.size);
    }
    if (magic[0] == 0x7f) {
        return mns_read_fail(context, MNS_ERR_UNSUPPORTED,
                             "is a .bgeo of Houdini 12 or later; only version 5 (Houdini 11, Partio) is read");
    }
    if (memcmp(magic, "BgeoV", 5) != 0) {
        return mns_read_fail(context, MNS_ERR_BAD_DATA, "is no .bgeo: it does not begin with BgeoV");
    }
    for (size_t i = 0; i < sizeof(fields) / sizeof(fields[0]); i++) {
        if (!mns_take_u32be(cursor, fields[i])) {
            return mns_read_fail(context, MNS_ERR_BAD_DATA, "ends in the header, after %zu bytes", cursor->bytes.size);
        }
    }
    if (header->version != 5) {
        return mns_read_fail(context, MNS_ERR_UNSUPPORTED, "is .bgeo version %u; only version 5 is read", (unsigned)header->version);
    }
    if (header->point_attributes >= ATTRIBUTE_MAX) {
        return mns_read_fail(context, MNS_ERR_BAD_DATA, "says that it has %u point attributes; at most %d are read",
                             (unsigned)header->point_attributes, (int)ATTRIBUTE_MAX - 1);
    }
    return MNS_OK;
}

struct description {
    struct bytes name;
    uint32_t kind;
    uint16_t words;
};

/* Takes one attribute's description; false: the file ends in it. */
static bool take_description(struct cursor *cursor, struct description *out)
{
    uint16_t length;
    const uint8_t *skipped;
    if (!mns_take_u16be(cursor, &length) || !mns_take(cursor, length, &out->name.data)) {
        return false;
    }
    out->name.size = length;
    if (!mns_take_u16be(cursor, &out->words) || !mns_take_u32be(cursor, &out->kind)) {
        return false;
    }
    if (out->kind != KIND_INDEXED_STRING) {
        return mns_take(cursor, (size_t)out->words * 4, &skipped); /* the default value */
    }
    uint32_t strings;
    if (!mns_take_u32be(cursor, &strings)) {
        return false;
    }
    for (uint32_t i = 0; i < strings; i++) {
        if (!mns_take_u16be(cursor, &length) || !mns_take(cursor, length, &skipped)) {
            return false;
        }
    }
    return true;
}

/* Checks the descriptions and adds up the size of a point's record. */
static mns_result measure_record(struct read_context *context, struct cursor *cursor, uint32_t attributes, size_t *words)
{
    *words = POSITION_WORDS;
    for (uint32_t i = 0; i < attributes; i++) {
        struct description description;
        if (!take_description(cursor, &description)) {
            return mns_read_fail(context, MNS_ERR_BAD_DATA, "ends in the description of point attribute %u of %u", (unsigned)i + 1,
                                 (unsigned)attributes);
        }
        int length = description.name.size < 100 ? (int)description.name.size : 100;
        uint32_t kind = description.kind;
        if (kind != KIND_FLOAT && kind != KIND_INT && kind != KIND_INDEXED_STRING && kind != KIND_VECTOR) {
            return mns_read_fail(context, MNS_ERR_BAD_DATA, "point attribute '%.*s' is of kind %u; 0, 1, 4 and 5 are known", length,
                                 (const char *)description.name.data, (unsigned)kind);
        }
        if (description.words == 0) {
            return mns_read_fail(context, MNS_ERR_BAD_DATA, "point attribute '%.*s' has no components", length,
                                 (const char *)description.name.data);
        }
        *words += description.words;
    }
    return MNS_OK;
}

static mns_result add_columns(struct read_context *context, struct cursor *cursor, uint32_t attributes, struct column *columns)
{
    char *name = mns_read_alloc(context, UINT16_MAX + 1, 1);
    size_t first = POSITION_WORDS;
    bool added = name != NULL;
    columns[0] = (struct column){.first = 0, .words = 3};
    if (added) {
        added = (columns[0].out = mns_set_add(context, "position", MNS_F32, 3)) != NULL;
    }
    for (uint32_t i = 0; i < attributes && added; i++) {
        struct description description;
        take_description(cursor, &description);
        memcpy(name, description.name.data, description.name.size);
        name[description.name.size] = '\0';
        enum mns_type type = description.kind == KIND_INT || description.kind == KIND_INDEXED_STRING ? MNS_I32 : MNS_F32;
        columns[i + 1] = (struct column){mns_set_add(context, name, type, description.words), first, description.words};
        first += description.words;
        added = columns[i + 1].out != NULL;
    }
    if (name) {
        mns_read_free(context, name, UINT16_MAX + 1, 1);
    }
    return added ? MNS_OK : MNS_ERR_OUT_OF_MEMORY;
}

/* records: [points][words] big-endian. */
static void take_apart(const uint8_t *records, size_t points, size_t words, const struct column *columns, size_t column_count)
{
    bool swap = !mns_big_endian();
    for (size_t start = 0; start < points; start += BLOCK) {
        size_t count = points - start < BLOCK ? points - start : BLOCK;
        for (size_t c = 0; c < column_count; c++) {
            size_t n = columns[c].words;
            const uint8_t *in = records + (start * words + columns[c].first) * 4;
            uint8_t *out = columns[c].out + start * n * 4;
            for (size_t i = 0; i < count; i++, in += words * 4) {
                for (size_t k = 0; k < n; k++, out += 4) {
                    uint32_t v;
                    memcpy(&v, in + 4 * k, 4);
                    v = swap ? v << 24 | (v & 0xff00u) << 8 | (v >> 8 & 0xff00u) | v >> 24 : v;
                    memcpy(out, &v, 4);
                }
            }
        }
    }
}

static mns_result read_bgeo(struct read_context *context, struct bytes file)
{
    struct cursor cursor = {file, 0};
    struct header header;
    size_t words;
    mns_result result = read_header(context, &cursor, &header);
    if (result != MNS_OK) {
        return result;
    }
    struct cursor descriptions = cursor;
    result = measure_record(context, &cursor, header.point_attributes, &words);
    if (result != MNS_OK) {
        return result;
    }
    if (header.points > mns_left(&cursor) / (words * 4)) {
        return mns_read_fail(context, MNS_ERR_BAD_DATA, "ends early: %u points of %zu bytes should follow byte %zu, but %zu bytes do",
                             (unsigned)header.points, words * 4, cursor.at, mns_left(&cursor));
    }
    result = mns_set_begin(context, header.points);
    if (result != MNS_OK) {
        return result;
    }
    size_t column_count = (size_t)header.point_attributes + 1;
    struct column *columns = mns_read_alloc(context, column_count, sizeof(*columns));
    if (!columns) {
        return MNS_ERR_OUT_OF_MEMORY;
    }
    result = add_columns(context, &descriptions, header.point_attributes, columns);
    if (result == MNS_OK) {
        take_apart(file.data + cursor.at, header.points, words, columns, column_count);
    }
    mns_read_free(context, columns, column_count, sizeof(*columns));
    return result;
}

const struct mns_reader mns_reader_bgeo = {"bgeo", "bgeo", probe, read_bgeo};
