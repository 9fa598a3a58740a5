/* read_ply.c: the vertices of a PLY file, ASCII or binary of either byte order, with all their scalar properties. Faces are not read.
 *
 * Consecutive properties of one type whose names differ in their ending alone (normal_x normal_y normal_z, q_0 q_1 ...) are one vector. */
#include "io/set.h"

#include <stdio.h>
#include <string.h>

enum { ELEMENT_MAX = 64, PROPERTY_MAX = 1024, NAME_LENGTH = 64, BLOCK = 256 /* vertices that stay in the cache */ };

enum encoding { ENCODING_ASCII, ENCODING_LITTLE, ENCODING_BIG };

struct property {
    char name[NAME_LENGTH];
    bool list;
    enum mns_type count_type; /* of a list */
    enum mns_type type;
    size_t offset; /* bytes, in a record without lists */
    uint8_t *out;  /* NULL: not kept */
    size_t stride; /* bytes from one vertex to the next in out */
};

struct element {
    char name[NAME_LENGTH];
    size_t count;
    size_t first, properties; /* into ply.properties */
    size_t record;            /* bytes; with lists, the least */
    bool lists;
};

struct ply {
    struct read_context *context;
    enum encoding encoding;
    struct element elements[ELEMENT_MAX];
    size_t element_count, property_count;
    struct property properties[PROPERTY_MAX];
};

static int probe(struct bytes head)
{
    return head.size >= 4 && memcmp(head.data, "ply", 3) == 0 && (head.data[3] == '\n' || head.data[3] == '\r') ? 2 : 0;
}

/* ---- header ---- */

/* Takes the next word of a line; an empty one at its end. */
static struct bytes take_word(struct bytes *line)
{
    size_t start = 0, stop;
    while (start < line->size && (line->data[start] == ' ' || line->data[start] == '\t' || line->data[start] == '\r')) {
        start++;
    }
    for (stop = start; stop < line->size && line->data[stop] != ' ' && line->data[stop] != '\t' && line->data[stop] != '\r';) {
        stop++;
    }
    struct bytes word = {line->data + start, stop - start};
    *line = (struct bytes){line->data + stop, line->size - stop};
    return word;
}

static bool is_word(struct bytes word, const char *text) { return word.size == strlen(text) && memcmp(word.data, text, word.size) == 0; }

static bool copy_name(char out[NAME_LENGTH], struct bytes word)
{
    if (word.size == 0 || word.size >= NAME_LENGTH) {
        return false;
    }
    memcpy(out, word.data, word.size);
    out[word.size] = '\0';
    return true;
}

static bool parse_type(struct bytes word, enum mns_type *out)
{
    static const struct {
        const char *name;
        enum mns_type type;
    } types[] = {{"float", MNS_F32},  {"float32", MNS_F32}, {"double", MNS_F64}, {"float64", MNS_F64}, {"char", MNS_I8},
                 {"int8", MNS_I8},    {"uchar", MNS_U8},    {"uint8", MNS_U8},   {"short", MNS_I16},   {"int16", MNS_I16},
                 {"ushort", MNS_U16}, {"uint16", MNS_U16},  {"int", MNS_I32},    {"int32", MNS_I32},   {"uint", MNS_U32},
                 {"uint32", MNS_U32}, {"int64", MNS_I64},   {"uint64", MNS_U64}};
    for (size_t i = 0; i < sizeof(types) / sizeof(types[0]); i++) {
        if (is_word(word, types[i].name)) {
            *out = types[i].type;
            return true;
        }
    }
    return false;
}

static bool parse_format(struct ply *ply, struct bytes line)
{
    struct bytes word = take_word(&line);
    if (is_word(word, "ascii")) {
        ply->encoding = ENCODING_ASCII;
    } else if (is_word(word, "binary_little_endian")) {
        ply->encoding = ENCODING_LITTLE;
    } else if (is_word(word, "binary_big_endian")) {
        ply->encoding = ENCODING_BIG;
    } else {
        return false;
    }
    return true;
}

static bool parse_element(struct ply *ply, struct bytes line)
{
    if (ply->element_count == ELEMENT_MAX) {
        return false;
    }
    struct element *element = &ply->elements[ply->element_count];
    *element = (struct element){.first = ply->property_count};
    bool named = copy_name(element->name, take_word(&line));
    struct bytes word = take_word(&line);
    const char *end = (const char *)word.data + word.size;
    int64_t count;
    if (!named || mns_parse_int64((const char *)word.data, end, &count) != end || count < 0 || (uint64_t)count > SIZE_MAX / 16) {
        return false;
    }
    element->count = (size_t)count;
    ply->element_count++;
    return true;
}

static bool parse_property(struct ply *ply, struct bytes line)
{
    if (ply->element_count == 0 || ply->property_count == PROPERTY_MAX) {
        return false;
    }
    struct element *element = &ply->elements[ply->element_count - 1];
    struct property *property = &ply->properties[ply->property_count];
    *property = (struct property){.offset = element->record};
    struct bytes word = take_word(&line);
    if (is_word(word, "list")) {
        property->list = true;
        if (!parse_type(take_word(&line), &property->count_type) || property->count_type == MNS_F32 || property->count_type == MNS_F64) {
            return false;
        }
        word = take_word(&line);
    }
    if (!parse_type(word, &property->type) || !copy_name(property->name, take_word(&line))) {
        return false;
    }
    element->record += mns_type_size(property->list ? property->count_type : property->type);
    element->lists |= property->list;
    element->properties++;
    ply->property_count++;
    return true;
}

static mns_result read_header(struct ply *ply, struct cursor *cursor)
{
    struct bytes line;
    bool has_format = false;
    size_t number = 1;
    mns_take_line(cursor, &line); /* ply */
    while (mns_take_line(cursor, &line)) {
        struct bytes whole = line, word = take_word(&line);
        bool good = true;
        number++;
        if (is_word(word, "end_header")) {
            break;
        }
        if (is_word(word, "format")) {
            good = has_format = parse_format(ply, line);
        } else if (is_word(word, "element")) {
            good = parse_element(ply, line);
        } else if (is_word(word, "property")) {
            good = parse_property(ply, line);
        } else {
            good = is_word(word, "comment") || is_word(word, "obj_info") || word.size == 0;
        }
        if (!good) {
            return mns_read_fail(ply->context, MNS_ERR_BAD_DATA, "line %zu of the PLY header cannot be understood: '%.*s'", number,
                                 whole.size < 60 ? (int)whole.size : 60, (const char *)whole.data);
        }
        if (mns_left(cursor) == 0) {
            return mns_read_fail(ply->context, MNS_ERR_BAD_DATA, "ends in the PLY header: 'end_header' is missing");
        }
    }
    if (!has_format) {
        return mns_read_fail(ply->context, MNS_ERR_BAD_DATA, "the PLY header has no 'format' line before 'end_header'");
    }
    return MNS_OK;
}

/* ---- bodies ---- */

static double load_number(const uint8_t *p, enum mns_type type, bool big_endian)
{
    union {
        float f32;
        double f64;
        int8_t i8;
        uint8_t u8;
        int16_t i16;
        uint16_t u16;
        int32_t i32;
        uint32_t u32;
        int64_t i64;
        uint64_t u64;
    } v;
    mns_copy_elements(&v, p, 1, type, big_endian);
    switch (type) {
    case MNS_F32: return (double)v.f32;
    case MNS_F64: return v.f64;
    case MNS_I8: return v.i8;
    case MNS_U8: return v.u8;
    case MNS_I16: return v.i16;
    case MNS_U16: return v.u16;
    case MNS_I32: return v.i32;
    case MNS_U32: return v.u32;
    case MNS_I64: return (double)v.i64;
    case MNS_U64: return (double)v.u64;
    }
    return 0.0;
}

/* What is out of the type's range becomes its nearest end; NaN 0. */
#define STORE_AS(type, lowest, highest)                                                                                                    \
    do {                                                                                                                                   \
        type v = value >= (double)(highest) ? (highest) : value > (double)(lowest) ? (type)value : value == value ? (lowest) : 0;          \
        memcpy(out, &v, sizeof(v));                                                                                                        \
    } while (0)

static void store_number(uint8_t *out, enum mns_type type, double value)
{
    float narrow = (float)value;
    switch (type) {
    case MNS_F32: memcpy(out, &narrow, sizeof(narrow)); break;
    case MNS_F64: memcpy(out, &value, sizeof(value)); break;
    case MNS_I8: STORE_AS(int8_t, INT8_MIN, INT8_MAX); break;
    case MNS_U8: STORE_AS(uint8_t, 0, UINT8_MAX); break;
    case MNS_I16: STORE_AS(int16_t, INT16_MIN, INT16_MAX); break;
    case MNS_U16: STORE_AS(uint16_t, 0, UINT16_MAX); break;
    case MNS_I32: STORE_AS(int32_t, INT32_MIN, INT32_MAX); break;
    case MNS_U32: STORE_AS(uint32_t, 0, UINT32_MAX); break;
    case MNS_I64: STORE_AS(int64_t, INT64_MIN, INT64_MAX); break;
    case MNS_U64: STORE_AS(uint64_t, 0, UINT64_MAX); break;
    }
}

static mns_result ends_early(const struct ply *ply, const struct element *element, size_t at)
{
    return mns_read_fail(ply->context, MNS_ERR_BAD_DATA, "ends early: %zu of %zu '%s' elements are there", at, element->count,
                         element->name);
}

/* Walks one binary element with lists record by record, keeping what has a place to go. */
static mns_result read_lists(const struct ply *ply, struct cursor *cursor, const struct element *element)
{
    bool big = ply->encoding == ENCODING_BIG;
    for (size_t i = 0; i < element->count; i++) {
        for (size_t k = 0; k < element->properties; k++) {
            const struct property *property = &ply->properties[element->first + k];
            const uint8_t *p;
            size_t size = mns_type_size(property->type);
            if (!mns_take(cursor, property->list ? mns_type_size(property->count_type) : size, &p)) {
                return ends_early(ply, element, i);
            }
            if (property->list) {
                double count = load_number(p, property->count_type, big);
                if (count < 0.0 || count > (double)(mns_left(cursor) / size) || !mns_take(cursor, (size_t)count * size, &p)) {
                    return ends_early(ply, element, i);
                }
            } else if (property->out) {
                mns_copy_elements(property->out + i * property->stride, p, 1, property->type, big);
            }
        }
    }
    return MNS_OK;
}

/* in, out: elements of one size, in_stride and out_stride bytes apart. Inlined once per size. */
static inline void copy_strided(uint8_t *out, size_t out_stride, const uint8_t *in, size_t in_stride, size_t count, size_t size, bool swap)
{
    for (size_t i = 0; i < count; i++, out += out_stride, in += in_stride) {
        for (size_t b = 0; b < size; b++) {
            out[b] = in[swap ? size - 1 - b : b];
        }
    }
}

static void copy_property(const struct property *property, size_t start, const uint8_t *in, size_t record, size_t count, bool swap)
{
    uint8_t *out = property->out + start * property->stride;
    size_t stride = property->stride, size = mns_type_size(property->type);
    switch (swap ? 16 + size : size) { /* constants, so that each copy is compiled for its size */
    case 2: copy_strided(out, stride, in, record, count, 2, false); break;
    case 4: copy_strided(out, stride, in, record, count, 4, false); break;
    case 8: copy_strided(out, stride, in, record, count, 8, false); break;
    case 18: copy_strided(out, stride, in, record, count, 2, true); break;
    case 20: copy_strided(out, stride, in, record, count, 4, true); break;
    case 24: copy_strided(out, stride, in, record, count, 8, true); break;
    default: copy_strided(out, stride, in, record, count, 1, false); break;
    }
}

static mns_result read_binary(const struct ply *ply, struct cursor *cursor, const struct element *element)
{
    const uint8_t *records;
    bool swap = (ply->encoding == ENCODING_BIG) != mns_big_endian();
    if (element->lists) {
        return read_lists(ply, cursor, element);
    }
    if (element->record != 0 && element->count > mns_left(cursor) / element->record) {
        return ends_early(ply, element, mns_left(cursor) / element->record);
    }
    mns_take(cursor, element->count * element->record, &records);
    for (size_t start = 0; start < element->count && element->record != 0; start += BLOCK) {
        size_t count = element->count - start < BLOCK ? element->count - start : BLOCK;
        for (size_t k = 0; k < element->properties; k++) {
            const struct property *property = &ply->properties[element->first + k];
            if (property->out) {
                copy_property(property, start, records + start * element->record + property->offset, element->record, count, swap);
            }
        }
    }
    return MNS_OK;
}

static const char *skip_space(const char *p, const char *end)
{
    while (p < end && (*p == ' ' || *p == '\n' || *p == '\r' || *p == '\t')) {
        p++;
    }
    return p;
}

static mns_result take_number(const struct ply *ply, const char **at, const char *end, const struct element *element, size_t i, double *out)
{
    const char *start = skip_space(*at, end);
    if (start == end) {
        return ends_early(ply, element, i);
    }
    *at = mns_parse_double(start, end, out);
    if (*at) {
        return MNS_OK;
    }
    int length = 0;
    while (start + length < end && length < 30 && (unsigned char)start[length] > ' ') {
        length++;
    }
    return mns_read_fail(ply->context, MNS_ERR_BAD_DATA, "'%s' element %zu (from 0) has '%.*s' where a number should be", element->name, i,
                         length, start);
}

static mns_result read_ascii(const struct ply *ply, struct cursor *cursor, const struct element *element)
{
    const char *p = (const char *)cursor->bytes.data + cursor->at, *end = (const char *)cursor->bytes.data + cursor->bytes.size;
    for (size_t i = 0; i < element->count; i++) {
        for (size_t k = 0; k < element->properties; k++) {
            const struct property *property = &ply->properties[element->first + k];
            double value, item;
            mns_result result = take_number(ply, &p, end, element, i, &value);
            for (double left = value; result == MNS_OK && property->list && left >= 1.0; left -= 1.0) {
                result = take_number(ply, &p, end, element, i, &item);
            }
            if (result != MNS_OK) {
                return result;
            }
            if (property->out) {
                store_number(property->out + i * property->stride, property->type, value);
            }
        }
    }
    cursor->at = (size_t)((const uint8_t *)p - cursor->bytes.data);
    return MNS_OK;
}

/* ---- vertices ---- */

static struct property *find_property(struct ply *ply, const struct element *element, const char *name)
{
    for (size_t k = 0; k < element->properties; k++) {
        struct property *property = &ply->properties[element->first + k];
        if (!property->list && strcmp(property->name, name) == 0) {
            return property;
        }
    }
    return NULL;
}

/* Whether a name is `base` with this component's ending: _x, _y, _z, or _0, _1 ... */
static bool is_component(const char *name, const char *base, size_t length, bool letters, size_t component)
{
    char ending[24];
    snprintf(ending, sizeof(ending), letters ? "_%c" : "_%u", letters ? (int)('x' + component) : (int)component);
    return strncmp(name, base, length) == 0 && strcmp(name + length, ending) == 0;
}

/* How many properties from here on are the components of one vector, which has the first `length` letters of their names; 1: none. */
static size_t find_vector(const struct property *first, size_t properties, size_t *length)
{
    const char *ending = strrchr(first->name, '_');
    *length = ending ? (size_t)(ending - first->name) : 0;
    bool letters = ending && strcmp(ending, "_x") == 0;
    if (*length == 0 || (!letters && strcmp(ending, "_0") != 0)) {
        return 1;
    }
    size_t size = 1;
    while (size < properties && !(letters && size == 3) && !first[size].list && !first[size].out && first[size].type == first->type &&
           is_component(first[size].name, first->name, *length, letters, size)) {
        size++;
    }
    return letters && size < 3 ? 1 : size;
}

/* Adds a scalar, or the vector that begins here; *taken: how many properties that are. */
static bool add_property(struct ply *ply, struct property *first, size_t properties, size_t *taken)
{
    char name[NAME_LENGTH];
    size_t length, size = mns_type_size(first->type);
    *taken = find_vector(first, properties, &length);
    memcpy(name, first->name, sizeof(name));
    if (*taken > 1) {
        name[length] = '\0';
    }
    uint8_t *out = mns_set_add(ply->context, name, first->type, (int)*taken);
    for (size_t k = 0; out && k < *taken; k++) {
        first[k].out = out + k * size;
        first[k].stride = *taken * size;
    }
    return out != NULL;
}

static mns_result add_attributes(struct ply *ply, const struct element *vertex)
{
    struct property *const axes[3] = {find_property(ply, vertex, "x"), find_property(ply, vertex, "y"), find_property(ply, vertex, "z")};
    if (!axes[0] || !axes[1] || !axes[2]) {
        return mns_read_fail(ply->context, MNS_ERR_BAD_DATA, "has no positions: the vertices have no x, y and z");
    }
    enum mns_type type = axes[0]->type;
    if (axes[1]->type != type || axes[2]->type != type || (type != MNS_F32 && type != MNS_F64)) {
        return mns_read_fail(ply->context, MNS_ERR_UNSUPPORTED, "has positions of %s, %s, %s; all float or all double are read",
                             mns_type_name(type), mns_type_name(axes[1]->type), mns_type_name(axes[2]->type));
    }
    mns_result result = mns_set_begin(ply->context, vertex->count);
    if (result != MNS_OK) {
        return result;
    }
    uint8_t *position = mns_set_add(ply->context, "position", type, 3);
    if (!position) {
        return MNS_ERR_OUT_OF_MEMORY;
    }
    for (size_t i = 0; i < 3; i++) {
        axes[i]->out = position + i * mns_type_size(type);
        axes[i]->stride = 3 * mns_type_size(type);
    }
    for (size_t k = 0, taken = 1; k < vertex->properties; k += taken, taken = 1) {
        struct property *property = &ply->properties[vertex->first + k];
        if (!property->list && !property->out && !add_property(ply, property, vertex->properties - k, &taken)) {
            return MNS_ERR_OUT_OF_MEMORY;
        }
    }
    return MNS_OK;
}

static mns_result read_elements(struct ply *ply, struct cursor *cursor)
{
    for (size_t e = 0; e < ply->element_count; e++) {
        struct element *element = &ply->elements[e];
        bool vertex = strcmp(element->name, "vertex") == 0;
        /* Every property of an element takes at least its size, or a digit and a space. */
        size_t least = ply->encoding == ENCODING_ASCII ? 2 * element->properties : element->record;
        if (least > 0 && element->count > (mns_left(cursor) + 1) / least) {
            return ends_early(ply, element, mns_left(cursor) / least);
        }
        if (least == 0 && element->count > 0 && vertex) {
            return mns_read_fail(ply->context, MNS_ERR_BAD_DATA, "has no positions: the vertices have no properties");
        }
        mns_result result = vertex ? add_attributes(ply, element) : MNS_OK;
        if (result == MNS_OK && least > 0) {
            result = ply->encoding == ENCODING_ASCII ? read_ascii(ply, cursor, element) : read_binary(ply, cursor, element);
        }
        if (result != MNS_OK || vertex) {
            return result; /* what stands behind the vertices is nothing to us */
        }
    }
    return mns_read_fail(ply->context, MNS_ERR_BAD_DATA, "has no positions: the PLY header names no element 'vertex'");
}

static mns_result read_ply(struct read_context *context, struct bytes file)
{
    struct cursor cursor = {file, 0};
    if (probe(file) == 0) {
        return mns_read_fail(context, MNS_ERR_BAD_DATA, "is no PLY file: it does not begin with 'ply'");
    }
    struct ply *ply = mns_read_alloc(context, 1, sizeof(*ply));
    if (!ply) {
        return MNS_ERR_OUT_OF_MEMORY;
    }
    ply->context = context;
    ply->element_count = ply->property_count = 0;
    mns_result result = read_header(ply, &cursor);
    if (result == MNS_OK) {
        result = read_elements(ply, &cursor);
    }
    mns_read_free(context, ply, 1, sizeof(*ply));
    return result;
}

const struct mns_reader mns_reader_ply = {"ply", "ply", probe, read_ply};
