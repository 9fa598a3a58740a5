/* codec.c: decompression to a known size. */
#include "io/codec.h"

bool mns_is_bomb(const struct read_context *context, size_t packed, size_t unpacked)
{
    const size_t harmless = (size_t)256 << 20, ratio = 200;
    return context->params->max_bytes == 0 && unpacked > harmless && unpacked / ratio > packed;
}

mns_result mns_decompress(struct read_context *context, enum codec codec, struct bytes in, void *out, size_t out_size)
{
    switch (codec) {
    case CODEC_ZLIB: return mns_codec_zlib(context, in, out, out_size);
    case CODEC_LZ4: return mns_codec_lz4(context, in, out, out_size);
    case CODEC_LZMA: return mns_codec_lzma(context, in, out, out_size);
    }
    return mns_read_fail(context, MNS_ERR_UNSUPPORTED, "unknown compression");
}
