/* write_particles.c: particles to files: the list of formats, the table of columns that they write, and its names. */
#include "core/message.h"
#include "io/particle_writer.h"
#include "io/set.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const struct mns_particle_writer *const writers[] = {&mns_particle_writer_npz, &mns_particle_writer_npy, &mns_particle_writer_ply,
                                                            &mns_particle_writer_vtp, &mns_particle_writer_bgeo};

enum { WRITERS = sizeof(writers) / sizeof(writers[0]), PIECE = 65536 };

const char *mns_particles_write_format(size_t index) { return index < WRITERS ? writers[index]->name : NULL; }

static char lower(char c) { return c >= 'A' && c <= 'Z' ? (char)(c - 'A' + 'a') : c; }

/* Whether path ends in a dot and one of the space-separated extensions. */
static bool ends_in(const char *path, const char *extensions)
{
    size_t length = strlen(path);
    for (const char *e = extensions; *e;) {
        size_t n = strcspn(e, " "), same = 0;
        while (length > n + 1 && same < n && lower(path[length - n + same]) == e[same]) {
            same++;
        }
        if (length > n + 1 && same == n && path[length - n - 1] == '.') {
            return true;
        }
        e += n;
        e += strspn(e, " ");
    }
    return false;
}

static mns_result find(const char *path, const struct mns_particle_writer **out, struct mns_message *message)
{
    char list[128] = "";
    for (size_t i = 0; i < WRITERS; i++) {
        if (ends_in(path, writers[i]->extensions)) {
            *out = writers[i];
            return MNS_OK;
        }
        size_t used = strlen(list);
        snprintf(list + used, sizeof(list) - used, "%s.%s", i == 0 ? "" : i + 1 < WRITERS ? ", " : " or ", writers[i]->name);
    }
    return mns_fail(message, MNS_ERR_UNSUPPORTED, "%s: particles are written as %s", path, list);
}

/* ---- what writers share ---- */

bool mns_put_file(void *user, const void *data, size_t size) { return mns_atomic_write(user, data, size); }

bool mns_column_put(const struct particle_table *table, const struct particle_column *column, const struct byte_sink *sink)
{
    size_t bytes = mns_column_bytes(column), per_piece = PIECE / bytes;
    if (column->stride == bytes || table->count == 0) { /* packed as it is */
        return table->count == 0 || sink->put(sink->user, column->data, table->count * bytes);
    }
    uint8_t piece[PIECE];
    for (size_t start = 0; start < table->count; start += per_piece) {
        size_t n = table->count - start < per_piece ? table->count - start : per_piece;
        for (size_t i = 0; i < n; i++) {
            memcpy(piece + i * bytes, column->data + (start + i) * column->stride, bytes);
        }
        if (!sink->put(sink->user, piece, n * bytes)) {
            return false;
        }
    }
    return true;
}

void mns_column_warn(const struct particle_table *table, const char *format, ...)
{
    char text[800];
    struct mns_message line;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof(text), format, arguments);
    va_end(arguments);
    if (table->log.message) {
        mns_fail(&line, MNS_OK, "%s: %s", table->path, text);
        table->log.message(table->log.user, MNS_LOG_WARNING, line.text);
    }
}

mns_result mns_table_out_of_memory(const struct particle_table *table)
{
    return mns_fail(table->message, MNS_ERR_OUT_OF_MEMORY, "%s: out of memory", table->path);
}

/* ---- the table ---- */

static bool name_is_taken(const struct particle_table *table, const char *name)
{
    for (size_t i = 0; i < table->column_count; i++) {
        if (strcmp(table->columns[i].name, name) == 0) {
            return true;
        }
    }
    return false;
}

/* A copy of the name that no column has yet, and that is no path and one line. NULL: out of memory. */
static char *make_name(const struct particle_table *table, const char *name)
{
    enum { NUMBER = 24 };
    size_t length = strlen(name);
    char *out = malloc(length + NUMBER);
    if (!out) {
        return NULL;
    }
    for (size_t i = 0; i <= length; i++) {
        bool bad = name[i] && ((unsigned char)name[i] < ' ' || name[i] == 127 || name[i] == '/' || name[i] == '\\');
        out[i] = bad ? '_' : name[i];
    }
    if (length == 0) {
        memcpy(out, "unnamed", sizeof("unnamed"));
        length = strlen(out);
    }
    for (size_t number = 2; name_is_taken(table, out); number++) {
        snprintf(out + length, NUMBER, "_%zu", number);
    }
    return out;
}

static bool add_column(struct particle_table *table, const char *name, enum mns_role role, struct mns_attr attr, int components)
{
    struct particle_column *column = &table->columns[table->column_count];
    *column = (struct particle_column){.type = attr.type, .components = components, .data = attr.data, .role = role};
    column->name = make_name(table, name);
    column->stride = attr.stride ? attr.stride : mns_column_bytes(column);
    column->vector = components > 1;
    table->column_count += column->name != NULL;
    return column->name != NULL;
}

static void free_table(struct particle_table *table)
{
    for (size_t i = 0; i < table->column_count; i++) {
        free(table->columns[i].name);
    }
    free(table->columns);
}

static mns_result write_table(struct particle_table *table, const struct mns_particle_writer *writer)
{
    mns_result result = mns_atomic_begin(&table->file, table->path, table->message);
    if (result != MNS_OK) {
        return result;
    }
    result = writer->write(table);
    if (result != MNS_OK) {
        mns_atomic_abort(table->file);
        return result;
    }
    return mns_atomic_commit(table->file, table->message); /* tells what went wrong in writing */
}

/* ---- particles of the caller ---- */

static mns_result check(const char *path, const struct mns_particles *particles, struct mns_message *message)
{
    const struct mns_attr *const attributes[] = {&particles->position, &particles->radius,  &particles->mass, &particles->color,
                                                 &particles->velocity, &particles->density, &particles->id};
    if (particles->count > 0 && !particles->position.data) {
        return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "%s: the particles have no positions", path);
    }
    if (particles->position.type != MNS_F32 && particles->position.type != MNS_F64) {
        return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "%s: positions must be float32 or float64", path);
    }
    for (size_t i = 0; i < sizeof(attributes) / sizeof(attributes[0]); i++) {
        if (mns_type_size(attributes[i]->type) == 0) {
            return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "%s: an attribute's type is unknown", path);
        }
    }
    return MNS_OK;
}

static bool add_roles(struct particle_table *table, const struct mns_particles *particles)
{
    const struct {
        enum mns_role role;
        struct mns_attr attr;
        int components;
    } all[] = {{MNS_ROLE_POSITION, particles->position, 3},
               {MNS_ROLE_VELOCITY, particles->velocity, 3},
               {MNS_ROLE_DENSITY, particles->density, 1},
               {MNS_ROLE_RADIUS, particles->radius, 1},
               {MNS_ROLE_ID, particles->id, 1},
               {MNS_ROLE_MASS, particles->mass, 1},
               {MNS_ROLE_COLOR, particles->color, 3}};
    table->columns = calloc(sizeof(all) / sizeof(all[0]), sizeof(*table->columns));
    bool good = table->columns != NULL;
    for (size_t i = 0; good && i < sizeof(all) / sizeof(all[0]); i++) {
        if (i == 0 || all[i].attr.data) {
            good = add_column(table, mns_role_name(all[i].role), all[i].role, all[i].attr, all[i].components);
        }
    }
    return good;
}

mns_result mns_particles_write(const char *path, const struct mns_particles *particles, struct mns_message *message)
{
    if (!path || !particles) {
        return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "mns_particles_write: path or particles is NULL");
    }
    struct mns_particles known;
    mns_particles_init(&known);
    memcpy(&known, particles, particles->struct_size < sizeof(known) ? particles->struct_size : sizeof(known));
    const struct mns_particle_writer *writer = NULL;
    mns_result result = find(path, &writer, message);
    result = result == MNS_OK ? check(path, &known, message) : result;
    if (result != MNS_OK) {
        return result;
    }
    struct particle_table table = {.path = path, .count = known.count, .message = message};
    result = add_roles(&table, &known) ? write_table(&table, writer) : mns_table_out_of_memory(&table);
    free_table(&table);
    return result;
}

/* ---- a set as it was read ---- */

static bool add_attribute(struct particle_table *table, const struct mns_attribute *attribute, const char *name)
{
    struct mns_attr attr = {.data = attribute->data, .type = attribute->type};
    return add_column(table, name, attribute->role, attr, attribute->components);
}

/* The positions first, then what the file had; what was put together from other attributes is left out. */
static bool add_attributes(struct particle_table *table, const mns_particle_set *set)
{
    const struct mns_attribute *position = NULL;
    for (size_t i = 0; i < set->listed_count; i++) {
        position = set->attributes[i].is.role == MNS_ROLE_POSITION ? &set->attributes[i].is : position;
    }
    const struct mns_attribute none = {.type = MNS_F32, .components = 3, .role = MNS_ROLE_POSITION};
    table->columns = calloc(set->listed_count + 1, sizeof(*table->columns));
    bool good = table->columns && add_attribute(table, position ? position : &none, "position");
    for (size_t i = 0; good && i < set->listed_count; i++) {
        const struct attribute *attribute = &set->attributes[i];
        if (&attribute->is != position && !attribute->joined) {
            good = add_attribute(table, &attribute->is, attribute->is.name);
        }
    }
    return good;
}

mns_result mns_particle_set_write(const char *path, const mns_particle_set *set, const struct mns_log *log, struct mns_message *message)
{
    if (!path || !set) {
        return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "mns_particle_set_write: path or set is NULL");
    }
    const struct mns_particle_writer *writer = NULL;
    mns_result result = find(path, &writer, message);
    if (result != MNS_OK) {
        return result;
    }
    struct particle_table table = {.path = path, .count = set->count, .message = message};
    table.log = log ? *log : table.log;
    result = add_attributes(&table, set) ? write_table(&table, writer) : mns_table_out_of_memory(&table);
    free_table(&table);
    return result;
}
