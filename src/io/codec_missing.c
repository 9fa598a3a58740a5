/* codec_missing.c: stands in for the compression libraries that this build was made without. */
#include "io/codec.h"

typedef int mns_codec_missing; /* C wants a declaration where nothing is missing */

#if !defined(MNS_HAVE_ZLIB) || !defined(MNS_HAVE_LZ4) || !defined(MNS_HAVE_LZMA)
static mns_result lacking(struct read_context *context, const char *what, const char *library)
{
    return mns_read_fail(context, MNS_ERR_UNSUPPORTED, "is compressed with %s, which this build cannot read: build with %s", what, library);
}
#endif

#ifndef MNS_HAVE_ZLIB
mns_result mns_codec_zlib(struct read_context *context, struct bytes in, void *out, size_t out_size)
{
    (void)in, (void)out, (void)out_size;
    return lacking(context, "zlib", "zlib");
}

mns_result mns_inflate_raw(struct read_context *context, struct bytes in, void *out, size_t out_size)
{
    (void)in, (void)out, (void)out_size;
    return lacking(context, "deflate", "zlib");
}

mns_result mns_gunzip(struct read_context *context, struct bytes in, uint8_t **out, size_t *out_size)
{
    (void)in;
    *out = NULL;
    *out_size = 0;
    return lacking(context, "gzip", "zlib");
}
#endif

#ifndef MNS_HAVE_LZ4
mns_result mns_codec_lz4(struct read_context *context, struct bytes in, void *out, size_t out_size)
{
    (void)in, (void)out, (void)out_size;
    return lacking(context, "lz4", "liblz4");
}
#endif

#ifndef MNS_HAVE_LZMA
mns_result mns_codec_lzma(struct read_context *context, struct bytes in, void *out, size_t out_size)
{
    (void)in, (void)out, (void)out_size;
    return lacking(context, "lzma", "liblzma");
}
#endif
