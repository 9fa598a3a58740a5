/* npy.h: arrays as numpy saves them: NumPy enhancement proposal 1, versions 1 to 3. */
#ifndef MNS_IO_NPY_H
#define MNS_IO_NPY_H

#include "io/reader.h"

struct npy {
    enum mns_type type;
    bool big_endian, fortran_order;
    int dimensions;    /* 0 to 2 */
    size_t shape[2];   /* 1 where there are fewer */
    struct bytes data; /* shape[0] * shape[1] elements, checked to be there */
};

/* Parses an .npy's bytes. what: "" or a member's name with ": " behind it, for messages. */
mns_result mns_npy_parse(struct read_context *context, const char *what, struct bytes file, struct npy *out);

/* Adds the array to the piece in hand, as shape[0] particles. stays: its bytes lie in the file given to read. */
mns_result mns_npy_add(struct read_context *context, const char *name, const struct npy *array, bool stays);

enum { NPY_HEADER_SIZE = 128 };

/* The header of an array of this shape (at most 3 dimensions) in the machine's byte order; its elements follow, the last index fastest. */
void mns_npy_header(uint8_t out[NPY_HEADER_SIZE], enum mns_type type, int dimensions, const size_t shape[]);

#endif
