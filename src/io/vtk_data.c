/* vtk_data.c: the data of an array in VTK's XML files: text, or a header and bytes, plain or in compressed blocks, raw or in base64.
 *
 * Not compressed: [bytes] data. Compressed: [blocks] [block bytes] [last block's bytes, 0: as the others] [packed bytes of each block] data.
 * In base64, the header of compressed data is a stream of its own. */
#include "io/vtk_data.h"

#include "io/base64.h"

#include <string.h>

/* An array's header, understood. */
struct packing {
    struct bytes data; /* behind the header; in base64 as text, with more behind it */
    size_t skip;       /* bytes of the header in data's base64 stream */
    size_t blocks, block_bytes, last_bytes, packed_bytes;
    const uint8_t *sizes; /* [blocks], of the packed blocks */
    uint8_t *header;      /* what base64 was decoded to; NULL: nothing was */
    size_t header_bytes;
};

static const struct vtk_packed *packed_of(const struct vtk_source *source) { return (const struct vtk_packed *)(const void *)source; }

static uint64_t load(const struct vtk_packed *packed, const uint8_t *p)
{
    uint64_t value = 0;
    for (size_t i = 0; i < packed->header_size; i++) {
        value |= (uint64_t)p[i] << 8 * (packed->big_endian ? packed->header_size - 1 - i : i);
    }
    return value;
}

static mns_result ends_early(const struct vtk_packed *packed, const struct vtk_array *array)
{
    return mns_read_fail(packed->source.context, MNS_ERR_BAD_DATA, "ends early, in the data of '%s'", mns_vtk_name(array));
}

static mns_result wrong_size(const struct vtk_packed *packed, const struct vtk_array *array, uint64_t bytes, size_t wanted)
{
    return mns_read_fail(packed->source.context, MNS_ERR_BAD_DATA, "'%s' holds %llu bytes where %zu should be", mns_vtk_name(array),
                         (unsigned long long)bytes, wanted);
}

/* What so many characters of base64 can hold at most. */
static size_t room(const struct vtk_array *array, struct bytes data)
{
    return array->coding == VTK_BASE64 ? data.size / 4 * 3 + 3 : data.size;
}

static mns_result open_plain(const struct vtk_packed *packed, const struct vtk_array *array, size_t wanted, struct packing *packing)
{
    uint8_t first[9]; /* one more than the header tells whether its stream goes on */
    const uint8_t *p = array->data.data;
    size_t header = packed->header_size, used;
    if (array->coding == VTK_BASE64) {
        size_t got = mns_base64_decode(array->data, 0, first, header + 1, &used);
        if (got < header) {
            return ends_early(packed, array);
        }
        p = first;
        packing->skip = got > header ? header : 0;
        used = got > header ? 0 : used;
    } else {
        if (array->data.size < header) {
            return ends_early(packed, array);
        }
        used = header;
    }
    packing->data = (struct bytes){array->data.data + used, array->data.size - used};
    if (load(packed, p) != wanted) {
        return wrong_size(packed, array, load(packed, p), wanted);
    }
    return wanted > room(array, packing->data) ? ends_early(packed, array) : MNS_OK;
}

/* Takes the header of compressed data, all (3 + blocks) numbers; *numbers: where they stand. */
static mns_result take_header(const struct vtk_packed *packed, const struct vtk_array *array, struct packing *packing,
                              const uint8_t **numbers)
{
    uint8_t first[8];
    size_t size = packed->header_size, used;
    bool text = array->coding == VTK_BASE64;
    if (text ? mns_base64_decode(array->data, 0, first, size, &used) < size : array->data.size < size) {
        return ends_early(packed, array);
    }
    uint64_t blocks = load(packed, text ? first : array->data.data);
    packing->blocks = (size_t)blocks;
    if (blocks == 0) {
        return MNS_OK;
    }
    if (blocks > room(array, array->data) / size - 1) {
        return ends_early(packed, array);
    }
    size_t bytes = (3 + packing->blocks) * size;
    if (!text) {
        if (bytes > array->data.size) {
            return ends_early(packed, array);
        }
        *numbers = array->data.data;
        used = bytes;
    } else {
        packing->header = mns_read_alloc(packed->source.context, bytes, 1);
        if (!packing->header) {
            return MNS_ERR_OUT_OF_MEMORY;
        }
        packing->header_bytes = bytes;
        *numbers = packing->header;
        if (mns_base64_decode(array->data, 0, packing->header, bytes, &used) < bytes) {
            return ends_early(packed, array);
        }
    }
    packing->data = (struct bytes){array->data.data + used, array->data.size - used};
    return MNS_OK;
}

static mns_result open_compressed(const struct vtk_packed *packed, const struct vtk_array *array, size_t wanted, struct packing *packing)
{
    const uint8_t *numbers = NULL;
    size_t size = packed->header_size;
    mns_result result = take_header(packed, array, packing, &numbers);
    if (result != MNS_OK) {
        return result;
    }
    if (packing->blocks == 0) {
        return wanted == 0 ? MNS_OK : wrong_size(packed, array, 0, wanted);
    }
    uint64_t block = load(packed, numbers + size), last = load(packed, numbers + 2 * size);
    uint64_t whole = packing->blocks - (last != 0);
    if (last > wanted || (whole > 0 && (block == 0 || block > wanted / whole)) || whole * block + last != wanted) {
        return mns_read_fail(packed->source.context, MNS_ERR_BAD_DATA,
                             "'%s' is packed as %zu blocks of %llu bytes, the last of %llu; that are not "
                             "the %zu bytes that should be there",
                             mns_vtk_name(array), packing->blocks, (unsigned long long)block, (unsigned long long)last, wanted);
    }
    packing->block_bytes = (size_t)block;
    packing->last_bytes = last != 0 ? (size_t)last : (size_t)block;
    packing->sizes = numbers + 3 * size;
    size_t most = room(array, packing->data);
    for (size_t i = 0; i < packing->blocks; i++) {
        uint64_t bytes = load(packed, packing->sizes + i * size);
        if (bytes > most - packing->packed_bytes) {
            return ends_early(packed, array);
        }
        packing->packed_bytes += (size_t)bytes;
    }
    if (mns_is_bomb(packed->source.context, packing->packed_bytes, wanted)) {
        return mns_read_fail(packed->source.context, MNS_ERR_BAD_DATA,
                             "'%s' unpacks to %zu bytes from %zu, which no particles do; set max_bytes if it "
                             "is meant so",
                             mns_vtk_name(array), wanted, packing->packed_bytes);
    }
    return MNS_OK;
}

static mns_result open_array(const struct vtk_packed *packed, const struct vtk_array *array, size_t elements, struct packing *packing)
{
    size_t wanted = elements * mns_type_size(array->type);
    *packing = (struct packing){.data = array->data};
    if (array->coding == VTK_TEXT) {
        if (elements <= array->data.size / 2 + 1) {
            return MNS_OK;
        }
        return mns_read_fail(packed->source.context, MNS_ERR_BAD_DATA,
                             "'%s' has %zu characters, which cannot be the %zu numbers that should be there", mns_vtk_name(array),
                             array->data.size, elements);
    }
    return packed->compressed ? open_compressed(packed, array, wanted, packing) : open_plain(packed, array, wanted, packing);
}

static void close_array(const struct vtk_packed *packed, struct packing *packing)
{
    if (packing->header) {
        mns_read_free(packed->source.context, packing->header, packing->header_bytes, 1);
    }
}

static mns_result check(const struct vtk_source *source, const struct vtk_array *array, size_t elements, const uint8_t **plain)
{
    const struct vtk_packed *packed = packed_of(source);
    struct packing packing;
    mns_result result = open_array(packed, array, elements, &packing);
    bool in_order = packed->big_endian == mns_big_endian() || mns_type_size(array->type) == 1;
    *plain = array->coding == VTK_RAW && !packed->compressed && in_order ? packing.data.data : NULL;
    close_array(packed, &packing);
    return result;
}

/* Says of which array and block the decompressor spoke. */
static mns_result name_fault(const struct vtk_packed *packed, const struct vtk_array *array, size_t block, size_t blocks, mns_result result)
{
    struct read_context *context = packed->source.context;
    char fault[sizeof(context->message->text)];
    if (result != MNS_ERR_BAD_DATA) {
        return result;
    }
    const char *text = context->message->text, *prefix = context->path ? context->path : "(memory)";
    if (strncmp(text, prefix, strlen(prefix)) == 0 && strncmp(text + strlen(prefix), ": ", 2) == 0) {
        text += strlen(prefix) + 2;
    }
    memcpy(fault, text, strlen(text) + 1);
    return mns_read_fail(context, result, "'%s', block %zu of %zu: %s", mns_vtk_name(array), block + 1, blocks, fault);
}

static mns_result unpack(const struct vtk_packed *packed, const struct vtk_array *array, const struct packing *packing, uint8_t *out)
{
    struct bytes data = packing->data;
    uint8_t *scratch = NULL;
    size_t at = 0, used;
    mns_result result = MNS_OK;
    if (array->coding == VTK_BASE64 && packing->blocks > 0) {
        scratch = mns_read_alloc(packed->source.context, packing->packed_bytes, 1);
        if (!scratch) {
            return MNS_ERR_OUT_OF_MEMORY;
        }
        if (mns_base64_decode(data, 0, scratch, packing->packed_bytes, &used) < packing->packed_bytes) {
            result = ends_early(packed, array);
        }
        data = (struct bytes){scratch, packing->packed_bytes};
    }
    for (size_t i = 0; i < packing->blocks && result == MNS_OK; i++) {
        size_t size = (size_t)load(packed, packing->sizes + i * packed->header_size);
        size_t bytes = i + 1 < packing->blocks ? packing->block_bytes : packing->last_bytes;
        result = mns_decompress(packed->source.context, packed->codec, (struct bytes){data.data + at, size}, out, bytes);
        result = name_fault(packed, array, i, packing->blocks, result);
        at += size;
        out += bytes;
    }
    if (scratch) {
        mns_read_free(packed->source.context, scratch, packing->packed_bytes, 1);
    }
    return result;
}

static mns_result decode(const struct vtk_source *source, const struct vtk_array *array, size_t elements, void *out)
{
    const struct vtk_packed *packed = packed_of(source);
    struct packing packing;
    size_t bytes = elements * mns_type_size(array->type), used;
    if (array->coding == VTK_TEXT) {
        return mns_vtk_parse_numbers(source->context, array, elements, out);
    }
    mns_result result = open_array(packed, array, elements, &packing);
    if (result == MNS_OK && packed->compressed) {
        result = unpack(packed, array, &packing, out);
    } else if (result == MNS_OK && array->coding == VTK_BASE64) {
        result = mns_base64_decode(packing.data, packing.skip, out, bytes, &used) < bytes ? ends_early(packed, array) : MNS_OK;
    } else if (result == MNS_OK) {
        mns_copy_elements(out, packing.data.data, elements, array->type, packed->big_endian);
    }
    bool in_place = packed->compressed || array->coding == VTK_BASE64;
    if (result == MNS_OK && in_place && packed->big_endian != mns_big_endian() && mns_type_size(array->type) > 1) {
        mns_copy_elements(out, out, elements, array->type, packed->big_endian);
    }
    close_array(packed, &packing);
    return result;
}

const struct vtk_source mns_vtk_packed_source = {NULL, check, decode};
