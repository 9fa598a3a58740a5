/* pack_zlib.c: packing: zlib streams and gzip files, through zlib. */
#include "io/particle_writer.h"

#include <stdlib.h>
#define ZLIB_CONST
#include <zlib.h>

/* Particles' low bits are noise: more effort saves a percent and takes several times as long. */
enum { LEVEL = 1, GZIP_WINDOW = 31, MEMORY_LEVEL = 8, PIECE = 65536 };

bool mns_can_pack(void) { return true; }

size_t mns_pack_bound(size_t size) { return (size_t)compressBound((uLong)size); }

size_t mns_pack(const void *data, size_t size, uint8_t *out)
{
    uLongf packed = (uLongf)mns_pack_bound(size);
    return compress2(out, &packed, data, (uLong)size, LEVEL) == Z_OK ? (size_t)packed : 0;
}

struct gzip {
    z_stream stream;
    struct byte_sink sink;
    bool failed;
    uint8_t out[PIECE];
};

struct gzip *mns_gzip_begin(struct byte_sink sink)
{
    struct gzip *gzip = calloc(1, sizeof(*gzip));
    if (gzip && deflateInit2(&gzip->stream, LEVEL, Z_DEFLATED, GZIP_WINDOW, MEMORY_LEVEL, Z_DEFAULT_STRATEGY) != Z_OK) {
        free(gzip);
        return NULL;
    }
    if (gzip) {
        gzip->sink = sink;
    }
    return gzip;
}

/* Feeds what is in the stream's input. */
static bool pump(struct gzip *gzip, int flush)
{
    z_stream *stream = &gzip->stream;
    do {
        stream->next_out = gzip->out;
        stream->avail_out = PIECE;
        deflate(stream, flush);
        size_t made = PIECE - stream->avail_out;
        if (made > 0 && !gzip->sink.put(gzip->sink.user, gzip->out, made)) {
            gzip->failed = true;
        }
    } while (stream->avail_out == 0 && !gzip->failed);
    return !gzip->failed;
}

bool mns_gzip_put(void *user, const void *data, size_t size)
{
    struct gzip *gzip = user;
    const uint8_t *in = data;
    while (size > 0 && !gzip->failed) {
        uInt window = (uInt)(size < (size_t)1 << 30 ? size : (size_t)1 << 30); /* zlib counts in 32 bits */
        gzip->stream.next_in = in;
        gzip->stream.avail_in = window;
        pump(gzip, Z_NO_FLUSH);
        in += window;
        size -= window;
    }
    return !gzip->failed;
}

bool mns_gzip_end(struct gzip *gzip)
{
    bool good = !gzip->failed && pump(gzip, Z_FINISH);
    deflateEnd(&gzip->stream);
    free(gzip);
    return good;
}
