/* io_test.h: what the tests of the readers share: bytes put together by hand, and reading them from memory. */
#ifndef MNS_TESTS_IO_TEST_H
#define MNS_TESTS_IO_TEST_H

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <meniscus/io.h>

#include "core/attr.h"

/* Bytes that grow at the end. */
struct blob {
    uint8_t data[16384];
    size_t size;
};

static inline void add(struct blob *blob, const void *data, size_t size)
{
    assert_true(blob->size + size <= sizeof(blob->data));
    memcpy(blob->data + blob->size, data, size);
    blob->size += size;
}

static inline void add_text(struct blob *blob, const char *text) { add(blob, text, strlen(text)); }

/* The low `size` bytes of value, in the order said. */
static inline void add_integer(struct blob *blob, uint64_t value, int size, int big_endian)
{
    for (int i = 0; i < size; i++) {
        uint8_t byte = (uint8_t)(value >> 8 * (big_endian ? size - 1 - i : i));
        add(blob, &byte, 1);
    }
}

static inline void add_float(struct blob *blob, float value, int big_endian)
{
    uint32_t bits;
    memcpy(&bits, &value, 4);
    add_integer(blob, bits, 4, big_endian);
}

static inline void add_double(struct blob *blob, double value, int big_endian)
{
    uint64_t bits;
    memcpy(&bits, &value, 8);
    add_integer(blob, bits, 8, big_endian);
}

/* Reads what must be readable. */
static inline mns_particle_set *read_blob(const void *data, size_t size, const char *name, const struct mns_read_params *params)
{
    struct mns_message message;
    mns_particle_set *set;
    /* A copy of exactly this size: reading beyond it is caught by the sanitizers. */
    uint8_t *copy = malloc(size ? size : 1);
    assert_non_null(copy);
    memcpy(copy, data, size);
    mns_result result = mns_particle_set_read_memory(&set, copy, size, name, params, &message);
    free(copy);
    if (result != MNS_OK)
        fail_msg("%s", message.text);
    return set;
}

static inline mns_particle_set *read_text(const char *text, const char *name, const struct mns_read_params *params)
{
    return read_blob(text, strlen(text), name, params);
}

/* Checks that reading fails with this code and a message that holds these words. */
static inline void refuses(const void *data, size_t size, const char *name, const struct mns_read_params *params, mns_result code,
                           const char *words)
{
    struct mns_message message;
    mns_particle_set *set;
    uint8_t *copy = malloc(size ? size : 1);
    assert_non_null(copy);
    memcpy(copy, data, size);
    mns_result result = mns_particle_set_read_memory(&set, copy, size, name, params, &message);
    free(copy);
    assert_null(set);
    if (result != code || !strstr(message.text, words) || strncmp(message.text, name, strlen(name)) != 0) {
        fail_msg("wanted code %d with '%s', got %d: '%s'", code, words, result, message.text);
    }
}

/* Component c of particle i. */
static inline double value_of(struct mns_attr attr, size_t i, int c)
{
    assert_non_null(attr.data);
    assert_true(attr.stride > 0);
    return mns_attr_get(&attr, attr.type, c + 1, i, c);
}

static inline const struct mns_attribute *find_attribute(const mns_particle_set *set, const char *name)
{
    for (size_t i = 0; i < mns_particle_set_attribute_count(set); i++)
        if (strcmp(mns_particle_set_attribute(set, i)->name, name) == 0)
            return mns_particle_set_attribute(set, i);
    return NULL;
}

static inline void assert_vector(struct mns_attr attr, size_t i, double x, double y, double z)
{
    const double wanted[3] = {x, y, z};
    for (int c = 0; c < 3; c++)
        assert_true(fabs(value_of(attr, i, c) - wanted[c]) < 1e-6);
}

/* Collects warnings. */
struct heard {
    int count;
    char last[1024];
};

static inline void hear(void *user, enum mns_log_level level, const char *text)
{
    struct heard *heard = user;
    assert_int_equal(level, MNS_LOG_WARNING);
    heard->count++;
    snprintf(heard->last, sizeof(heard->last), "%s", text);
}

#endif
