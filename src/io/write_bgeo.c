/* write_bgeo.c: Houdini's .bgeo version 5 as Partio reads it, packed with gzip where zlib is there. It knows float32 and int32 only: float64 is
 * rounded, whole numbers that int32 does not hold are left out, each with a warning. */
#include "core/message.h"
#include "io/particle_writer.h"

#include <stdlib.h>
#include <string.h>

enum { KIND_FLOAT = 0, KIND_INT = 1, KIND_VECTOR = 5 };
enum { POSITION_BYTES = 16, NAME_MAX_SIZE = UINT16_MAX, COMPONENTS_MAX = UINT16_MAX };

static bool put_number(const struct byte_sink *sink, uint32_t value, size_t bytes)
{
    uint8_t out[4];
    for (size_t i = 0; i < bytes; i++) {
        out[i] = (uint8_t)(value >> 8 * (bytes - 1 - i));
    }
    return sink->put(sink->user, out, bytes);
}

static bool choose_type(const struct particle_table *table, const struct particle_column *column, enum mns_type *out)
{
    bool real = column->type == MNS_F32 || column->type == MNS_F64;
    *out = real ? MNS_F32 : MNS_I32;
    if (column->type == MNS_F64) {
        mns_column_warn(table, "'%s' is rounded from float64 to float32, the widest that .bgeo holds", column->name);
    }
    if (column->components > COMPONENTS_MAX) {
        mns_column_warn(table, "'%s' is left out: .bgeo holds no more than %d components", column->name, (int)COMPONENTS_MAX);
        return false;
    }
    if (!real && column->type != MNS_I32 && !mns_column_fits(table, column, MNS_I32)) {
        mns_column_warn(table, "'%s' is left out: it has numbers beyond int32, the widest that .bgeo holds", column->name);
        return false;
    }
    return true;
}

static bool put_header(const struct byte_sink *sink, const struct particle_table *table, const struct record_field *fields, size_t count)
{
    bool good = sink->put(sink->user, "BgeoV", 5) && put_number(sink, 5, 4) && put_number(sink, (uint32_t)table->count, 4);
    for (int i = 0; i < 3; i++) { /* primitives, groups of points, of primitives */
        good = good && put_number(sink, 0, 4);
    }
    good = good && put_number(sink, (uint32_t)count - 1, 4); /* the position is none of the attributes */
    for (int i = 0; i < 3; i++) {                            /* attributes of vertices, of primitives, of the whole */
        good = good && put_number(sink, 0, 4);
    }
    for (size_t k = 1; good && k < count; k++) {
        const struct particle_column *column = fields[k].column;
        size_t length = strlen(column->name), components = (size_t)column->components;
        length = length < NAME_MAX_SIZE ? length : NAME_MAX_SIZE;
        uint32_t kind = fields[k].type == MNS_I32 ? KIND_INT : components == 3 ? KIND_VECTOR : KIND_FLOAT;
        good = put_number(sink, (uint32_t)length, 2) && sink->put(sink->user, column->name, length) &&
               put_number(sink, (uint32_t)components, 2) && put_number(sink, kind, 4);
        for (size_t c = 0; good && c < components; c++) { /* the default value */
            good = put_number(sink, 0, 4);
        }
    }
    return good;
}

/* Records with the fourth coordinate of the position, which is 1. */
static mns_result put_points(const struct byte_sink *sink, const struct particle_table *table, const struct record_field *fields,
                             size_t count, size_t record)
{
    static const float one = 1;
    const struct particle_column weight = {.type = MNS_F32, .components = 1, .data = (const uint8_t *)(const void *)&one, .stride = 0};
    struct record_field *all = malloc((count + 1) * sizeof(*all));
    if (!all) {
        return mns_table_out_of_memory(table);
    }
    memcpy(all, fields, count * sizeof(*all));
    all[count] = (struct record_field){&weight, MNS_F32, 12};
    mns_result result = mns_records_put(table, all, count + 1, record, true, sink);
    free(all);
    return result;
}

static mns_result put_all(const struct byte_sink *sink, const struct particle_table *table)
{
    struct record_field *fields = calloc(table->column_count, sizeof(*fields));
    size_t count = 0, record = 0;
    if (!fields) {
        return mns_table_out_of_memory(table);
    }
    for (size_t i = 0; i < table->column_count; i++) {
        struct record_field *field = &fields[count];
        *field = (struct record_field){.column = &table->columns[i], .offset = record};
        if (choose_type(table, field->column, &field->type)) {
            record += count == 0 ? (size_t)POSITION_BYTES : 4 * (size_t)field->column->components;
            count++;
        }
    }
    put_header(sink, table, fields, count);
    mns_result result = put_points(sink, table, fields, count, record);
    if (result == MNS_OK) {
        sink->put(sink->user, "\0\xff", 2); /* no extra data; the end */
    }
    free(fields);
    return result;
}

static mns_result write_bgeo(struct particle_table *table)
{
    if (table->count > UINT32_MAX) {
        return mns_fail(table->message, MNS_ERR_UNSUPPORTED, "%s: .bgeo counts to %u particles; there are %zu", table->path, UINT32_MAX,
                        table->count);
    }
    const struct byte_sink plain = {mns_put_file, table->file};
    if (!mns_can_pack()) {
        return put_all(&plain, table);
    }
    struct gzip *gzip = mns_gzip_begin(plain);
    if (!gzip) {
        return mns_table_out_of_memory(table);
    }
    mns_result result = put_all(&(struct byte_sink){mns_gzip_put, gzip}, table);
    mns_gzip_end(gzip);
    return result;
}

const struct mns_particle_writer mns_particle_writer_bgeo = {"bgeo", "bgeo bgeo.gz", write_bgeo};
