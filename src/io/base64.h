/* base64.h: bytes written as text. */
#ifndef MNS_IO_BASE64_H
#define MNS_IO_BASE64_H

#include "io/reader.h"

/* Decodes a stream from its byte `skip` on, at most `size` bytes. Blanks between characters are nothing; padding or any other character ends
 * the stream. Returns the number of bytes; *used: how much of the text was read, in whole groups of four with their padding. */
size_t mns_base64_decode(struct bytes text, size_t skip, uint8_t *out, size_t size, size_t *used);

#endif
