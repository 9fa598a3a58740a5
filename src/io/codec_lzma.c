/* codec_lzma.c: .xz streams, as VTK's vtkLZMADataCompressor writes them. */
#include "io/codec.h"

#include <lzma.h>
#include <string.h>

static void *lzma_allocate(void *user, size_t count, size_t size)
{
    struct read_context *context = user;
    if (size != 0 && count > (SIZE_MAX - 64) / size) {
        return NULL;
    }
    size_t bytes = count * size + 64; /* its size stands before the block */
    uint8_t *block = mns_read_alloc(context, bytes, 1);
    if (!block) {
        return NULL;
    }
    memcpy(block, &bytes, sizeof(bytes));
    return block + 64;
}

static void lzma_release(void *user, void *memory)
{
    if (!memory) {
        return;
    }
    uint8_t *block = (uint8_t *)memory - 64;
    size_t bytes;
    memcpy(&bytes, block, sizeof(bytes));
    mns_read_free(user, block, bytes, 1);
}

mns_result mns_codec_lzma(struct read_context *context, struct bytes in, void *out, size_t out_size)
{
    const lzma_allocator allocator = {lzma_allocate, lzma_release, context};
    uint64_t memory_limit = (uint64_t)128 << 20; /* xz -9 needs 65 MiB */
    size_t in_at = 0, out_at = 0;
    lzma_ret status = lzma_stream_buffer_decode(&memory_limit, 0, &allocator, in.data, &in_at, in.size, out, &out_at, out_size);
    if (status == LZMA_MEM_ERROR || status == LZMA_MEMLIMIT_ERROR) {
        return mns_read_fail(context, MNS_ERR_OUT_OF_MEMORY, "out of memory in lzma");
    }
    if (status == LZMA_BUF_ERROR) {
        return mns_read_fail(context, MNS_ERR_BAD_DATA, "lzma data end early, or hold more than the %zu bytes that should be there",
                             out_size);
    }
    if (status != LZMA_OK) {
        return mns_read_fail(context, MNS_ERR_BAD_DATA, "lzma data are corrupt");
    }
    if (out_at != out_size) {
        return mns_read_fail(context, MNS_ERR_BAD_DATA, "lzma data hold %zu bytes where %zu should be", out_at, out_size);
    }
    return MNS_OK;
}
