/* particle_writer.h: what a format for writing particles is. A new one is a file write_<format>.c and a line in write_particles.c's list.
 *
 * A writer gets a table whose first column is the position. Its names are unique and hold no control characters and no slashes. */
#ifndef MNS_IO_PARTICLE_WRITER_H
#define MNS_IO_PARTICLE_WRITER_H

#include "io/atomic_file.h"

#include <meniscus/io.h>

struct particle_column {
    char *name;
    enum mns_type type;
    int components;
    const uint8_t *data;
    size_t stride; /* bytes from one particle to the next */
    enum mns_role role;
    bool vector; /* [n][components], even where that is [n][1] */
};

struct particle_table {
    const char *path;
    size_t count;                    /* particles */
    struct particle_column *columns; /* [column_count] */
    size_t column_count;
    struct mns_log log; /* of what a format cannot hold */
    struct atomic_file *file;
    struct mns_message *message; /* may be NULL */
};

struct mns_particle_writer {
    const char *name, *extensions; /* "bgeo", "bgeo bgeo.gz" */
    /* MNS_OK also where the file takes no more, which whoever ends the file is told; else the message says what went wrong. */
    mns_result (*write)(struct particle_table *table);
};

extern const struct mns_particle_writer mns_particle_writer_npy;
extern const struct mns_particle_writer mns_particle_writer_npz;
extern const struct mns_particle_writer mns_particle_writer_ply;
extern const struct mns_particle_writer mns_particle_writer_vtp;
extern const struct mns_particle_writer mns_particle_writer_bgeo;

static inline size_t mns_column_bytes(const struct particle_column *column)
{
    return mns_type_size(column->type) * (size_t)column->components;
}

/* Takes bytes in order; false: stop. */
struct byte_sink {
    bool (*put)(void *user, const void *data, size_t size);
    void *user;
};

/* Into the file in hand; user: the struct atomic_file. */
bool mns_put_file(void *user, const void *data, size_t size);

/* The packed bytes of a column, piece by piece. */
bool mns_column_put(const struct particle_table *table, const struct particle_column *column, const struct byte_sink *sink);

void mns_column_warn(const struct particle_table *table, const char *format, ...)
#ifdef __GNUC__
    __attribute__((format(printf, 2, 3)))
#endif
    ;

mns_result mns_table_out_of_memory(const struct particle_table *table);

/* Records of all columns, for formats that keep a particle's values together (write_records.c). */
struct record_field {
    const struct particle_column *column;
    enum mns_type type; /* as stored; may be narrower than the column's */
    size_t offset;      /* bytes, in the record */
};

/* Whether every value of the column is a whole number that the type, a whole-number one of at most 32 bits, or float64, holds exactly. */
bool mns_column_fits(const struct particle_table *table, const struct particle_column *column, enum mns_type type);

/* record: bytes of one, where what no field fills is zero. */
mns_result mns_records_put(const struct particle_table *table, const struct record_field *fields, size_t field_count, size_t record,
                           bool big_endian, const struct byte_sink *sink);

/* Packing with zlib (pack_zlib.c, or pack_missing.c which says no and copies). */
bool mns_can_pack(void);
size_t mns_pack_bound(size_t size);
/* One zlib stream of `size` bytes at most 2^30; returns its size, 0 on failure. out: [mns_pack_bound(size)] */
size_t mns_pack(const void *data, size_t size, uint8_t *out);

/* A gzip file into a sink. NULL: out of memory. */
struct gzip;
struct gzip *mns_gzip_begin(struct byte_sink sink);
bool mns_gzip_put(void *gzip, const void *data, size_t size); /* as in struct byte_sink */
bool mns_gzip_end(struct gzip *gzip);                         /* frees it */

#endif
