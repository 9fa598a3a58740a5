/* pack_missing.c: stands in for pack_zlib.c in builds without zlib, which write unpacked files. */
#include "io/particle_writer.h"

bool mns_can_pack(void) { return false; }

size_t mns_pack_bound(size_t size) { return size; }

size_t mns_pack(const void *data, size_t size, uint8_t *out)
{
    (void)data, (void)size, (void)out;
    return 0;
}

struct gzip *mns_gzip_begin(struct byte_sink sink)
{
    (void)sink;
    return NULL;
}

bool mns_gzip_put(void *gzip, const void *data, size_t size)
{
    (void)gzip, (void)data, (void)size;
    return false;
}

bool mns_gzip_end(struct gzip *gzip)
{
    (void)gzip;
    return false;
}
