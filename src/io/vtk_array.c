/* vtk_array.c: from the arrays of a VTK file to particles. */
#include "io/vtk_array.h"

#include <string.h>

void *mns_vtk_grow(struct read_context *context, void *items, size_t *capacity, size_t count, size_t size)
{
    if (count < *capacity) {
        return items;
    }
    size_t more = *capacity > 0 ? 2 * *capacity : 16;
    void *larger = mns_read_alloc(context, more, size);
    if (!larger) {
        return NULL;
    }
    if (*capacity > 0) {
        memcpy(larger, items, count * size);
        mns_read_free(context, items, *capacity, size);
    }
    *capacity = more;
    return larger;
}

struct vtk_array *mns_vtk_add(struct read_context *context, struct vtk_arrays *arrays, const struct vtk_array *array, struct bytes name)
{
    struct vtk_array *items = mns_vtk_grow(context, arrays->items, &arrays->capacity, arrays->count, sizeof(*items));
    if (!items) {
        return NULL;
    }
    arrays->items = items;
    struct vtk_array *added = &items[arrays->count];
    *added = *array;
    added->name = NULL;
    if (name.size > 0) {
        added->name = mns_read_alloc(context, name.size + 1, 1);
        if (!added->name) {
            return NULL;
        }
        memcpy(added->name, name.data, name.size);
        added->name[name.size] = '\0';
    }
    arrays->count++;
    return added;
}

void mns_vtk_free(struct read_context *context, struct vtk_arrays *arrays)
{
    for (size_t i = 0; i < arrays->count; i++) {
        if (arrays->items[i].name) {
            mns_read_free(context, arrays->items[i].name, strlen(arrays->items[i].name) + 1, 1);
        }
    }
    if (arrays->capacity > 0) {
        mns_read_free(context, arrays->items, arrays->capacity, sizeof(*arrays->items));
    }
}

const char *mns_vtk_name(const struct vtk_array *array)
{
    return array->points ? "Points" : array->name ? array->name : "an array without a name";
}

/* ---- numbers in text ---- */

static bool is_real(enum mns_type type) { return type == MNS_F32 || type == MNS_F64; }

/* Writes the low bytes of a whole number, which are the same whether it has a sign or not. */
static void store_whole(void *out, uint64_t value, enum mns_type type)
{
    switch (mns_type_size(type)) {
    case 1: memcpy(out, &(uint8_t){(uint8_t)value}, 1); break;
    case 2: memcpy(out, &(uint16_t){(uint16_t)value}, 2); break;
    case 4: memcpy(out, &(uint32_t){(uint32_t)value}, 4); break;
    default: memcpy(out, &value, 8); break;
    }
}

/* A number of digits alone up to 2^64 - 1; NULL: there is none. */
static const char *parse_uint64(const char *text, const char *end, uint64_t *out)
{
    const char *p = text;
    *out = 0;
    for (; p < end && *p >= '0' && *p <= '9'; p++) {
        uint64_t digit = (uint64_t)(*p - '0');
        if (*out > (UINT64_MAX - digit) / 10) {
            return NULL;
        }
        *out = *out * 10 + digit;
    }
    return p > text ? p : NULL;
}

static bool ends_word(const char *p, const char *end) { return p == end || mns_vtk_is_blank((uint8_t)*p); }

/* A whole number, also written as 1.0 or 1e3. NULL: none that the type holds. */
static const char *parse_whole(const char *text, const char *end, enum mns_type type, void *out)
{
    static const struct {
        int64_t lowest, highest;
    } ranges[] = {
        [MNS_I8] = {INT8_MIN, INT8_MAX},    [MNS_U8] = {0, UINT8_MAX},   [MNS_I16] = {INT16_MIN, INT16_MAX}, [MNS_U16] = {0, UINT16_MAX},
        [MNS_I32] = {INT32_MIN, INT32_MAX}, [MNS_U32] = {0, UINT32_MAX}, [MNS_I64] = {INT64_MIN, INT64_MAX}, [MNS_U64] = {0, INT64_MAX}};
    int64_t value;
    uint64_t large;
    double real;
    const char *after = mns_parse_int64(text, end, &value);
    if (!after && type == MNS_U64 && (after = parse_uint64(text, end, &large)) && ends_word(after, end)) {
        memcpy(out, &large, sizeof(large));
        return after;
    }
    if (!after || !ends_word(after, end)) {
        after = mns_parse_double(text, end, &real);
        if (!after || !(real >= -0x1p63 && real < 0x1p63)) {
            return NULL;
        }
        value = (int64_t)real;
    }
    if (value < ranges[type].lowest || value > ranges[type].highest) {
        return NULL;
    }
    store_whole(out, (uint64_t)value, type);
    return after;
}

static const char *parse_real(const char *text, const char *end, enum mns_type type, void *out)
{
    double value;
    const char *after = mns_parse_double(text, end, &value);
    if (!after) {
        return NULL;
    }
    if (type == MNS_F32) {
        memcpy(out, &(float){(float)value}, sizeof(float));
    } else {
        memcpy(out, &value, sizeof(value));
    }
    return after;
}

/* 0 to 1, stored as 0 to 255. */
static const char *parse_share(const char *text, const char *end, void *out)
{
    double value;
    const char *after = mns_parse_double(text, end, &value);
    if (!after) {
        return NULL;
    }
    double held = value > 0.0 ? value < 1.0 ? value : 1.0 : 0.0;
    *(uint8_t *)out = (uint8_t)(held * 255.0 + 0.5);
    return after;
}

static const char *skip_blanks(const char *text, const char *end)
{
    while (text < end && mns_vtk_is_blank((uint8_t)*text)) {
        text++;
    }
    return text;
}

static mns_result fail_number(struct read_context *context, const struct vtk_array *array, size_t index, const char *text, const char *end)
{
    int length = 0;
    while (length < 40 && !ends_word(text + length, end)) {
        length++;
    }
    return mns_read_fail(context, MNS_ERR_BAD_DATA, "number %zu of '%s': '%.*s' is no %s", index + 1, mns_vtk_name(array), length, text,
                         array->coding == VTK_TEXT_SHARES ? "number" : mns_type_name(array->type));
}

mns_result mns_vtk_parse_numbers(struct read_context *context, const struct vtk_array *array, size_t elements, void *out)
{
    const char *p = (const char *)array->data.data, *end = p + array->data.size;
    size_t size = mns_type_size(array->type);
    bool real = is_real(array->type), share = array->coding == VTK_TEXT_SHARES;
    uint8_t *element = out;
    for (size_t i = 0; i < elements; i++, element += size) {
        p = skip_blanks(p, end);
        if (p == end) {
            return mns_read_fail(context, MNS_ERR_BAD_DATA, "'%s' holds %zu numbers where %zu should be", mns_vtk_name(array), i, elements);
        }
        const char *after = share  ? parse_share(p, end, element)
                            : real ? parse_real(p, end, array->type, element)
                                   : parse_whole(p, end, array->type, element);
        if (!after || !ends_word(after, end)) {
            return fail_number(context, array, i, p, end);
        }
        p = after;
    }
    if (skip_blanks(p, end) != end) {
        return mns_read_fail(context, MNS_ERR_BAD_DATA, "'%s' holds more than the %zu numbers that should be there", mns_vtk_name(array),
                             elements);
    }
    return MNS_OK;
}

/* ---- pieces ---- */

struct piece {
    const struct vtk_source *source;
    struct read_context *context;
    const struct vtk_array *arrays;
    size_t count, points;
    uint8_t *keep; /* [points], 0: a ghost. NULL: all are kept */
    size_t kept;
};

/* Reads an array into memory of its own; NULL: failed, message set. */
static void *read_scratch(const struct piece *piece, const struct vtk_array *array, size_t elements)
{
    const uint8_t *plain;
    size_t size = mns_type_size(array->type);
    if (piece->source->check(piece->source, array, elements, &plain) != MNS_OK) {
        return NULL;
    }
    void *scratch = mns_read_alloc(piece->context, elements, size);
    if (scratch && piece->source->decode(piece->source, array, elements, scratch) != MNS_OK) {
        mns_read_free(piece->context, scratch, elements, size);
        scratch = NULL;
    }
    return scratch;
}

/* ParaView marks points that another piece has too: vtkGhostType bit 0 (duplicate) and bit 1 (hidden); before VTK 6.3 vtkGhostLevels > 0. */
static unsigned ghost_mask(const struct vtk_array *array)
{
    if (array->points || !array->name || array->components != 1 || array->type != MNS_U8) {
        return 0;
    }
    return strcmp(array->name, "vtkGhostType") == 0 ? 3 : strcmp(array->name, "vtkGhostLevels") == 0 ? 0xff : 0;
}

static mns_result find_ghosts(struct piece *piece)
{
    const struct vtk_array *ghosts = NULL;
    unsigned mask = 0;
    for (size_t i = 0; i < piece->count && mask == 0; i++) {
        ghosts = &piece->arrays[i];
        mask = ghost_mask(ghosts);
    }
    if (mask == 0) {
        return MNS_OK;
    }
    piece->keep = read_scratch(piece, ghosts, piece->points);
    if (!piece->keep) {
        return MNS_ERR_BAD_DATA;
    }
    piece->kept = 0;
    for (size_t i = 0; i < piece->points; i++) {
        piece->keep[i] = (piece->keep[i] & mask) == 0;
        piece->kept += piece->keep[i];
    }
    return MNS_OK;
}

/* Copies the elements of `size` bytes that are kept. */
static void gather(const struct piece *piece, uint8_t *out, const uint8_t *in, size_t size)
{
    for (size_t i = 0; i < piece->points; i++) {
        if (!piece->keep[i]) {
            continue;
        }
        memcpy(out, in + i * size, size);
        out += size;
    }
}

static mns_result add_array(const struct piece *piece, const struct vtk_array *array, const char *name)
{
    const struct vtk_source *source = piece->source;
    const uint8_t *plain;
    size_t components = (size_t)array->components;
    if (piece->points > SIZE_MAX / 16 / components) {
        return mns_read_fail(piece->context, MNS_ERR_BAD_DATA, "'%s' has %zu numbers per point, which no memory holds", name, components);
    }
    size_t elements = piece->points * components;
    mns_result result = source->check(source, array, elements, &plain);
    if (result != MNS_OK) {
        return result;
    }
    if (plain && piece->kept == piece->points) {
        return mns_set_view(piece->context, name, array->type, array->components, plain) ? MNS_OK : MNS_ERR_OUT_OF_MEMORY;
    }
    void *out = mns_set_add(piece->context, name, array->type, array->components);
    if (!out) {
        return MNS_ERR_OUT_OF_MEMORY;
    }
    if (piece->kept == piece->points) {
        return source->decode(source, array, elements, out);
    }
    uint8_t *all = read_scratch(piece, array, elements);
    if (!all) {
        return MNS_ERR_BAD_DATA;
    }
    gather(piece, out, all, components * mns_type_size(array->type));
    mns_read_free(piece->context, all, elements, mns_type_size(array->type));
    return MNS_OK;
}

static mns_result add_attributes(const struct piece *piece, const struct vtk_array *position)
{
    mns_result result = mns_set_begin(piece->context, piece->kept);
    if (result == MNS_OK && piece->kept > 0) {
        result = add_array(piece, position, "position");
    }
    for (size_t i = 0; i < piece->count && piece->kept > 0 && result == MNS_OK; i++) {
        const struct vtk_array *array = &piece->arrays[i];
        if (!array->points && array->name && ghost_mask(array) == 0) {
            result = add_array(piece, array, array->name);
        }
    }
    return result;
}

mns_result mns_vtk_add_piece(const struct vtk_source *source, const struct vtk_array *arrays, size_t count, size_t points)
{
    struct piece piece = {source, source->context, arrays, count, points, NULL, points};
    const struct vtk_array *position = NULL;
    for (size_t i = 0; i < count && !position; i++) {
        position = arrays[i].points ? &arrays[i] : NULL;
    }
    if (points == 0) {
        return mns_set_begin(source->context, 0);
    }
    if (!position) {
        return mns_read_fail(source->context, MNS_ERR_BAD_DATA, "has no positions for its %zu points", points);
    }
    if (!is_real(position->type)) {
        return mns_read_fail(source->context, MNS_ERR_UNSUPPORTED, "has positions of type %s; float32 and float64 are read",
                             mns_type_name(position->type));
    }
    if (position->components != 3) {
        return mns_read_fail(source->context, MNS_ERR_BAD_DATA, "has positions of %d components where 3 should be", position->components);
    }
    mns_result result = find_ghosts(&piece);
    if (result == MNS_OK) {
        result = add_attributes(&piece, position);
    }
    if (piece.keep) {
        mns_read_free(source->context, piece.keep, points, 1);
    }
    return result;
}
