/* reader.h: what a particle format is. A new format is one file and one line in reader.c's list.
 *
 * A reader gets the whole file as bytes and adds attributes to a set. It never trusts a count: mns_set_begin and mns_set_add check
 * sizes against the limit before memory is asked for, and struct bytes / cursor check every access against the end. */
#ifndef MNS_IO_READER_H
#define MNS_IO_READER_H

#include <meniscus/io.h>

#include <stdarg.h>
#include <stdbool.h>

struct bytes {
    const uint8_t *data;
    size_t size;
};

struct read_context {
    const char *path;                     /* as the user named it; for messages and for files beside it. NULL: memory without a name */
    bool may_open;                        /* false when reading from memory: no other file is opened */
    int depth;                            /* of nested files (.pvd > .pvtu > .vtu); readers refuse more than 4 */
    const struct mns_read_params *params; /* never NULL */
    struct mns_message *message;          /* never NULL */
    mns_particle_set *set;                /* being filled */
    bool file_is_ours;                    /* the file's bytes may stay with the set (mns_set_view) */
    bool file_stays;                      /* set by mns_set_view */
};

struct mns_reader {
    const char *name;       /* "bgeo" */
    const char *extensions; /* space-separated, without dots: "bgeo bgeo.gz" */
    /* 0: not this format. 1: perhaps (told by extension). 2: surely (magic). head: the first bytes, at most 64 KiB. */
    int (*probe)(struct bytes head);
    mns_result (*read)(struct read_context *context, struct bytes file);
};

extern const struct mns_reader *const mns_readers[]; /* NULL-ended; the order of probing (formats.c) */
/* NULL-ended: what stands in for formats that this build lacks, only to say so. */
extern const struct mns_reader *const mns_missing_readers[];
extern const struct mns_reader mns_reader_vtk_xml_missing;
extern const struct mns_reader mns_reader_bgeo;
extern const struct mns_reader mns_reader_vtk;  /* legacy */
extern const struct mns_reader mns_reader_vtu;  /* XML UnstructuredGrid, .vtu */
extern const struct mns_reader mns_reader_vtp;  /* XML PolyData, .vtp */
extern const struct mns_reader mns_reader_pvtu; /* .pvtu and .pvtp, .vtm, .vtpc, .vtpd */
extern const struct mns_reader mns_reader_pvd;
extern const struct mns_reader mns_reader_ply;
extern const struct mns_reader mns_reader_npy;
extern const struct mns_reader mns_reader_npz;
extern const struct mns_reader mns_reader_csv; /* CSV and XYZ */

/* Fails with "PATH: what" in context->message; returns code. */
mns_result mns_read_fail(struct read_context *context, mns_result code, const char *format, ...)
#ifdef __GNUC__
    __attribute__((format(printf, 3, 4)))
#endif
    ;

/* A warning to the log: "PATH: what". */
void mns_read_warn(struct read_context *context, const char *format, ...)
#ifdef __GNUC__
    __attribute__((format(printf, 2, 3)))
#endif
    ;

/* Memory from the set's allocator, counted against params->max_bytes. count * size is overflow-checked. NULL: refused, message set.
 * Memory is not cleared. Freed with mns_read_free (scratch) or with the set (attributes). */
void *mns_read_alloc(struct read_context *context, size_t count, size_t size);
void mns_read_free(struct read_context *context, void *memory, size_t count, size_t size);

/* Says how many particles this file (or piece) adds, before any mns_set_add. Several pieces: call it again for each; attributes that
 * a piece lacks are dropped from the whole set with a warning. */
mns_result mns_set_begin(struct read_context *context, size_t count);

/* Adds an attribute of [count][components] to the piece in hand and gives the memory to fill, in the machine's byte order; NULL: failed,
 * message set. "position" (3 components, F32 or F64) is required of every piece. Pieces must agree in type and components, else the
 * attribute is dropped with a warning. */
void *mns_set_add(struct read_context *context, const char *name, enum mns_type type, int components);

/* The same for an attribute that stands in the file's bytes as it is to be used: packed, in the machine's order. It is not copied where the
 * bytes may stay and are aligned. data: inside the bytes given to read, where count * components elements were checked to be. */
bool mns_set_view(struct read_context *context, const char *name, enum mns_type type, int components, const uint8_t *data);

/* The path of a file that is named in the file in hand: relative to its folder. Freed with mns_read_free(context, path, strlen(path) + 1, 1).
 * NULL: failed, message set. */
char *mns_read_beside(struct read_context *context, const char *reference);

/* Reads another file into the same set (pieces of a .pvtu, steps of a .pvd). reference: as written in the file; relative to its folder. */
mns_result mns_read_referenced(struct read_context *context, const char *reference);

/* Loads a whole file. Freed with mns_read_free(context, data, size, 1). */
mns_result mns_read_file(struct read_context *context, const char *path, struct bytes *out);

/* Decompressors to a known size (exactly; anything else fails) and gzip/zlib to an unknown size bounded by max_bytes.
 * In builds without the library they fail with MNS_ERR_UNSUPPORTED and name it. */
enum codec { CODEC_ZLIB, CODEC_LZ4, CODEC_LZMA };
mns_result mns_decompress(struct read_context *context, enum codec codec, struct bytes in, void *out, size_t out_size);
mns_result mns_gunzip(struct read_context *context, struct bytes in, uint8_t **out,
                      size_t *out_size); /* *out: mns_read_free(.., *out, *out_size, 1) */
mns_result mns_inflate_raw(struct read_context *context, struct bytes in, void *out, size_t out_size); /* zip members */

/* Whether data that unpack so far are made to fill the memory: particles shrink to a tenth, not to a thousandth. Never when max_bytes is set. */
bool mns_is_bomb(const struct read_context *context, size_t packed, size_t unpacked);

/* A bounded read position. Functions return false at the end of the bytes and leave the cursor where it was. */
struct cursor {
    struct bytes bytes;
    size_t at;
};
bool mns_take(struct cursor *cursor, size_t size, const uint8_t **out);
static inline size_t mns_left(const struct cursor *cursor) { return cursor->bytes.size - cursor->at; }
bool mns_take_u16be(struct cursor *cursor, uint16_t *out);
bool mns_take_u32be(struct cursor *cursor, uint32_t *out);
bool mns_take_line(struct cursor *cursor, struct bytes *line); /* without \n or \r\n */

/* Whether this machine stores the high byte first. */
static inline bool mns_big_endian(void)
{
    const uint16_t probe = 1;
    return *(const uint8_t *)&probe == 0;
}

/* Copies count elements of type from in (of the given byte order) to the machine's order. in may be unaligned. */
void mns_copy_elements(void *out, const uint8_t *in, size_t count, enum mns_type type, bool big_endian);

/* Locale-free number parsing of [text, end). Returns the place after the number, or NULL when there is none.
 * Accepts nan, inf, 1e400 (inf). */
const char *mns_parse_double(const char *text, const char *end, double *out);
const char *mns_parse_int64(const char *text, const char *end, int64_t *out);

#endif
