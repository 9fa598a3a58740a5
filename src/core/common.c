/* common.c: names, versions and empty structs. */
#include <meniscus/common.h>
#include <meniscus/particles.h>

#include <string.h>

const char *mns_result_text(mns_result result)
{
    switch (result) {
    case MNS_OK: return "done";
    case MNS_ERR_OUT_OF_MEMORY: return "out of memory";
    case MNS_ERR_INVALID_ARGUMENT: return "invalid argument";
    case MNS_ERR_UNSUPPORTED: return "not supported by this build or machine";
    case MNS_ERR_DEVICE: return "the device refused or was lost";
    case MNS_ERR_IO: return "cannot open, read or write a file";
    case MNS_ERR_BAD_DATA: return "malformed file";
    }
    return "unknown result";
}

uint32_t mns_version(void) { return MNS_VERSION_MAJOR * 1000000u + MNS_VERSION_MINOR * 1000u + MNS_VERSION_PATCH; }

/* In the order of enum mns_type. */
static const struct {
    const char *name;
    size_t size;
} types[] = {
    {"float32", 4}, {"float64", 8}, {"int8", 1},   {"uint8", 1}, {"int16", 2},
    {"uint16", 2},  {"int32", 4},   {"uint32", 4}, {"int64", 8}, {"uint64", 8},
};

size_t mns_type_size(enum mns_type type) { return (size_t)type < sizeof(types) / sizeof(types[0]) ? types[type].size : 0; }

const char *mns_type_name(enum mns_type type) { return (size_t)type < sizeof(types) / sizeof(types[0]) ? types[type].name : "unknown"; }

void mns_particles_init_sized(struct mns_particles *particles, size_t size)
{
    memset(particles, 0, size);
    particles->struct_size = size;
}
