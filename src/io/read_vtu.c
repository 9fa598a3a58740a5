/* read_vtu.c: VTK XML files of one UnstructuredGrid (.vtu) or PolyData (.vtp): the points and point data of all their pieces.
 *
 * Appended raw data are no XML: parsing stops where they begin. */
#include "io/vtk_data.h"
#include "io/vtk_xml.h"

#include <string.h>

struct piece {
    size_t points;
    size_t first; /* of its arrays */
};

enum section { SECTION_NONE, SECTION_POINTS, SECTION_POINT_DATA };

struct vtu {
    struct read_context *context;
    const char *type; /* UnstructuredGrid, PolyData */
    struct vtk_packed packed;
    struct vtk_arrays arrays;
    struct piece *pieces;
    size_t piece_count, piece_capacity;
    bool has_grid, in_grid, in_piece; /* of the element in hand */
    enum section section;
    bool in_array;      /* the last of arrays is being read */
    size_t text_at;     /* where what may be its data begins */
    size_t appended_at; /* 0: there are no appended data */
    bool appended_raw;
};

/* ---- attributes of elements ---- */

static mns_result bad_value(const struct vtu *vtu, const char *element, const char *attribute, const char *value, const char *wanted)
{
    return mns_read_fail(vtu->context, MNS_ERR_BAD_DATA, "<%s %s=\"%.60s\"> where %s should be", element, attribute, value ? value : "",
                         wanted);
}

static mns_result set_compressor(struct vtu *vtu, const char *name)
{
    static const struct {
        const char *name;
        enum codec codec;
    } compressors[] = {{"vtkZLibDataCompressor", CODEC_ZLIB}, {"vtkLZ4DataCompressor", CODEC_LZ4}, {"vtkLZMADataCompressor", CODEC_LZMA}};
    vtu->packed.compressed = name && name[0] != '\0';
    if (!vtu->packed.compressed) {
        return MNS_OK;
    }
    for (size_t i = 0; i < sizeof(compressors) / sizeof(compressors[0]); i++) {
        if (strcmp(name, compressors[i].name) == 0) {
            vtu->packed.codec = compressors[i].codec;
            return MNS_OK;
        }
    }
    return mns_read_fail(vtu->context, MNS_ERR_UNSUPPORTED, "is compressed with '%.60s'; zlib, lz4 and lzma are read", name);
}

static mns_result start_file(struct vtu *vtu, const char *const *attributes)
{
    const char *order = mns_xml_get(attributes, "byte_order"), *header = mns_xml_get(attributes, "header_type");
    vtu->packed.big_endian = order ? strcmp(order, "BigEndian") == 0 : mns_big_endian();
    if (order && !vtu->packed.big_endian && strcmp(order, "LittleEndian") != 0) {
        return bad_value(vtu, "VTKFile", "byte_order", order, "LittleEndian or BigEndian");
    }
    vtu->packed.header_size = header && strcmp(header, "UInt64") == 0 ? 8 : 4;
    if (header && vtu->packed.header_size == 4 && strcmp(header, "UInt32") != 0) {
        return bad_value(vtu, "VTKFile", "header_type", header, "UInt32 or UInt64");
    }
    return set_compressor(vtu, mns_xml_get(attributes, "compressor"));
}

static mns_result start_appended(struct vtu *vtu, struct vtk_xml *xml, const char *const *attributes)
{
    const char *encoding = mns_xml_get(attributes, "encoding");
    vtu->appended_raw = encoding && strcmp(encoding, "raw") == 0;
    if (encoding && !vtu->appended_raw && strcmp(encoding, "base64") != 0) {
        return bad_value(vtu, "AppendedData", "encoding", encoding, "raw or base64");
    }
    vtu->appended_at = xml->tag_end;
    xml->stop = true;
    return MNS_OK;
}

static mns_result start_piece(struct vtu *vtu, const char *const *attributes)
{
    const char *count = mns_xml_get(attributes, "NumberOfPoints");
    struct piece *pieces = mns_vtk_grow(vtu->context, vtu->pieces, &vtu->piece_capacity, vtu->piece_count, sizeof(*pieces));
    if (!pieces) {
        return MNS_ERR_OUT_OF_MEMORY;
    }
    vtu->pieces = pieces;
    struct piece *piece = &pieces[vtu->piece_count];
    piece->first = vtu->arrays.count;
    if (!mns_xml_count(count, &piece->points)) {
        return bad_value(vtu, "Piece", "NumberOfPoints", count, "the number of points");
    }
    vtu->piece_count++;
    vtu->in_piece = true;
    return MNS_OK;
}

/* false: of strings or bits, which are nothing to us. */
static bool parse_type(const char *name, enum mns_type *out)
{
    static const struct {
        const char *name;
        enum mns_type type;
    } types[] = {{"Float32", MNS_F32}, {"Float64", MNS_F64}, {"Int8", MNS_I8},    {"UInt8", MNS_U8},  {"Int16", MNS_I16},
                 {"UInt16", MNS_U16},  {"Int32", MNS_I32},   {"UInt32", MNS_U32}, {"Int64", MNS_I64}, {"UInt64", MNS_U64}};
    for (size_t i = 0; i < sizeof(types) / sizeof(types[0]); i++) {
        if (strcmp(name, types[i].name) == 0) {
            *out = types[i].type;
            return true;
        }
    }
    return false;
}

static mns_result start_array(struct vtu *vtu, const struct vtk_xml *xml, const char *const *attributes)
{
    const char *type = mns_xml_get(attributes, "type"), *format = mns_xml_get(attributes, "format");
    const char *components = mns_xml_get(attributes, "NumberOfComponents"), *offset = mns_xml_get(attributes, "offset");
    const char *name = mns_xml_get(attributes, "Name");
    struct vtk_array array = {.points = vtu->section == SECTION_POINTS, .data = {xml->file.data + xml->tag_end, 0}};
    size_t count = array.points ? 3 : 1, place = 0;
    if (!type) {
        return bad_value(vtu, "DataArray", "type", type, "a type such as Float32");
    }
    if (!parse_type(type, &array.type)) {
        return MNS_OK;
    }
    if (components && (!mns_xml_count(components, &count) || count < 1 || count > 1 << 20)) {
        return bad_value(vtu, "DataArray", "NumberOfComponents", components, "a number from 1 on");
    }
    array.components = (int)count;
    array.appended = format && strcmp(format, "appended") == 0;
    if (array.appended && !mns_xml_count(offset, &place)) {
        return bad_value(vtu, "DataArray", "offset", offset, "the place in the appended data");
    }
    array.offset = place;
    array.coding = format && strcmp(format, "binary") == 0 ? VTK_BASE64 : VTK_TEXT;
    if (format && !array.appended && array.coding == VTK_TEXT && strcmp(format, "ascii") != 0) {
        return bad_value(vtu, "DataArray", "format", format, "ascii, binary or appended");
    }
    struct bytes text = {(const uint8_t *)name, name ? strlen(name) : 0};
    if (!mns_vtk_add(vtu->context, &vtu->arrays, &array, text)) {
        return MNS_ERR_OUT_OF_MEMORY;
    }
    vtu->in_array = true;
    vtu->text_at = xml->tag_end;
    return MNS_OK;
}

/* ---- elements ---- */

/* Data of an array in hand end at the next tag, unless they are blanks: an <InformationKey> may stand before or behind them. */
static void end_text(struct vtu *vtu, const struct vtk_xml *xml)
{
    struct vtk_array *array = &vtu->arrays.items[vtu->arrays.count - 1];
    const uint8_t *data = xml->file.data;
    size_t at = vtu->text_at;
    if (array->appended || array->data.size > 0) {
        return;
    }
    while (at < xml->tag_at && mns_vtk_is_blank(data[at])) {
        at++;
    }
    if (at < xml->tag_at) {
        array->data = (struct bytes){data + at, xml->tag_at - at};
    }
    vtu->text_at = xml->tag_end;
}

static mns_result start(struct vtk_xml *xml, const char *name, const char *const *attributes)
{
    struct vtu *vtu = xml->user;
    switch (xml->depth) {
    case 0: return start_file(vtu, attributes);
    case 1:
        vtu->in_grid = strcmp(name, vtu->type) == 0;
        vtu->has_grid |= vtu->in_grid;
        return strcmp(name, "AppendedData") == 0 ? start_appended(vtu, xml, attributes) : MNS_OK;
    case 2: return vtu->in_grid && strcmp(name, "Piece") == 0 ? start_piece(vtu, attributes) : MNS_OK;
    case 3:
        if (vtu->in_piece && strcmp(name, "Points") == 0) {
            vtu->section = SECTION_POINTS;
        } else if (vtu->in_piece && strcmp(name, "PointData") == 0) {
            vtu->section = SECTION_POINT_DATA;
        }
        return MNS_OK;
    case 4: return vtu->section != SECTION_NONE && strcmp(name, "DataArray") == 0 ? start_array(vtu, xml, attributes) : MNS_OK;
    case 5:
        if (vtu->in_array) {
            end_text(vtu, xml);
        }
        return MNS_OK;
    default: return MNS_OK;
    }
}

static mns_result end(struct vtk_xml *xml)
{
    struct vtu *vtu = xml->user;
    switch (xml->depth) {
    case 1: vtu->in_grid = false; break;
    case 2: vtu->in_piece = false; break;
    case 3: vtu->section = SECTION_NONE; break;
    case 4:
        if (vtu->in_array) {
            end_text(vtu, xml);
        }
        vtu->in_array = false;
        break;
    case 5: vtu->text_at = xml->tag_end; break;
    default: break;
    }
    return MNS_OK;
}

/* ---- reading ---- */

/* Appended data begin with an underscore; offsets count from behind it. */
static mns_result find_appended(const struct vtu *vtu, struct bytes file, struct bytes *out)
{
    size_t at = vtu->appended_at;
    *out = (struct bytes){NULL, 0};
    if (at == 0) {
        return MNS_OK;
    }
    while (at < file.size && mns_vtk_is_blank(file.data[at])) {
        at++;
    }
    if (at == file.size || file.data[at] != '_') {
        return mns_read_fail(vtu->context, MNS_ERR_BAD_DATA, "has no '_' where the appended data begin");
    }
    *out = (struct bytes){file.data + at + 1, file.size - at - 1};
    return MNS_OK;
}

/* Moves raw data that could stay where they are, but for their alignment, over the end of <AppendedData>, which has been read: at most 7 bytes.
 * The first array then stands on 8 bytes, and so do most others. Moving takes less time than new memory, and half the room. */
static void align_appended(const struct vtu *vtu, struct bytes *data)
{
    bool may_stay = vtu->appended_raw && !vtu->packed.compressed && vtu->packed.big_endian == mns_big_endian();
    if (!may_stay || !vtu->context->file_is_ours || data->size == 0) {
        return;
    }
    size_t shift = ((uintptr_t)data->data + vtu->packed.header_size) % 8;
    uint8_t *aligned = (uint8_t *)(uintptr_t)data->data - shift;
    if (shift > 0) {
        memmove(aligned, data->data, data->size);
    }
    data->data = aligned;
}

static mns_result place_appended(struct vtu *vtu, struct bytes file)
{
    struct bytes data;
    mns_result result = find_appended(vtu, file, &data);
    if (result == MNS_OK) {
        align_appended(vtu, &data);
    }
    for (size_t i = 0; i < vtu->arrays.count && result == MNS_OK; i++) {
        struct vtk_array *array = &vtu->arrays.items[i];
        if (!array->appended) {
            continue;
        }
        if (!data.data) {
            return mns_read_fail(vtu->context, MNS_ERR_BAD_DATA, "has no <AppendedData>, where '%s' should be", mns_vtk_name(array));
        }
        if (array->offset > data.size) {
            return mns_read_fail(vtu->context, MNS_ERR_BAD_DATA,
                                 "ends early: '%s' should begin at byte %llu of the appended data, which have %zu", mns_vtk_name(array),
                                 (unsigned long long)array->offset, data.size);
        }
        array->coding = vtu->appended_raw ? VTK_RAW : VTK_BASE64;
        array->data = (struct bytes){data.data + array->offset, data.size - (size_t)array->offset};
    }
    return result;
}

static mns_result add_pieces(const struct vtu *vtu)
{
    mns_result result = MNS_OK;
    if (!vtu->has_grid) {
        return mns_read_fail(vtu->context, MNS_ERR_BAD_DATA, "has no <%s>", vtu->type);
    }
    if (vtu->piece_count == 0) {
        return mns_set_begin(vtu->context, 0);
    }
    for (size_t i = 0; i < vtu->piece_count && result == MNS_OK; i++) {
        const struct piece *piece = &vtu->pieces[i];
        size_t end_of_arrays = i + 1 < vtu->piece_count ? piece[1].first : vtu->arrays.count;
        const struct vtk_array *arrays = vtu->arrays.items ? vtu->arrays.items + piece->first : NULL;
        result = mns_vtk_add_piece(&vtu->packed.source, arrays, end_of_arrays - piece->first, piece->points);
    }
    return result;
}

static mns_result read_grid(struct read_context *context, struct bytes file, const char *const *types)
{
    struct vtu vtu = {.context = context, .type = types[0], .packed = {.source = mns_vtk_packed_source}};
    struct vtk_xml xml = {.context = context, .file = file, .types = types, .user = &vtu, .start = start, .end = end};
    vtu.packed.source.context = context;
    mns_result result = mns_xml_parse(&xml);
    if (result == MNS_OK) {
        result = place_appended(&vtu, file);
    }
    if (result == MNS_OK) {
        result = add_pieces(&vtu);
    }
    mns_vtk_free(context, &vtu.arrays);
    if (vtu.piece_capacity > 0) {
        mns_read_free(context, vtu.pieces, vtu.piece_capacity, sizeof(*vtu.pieces));
    }
    return result;
}

static const char *const vtu_types[] = {"UnstructuredGrid", NULL};
static const char *const vtp_types[] = {"PolyData", NULL};

static int probe_vtu(struct bytes head) { return mns_xml_probe(head, vtu_types); }

static int probe_vtp(struct bytes head) { return mns_xml_probe(head, vtp_types); }

static mns_result read_vtu(struct read_context *context, struct bytes file) { return read_grid(context, file, vtu_types); }

static mns_result read_vtp(struct read_context *context, struct bytes file) { return read_grid(context, file, vtp_types); }

const struct mns_reader mns_reader_vtu = {"vtu", "vtu", probe_vtu, read_vtu};
const struct mns_reader mns_reader_vtp = {"vtp", "vtp", probe_vtp, read_vtp};
