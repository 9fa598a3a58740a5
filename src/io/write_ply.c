/* write_ply.c: particles as the vertices of a binary PLY file. A vector becomes consecutive scalars NAME_x NAME_y NAME_z, or NAME_0 NAME_1 ...,
 * which read_ply.c puts together again; colours of uint8 are called red green blue (alpha), as viewers want them. PLY has no whole numbers of
 * 64 bits: they become 32 bits or float64 where that holds them exactly, else they are left out with a warning. */
#include "io/particle_writer.h"
#include "io/reader.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { NAME_LENGTH = 48 /* with the component behind it, what read_ply.c takes */ };

static const char *const type_names[] = {"float", "double", "char", "uchar", "short", "ushort", "int", "uint"}; /* by enum mns_type */

/* false: no type of PLY holds it. */
static bool choose_type(const struct particle_table *table, const struct particle_column *column, enum mns_type *out)
{
    static const enum mns_type narrower[] = {MNS_I32, MNS_U32, MNS_F64};
    *out = column->type;
    if (column->type != MNS_I64 && column->type != MNS_U64) {
        return true;
    }
    for (size_t i = 0; i < sizeof(narrower) / sizeof(narrower[0]); i++) {
        if (mns_column_fits(table, column, narrower[i])) {
            *out = narrower[i];
            return true;
        }
    }
    mns_column_warn(table, "'%s' is left out: PLY holds no whole numbers as large as its own", column->name);
    return false;
}

/* A property's name: one word. */
static void name_property(char out[NAME_LENGTH + 16], const struct particle_column *column, int component)
{
    static const char *const axes[] = {"x", "y", "z"}, *const channels[] = {"red", "green", "blue", "alpha"};
    int components = column->components;
    if (column->role == MNS_ROLE_POSITION) {
        snprintf(out, NAME_LENGTH + 16, "%s", axes[component]);
    } else if (column->role == MNS_ROLE_COLOR && column->type == MNS_U8) {
        snprintf(out, NAME_LENGTH + 16, "%s", channels[component]);
    } else if (components == 1) {
        snprintf(out, NAME_LENGTH + 16, "%.*s", NAME_LENGTH, column->name);
    } else if (components == 3) {
        snprintf(out, NAME_LENGTH + 16, "%.*s_%s", NAME_LENGTH, column->name, axes[component]);
    } else {
        snprintf(out, NAME_LENGTH + 16, "%.*s_%d", NAME_LENGTH, column->name, component);
    }
    for (char *at = out; *at; at++) {
        *at = *at == ' ' ? '_' : *at;
    }
}

static bool put_text(const struct particle_table *table, const char *text) { return mns_atomic_write(table->file, text, strlen(text)); }

static void put_header(const struct particle_table *table, const struct record_field *fields, size_t field_count)
{
    char line[NAME_LENGTH + 64], name[NAME_LENGTH + 16];
    put_text(table, mns_big_endian() ? "ply\nformat binary_big_endian 1.0\n" : "ply\nformat binary_little_endian 1.0\n");
    snprintf(line, sizeof(line), "element vertex %zu\n", table->count);
    put_text(table, line);
    for (size_t k = 0; k < field_count; k++) {
        for (int c = 0; c < fields[k].column->components; c++) {
            name_property(name, fields[k].column, c);
            snprintf(line, sizeof(line), "property %s %s\n", type_names[fields[k].type], name);
            put_text(table, line);
        }
    }
    put_text(table, "end_header\n");
}

static mns_result write_ply(struct particle_table *table)
{
    struct record_field *fields = calloc(table->column_count, sizeof(*fields));
    size_t field_count = 0, record = 0;
    if (!fields) {
        return mns_table_out_of_memory(table);
    }
    for (size_t i = 0; i < table->column_count; i++) {
        struct record_field *field = &fields[field_count];
        *field = (struct record_field){.column = &table->columns[i], .offset = record};
        if (choose_type(table, field->column, &field->type)) {
            record += mns_type_size(field->type) * (size_t)field->column->components;
            field_count++;
        }
    }
    put_header(table, fields, field_count);
    mns_result result =
        mns_records_put(table, fields, field_count, record, mns_big_endian(), &(struct byte_sink){mns_put_file, table->file});
    free(fields);
    return result;
}

const struct mns_particle_writer mns_particle_writer_ply = {"ply", "ply", write_ply};
