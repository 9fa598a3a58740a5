/* fuzz.h: what all fuzz targets share: reads the bytes as one format, with memory enough and with memory that runs out, and looks at every
 * byte of the result. */
#ifndef MNS_TESTS_FUZZ_H
#define MNS_TESTS_FUZZ_H

#include <meniscus/io.h>

#include <stdint.h>

/* format: a name from mns_read_format. where: an expression, or NULL. */
void fuzz_read(const char *format, const char *where, const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

#define FUZZ_FORMAT(name)                                                                                                                  \
    int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)                                                                           \
    {                                                                                                                                      \
        fuzz_read(name, NULL, data, size);                                                                                                 \
        return 0;                                                                                                                          \
    }

#endif
