/* codec_zlib.c: zlib streams, gzip files and raw deflate, through zlib. */
#include "io/codec.h"

#include <string.h>
#define ZLIB_CONST
#include <zlib.h>

/* zlib counts in 32 bits: its windows onto larger buffers. */
static uInt window(size_t left)
{
    const size_t most = (size_t)1 << 30;
    return (uInt)(left < most ? left : most);
}

static void *zlib_allocate(void *user, uInt count, uInt size)
{
    /* zlib gives no size back when it frees, so it stands before the block. */
    struct read_context *context = user;
    size_t bytes = (size_t)count * size + 64;
    uint8_t *block = mns_read_alloc(context, bytes, 1);
    if (!block) {
        return Z_NULL;
    }
    memcpy(block, &bytes, sizeof(bytes));
    return block + 64;
}

static void zlib_release(void *user, void *memory)
{
    uint8_t *block = (uint8_t *)memory - 64;
    size_t bytes;
    memcpy(&bytes, block, sizeof(bytes));
    mns_read_free(user, block, bytes, 1);
}

enum { WINDOW_RAW = -15, WINDOW_ZLIB = 15, WINDOW_GZIP = 31 };

static mns_result start(struct read_context *context, z_stream *stream, struct bytes in, int window_bits)
{
    *stream = (z_stream){.zalloc = zlib_allocate, .zfree = zlib_release, .opaque = context, .next_in = in.data};
    if (inflateInit2(stream, window_bits) == Z_OK) {
        return MNS_OK;
    }
    if (context->message->text[0] == '\0') {
        mns_read_fail(context, MNS_ERR_OUT_OF_MEMORY, "out of memory in zlib");
    }
    return MNS_ERR_OUT_OF_MEMORY;
}

/* Inflates until the stream ends (Z_STREAM_END), or out is full or in is used up (Z_BUF_ERROR), or it fails. */
static int inflate_into(z_stream *stream, struct bytes in, uint8_t *out, size_t out_size, size_t *done)
{
    int status = Z_OK;
    while (status == Z_OK) {
        size_t taken = (size_t)(stream->next_in - in.data);
        stream->avail_in = window(in.size - taken);
        stream->next_out = out + *done;
        stream->avail_out = window(out_size - *done);
        uInt room = stream->avail_out;
        status = inflate(stream, Z_NO_FLUSH); /* Z_BUF_ERROR once it can go no further */
        *done += room - stream->avail_out;
    }
    return status;
}

static mns_result inflate_exactly(struct read_context *context, const char *what, int window_bits, struct bytes in, void *out,
                                  size_t out_size)
{
    z_stream stream;
    size_t done = 0;
    mns_result result = start(context, &stream, in, window_bits);
    if (result != MNS_OK) {
        return result;
    }
    int status = inflate_into(&stream, in, out, out_size, &done);
    if (status == Z_MEM_ERROR) {
        result = mns_read_fail(context, MNS_ERR_OUT_OF_MEMORY, "out of memory in zlib");
    } else if (status == Z_STREAM_END && done != out_size) {
        result = mns_read_fail(context, MNS_ERR_BAD_DATA, "%s data hold %zu bytes where %zu should be", what, done, out_size);
    } else if (status == Z_BUF_ERROR && done == out_size) {
        result = mns_read_fail(context, MNS_ERR_BAD_DATA, "%s data hold more than the %zu bytes that should be there", what, out_size);
    } else if (status == Z_BUF_ERROR) {
        result = mns_read_fail(context, MNS_ERR_BAD_DATA, "%s data end early, after %zu of %zu bytes", what, done, out_size);
    } else if (status != Z_STREAM_END) {
        result = mns_read_fail(context, MNS_ERR_BAD_DATA, "%s data are corrupt after %zu of %zu bytes", what, done, out_size);
    }
    inflateEnd(&stream);
    return result;
}

mns_result mns_codec_zlib(struct read_context *context, struct bytes in, void *out, size_t out_size)
{
    return inflate_exactly(context, "zlib", WINDOW_ZLIB, in, out, out_size);
}

mns_result mns_inflate_raw(struct read_context *context, struct bytes in, void *out, size_t out_size)
{
    return inflate_exactly(context, "deflate", WINDOW_RAW, in, out, out_size);
}

/* A buffer that grows by doubling. */
struct growing {
    uint8_t *data;
    size_t size, capacity;
};

static bool enlarge(struct read_context *context, struct growing *buffer)
{
    size_t capacity = 2 * buffer->capacity;
    uint8_t *larger = mns_read_alloc(context, capacity, 1);
    if (!larger) {
        return false;
    }
    memcpy(larger, buffer->data, buffer->size);
    mns_read_free(context, buffer->data, buffer->capacity, 1);
    buffer->data = larger;
    buffer->capacity = capacity;
    return true;
}

/* The first size to try: what the gzip trailer says where that is plausible (it is the size modulo 2^32 of the last member). */
static size_t first_capacity(struct bytes in)
{
    const uint8_t *tail = in.data + in.size - 4;
    size_t said = tail[0] | (size_t)tail[1] << 8 | (size_t)tail[2] << 16 | (size_t)tail[3] << 24;
    return said >= in.size / 2 && said / 32 <= in.size && said > 0 ? said : 4 * in.size + 4096;
}

mns_result mns_gunzip(struct read_context *context, struct bytes in, uint8_t **out, size_t *out_size)
{
    z_stream stream;
    *out = NULL;
    *out_size = 0;
    if (in.size < 18) {
        return mns_read_fail(context, MNS_ERR_BAD_DATA, "gzip data end early, in the header");
    }
    mns_result result = start(context, &stream, in, WINDOW_GZIP);
    if (result != MNS_OK) {
        return result;
    }
    struct growing buffer = {.capacity = first_capacity(in)};
    buffer.data = mns_read_alloc(context, buffer.capacity, 1);
    result = buffer.data ? MNS_OK : MNS_ERR_OUT_OF_MEMORY;
    while (result == MNS_OK) {
        int status = inflate_into(&stream, in, buffer.data, buffer.capacity, &buffer.size);
        size_t left = in.size - (size_t)(stream.next_in - in.data);
        if (status == Z_STREAM_END && left >= 2 && stream.next_in[0] == 0x1f && stream.next_in[1] == 0x8b) {
            inflateReset(&stream); /* another member follows */
        } else if (status == Z_STREAM_END) {
            break;
        } else if (status == Z_MEM_ERROR) {
            result = mns_read_fail(context, MNS_ERR_OUT_OF_MEMORY, "out of memory in zlib");
        } else if (status == Z_BUF_ERROR && buffer.size == buffer.capacity && mns_is_bomb(context, in.size, 2 * buffer.capacity)) {
            result = mns_read_fail(context, MNS_ERR_BAD_DATA,
                                   "unpacks to more than %zu bytes from %zu, which no particles do; "
                                   "set max_bytes if it is meant so",
                                   buffer.size, in.size);
        } else if (status == Z_BUF_ERROR && buffer.size == buffer.capacity) {
            result = enlarge(context, &buffer) ? MNS_OK : MNS_ERR_OUT_OF_MEMORY;
        } else if (status == Z_BUF_ERROR) {
            result = mns_read_fail(context, MNS_ERR_BAD_DATA, "gzip data end early, after %zu unpacked bytes", buffer.size);
        } else {
            result = mns_read_fail(context, MNS_ERR_BAD_DATA, "gzip data are corrupt after %zu unpacked bytes", buffer.size);
        }
    }
    inflateEnd(&stream);
    if (result == MNS_OK && buffer.size != buffer.capacity) {
        uint8_t *exact = mns_read_alloc(context, buffer.size, 1);
        if (exact) {
            memcpy(exact, buffer.data, buffer.size);
        } else {
            result = MNS_ERR_OUT_OF_MEMORY;
        }
        mns_read_free(context, buffer.data, buffer.capacity, 1);
        buffer.data = exact;
    } else if (result != MNS_OK && buffer.data) {
        mns_read_free(context, buffer.data, buffer.capacity, 1);
    }
    if (result != MNS_OK) {
        return result;
    }
    *out = buffer.data;
    *out_size = buffer.size;
    return MNS_OK;
}
