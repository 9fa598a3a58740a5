/* codec.h: what mns_decompress chooses from: one file per library; codec_missing.c stands in for those that are not there. */
#ifndef MNS_IO_CODEC_H
#define MNS_IO_CODEC_H

#include "io/reader.h"

mns_result mns_codec_zlib(struct read_context *context, struct bytes in, void *out, size_t out_size);
mns_result mns_codec_lz4(struct read_context *context, struct bytes in, void *out, size_t out_size);
mns_result mns_codec_lzma(struct read_context *context, struct bytes in, void *out, size_t out_size);

#endif
