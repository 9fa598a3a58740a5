/* write_records.c: formats that keep the values of a particle together: columns to records, in the stored types and byte order. */
#include "core/attr.h"
#include "io/particle_writer.h"
#include "io/reader.h"

#include <math.h>
#include <stdlib.h>

enum { BLOCK = 256 /* particles that stay in the cache while their columns are put together */ };

static void range_of(enum mns_type type, double *low, double *high)
{
    switch (type) {
    case MNS_I8: *low = INT8_MIN, *high = INT8_MAX; return;
    case MNS_U8: *low = 0, *high = UINT8_MAX; return;
    case MNS_I16: *low = INT16_MIN, *high = INT16_MAX; return;
    case MNS_U16: *low = 0, *high = UINT16_MAX; return;
    case MNS_I32: *low = INT32_MIN, *high = INT32_MAX; return;
    case MNS_U32: *low = 0, *high = UINT32_MAX; return;
    default: *low = -9007199254740991.0, *high = 9007199254740991.0; return; /* 2^53 - 1: whole numbers that a double tells apart */
    }
}

bool mns_column_fits(const struct particle_table *table, const struct particle_column *column, enum mns_type type)
{
    const struct mns_attr attr = {column->data, column->stride, column->type};
    double low, high;
    range_of(type, &low, &high);
    for (size_t i = 0; i < table->count; i++) {
        for (int c = 0; c < column->components; c++) {
            double value = mns_attr_get(&attr, column->type, column->components, i, c);
            if (!(value >= low && value <= high)) {
                return false;
            }
        }
    }
    return true;
}

static void store(uint8_t *out, enum mns_type type, double value)
{
    float narrow = (float)value;
    int32_t whole = type == MNS_I32 ? (int32_t)value : 0;
    uint32_t natural = type == MNS_U32 ? (uint32_t)value : 0;
    switch (type) {
    case MNS_F32: memcpy(out, &narrow, sizeof(narrow)); break;
    case MNS_F64: memcpy(out, &value, sizeof(value)); break;
    case MNS_I32: memcpy(out, &whole, sizeof(whole)); break;
    default: memcpy(out, &natural, sizeof(natural)); break;
    }
}

/* Puts one field into the records of the particles from start on. scratch: [8 * components] */
static void put_field(const struct record_field *field, size_t start, size_t count, size_t record, bool big_endian, uint8_t *scratch,
                      uint8_t *out)
{
    const struct particle_column *column = field->column;
    const struct mns_attr attr = {column->data, column->stride, column->type};
    size_t size = mns_type_size(field->type), components = (size_t)column->components;
    for (size_t i = 0; i < count; i++) {
        const uint8_t *in = column->data + (start + i) * column->stride;
        if (field->type != column->type) {
            for (size_t c = 0; c < components; c++) {
                store(scratch + c * size, field->type, mns_attr_get(&attr, column->type, column->components, start + i, (int)c));
            }
            in = scratch;
        }
        mns_copy_elements(out + i * record + field->offset, in, components, field->type, big_endian);
    }
}

mns_result mns_records_put(const struct particle_table *table, const struct record_field *fields, size_t field_count, size_t record,
                           bool big_endian, const struct byte_sink *sink)
{
    size_t most = 1;
    for (size_t k = 0; k < field_count; k++) {
        most = (size_t)fields[k].column->components > most ? (size_t)fields[k].column->components : most;
    }
    uint8_t *block = calloc(BLOCK, record), *scratch = malloc(8 * most);
    bool good = block && scratch;
    for (size_t start = 0; good && start < table->count; start += BLOCK) {
        size_t count = table->count - start < BLOCK ? table->count - start : BLOCK;
        for (size_t k = 0; k < field_count; k++) {
            put_field(&fields[k], start, count, record, big_endian, scratch, block);
        }
        if (!sink->put(sink->user, block, count * record)) {
            break;
        }
    }
    free(block);
    free(scratch);
    return good ? MNS_OK : mns_table_out_of_memory(table);
}
