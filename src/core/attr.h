/* attr.h: reading one number of a caller's attribute, whatever its type, stride and alignment. */
#ifndef MNS_CORE_ATTR_H
#define MNS_CORE_ATTR_H

#include <meniscus/particles.h>

#include <string.h>

/* Component `component` of particle `index`. type is passed apart so that loops over a constant type compile to plain loads; an unknown one
 * reads as 0. */
static inline double mns_attr_get(const struct mns_attr *attr, enum mns_type type, int components, size_t index, int component)
{
#define MNS_ATTR_CASE(name, c_type)                                                                                                        \
    case name: {                                                                                                                           \
        c_type value;                                                                                                                      \
        size_t stride = attr->stride ? attr->stride : sizeof(value) * (size_t)components;                                                  \
        const char *at = (const char *)attr->data + index * stride + (size_t)component * sizeof(value);                                    \
        memcpy(&value, at, sizeof(value));                                                                                                 \
        return (double)value;                                                                                                              \
    }
    switch (type) {
        MNS_ATTR_CASE(MNS_F32, float)
        MNS_ATTR_CASE(MNS_F64, double)
        MNS_ATTR_CASE(MNS_I8, int8_t)
        MNS_ATTR_CASE(MNS_U8, uint8_t)
        MNS_ATTR_CASE(MNS_I16, int16_t)
        MNS_ATTR_CASE(MNS_U16, uint16_t)
        MNS_ATTR_CASE(MNS_I32, int32_t)
        MNS_ATTR_CASE(MNS_U32, uint32_t)
        MNS_ATTR_CASE(MNS_I64, int64_t)
        MNS_ATTR_CASE(MNS_U64, uint64_t)
    }
#undef MNS_ATTR_CASE
    return 0;
}

#endif
