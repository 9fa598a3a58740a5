/* vtk_array.h: what VTK's legacy and XML files share: the arrays that are found in a file, and how they become particles. A first pass over
 * a file finds its arrays without reading them; then the points and the point data are taken over, each in one go. */
#ifndef MNS_IO_VTK_ARRAY_H
#define MNS_IO_VTK_ARRAY_H

#include "io/reader.h"

enum vtk_coding {
    VTK_TEXT,
    VTK_TEXT_SHARES, /* legacy colours in text: 0 to 1, read as uint8 0 to 255 */
    VTK_RAW,
    VTK_BASE64, /* XML */
    VTK_BITS    /* legacy: eight to a byte, the first one highest; read as uint8 */
};

struct vtk_array {
    char *name;  /* NULL: it has none */
    bool points; /* positions; else point data */
    enum vtk_coding coding;
    enum mns_type type;
    int components;
    struct bytes data; /* legacy: just this array. XML: from its first byte to the end of all that may be its own */
    bool appended;     /* XML: data is known once the first pass has ended */
    uint64_t offset;   /* XML: from the beginning of the appended data */
};

struct vtk_arrays {
    struct vtk_array *items;
    size_t count, capacity;
};

/* Adds an array, whose name is copied: it holds no NUL, and need not end in one. NULL: failed, message set. */
struct vtk_array *mns_vtk_add(struct read_context *context, struct vtk_arrays *arrays, const struct vtk_array *array, struct bytes name);
void mns_vtk_free(struct read_context *context, struct vtk_arrays *arrays);

/* What an array is called in messages. */
const char *mns_vtk_name(const struct vtk_array *array);

/* Makes room for one more item behind count; contents are kept. NULL: failed, message set, items are as they were. */
void *mns_vtk_grow(struct read_context *context, void *items, size_t *capacity, size_t count, size_t size);

/* Whether a character parts numbers. */
static inline bool mns_vtk_is_blank(uint8_t c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

/* Reads numbers in text. Exactly `elements` of them must be there. */
mns_result mns_vtk_parse_numbers(struct read_context *context, const struct vtk_array *array, size_t elements, void *out);

/* How a format reads its arrays. */
struct vtk_source {
    struct read_context *context;
    /* Checks, before memory is asked for, that the bytes can hold `elements` elements. Where these stand packed and in the machine's order,
     * *plain is their place, else NULL. */
    mns_result (*check)(const struct vtk_source *source, const struct vtk_array *array, size_t elements, const uint8_t **plain);
    mns_result (*decode)(const struct vtk_source *source, const struct vtk_array *array, size_t elements, void *out);
};

/* Adds a piece to the set: its positions and point data. Ghost points, which another piece has too, are left out. */
mns_result mns_vtk_add_piece(const struct vtk_source *source, const struct vtk_array *arrays, size_t count, size_t points);

#endif
