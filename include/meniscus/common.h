/* meniscus/common.h: results, messages, memory, threads, images.
 *
 * Rules that hold for every function of the library:
 *  - Nothing is global, nothing is printed, nothing exits. Errors are a code (enum mns_result) and a text.
 *  - Pointers passed in are borrowed: read during the call, never kept, unless a line says otherwise.
 *  - A pointer the caller gets from *_create or *_read is the caller's, who gives it back to the matching *_destroy.
 *  - Different objects may be used in different threads at once; one object by one thread at a time.
 *  - Lengths are in the particles' own unit, called metres; times in seconds; angles in degrees.
 *  - World space is right-handed. View space looks down -z. `depth` is the positive distance along the view axis, +inf where
 *    there is no fluid. Images have row 0 at the top and pixel centres at +0.5. Colours are linear Rec.709 unless said.
 *  - A struct whose first field is struct_size is filled by its _init function, which sets that field; later versions add
 *    fields at the end only.
 */
#ifndef MENISCUS_COMMON_H
#define MENISCUS_COMMON_H

#include <stddef.h>
#include <stdint.h>

#include <meniscus/config.h>

#ifdef __cplusplus
extern "C" {
#endif

/* What became of a call. The numbers never change. */
typedef enum mns_result {
    MNS_OK = 0,
    MNS_ERR_OUT_OF_MEMORY = 1,
    MNS_ERR_INVALID_ARGUMENT = 2,
    MNS_ERR_UNSUPPORTED = 3, /* not in this build, or not on this machine */
    MNS_ERR_DEVICE = 4,      /* the GPU refused or was lost */
    MNS_ERR_IO = 5,          /* a file cannot be opened, read or written */
    MNS_ERR_BAD_DATA = 6     /* a file was opened but is malformed */
} mns_result;

/* A few words for a result ("out of memory"). Never NULL; static storage. */
MNS_API const char *mns_result_text(mns_result result);

/* The library's version as run, which may differ from the headers' MNS_VERSION_*: major * 1000000 + minor * 1000 + patch. */
MNS_API uint32_t mns_version(void);

/* What went wrong, in one line without a newline: what, where, and what would be right. Always NUL-terminated. */
struct mns_message {
    char text[1024];
};

enum mns_log_level { MNS_LOG_ERROR = 0, MNS_LOG_WARNING = 1, MNS_LOG_INFO = 2, MNS_LOG_DEBUG = 3 };

/* Where messages go. message NULL: nowhere. It is called from the thread that called the library. */
struct mns_log {
    void (*message)(void *user, enum mns_log_level level, const char *text);
    void *user;
};

/* Where memory comes from. Both functions or neither; with neither, the C library's. Called from one thread at a time per object. */
struct mns_allocator {
    void *(*allocate)(void *user, size_t size, size_t alignment); /* alignment: a power of two; NULL when out of memory */
    void (*release)(void *user, void *memory, size_t size);       /* memory: from allocate, with the size asked for; or NULL */
    void *user;
};

/* The caller's own threads. run must call job(context, i) once for every i in [0, count), in any threads and any order,
 * and return when all have returned. Results do not depend on which thread ran what. */
struct mns_parallel {
    void (*run)(void *user, void (*job)(void *context, int index), void *context, int count);
    void *user;
};

/* The type of one element of an array. */
enum mns_type {
    MNS_F32 = 0,
    MNS_F64 = 1,
    MNS_I8 = 2,
    MNS_U8 = 3,
    MNS_I16 = 4,
    MNS_U16 = 5,
    MNS_I32 = 6,
    MNS_U32 = 7,
    MNS_I64 = 8,
    MNS_U64 = 9
};

/* Bytes of one element; 0 for an unknown type. */
MNS_API size_t mns_type_size(enum mns_type type);

/* "float32", "uint64", ...; "unknown" for an unknown type. */
MNS_API const char *mns_type_name(enum mns_type type);

/* How a pixel is stored. */
enum mns_pixel {
    MNS_PIXEL_F32 = 0, /* float32 per channel: linear colour (straight alpha), metres, ... as the layer says */
    MNS_PIXEL_U8 = 1,  /* sRGB, 8 bits per channel, alpha straight and linear; colour layers only */
    MNS_PIXEL_U16 = 2  /* sRGB, 16 bits per channel in the machine's byte order; colour layers only */
};

/* Pixels in the caller's memory. Nothing in between the rows is touched. */
struct mns_image {
    void *data;           /* [height] rows of [width][channels] */
    size_t stride;        /* bytes from one row to the next; 0: packed */
    int width, height;    /* pixels */
    int channels;         /* 1 to 4 */
    enum mns_pixel pixel; /* what data holds */
};

#ifdef __cplusplus
}
#endif

#endif
