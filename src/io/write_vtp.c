/* write_vtp.c: particles as the points of a VTK XML PolyData file: raw appended data, in zlib blocks where zlib is there. One poly-vertex holds
 * all points, so that viewers show them. */
#include "io/particle_writer.h"
#include "io/reader.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { BLOCK_BYTES = 1 << 20 };

/* The appended data, gathered before the XML that says where in them each array begins. */
struct appended {
    uint8_t *data;
    size_t size, capacity;
    bool failed;                /* out of memory */
    size_t sizes_at;            /* place of the packed blocks' sizes in the header of the array in hand */
    uint8_t block[BLOCK_BYTES]; /* being filled */
    size_t block_size;
};

static uint8_t *reserve(struct appended *appended, size_t size)
{
    if (size > appended->capacity - appended->size) {
        size_t wanted = appended->capacity + appended->capacity / 2 + size;
        uint8_t *grown = wanted > appended->capacity ? realloc(appended->data, wanted) : NULL;
        if (!grown) {
            appended->failed = true;
            return NULL;
        }
        appended->data = grown;
        appended->capacity = wanted;
    }
    return appended->data + appended->size;
}

static void append(struct appended *appended, const void *data, size_t size)
{
    uint8_t *at = reserve(appended, size);
    if (at && size > 0) {
        memcpy(at, data, size);
        appended->size += size;
    }
}

static void append_number(struct appended *appended, uint64_t value) { append(appended, &value, sizeof(value)); }

/* Packs the block that was filled and notes its size in the array's header. */
static void end_block(struct appended *appended)
{
    uint8_t *at = appended->block_size ? reserve(appended, mns_pack_bound(appended->block_size)) : NULL;
    if (!at) {
        return;
    }
    uint64_t packed = mns_pack(appended->block, appended->block_size, at);
    appended->failed = appended->failed || packed == 0;
    memcpy(appended->data + appended->sizes_at, &packed, sizeof(packed));
    appended->sizes_at += sizeof(packed);
    appended->size += (size_t)packed;
    appended->block_size = 0;
}

static bool put_packed(void *user, const void *data, size_t size)
{
    struct appended *appended = user;
    const uint8_t *in = data;
    while (size > 0 && !appended->failed) {
        size_t room = BLOCK_BYTES - appended->block_size, taken = size < room ? size : room;
        memcpy(appended->block + appended->block_size, in, taken);
        appended->block_size += taken;
        in += taken;
        size -= taken;
        if (appended->block_size == BLOCK_BYTES) {
            end_block(appended);
        }
    }
    return !appended->failed;
}

static bool put_plain(void *user, const void *data, size_t size)
{
    struct appended *appended = user;
    append(appended, data, size);
    return !appended->failed;
}

/* The header of an array of so many bytes. */
static void begin_array(struct appended *appended, uint64_t bytes)
{
    if (!mns_can_pack()) {
        append_number(appended, bytes);
        return;
    }
    uint64_t blocks = (bytes + BLOCK_BYTES - 1) / BLOCK_BYTES;
    append_number(appended, blocks);
    append_number(appended, BLOCK_BYTES);
    append_number(appended, bytes % BLOCK_BYTES);
    appended->sizes_at = appended->size;
    for (uint64_t i = 0; i < blocks && !appended->failed; i++) {
        append_number(appended, 0);
    }
}

static struct byte_sink sink_of(struct appended *appended) { return (struct byte_sink){mns_can_pack() ? put_packed : put_plain, appended}; }

/* Whole numbers from `first` on, as the connectivity of the poly-vertex wants them. */
static void append_counting(struct appended *appended, size_t count, size_t first)
{
    const struct byte_sink sink = sink_of(appended);
    begin_array(appended, 8 * (uint64_t)count);
    for (size_t i = 0; i < count && !appended->failed; i++) {
        int64_t value = (int64_t)(first + i);
        sink.put(sink.user, &value, sizeof(value));
    }
    end_block(appended);
}

/* ---- XML ---- */

static bool put_text(const struct particle_table *table, const char *text) { return mns_atomic_write(table->file, text, strlen(text)); }

static void put_escaped(const struct particle_table *table, const char *text)
{
    for (; *text; text++) {
        const char *entity = *text == '&' ? "&amp;" : *text == '<' ? "&lt;" : *text == '>' ? "&gt;" : *text == '"' ? "&quot;" : NULL;
        if (entity) {
            put_text(table, entity);
        } else {
            mns_atomic_write(table->file, text, 1);
        }
    }
}

static void put_array(const struct particle_table *table, const char *type, const char *name, int components, uint64_t offset)
{
    char text[128];
    snprintf(text, sizeof(text), "<DataArray type=\"%s\" Name=\"", type);
    put_text(table, text);
    put_escaped(table, name);
    snprintf(text, sizeof(text), "\" NumberOfComponents=\"%d\" format=\"appended\" offset=\"%" PRIu64 "\"/>\n", components, offset);
    put_text(table, text);
}

static const char *type_name(enum mns_type type)
{
    static const char *const names[] = {"Float32", "Float64", "Int8", "UInt8", "Int16", "UInt16", "Int32", "UInt32", "Int64", "UInt64"};
    return names[type];
}

/* offsets: [column_count + 2], of the columns, the connectivity and its end. */
static void put_document(const struct particle_table *table, const uint64_t *offsets, const struct appended *appended)
{
    char text[256];
    snprintf(text, sizeof(text),
             "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"%s\" header_type=\"UInt64\"%s>\n",
             mns_big_endian() ? "BigEndian" : "LittleEndian", mns_can_pack() ? " compressor=\"vtkZLibDataCompressor\"" : "");
    put_text(table, text);
    snprintf(text, sizeof(text),
             "<PolyData><Piece NumberOfPoints=\"%zu\" NumberOfVerts=\"%d\" NumberOfLines=\"0\" NumberOfStrips=\"0\" NumberOfPolys=\"0\">\n",
             table->count, table->count > 0);
    put_text(table, text);
    put_text(table, "<Points>\n");
    put_array(table, type_name(table->columns[0].type), "Points", 3, offsets[0]);
    put_text(table, "</Points>\n<PointData>\n");
    for (size_t i = 1; i < table->column_count; i++) {
        put_array(table, type_name(table->columns[i].type), table->columns[i].name, table->columns[i].components, offsets[i]);
    }
    put_text(table, "</PointData>\n<Verts>\n");
    put_array(table, "Int64", "connectivity", 1, offsets[table->column_count]);
    put_array(table, "Int64", "offsets", 1, offsets[table->column_count + 1]);
    put_text(table, "</Verts>\n</Piece></PolyData>\n<AppendedData encoding=\"raw\">\n_");
    mns_atomic_write(table->file, appended->data, appended->size);
    put_text(table, "\n</AppendedData>\n</VTKFile>\n");
}

static mns_result write_vtp(struct particle_table *table)
{
    size_t columns = table->column_count;
    struct appended *appended = calloc(1, sizeof(*appended));
    uint64_t *offsets = malloc((columns + 2) * sizeof(*offsets));
    mns_result result = MNS_OK;
    if (!appended || !offsets) {
        result = mns_table_out_of_memory(table);
        goto done;
    }
    const struct byte_sink sink = sink_of(appended);
    for (size_t i = 0; i < columns; i++) {
        offsets[i] = appended->size;
        begin_array(appended, (uint64_t)table->count * mns_column_bytes(&table->columns[i]));
        mns_column_put(table, &table->columns[i], &sink);
        end_block(appended);
    }
    offsets[columns] = appended->size;
    append_counting(appended, table->count, 0);
    offsets[columns + 1] = appended->size;
    append_counting(appended, table->count > 0, table->count);
    if (appended->failed) {
        result = mns_table_out_of_memory(table);
    } else {
        put_document(table, offsets, appended);
    }
done:
    free(appended ? appended->data : NULL);
    free(appended);
    free(offsets);
    return result;
}

const struct mns_particle_writer mns_particle_writer_vtp = {"vtp", "vtp", write_vtp};
