/* read_vtk.c: legacy VTK files (.vtk), versions 1 to 5.1, ASCII and binary: the points and point data of PolyData and UnstructuredGrid.
 *
 * Keywords and headers are text; the numbers behind a header are text too, or big-endian. Cells, cell data and field data are stepped over.
 * As VTK's own writer does, long is taken to have 64 bits and vtkIdType 32. */
#include "io/vtk_array.h"

#include <string.h>

struct legacy {
    struct read_context *context;
    struct cursor cursor;
    bool binary, has_points;
    size_t points;
    struct vtk_arrays arrays;
    bool in_data;       /* behind POINT_DATA or CELL_DATA */
    bool in_point_data; /* cell data are not kept */
    size_t tuples;      /* of these data */
};

static int probe(struct bytes head)
{
    static const char magic[] = "# vtk DataFile Version";
    return head.size >= sizeof(magic) - 1 && memcmp(head.data, magic, sizeof(magic) - 1) == 0 ? 2 : 0;
}

/* ---- words ---- */

static void skip_blanks(struct cursor *cursor)
{
    while (mns_left(cursor) > 0 && mns_vtk_is_blank(cursor->bytes.data[cursor->at])) {
        cursor->at++;
    }
}

/* The next word, an empty one at the end of the bytes. */
static struct bytes take_word(struct cursor *cursor)
{
    skip_blanks(cursor);
    size_t start = cursor->at;
    while (mns_left(cursor) > 0 && !mns_vtk_is_blank(cursor->bytes.data[cursor->at])) {
        cursor->at++;
    }
    return (struct bytes){cursor->bytes.data + start, cursor->at - start};
}

/* Whether a word is the text, whose letters are lower case, in any case. */
static bool is_word(struct bytes word, const char *text)
{
    if (word.size != strlen(text)) {
        return false;
    }
    for (size_t i = 0; i < word.size; i++) {
        uint8_t c = word.data[i];
        if ((c >= 'A' && c <= 'Z' ? c + ('a' - 'A') : c) != (uint8_t)text[i]) {
            return false;
        }
    }
    return true;
}

static int shown(struct bytes word) { return word.size < 60 ? (int)word.size : 60; }

static bool to_count(struct bytes word, size_t *out)
{
    const char *text = (const char *)word.data, *end = text + word.size;
    int64_t value;
    if (word.size == 0 || mns_parse_int64(text, end, &value) != end || value < 0 || (uint64_t)value > SIZE_MAX / 16) {
        return false;
    }
    *out = (size_t)value;
    return true;
}

static mns_result take_count(struct legacy *vtk, const char *behind, size_t *out)
{
    size_t at = vtk->cursor.at;
    struct bytes word = take_word(&vtk->cursor);
    if (to_count(word, out)) {
        return MNS_OK;
    }
    return mns_read_fail(vtk->context, MNS_ERR_BAD_DATA, "byte %zu: '%.*s' where a number should be, behind %s", at, shown(word),
                         (const char *)word.data, behind);
}

/* VTK writes what is no plain character of a name as %XX. Returns the name, which is in out and has no NUL. */
static struct bytes decode_name(struct bytes encoded, char out[256])
{
    static const char digits[] = "0123456789abcdef";
    size_t size = 0;
    for (size_t i = 0; i < encoded.size && size < 255; i++) {
        char c = (char)encoded.data[i];
        if (c == '%' && i + 2 < encoded.size) {
            const char *high = memchr(digits, encoded.data[i + 1] | 0x20, 16), *low = memchr(digits, encoded.data[i + 2] | 0x20, 16);
            if (high && low) {
                c = (char)((high - digits) << 4 | (low - digits));
                i += 2;
            }
        }
        out[size++] = c != '\0' ? c : '?';
    }
    return (struct bytes){(const uint8_t *)out, size};
}

/* ---- arrays ---- */

enum kind { KIND_NUMBER, KIND_BIT, KIND_STRING, KIND_VARIANT };

static bool parse_type(struct bytes word, enum kind *kind, enum mns_type *type)
{
    static const struct {
        const char *name;
        enum kind kind;
        enum mns_type type;
    } types[] = {{"float", KIND_NUMBER, MNS_F32},        {"double", KIND_NUMBER, MNS_F64},         {"int", KIND_NUMBER, MNS_I32},
                 {"unsigned_int", KIND_NUMBER, MNS_U32}, {"long", KIND_NUMBER, MNS_I64},           {"unsigned_long", KIND_NUMBER, MNS_U64},
                 {"short", KIND_NUMBER, MNS_I16},        {"unsigned_short", KIND_NUMBER, MNS_U16}, {"char", KIND_NUMBER, MNS_I8},
                 {"signed_char", KIND_NUMBER, MNS_I8},   {"unsigned_char", KIND_NUMBER, MNS_U8},   {"vtkidtype", KIND_NUMBER, MNS_I32},
                 {"vtktypeint64", KIND_NUMBER, MNS_I64}, {"vtktypeuint64", KIND_NUMBER, MNS_U64},  {"bit", KIND_BIT, MNS_U8},
                 {"string", KIND_STRING, MNS_U8},        {"utf8_string", KIND_STRING, MNS_U8},     {"variant", KIND_VARIANT, MNS_U8}};
    for (size_t i = 0; i < sizeof(types) / sizeof(types[0]); i++) {
        if (is_word(word, types[i].name)) {
            *kind = types[i].kind;
            *type = types[i].type;
            return true;
        }
    }
    return false;
}

static mns_result take_type(struct legacy *vtk, const char *behind, enum kind *kind, enum mns_type *type)
{
    size_t at = vtk->cursor.at;
    struct bytes word = take_word(&vtk->cursor);
    if (parse_type(word, kind, type)) {
        return MNS_OK;
    }
    return mns_read_fail(vtk->context, MNS_ERR_BAD_DATA, "byte %zu: '%.*s' where a type such as float should be, behind %s", at,
                         shown(word), (const char *)word.data, behind);
}

/* Binary numbers begin behind the line end of their header. */
static void end_header(struct legacy *vtk)
{
    struct bytes rest;
    if (vtk->binary) {
        mns_take_line(&vtk->cursor, &rest);
    }
}

/* Steps over `count` words; false: there are fewer. */
static bool skip_words(struct cursor *cursor, size_t count)
{
    const uint8_t *p = cursor->bytes.data + cursor->at, *end = cursor->bytes.data + cursor->bytes.size;
    for (; count > 0; count--) {
        while (p < end && mns_vtk_is_blank(*p)) {
            p++;
        }
        if (p == end) {
            break;
        }
        while (p < end && !mns_vtk_is_blank(*p)) {
            p++;
        }
    }
    cursor->at = (size_t)(p - cursor->bytes.data);
    return count == 0;
}

/* Takes the numbers of an array that has `elements` of them. */
static mns_result take_numbers(struct legacy *vtk, const char *name, enum vtk_coding coding, enum mns_type type, size_t elements,
                               struct bytes *out)
{
    size_t start = vtk->cursor.at, left = mns_left(&vtk->cursor), size = mns_type_size(type);
    bool there;
    if (coding == VTK_RAW || coding == VTK_BITS) {
        size_t most = coding == VTK_BITS ? (left < SIZE_MAX / 8 ? 8 * left : SIZE_MAX) : left / size;
        there = elements <= most && mns_take(&vtk->cursor, coding == VTK_BITS ? (elements + 7) / 8 : elements * size, &out->data);
    } else {
        there = elements <= left / 2 + 1 && skip_words(&vtk->cursor, elements);
        out->data = vtk->cursor.bytes.data + start;
    }
    if (!there) {
        return mns_read_fail(vtk->context, MNS_ERR_BAD_DATA,
                             "ends in '%s': %zu numbers of type %s should follow byte %zu, but %zu bytes do", name, elements,
                             mns_type_name(type), start, left);
    }
    out->size = (size_t)(vtk->cursor.bytes.data + vtk->cursor.at - out->data);
    return MNS_OK;
}

/* Steps over binary strings: each begins with its length in 1, 2, 4 or 8 bytes, whose two highest bits say which. */
static bool skip_binary_strings(struct cursor *cursor, size_t count)
{
    for (; count > 0; count--) {
        const uint8_t *p;
        if (mns_left(cursor) == 0) {
            return false;
        }
        size_t bytes = (size_t)8 >> (cursor->bytes.data[cursor->at] >> 6);
        if (!mns_take(cursor, bytes, &p)) {
            return false;
        }
        uint64_t length = p[0] & 0x3f;
        for (size_t i = 1; i < bytes; i++) {
            length = length << 8 | p[i];
        }
        if (length > mns_left(cursor) || !mns_take(cursor, (size_t)length, &p)) {
            return false;
        }
    }
    return true;
}

/* Steps over strings; in text, and variants always, one stands on each line. */
static mns_result skip_strings(struct legacy *vtk, const char *name, enum kind kind, size_t count)
{
    struct bytes line;
    mns_take_line(&vtk->cursor, &line); /* the rest of the header */
    bool there = true;
    if (vtk->binary && kind == KIND_STRING) {
        there = skip_binary_strings(&vtk->cursor, count);
    } else {
        for (size_t i = 0; i < count && there; i++) {
            there = mns_take_line(&vtk->cursor, &line);
        }
    }
    return there ? MNS_OK : mns_read_fail(vtk->context, MNS_ERR_BAD_DATA, "ends in '%s', which should hold %zu strings", name, count);
}

/* What the header of an array says. */
struct header {
    char name[256];
    struct bytes name_bytes; /* of name */
    enum kind kind;
    enum mns_type type;
    size_t components, tuples;
    enum vtk_coding coding;
    bool keep; /* as point data */
};

static mns_result take_array(struct legacy *vtk, struct header *header)
{
    if (header->components == 0 || header->components > 1 << 20 || header->tuples > SIZE_MAX / 16 / header->components) {
        return mns_read_fail(vtk->context, MNS_ERR_BAD_DATA, "'%s' has %zu times %zu numbers", header->name, header->tuples,
                             header->components);
    }
    size_t elements = header->components * header->tuples;
    if (header->kind == KIND_STRING || header->kind == KIND_VARIANT) {
        return skip_strings(vtk, header->name, header->kind, elements);
    }
    struct vtk_array array = {.coding = header->coding, .type = header->type, .components = (int)header->components};
    if (header->kind == KIND_BIT && header->coding == VTK_RAW) {
        array.coding = VTK_BITS;
    }
    mns_result result = take_numbers(vtk, header->name, array.coding, array.type, elements, &array.data);
    if (result == MNS_OK && header->keep && header->tuples != vtk->points) {
        mns_read_warn(vtk->context, "'%s' is left out: it has %zu values for %zu points", header->name, header->tuples, vtk->points);
        return MNS_OK;
    }
    if (result == MNS_OK && header->keep && !mns_vtk_add(vtk->context, &vtk->arrays, &array, header->name_bytes)) {
        result = MNS_ERR_OUT_OF_MEMORY;
    }
    return result;
}

static void take_name(struct legacy *vtk, struct header *header)
{
    header->name_bytes = decode_name(take_word(&vtk->cursor), header->name);
    header->name[header->name_bytes.size] = '\0';
}

static struct header new_header(const struct legacy *vtk)
{
    return (struct header){
        .type = MNS_F32, .components = 1, .tuples = vtk->tuples, .coding = vtk->binary ? VTK_RAW : VTK_TEXT, .keep = vtk->in_point_data};
}

/* ---- keywords ---- */

/* Steps over lines up to an empty one. */
static void skip_metadata(struct legacy *vtk)
{
    struct bytes line;
    mns_take_line(&vtk->cursor, &line); /* the rest of METADATA's own line */
    while (mns_take_line(&vtk->cursor, &line) && line.size > 0) {
        continue;
    }
}

/* FIELD name count, then arrays: name components tuples type, and METADATA behind some. keep: they are point data. */
static mns_result take_field(struct legacy *vtk, bool keep)
{
    size_t count;
    take_word(&vtk->cursor); /* the field's name */
    mns_result result = take_count(vtk, "FIELD", &count);
    for (size_t i = 0; i < count && result == MNS_OK; i++) {
        struct header header = new_header(vtk);
        header.keep = keep;
        take_name(vtk, &header);
        while (is_word(header.name_bytes, "metadata")) {
            skip_metadata(vtk);
            take_name(vtk, &header);
        }
        if (header.name_bytes.size == 0) {
            return mns_read_fail(vtk->context, MNS_ERR_BAD_DATA, "ends in a FIELD, after %zu of %zu arrays", i, count);
        }
        if (is_word(header.name_bytes, "null_array")) {
            continue;
        }
        result = take_count(vtk, header.name, &header.components);
        if (result == MNS_OK) {
            result = take_count(vtk, header.name, &header.tuples);
        }
        if (result == MNS_OK) {
            result = take_type(vtk, header.name, &header.kind, &header.type);
        }
        if (result == MNS_OK && header.kind != KIND_STRING && header.kind != KIND_VARIANT) {
            end_header(vtk);
        }
        if (result == MNS_OK && header.tuples > 0 && header.components > 0) {
            result = take_array(vtk, &header);
        }
    }
    return result;
}

/* SCALARS name type [components], then LOOKUP_TABLE name on a line of its own. */
static mns_result take_scalars(struct legacy *vtk)
{
    struct header header = new_header(vtk);
    struct bytes line;
    take_name(vtk, &header);
    mns_result result = take_type(vtk, "SCALARS", &header.kind, &header.type);
    if (result != MNS_OK) {
        return result;
    }
    if (mns_take_line(&vtk->cursor, &line)) {
        struct cursor rest = {line, 0};
        struct bytes word = take_word(&rest);
        if (word.size > 0 && !to_count(word, &header.components)) {
            return mns_read_fail(vtk->context, MNS_ERR_BAD_DATA, "'%.*s' where the number of components of '%s' should be", shown(word),
                                 (const char *)word.data, header.name);
        }
    }
    struct cursor ahead = vtk->cursor;
    if (is_word(take_word(&ahead), "lookup_table")) {
        take_word(&ahead);
        vtk->cursor = ahead;
        end_header(vtk);
    }
    return take_array(vtk, &header);
}

/* COLOR_SCALARS name components: bytes, or shares of 1 in text. */
static mns_result take_color_scalars(struct legacy *vtk)
{
    struct header header = new_header(vtk);
    take_name(vtk, &header);
    mns_result result = take_count(vtk, "COLOR_SCALARS", &header.components);
    if (result != MNS_OK) {
        return result;
    }
    header.type = MNS_U8;
    header.coding = vtk->binary ? VTK_RAW : VTK_TEXT_SHARES;
    end_header(vtk);
    return take_array(vtk, &header);
}

/* LOOKUP_TABLE name size: RGBA, which no particle needs. */
static mns_result skip_lookup_table(struct legacy *vtk)
{
    struct header header = new_header(vtk);
    take_name(vtk, &header);
    mns_result result = take_count(vtk, "LOOKUP_TABLE", &header.tuples);
    if (result != MNS_OK || header.tuples == 0) {
        return result;
    }
    header.type = vtk->binary ? MNS_U8 : MNS_F32;
    header.components = 4;
    header.keep = false;
    end_header(vtk);
    return take_array(vtk, &header);
}

/* VECTORS name type and its like; components 0: they stand before the type. */
static mns_result take_vectors(struct legacy *vtk, const char *keyword, size_t components)
{
    struct header header = new_header(vtk);
    take_name(vtk, &header);
    header.components = components;
    mns_result result = components == 0 ? take_count(vtk, keyword, &header.components) : MNS_OK;
    if (result == MNS_OK) {
        result = take_type(vtk, keyword, &header.kind, &header.type);
    }
    if (result != MNS_OK) {
        return result;
    }
    if (header.kind != KIND_STRING && header.kind != KIND_VARIANT) {
        end_header(vtk);
    }
    return take_array(vtk, &header);
}

/* POINT_DATA and CELL_DATA hold these. *known: whether keyword is one of them. */
static mns_result take_attribute(struct legacy *vtk, struct bytes keyword, bool *known)
{
    static const struct {
        const char *keyword;
        size_t components;
    } vectors[] = {{"vectors", 3},  {"normals", 3},    {"texture_coordinates", 0}, {"tensors", 9},
                   {"tensors6", 6}, {"global_ids", 1}, {"pedigree_ids", 1},        {"edge_flags", 1}};
    *known = true;
    if (is_word(keyword, "scalars")) {
        return take_scalars(vtk);
    }
    if (is_word(keyword, "color_scalars")) {
        return take_color_scalars(vtk);
    }
    if (is_word(keyword, "lookup_table")) {
        return skip_lookup_table(vtk);
    }
    for (size_t i = 0; i < sizeof(vectors) / sizeof(vectors[0]); i++) {
        if (is_word(keyword, vectors[i].keyword)) {
            return take_vectors(vtk, vectors[i].keyword, vectors[i].components);
        }
    }
    *known = false;
    return MNS_OK;
}

static mns_result take_points(struct legacy *vtk)
{
    struct header header = {.name = "Points", .components = 3, .coding = vtk->binary ? VTK_RAW : VTK_TEXT};
    if (vtk->has_points) {
        return mns_read_fail(vtk->context, MNS_ERR_BAD_DATA, "byte %zu: has POINTS a second time", vtk->cursor.at);
    }
    mns_result result = take_count(vtk, "POINTS", &vtk->points);
    if (result == MNS_OK) {
        result = take_type(vtk, "POINTS", &header.kind, &header.type);
    }
    if (result == MNS_OK && header.kind != KIND_NUMBER) {
        result = mns_read_fail(vtk->context, MNS_ERR_BAD_DATA, "has POINTS that are no numbers");
    }
    if (result != MNS_OK) {
        return result;
    }
    vtk->has_points = true;
    end_header(vtk);
    struct vtk_array array = {.points = true, .coding = header.coding, .type = header.type, .components = 3};
    result = take_numbers(vtk, header.name, array.coding, array.type, 3 * vtk->points, &array.data);
    if (result == MNS_OK && !mns_vtk_add(vtk->context, &vtk->arrays, &array, (struct bytes){NULL, 0})) {
        result = MNS_ERR_OUT_OF_MEMORY;
    }
    return result;
}

/* OFFSETS or CONNECTIVITY, type, integers. */
static mns_result skip_cell_array(struct legacy *vtk, const char *keyword, const char *name, size_t elements)
{
    struct bytes unused, word = take_word(&vtk->cursor);
    enum kind kind;
    enum mns_type type;
    if (!is_word(word, keyword)) {
        return mns_read_fail(vtk->context, MNS_ERR_BAD_DATA, "'%.*s' where %s should be", shown(word), (const char *)word.data, name);
    }
    mns_result result = take_type(vtk, name, &kind, &type);
    if (result != MNS_OK) {
        return result;
    }
    end_header(vtk);
    return take_numbers(vtk, name, vtk->binary ? VTK_RAW : VTK_TEXT, type, elements, &unused);
}

/* Cells: count size, then int32 length, indices, length, ...; since 5.0: two sizes, then arrays OFFSETS and CONNECTIVITY. */
static mns_result skip_cells(struct legacy *vtk)
{
    size_t first, second;
    struct bytes unused;
    mns_result result = take_count(vtk, "cells", &first);
    if (result == MNS_OK) {
        result = take_count(vtk, "cells", &second);
    }
    if (result != MNS_OK) {
        return result;
    }
    struct cursor ahead = vtk->cursor;
    if (!is_word(take_word(&ahead), "offsets")) {
        end_header(vtk);
        return take_numbers(vtk, "cells", vtk->binary ? VTK_RAW : VTK_TEXT, MNS_I32, second, &unused);
    }
    result = skip_cell_array(vtk, "offsets", "OFFSETS", first);
    return result == MNS_OK ? skip_cell_array(vtk, "connectivity", "CONNECTIVITY", second) : result;
}

static mns_result skip_cell_types(struct legacy *vtk)
{
    size_t count;
    struct bytes unused;
    mns_result result = take_count(vtk, "CELL_TYPES", &count);
    if (result != MNS_OK) {
        return result;
    }
    end_header(vtk);
    return take_numbers(vtk, "CELL_TYPES", vtk->binary ? VTK_RAW : VTK_TEXT, MNS_I32, count, &unused);
}

static mns_result begin_data(struct legacy *vtk, bool of_points)
{
    mns_result result = take_count(vtk, of_points ? "POINT_DATA" : "CELL_DATA", &vtk->tuples);
    vtk->in_data = true;
    vtk->in_point_data = of_points;
    if (result == MNS_OK && of_points && vtk->tuples != vtk->points) {
        result =
            mns_read_fail(vtk->context, MNS_ERR_BAD_DATA, "has POINT_DATA for %zu points where there are %zu", vtk->tuples, vtk->points);
    }
    return result;
}

static mns_result take_section(struct legacy *vtk, struct bytes keyword)
{
    static const char *const cells[] = {"cells", "vertices", "lines", "polygons", "triangle_strips"};
    size_t at = (size_t)(keyword.data - vtk->cursor.bytes.data);
    bool known = false;
    for (size_t i = 0; i < sizeof(cells) / sizeof(cells[0]); i++) {
        if (is_word(keyword, cells[i])) {
            return skip_cells(vtk);
        }
    }
    if (is_word(keyword, "points")) {
        return take_points(vtk);
    }
    if (is_word(keyword, "cell_types")) {
        return skip_cell_types(vtk);
    }
    if (is_word(keyword, "point_data")) {
        return begin_data(vtk, true);
    }
    if (is_word(keyword, "cell_data")) {
        return begin_data(vtk, false);
    }
    if (is_word(keyword, "field")) {
        return take_field(vtk, vtk->in_point_data);
    }
    if (is_word(keyword, "metadata")) {
        skip_metadata(vtk);
        return MNS_OK;
    }
    mns_result result = vtk->in_data ? take_attribute(vtk, keyword, &known) : MNS_OK;
    if (result == MNS_OK && !known) {
        result = mns_read_fail(vtk->context, MNS_ERR_BAD_DATA, "byte %zu: '%.*s' where a keyword such as POINT_DATA should be", at,
                               shown(keyword), (const char *)keyword.data);
    }
    return result;
}

static mns_result read_header(struct legacy *vtk)
{
    struct read_context *context = vtk->context;
    struct bytes line, title;
    double version;
    if (!probe(vtk->cursor.bytes)) {
        return mns_read_fail(context, MNS_ERR_BAD_DATA, "is no legacy VTK file: it does not begin with '# vtk DataFile Version'");
    }
    mns_take_line(&vtk->cursor, &line);
    struct cursor number = {line, 22}; /* behind the signature */
    struct bytes word = take_word(&number);
    const char *end = (const char *)word.data + word.size;
    if (mns_parse_double((const char *)word.data, end, &version) != end || !(version > 0.0)) {
        return mns_read_fail(context, MNS_ERR_BAD_DATA, "has no version number in its first line");
    }
    if (version >= 6.0) {
        return mns_read_fail(context, MNS_ERR_UNSUPPORTED, "is a legacy VTK file of version %.*s; up to 5.1 is read", shown(word),
                             (const char *)word.data);
    }
    mns_take_line(&vtk->cursor, &title);
    word = take_word(&vtk->cursor);
    vtk->binary = is_word(word, "binary");
    if (!vtk->binary && !is_word(word, "ascii")) {
        return mns_read_fail(context, MNS_ERR_BAD_DATA, "line 3: '%.*s' where ASCII or BINARY should be", shown(word),
                             (const char *)word.data);
    }
    word = take_word(&vtk->cursor);
    if (!is_word(word, "dataset")) {
        return mns_read_fail(context, MNS_ERR_BAD_DATA, "line 4: '%.*s' where DATASET should be", shown(word), (const char *)word.data);
    }
    word = take_word(&vtk->cursor);
    if (!is_word(word, "polydata") && !is_word(word, "unstructured_grid")) {
        return mns_read_fail(context, MNS_ERR_UNSUPPORTED, "holds a data set of kind '%.*s'; POLYDATA and UNSTRUCTURED_GRID are read",
                             shown(word), (const char *)word.data);
    }
    return MNS_OK;
}

/* ---- reading ---- */

static mns_result check(const struct vtk_source *source, const struct vtk_array *array, size_t elements, const uint8_t **plain)
{
    (void)source, (void)elements; /* arrays were measured when they were found, and hold as many as there are points */
    bool in_order = mns_big_endian() || mns_type_size(array->type) == 1;
    *plain = array->coding == VTK_RAW && in_order ? array->data.data : NULL;
    return MNS_OK;
}

static mns_result decode(const struct vtk_source *source, const struct vtk_array *array, size_t elements, void *out)
{
    uint8_t *bytes = out;
    if (array->coding == VTK_TEXT || array->coding == VTK_TEXT_SHARES) {
        return mns_vtk_parse_numbers(source->context, array, elements, out);
    }
    if (array->coding == VTK_RAW) {
        mns_copy_elements(out, array->data.data, elements, array->type, true);
    } else {
        for (size_t i = 0; i < elements; i++) {
            bytes[i] = array->data.data[i / 8] >> (7 - i % 8) & 1;
        }
    }
    return MNS_OK;
}

static mns_result read_vtk(struct read_context *context, struct bytes file)
{
    struct legacy vtk = {.context = context, .cursor = {file, 0}};
    mns_result result = read_header(&vtk);
    while (result == MNS_OK) {
        struct bytes keyword = take_word(&vtk.cursor);
        if (keyword.size == 0) {
            break;
        }
        result = take_section(&vtk, keyword);
    }
    if (result == MNS_OK && !vtk.has_points) {
        result = mns_read_fail(context, MNS_ERR_BAD_DATA, "has no POINTS");
    }
    const struct vtk_source source = {context, check, decode};
    if (result == MNS_OK) {
        result = mns_vtk_add_piece(&source, vtk.arrays.items, vtk.arrays.count, vtk.points);
    }
    mns_vtk_free(context, &vtk.arrays);
    return result;
}

const struct mns_reader mns_reader_vtk = {"vtk", "vtk", probe, read_vtk};
