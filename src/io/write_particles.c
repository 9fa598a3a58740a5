/* write_particles.c: particles as numpy arrays: .npy holds the positions, .npz (a zip of stored .npy members) all there is. */
#include "core/message.h"
#include "io/atomic_file.h"
#include "io/npy.h"
#include "io/reader.h"

#include <stdio.h>
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
    BUFFER = 65536,
    MEMBER_MAX = 7,
    ALIGNMENT = 64
};

struct member {
    const char *name;
    struct mns_attr attr;
    int components;
    uint64_t offset; /* of the local header */
    uint64_t size;   /* of the .npy in it */
    uint32_t crc;
    bool vector; /* [n][components], not [n] */
};

struct writer {
    struct atomic_file *file;
    const struct mns_particles *particles;
    uint32_t crc_table[256];
    uint8_t *buffer; /* [BUFFER] */
};

/* ---- .npy ---- */

static void npy_header(uint8_t out[NPY_HEADER_SIZE], const struct member *member, size_t count)
{
    mns_npy_header(out, member->attr.type, member->vector ? 2 : 1, (const size_t[]){count, (size_t)member->components});
}

/* Takes the packed bytes of an array piece by piece; false: stop. */
typedef bool (*sink)(struct writer *writer, const void *data, size_t size, void *user);

static bool each_piece(struct writer *writer, const struct member *member, sink out, void *user)
{
    size_t bytes = mns_type_size(member->attr.type) * (size_t)member->components, count = writer->particles->count;
    size_t stride = member->attr.stride ? member->attr.stride : bytes, per_piece = BUFFER / bytes;
    const uint8_t *in = member->attr.data;
    if (stride == bytes) { /* packed as it is */
        return count == 0 || out(writer, in, count * bytes, user);
    }
    for (size_t start = 0; start < count; start += per_piece) {
        size_t n = count - start < per_piece ? count - start : per_piece;
        for (size_t i = 0; i < n; i++) {
            memcpy(writer->buffer + i * bytes, in + (start + i) * stride, bytes);
        }
        if (!out(writer, writer->buffer, n * bytes, user)) {
            return false;
        }
    }
    return true;
}

static bool to_file(struct writer *writer, const void *data, size_t size, void *user)
{
    (void)user;
    return mns_atomic_write(writer->file, data, size);
}

static bool write_npy(struct writer *writer, const struct member *member)
{
    uint8_t header[NPY_HEADER_SIZE];
    npy_header(header, member, writer->particles->count);
    return mns_atomic_write(writer->file, header, NPY_HEADER_SIZE) && each_piece(writer, member, to_file, NULL);
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

static bool to_crc(struct writer *writer, const void *data, size_t size, void *user)
{
    uint32_t *crc = user, c = *crc;
    const uint8_t *p = data;
    for (size_t i = 0; i < size; i++) {
        c = writer->crc_table[(c ^ p[i]) & 0xff] ^ (c >> 8);
    }
    *crc = c;
    return true;
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
    p = put(p, 45, 2);   /* zip64 */
    p = put(p, 0, 2);    /* flags */
    p = put(p, 0, 2);    /* stored */
    p = put(p, 0, 2);    /* 00:00 */
    p = put(p, 0x21, 2); /* 1 January 1980: the same bytes every time */
    p = put(p, member->crc, 4);
    p = put(p, UINT32_MAX, 4);
    p = put(p, UINT32_MAX, 4);
    p = put(p, name_size, 2);
    return put(p, extra_size, 2);
}

/* The local header, padded by an extra field so that the array's bytes are aligned in the file, and the member. */
static bool write_member(struct writer *writer, struct member *member)
{
    uint8_t header[LOCAL_SIZE + 32 + LOCAL_EXTRA + 4 + ALIGNMENT] = {0}, array[NPY_HEADER_SIZE];
    size_t name_size = strlen(member->name) + 4, count = writer->particles->count;
    member->offset = mns_atomic_size(writer->file);
    member->size = NPY_HEADER_SIZE + (uint64_t)count * (uint64_t)member->components * mns_type_size(member->attr.type);
    npy_header(array, member, count);
    uint32_t crc = UINT32_MAX;
    to_crc(writer, array, NPY_HEADER_SIZE, &crc);
    each_piece(writer, member, to_crc, &crc);
    member->crc = ~crc;

    size_t padding = (ALIGNMENT - (size_t)((member->offset + LOCAL_SIZE + name_size + LOCAL_EXTRA + 4) % ALIGNMENT)) % ALIGNMENT;
    uint8_t *p = put(header, 0x04034b50, 4);
    p = put_common(p, member, name_size, LOCAL_EXTRA + 4 + padding);
    memcpy(p, member->name, name_size - 4);
    memcpy(p + name_size - 4, ".npy", 4);
    p = put(p + name_size, 1, 2);
    p = put(p, 16, 2);
    p = put(p, member->size, 8);
    p = put(p, member->size, 8);
    p = put(p, 0xa220, 2); /* padding, as others mark it */
    p = put(p, padding, 2);
    return mns_atomic_write(writer->file, header, (size_t)(p - header) + padding) && write_npy(writer, member);
}

static bool write_entry(struct writer *writer, const struct member *member)
{
    uint8_t entry[ENTRY_SIZE + 32 + ENTRY_EXTRA] = {0};
    size_t name_size = strlen(member->name) + 4;
    uint8_t *p = put(entry, 0x02014b50, 4);
    p = put(p, 45, 2);
    p = put_common(p, member, name_size, ENTRY_EXTRA);
    p = put(p, 0, 2); /* comment */
    p = put(p, 0, 2); /* disk */
    p = put(p, 0, 2);
    p = put(p, 0, 4); /* attributes */
    p = put(p, UINT32_MAX, 4);
    memcpy(p, member->name, name_size - 4);
    memcpy(p + name_size - 4, ".npy", 4);
    p = put(p + name_size, 1, 2);
    p = put(p, 24, 2);
    p = put(p, member->size, 8);
    p = put(p, member->size, 8);
    p = put(p, member->offset, 8);
    return mns_atomic_write(writer->file, entry, (size_t)(p - entry));
}

static bool write_end(struct writer *writer, size_t members, uint64_t directory)
{
    uint8_t end[END64_SIZE + LOCATOR_SIZE + END_SIZE];
    uint64_t at = mns_atomic_size(writer->file), size = at - directory;
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
    p = put(p, members, 2);
    p = put(p, members, 2);
    p = put(p, UINT32_MAX, 4);
    p = put(p, UINT32_MAX, 4);
    p = put(p, 0, 2);
    return mns_atomic_write(writer->file, end, (size_t)(p - end));
}

static bool write_npz(struct writer *writer)
{
    const struct mns_particles *particles = writer->particles;
    struct member members[MEMBER_MAX] = {
        {.name = "position", .attr = particles->position, .components = 3, .vector = true},
        {.name = "velocity", .attr = particles->velocity, .components = 3, .vector = true},
        {.name = "density", .attr = particles->density, .components = 1},
        {.name = "radius", .attr = particles->radius, .components = 1},
        {.name = "id", .attr = particles->id, .components = 1},
        {.name = "mass", .attr = particles->mass, .components = 1},
        {.name = "color", .attr = particles->color, .components = 3, .vector = true},
    };
    size_t count = 0;
    fill_crc_table(writer->crc_table);
    for (size_t i = 0; i < MEMBER_MAX; i++) {
        if (!members[i].attr.data && i > 0) {
            continue;
        }
        members[count] = members[i];
        if (!write_member(writer, &members[count++])) {
            return false;
        }
    }
    uint64_t directory = mns_atomic_size(writer->file);
    for (size_t i = 0; i < count; i++) {
        if (!write_entry(writer, &members[i])) {
            return false;
        }
    }
    return write_end(writer, count, directory);
}

/* ---- entry ---- */

static bool ends_in(const char *path, const char *extension)
{
    size_t length = strlen(path), n = strlen(extension);
    return length > n && strcmp(path + length - n, extension) == 0;
}

static mns_result check(const char *path, const struct mns_particles *particles, struct mns_message *message)
{
    const struct mns_attr *const attributes[] = {&particles->position, &particles->radius,  &particles->mass, &particles->color,
                                                 &particles->velocity, &particles->density, &particles->id};
    if (!ends_in(path, ".npy") && !ends_in(path, ".npz")) {
        return mns_fail(message, MNS_ERR_UNSUPPORTED, "%s: particles are written as .npy or .npz", path);
    }
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

mns_result mns_particles_write(const char *path, const struct mns_particles *particles, struct mns_message *message)
{
    if (!path || !particles) {
        return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "mns_particles_write: path or particles is NULL");
    }
    struct mns_particles known;
    mns_particles_init(&known);
    memcpy(&known, particles, particles->struct_size < sizeof(known) ? particles->struct_size : sizeof(known));
    struct writer writer = {.particles = &known};
    mns_result result = check(path, &known, message);
    if (result != MNS_OK) {
        return result;
    }
    writer.buffer = malloc(BUFFER);
    if (!writer.buffer) {
        return mns_fail(message, MNS_ERR_OUT_OF_MEMORY, "%s: out of memory", path);
    }
    result = mns_atomic_begin(&writer.file, path, message);
    if (result == MNS_OK) {
        if (ends_in(path, ".npz")) {
            write_npz(&writer); /* what fails is told by the commit */
        } else {
            write_npy(&writer, &(struct member){.attr = known.position, .components = 3, .vector = true});
        }
        result = mns_atomic_commit(writer.file, message);
    }
    free(writer.buffer);
    return result;
}
