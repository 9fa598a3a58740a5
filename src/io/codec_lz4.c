/* codec_lz4.c: lz4 blocks, as VTK's vtkLZ4DataCompressor writes them: no frame. */
#include "io/codec.h"

#include <limits.h>
#include <lz4.h>

mns_result mns_codec_lz4(struct read_context *context, struct bytes in, void *out, size_t out_size)
{
    if (in.size > INT_MAX || out_size > INT_MAX) {
        return mns_read_fail(context, MNS_ERR_BAD_DATA, "an lz4 block of %zu bytes, packed into %zu, is too large", out_size, in.size);
    }
    int got = LZ4_decompress_safe((const char *)in.data, out, (int)in.size, (int)out_size);
    if (got < 0) {
        return mns_read_fail(context, MNS_ERR_BAD_DATA, "lz4 data are corrupt, or hold more than the %zu bytes that should be there",
                             out_size);
    }
    if ((size_t)got != out_size) {
        return mns_read_fail(context, MNS_ERR_BAD_DATA, "lz4 data hold %d bytes where %zu should be", got, out_size);
    }
    return MNS_OK;
}
