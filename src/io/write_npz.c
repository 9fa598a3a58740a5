/* write_npz.c: particles as numpy arrays: .npy holds the positions, .npz (a zip of stored .npy members) all there is. */
#include "io/npy.h"
#include "io/particle_writer.h"

#include <stdlib.h>
#include <string.h>

enum {
    LOCAL_SIZE = 30,
    LOCAL_EXTRA = 20,
    ENTRY_SIZE = 46,
    ENTRY_EXTRA = 28,
    END64_SIZE = 56,
    LOCATOR_SIZE = 20,
    END_SIZE = 22,
    ALIGNMENT = 64
};

enum { NAME_MAX_SIZE = 1024 }; /* bytes of a member's name; longer ones are cut */

struct member {
    const struct particle_column *column;
    uint64_t offset; /* of the local header */
    uint64_t size;   /* of the .npy in it */
    uint32_t crc;
    size_t name_size; /* with .npy */
    char name[NAME_MAX_SIZE + 4];
};

struct archive {
    const struct particle_table *table;
    uint32_t crc_table[256];
};

/* ---- .npy ---- */

static void npy_header(uint8_t out[NPY_HEADER_SIZE], const struct particle_column *column, size_t count)
{
    mns_npy_header(out, column->type, column->vector ? 2 : 1, (const size_t[]){count, (size_t)column->components});
}

static bool put_npy(const struct particle_table *table, const struct particle_column *column)
{
    const struct byte_sink sink = {mns_put_file, table->file};
    uint8_t header[NPY_HEADER_SIZE];
    npy_header(header, column, table->count);
    return mns_atomic_write(table->file, header, NPY_HEADER_SIZE) && mns_column_put(table, column, &sink);
}

static mns_result write_npy(struct particle_table *table)
{
    if (table->column_count > 1) {
        mns_column_warn(table, "holds the positions only; .npz holds all attributes");
    }
    put_npy(table, &table->columns[0]);
    return MNS_OK;
}

/* ---- .npz ---- */

static void fill_crc_table(uint32_t table[256])
{
    for (uint32_t i = 0; i < 256; i++) {
        uint32_t c = i;
        for (int k = 0; k < 8; k++) {
            c = (c & 1) ? 0xedb88320u ^ (c >> 1) : c >> 1;
        }
        table[i] = c;
    }
}

struct crc {
    const uint32_t *table;
    uint32_t value;
};

static bool put_crc(void *user, const void *data, size_t size)
{
    struct crc *crc = user;
    uint32_t c = crc->value;
    const uint8_t *p = data;
    for (size_t i = 0; i < size; i++) {
        c = crc->table[(c ^ p[i]) & 0xff] ^ (c >> 8);
    }
    crc->value = c;
    return true;
}

static uint32_t crc_of(const struct archive *archive, const struct particle_column *column, const uint8_t header[NPY_HEADER_SIZE])
{
    struct crc crc = {archive->crc_table, UINT32_MAX};
    put_crc(&crc, header, NPY_HEADER_SIZE);
    mns_column_put(archive->table, column, &(struct byte_sink){put_crc, &crc});
    return ~crc.value;
}

static uint8_t *put(uint8_t *p, uint64_t value, int bytes)
{
    for (int i = 0; i < bytes; i++) {
        *p++ = (uint8_t)(value >> (8 * i));
    }
    return p;
}

/* What a local header and a directory entry share: version to crc and 32-bit sizes, which say that the 64-bit ones stand in the extra field. */
static uint8_t *put_common(uint8_t *p, const struct member *member, size_t name_size, size_t extra_size)
{
    p = put(p, 45, 2);    /* zip64 */
    p = put(p, 0x800, 2); /* flags: names in UTF-8 */
    p = put(p, 0, 2);     /* stored */
    p = put(p, 0, 2);     /* 00:00 */
    p = put(p, 0x21, 2);  /* 1 January 1980: the same bytes every time */
    p = put(p, member->crc, 4);
    p = put(p, UINT32_MAX, 4);
    p = put(p, UINT32_MAX, 4);
    p = put(p, name_size, 2);
    return put(p, extra_size, 2);
}

/* The local header, padded by an extra field so that the array's bytes are aligned in the file, and the member. */
static bool write_member(const struct archive *archive, struct member *member)
{
    const struct particle_table *table = archive->table;
    uint8_t header[LOCAL_SIZE + sizeof(member->name) + LOCAL_EXTRA + 4 + ALIGNMENT] = {0}, array[NPY_HEADER_SIZE];
    npy_header(array, member->column, table->count);
    member->offset = mns_atomic_size(table->file);
    member->size = NPY_HEADER_SIZE + (uint64_t)table->count * mns_column_bytes(member->column);
    member->crc = crc_of(archive, member->column, array);

    size_t fixed = LOCAL_SIZE + member->name_size + LOCAL_EXTRA + 4;
    size_t padding = (ALIGNMENT - (size_t)((member->offset + fixed) % ALIGNMENT)) % ALIGNMENT;
    uint8_t *p = put(header, 0x04034b50, 4);
    p = put_common(p, member, member->name_size, LOCAL_EXTRA + 4 + padding);
    memcpy(p, member->name, member->name_size);
    p = put(p + member->name_size, 1, 2);
    p = put(p, 16, 2);
    p = put(p, member->size, 8);
    p = put(p, member->size, 8);
    p = put(p, 0xa220, 2); /* padding, as others mark it */
    p = put(p, padding, 2);
    return mns_atomic_write(table->file, header, (size_t)(p - header) + padding) && put_npy(table, member->column);
}

static bool write_entry(const struct archive *archive, const struct member *member)
{
    uint8_t entry[ENTRY_SIZE + sizeof(member->name) + ENTRY_EXTRA] = {0};
    uint8_t *p = put(entry, 0x02014b50, 4);
    p = put(p, 45, 2);
    p = put_common(p, member, member->name_size, ENTRY_EXTRA);
    p = put(p, 0, 2); /* comment */
    p = put(p, 0, 2); /* disk */
    p = put(p, 0, 2);
    p = put(p, 0, 4); /* attributes */
    p = put(p, UINT32_MAX, 4);
    memcpy(p, member->name, member->name_size);
    p = put(p + member->name_size, 1, 2);
    p = put(p, 24, 2);
    p = put(p, member->size, 8);
    p = put(p, member->size, 8);
    p = put(p, member->offset, 8);
    return mns_atomic_write(archive->table->file, entry, (size_t)(p - entry));
}

static bool write_end(const struct archive *archive, size_t members, uint64_t directory)
{
    uint8_t end[END64_SIZE + LOCATOR_SIZE + END_SIZE];
    uint64_t at = mns_atomic_size(archive->table->file), size = at - directory;
    uint8_t *p = put(end, 0x06064b50, 4);
    p = put(p, END64_SIZE - 12, 8);
    p = put(p, 45, 2);
    p = put(p, 45, 2);
    p = put(p, 0, 4);
    p = put(p, 0, 4);
    p = put(p, members, 8);
    p = put(p, members, 8);
    p = put(p, size, 8);
    p = put(p, directory, 8);
    p = put(p, 0x07064b50, 4);
    p = put(p, 0, 4);
    p = put(p, at, 8);
    p = put(p, 1, 4);
    p = put(p, 0x06054b50, 4);
    p = put(p, 0, 4);
    p = put(p, members, 2); /* at most ATTRIBUTE_MAX */
    p = put(p, members, 2);
    p = put(p, UINT32_MAX, 4);
    p = put(p, UINT32_MAX, 4);
    p = put(p, 0, 2);
    return mns_atomic_write(archive->table->file, end, (size_t)(p - end));
}

static void name_member(struct member *member)
{
    size_t length = strlen(member->column->name);
    length = length < NAME_MAX_SIZE ? length : NAME_MAX_SIZE;
    memcpy(member->name, member->column->name, length);
    memcpy(member->name + length, ".npy", 4);
    member->name_size = length + 4;
}

static void write_archive(const struct archive *archive, struct member *members)
{
    size_t count = archive->table->column_count;
    for (size_t i = 0; i < count; i++) {
        members[i].column = &archive->table->columns[i];
        name_member(&members[i]);
        if (!write_member(archive, &members[i])) {
            return;
        }
    }
    uint64_t directory = mns_atomic_size(archive->table->file);
    for (size_t i = 0; i < count; i++) {
        if (!write_entry(archive, &members[i])) {
            return;
        }
    }
    write_end(archive, count, directory);
}

static mns_result write_npz(struct particle_table *table)
{
    struct archive archive = {.table = table};
    struct member *members = calloc(table->column_count, sizeof(*members));
    if (!members) {
        return mns_table_out_of_memory(table);
    }
    fill_crc_table(archive.crc_table);
    write_archive(&archive, members);
    free(members);
    return MNS_OK;
}

const struct mns_particle_writer mns_particle_writer_npy = {"npy", "npy", write_npy};
const struct mns_particle_writer mns_particle_writer_npz = {"npz", "npz", write_npz};
