/* read_npy.c: positions as an array of numpy, float32 or float64 [n][3]. */
#include "io/npy.h"

#include <stdio.h>
#include <string.h>

static int probe(struct bytes head) { return head.size >= 6 && memcmp(head.data, "\x93NUMPY", 6) == 0 ? 2 : 0; }

/* The header is a Python dictionary: {'descr': '<f4', 'fortran_order': False, 'shape': (10, 3), }. */
struct literal {
    const char *at, *end;
};

static void skip_space(struct literal *text)
{
    while (text->at < text->end && (*text->at == ' ' || *text->at == '\n' || *text->at == '\t')) {
        text->at++;
    }
}

static bool accept(struct literal *text, const char *token)
{
    size_t length = strlen(token);
    skip_space(text);
    if ((size_t)(text->end - text->at) < length || memcmp(text->at, token, length) != 0) {
        return false;
    }
    text->at += length;
    return true;
}

static bool take_string(struct literal *text, const char **string, size_t *length)
{
    skip_space(text);
    if (text->at == text->end || (*text->at != '\'' && *text->at != '"')) {
        return false;
    }
    const char *end = memchr(text->at + 1, *text->at, (size_t)(text->end - text->at - 1));
    if (!end) {
        return false;
    }
    *string = text->at + 1;
    *length = (size_t)(end - *string);
    text->at = end + 1;
    return true;
}

static bool set_type(struct npy *array, const char *descr, size_t length)
{
    static const struct {
        const char *name;
        enum mns_type type;
    } types[] = {{"f4", MNS_F32}, {"f8", MNS_F64}, {"i1", MNS_I8},  {"u1", MNS_U8},  {"b1", MNS_U8}, {"i2", MNS_I16},
                 {"u2", MNS_U16}, {"i4", MNS_I32}, {"u4", MNS_U32}, {"i8", MNS_I64}, {"u8", MNS_U64}};
    if (length != 3) {
        return false;
    }
    array->big_endian = descr[0] == '>' || (descr[0] == '=' && mns_big_endian());
    for (size_t i = 0; i < sizeof(types) / sizeof(types[0]); i++) {
        if (memcmp(descr + 1, types[i].name, 2) == 0) {
            array->type = types[i].type;
            return strchr("<>=|", descr[0]) != NULL;
        }
    }
    return false;
}

static bool take_shape(struct literal *text, struct npy *array, int *dimensions)
{
    *dimensions = 0;
    if (!accept(text, "(")) {
        return false;
    }
    while (!accept(text, ")")) {
        int64_t size;
        skip_space(text);
        const char *end = mns_parse_int64(text->at, text->end, &size);
        if (!end || size < 0 || (uint64_t)size > SIZE_MAX) {
            return false;
        }
        text->at = end;
        if (*dimensions < 2) {
            array->shape[*dimensions] = (size_t)size;
        }
        ++*dimensions;
        accept(text, "L"); /* Python 2 */
        if (!accept(text, ",")) {
            if (!accept(text, ")")) {
                return false;
            }
            break;
        }
    }
    return true;
}

static mns_result parse_dictionary(struct read_context *context, const char *what, struct literal text, struct npy *array)
{
    const char *key, *value;
    size_t key_length, length;
    bool has_type = false, has_order = false, has_shape = false;
    const char *fault = "is no Python dictionary";
    if (!accept(&text, "{")) {
        goto malformed;
    }
    while (!accept(&text, "}")) {
        if (!take_string(&text, &key, &key_length) || !accept(&text, ":")) {
            goto malformed;
        }
        if (key_length == 5 && memcmp(key, "descr", 5) == 0) {
            if (!take_string(&text, &value, &length)) {
                return mns_read_fail(context, MNS_ERR_UNSUPPORTED, "%sis an array of records; arrays of plain numbers are read", what);
            }
            if (!set_type(array, value, length)) {
                return mns_read_fail(context, MNS_ERR_UNSUPPORTED, "%sis an array of '%.*s'; float32, float64 and integers are read", what,
                                     length < 40 ? (int)length : 40, value);
            }
            has_type = true;
        } else if (key_length == 13 && memcmp(key, "fortran_order", 13) == 0) {
            array->fortran_order = accept(&text, "True");
            if (!array->fortran_order && !accept(&text, "False")) {
                goto malformed;
            }
            has_order = true;
        } else if (key_length == 5 && memcmp(key, "shape", 5) == 0) {
            fault = "has no good shape";
            if (!take_shape(&text, array, &array->dimensions)) {
                goto malformed;
            }
            has_shape = true;
        } else {
            goto malformed;
        }
        if (!accept(&text, ",") && !accept(&text, "}")) {
            goto malformed;
        } else if (text.at[-1] == '}') {
            break;
        }
    }
    fault = "lacks descr, fortran_order or shape";
    if (has_type && has_order && has_shape) {
        return MNS_OK;
    }
malformed:
    return mns_read_fail(context, MNS_ERR_BAD_DATA, "%sthe .npy header %s", what, fault);
}

mns_result mns_npy_parse(struct read_context *context, const char *what, struct bytes file, struct npy *out)
{
    struct cursor cursor = {file, 0};
    const uint8_t *magic, *size_bytes, *header;
    *out = (struct npy){.shape = {1, 1}};
    if (!mns_take(&cursor, 8, &magic)) {
        return mns_read_fail(context, MNS_ERR_BAD_DATA, "%sends in the .npy header, after %zu bytes", what, file.size);
    }
    if (memcmp(magic, "\x93NUMPY", 6) != 0) {
        return mns_read_fail(context, MNS_ERR_BAD_DATA, "%sis no .npy: it does not begin with \\x93NUMPY", what);
    }
    if (magic[6] < 1 || magic[6] > 3) {
        return mns_read_fail(context, MNS_ERR_UNSUPPORTED, "%sis .npy version %d; 1 to 3 are read", what, magic[6]);
    }
    size_t width = magic[6] == 1 ? 2 : 4, size = 0;
    if (!mns_take(&cursor, width, &size_bytes)) {
        return mns_read_fail(context, MNS_ERR_BAD_DATA, "%sends in the .npy header, after %zu bytes", what, file.size);
    }
    for (size_t i = 0; i < width; i++) {
        size |= (size_t)size_bytes[i] << (8 * i);
    }
    if (!mns_take(&cursor, size, &header)) {
        return mns_read_fail(context, MNS_ERR_BAD_DATA, "%sends in the .npy header: it should have %zu bytes, %zu are there", what, size,
                             mns_left(&cursor));
    }
    mns_result result = parse_dictionary(context, what, (struct literal){(const char *)header, (const char *)header + size}, out);
    if (result != MNS_OK) {
        return result;
    }
    if (out->dimensions > 2) {
        return mns_read_fail(context, MNS_ERR_UNSUPPORTED, "%shas %d dimensions; [n] and [n][c] are read", what, out->dimensions);
    }
    size_t left = mns_left(&cursor), per_row = out->shape[1], element = mns_type_size(out->type);
    if (out->shape[0] > 0 && per_row > 0 && out->shape[0] > left / element / per_row) {
        return mns_read_fail(context, MNS_ERR_BAD_DATA, "%sends early: [%zu][%zu] of %s should follow byte %zu, but %zu bytes do", what,
                             out->shape[0], per_row, mns_type_name(out->type), cursor.at, left);
    }
    out->data = (struct bytes){file.data + cursor.at, out->shape[0] * per_row * element};
    return MNS_OK;
}

/* in: [columns][rows], out: [rows][columns], both in the machine's order. */
static void transpose(uint8_t *out, const uint8_t *in, size_t rows, size_t columns, size_t size)
{
    for (size_t c = 0; c < columns; c++) {
        for (size_t r = 0; r < rows; r++) {
            memcpy(out + (r * columns + c) * size, in + (c * rows + r) * size, size);
        }
    }
}

mns_result mns_npy_add(struct read_context *context, const char *name, const struct npy *array, bool stays)
{
    size_t columns = array->shape[1], rows = array->shape[0], elements = rows * columns;
    bool native = mns_type_size(array->type) == 1 || array->big_endian == mns_big_endian();
    bool by_columns = array->fortran_order && columns > 1;
    if (columns < 1 || columns > 1 << 20) {
        return mns_read_fail(context, MNS_ERR_BAD_DATA, "'%s' has %zu components per particle", name, columns);
    }
    if (stays && native && !by_columns) {
        return mns_set_view(context, name, array->type, (int)columns, array->data.data) ? MNS_OK : MNS_ERR_OUT_OF_MEMORY;
    }
    uint8_t *out = mns_set_add(context, name, array->type, (int)columns);
    if (!out) {
        return MNS_ERR_OUT_OF_MEMORY;
    }
    if (!by_columns) {
        mns_copy_elements(out, array->data.data, elements, array->type, array->big_endian);
        return MNS_OK;
    }
    uint8_t *straight = mns_read_alloc(context, array->data.size, 1);
    if (!straight) {
        return MNS_ERR_OUT_OF_MEMORY;
    }
    mns_copy_elements(straight, array->data.data, elements, array->type, array->big_endian);
    transpose(out, straight, rows, columns, mns_type_size(array->type));
    mns_read_free(context, straight, array->data.size, 1);
    return MNS_OK;
}

static mns_result read_npy(struct read_context *context, struct bytes file)
{
    struct npy array;
    mns_result result = mns_npy_parse(context, "", file, &array);
    if (result != MNS_OK) {
        return result;
    }
    if (array.dimensions != 2 || array.shape[1] != 3) {
        return mns_read_fail(context, MNS_ERR_BAD_DATA, "is no array of positions: its shape is %s%zu%s%zu%s, not [n][3]",
                             array.dimensions == 0 ? "() of " : "[", array.shape[0], array.dimensions == 2 ? "][" : "] of ", array.shape[1],
                             array.dimensions == 2 ? "]" : "");
    }
    if (array.type != MNS_F32 && array.type != MNS_F64) {
        return mns_read_fail(context, MNS_ERR_BAD_DATA, "holds positions as %s; float32 or float64 is wanted", mns_type_name(array.type));
    }
    result = mns_set_begin(context, array.shape[0]);
    return result == MNS_OK ? mns_npy_add(context, "position", &array, true) : result;
}

const struct mns_reader mns_reader_npy = {"npy", "npy", probe, read_npy};
