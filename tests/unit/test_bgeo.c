/* Partio's .bgeo version 5, plain and gzip. */
#include "io_test.h"

#ifdef MNS_HAVE_ZLIB
#include <zlib.h>
#endif

static void add_attribute(struct blob *blob, const char *name, int words, int kind)
{
    add_integer(blob, strlen(name), 2, 1);
    add_text(blob, name);
    add_integer(blob, (uint64_t)words, 2, 1);
    add_integer(blob, (uint64_t)kind, 4, 1);
    if (kind == 4) {
        add_integer(blob, 2, 4, 1);
        add_integer(blob, 3, 2, 1);
        add_text(blob, "air");
        add_integer(blob, 5, 2, 1);
        add_text(blob, "water");
        return;
    }
    for (int i = 0; i < words; i++) {
        add_integer(blob, 0, 4, 1);
    }
}

static void add_head(struct blob *blob, uint32_t points, uint32_t attributes)
{
    const uint32_t fields[] = {5, points, 0, 0, 0, attributes, 0, 0, 0};
    add_text(blob, "BgeoV");
    for (int i = 0; i < 9; i++) {
        add_integer(blob, fields[i], 4, 1);
    }
}

static void make(struct blob *blob, uint32_t points)
{
    add_head(blob, points, 4);
    add_attribute(blob, "id", 1, 1);
    add_attribute(blob, "v", 3, 5);
    add_attribute(blob, "name", 1, 4);
    add_attribute(blob, "pscale", 1, 0);
    for (uint32_t i = 0; i < points; i++) {
        for (int c = 0; c < 3; c++) {
            add_float(blob, (float)i + 0.25f * (float)c, 1);
        }
        add_float(blob, 1.0f, 1);
        add_integer(blob, 100 + i, 4, 1);
        for (int c = 0; c < 3; c++) {
            add_float(blob, (float)-c, 1);
        }
        add_integer(blob, i % 2, 4, 1);
        add_float(blob, 0.5f, 1);
    }
    add(blob, "\0\xff", 2);
}

static void check(const mns_particle_set *set, size_t points)
{
    const struct mns_particles *particles = mns_particle_set_particles(set);
    assert_string_equal(mns_particle_set_format(set), "bgeo");
    assert_int_equal(particles->count, points);
    assert_int_equal(mns_particle_set_attribute_count(set), 5);
    for (size_t i = 0; i < points; i++) {
        assert_vector(particles->position, i, (double)i, (double)i + 0.25, (double)i + 0.5);
        assert_vector(particles->velocity, i, 0, -1, -2);
        assert_int_equal((int)value_of(particles->id, i, 0), 100 + (int)i);
        assert_true(value_of(particles->radius, i, 0) == 0.5);
    }
    const struct mns_attribute *name = find_attribute(set, "name");
    assert_non_null(name);
    assert_int_equal(name->type, MNS_I32);
    assert_int_equal(((const int32_t *)name->data)[1], 1);
}

static void points_are_read(void **state)
{
    (void)state;
    static struct blob blob;
    blob.size = 0;
    make(&blob, 300); /* more than one block */
    mns_particle_set *set = read_blob(blob.data, blob.size, "a.bgeo", NULL);
    check(set, 300);
    mns_particle_set_destroy(&set);
    set = read_blob(blob.data, blob.size, "named.otherwise", NULL);
    check(set, 300);
    mns_particle_set_destroy(&set);
}

static void no_points_are_a_valid_set(void **state)
{
    (void)state;
    struct blob blob = {.size = 0};
    make(&blob, 0);
    mns_particle_set *set = read_blob(blob.data, blob.size, "a.bgeo", NULL);
    assert_int_equal(mns_particle_set_particles(set)->count, 0);
    mns_particle_set_destroy(&set);
}

static void gigantic_counts_are_refused(void **state)
{
    (void)state;
    struct blob blob = {.size = 0};
    add_head(&blob, UINT32_MAX, 0);
    add_float(&blob, 1.0f, 1);
    refuses(blob.data, blob.size, "a.bgeo", NULL, MNS_ERR_BAD_DATA, "4294967295 points of 16 bytes should follow byte 41, but 4 bytes do");
    blob.size = 0;
    add_head(&blob, 1, UINT32_MAX);
    refuses(blob.data, blob.size, "a.bgeo", NULL, MNS_ERR_BAD_DATA, "4294967295 point attributes");
    blob.size = 0;
    add_head(&blob, 1, 1);
    add_integer(&blob, 1, 2, 1);
    add_text(&blob, "s");
    add_integer(&blob, 1, 2, 1);
    add_integer(&blob, 4, 4, 1);
    add_integer(&blob, UINT32_MAX, 4, 1);
    refuses(blob.data, blob.size, "a.bgeo", NULL, MNS_ERR_BAD_DATA, "description of point attribute 1 of 1");
}

static void other_kinds_are_refused(void **state)
{
    (void)state;
    struct blob blob = {.size = 0};
    add_head(&blob, 0, 1);
    add_attribute(&blob, "odd", 1, 3);
    refuses(blob.data, blob.size, "a.bgeo", NULL, MNS_ERR_BAD_DATA, "'odd' is of kind 3");
    refuses("\x7fNSJb\0\0", 7, "a.bgeo", NULL, MNS_ERR_UNSUPPORTED, "Houdini 12");
    refuses("BgeoV\0\0\0\4aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa", 50, "a.bgeo", NULL, MNS_ERR_UNSUPPORTED, "version 4");
}

static void every_cut_is_refused(void **state)
{
    (void)state;
    struct blob blob = {.size = 0};
    make(&blob, 3);
    for (size_t size = 5; size < blob.size - 2; size++) {
        refuses(blob.data, size, "a.bgeo", NULL, MNS_ERR_BAD_DATA, "end");
    }
}

#ifdef MNS_HAVE_ZLIB
static struct blob gzipped(const void *data, size_t size)
{
    struct blob out = {.size = 0};
    z_stream stream = {.next_in = (Bytef *)(uintptr_t)data, .avail_in = (uInt)size, .next_out = out.data, .avail_out = sizeof(out.data)};
    assert_int_equal(deflateInit2(&stream, 9, Z_DEFLATED, 31, 9, Z_DEFAULT_STRATEGY), Z_OK);
    assert_int_equal(deflate(&stream, Z_FINISH), Z_STREAM_END);
    out.size = stream.total_out;
    deflateEnd(&stream);
    return out;
}

static void gzip_is_unpacked(void **state)
{
    (void)state;
    static struct blob blob;
    blob.size = 0;
    make(&blob, 300);
    struct blob packed = gzipped(blob.data, blob.size);
    mns_particle_set *set = read_blob(packed.data, packed.size, "a.bgeo", NULL);
    check(set, 300);
    mns_particle_set_destroy(&set);
    /* Two members in a row are one file. */
    struct blob first = gzipped(blob.data, 1000), second = gzipped(blob.data + 1000, blob.size - 1000);
    add(&first, second.data, second.size);
    set = read_blob(first.data, first.size, "a.bgeo.gz", NULL);
    check(set, 300);
    mns_particle_set_destroy(&set);
}

static void bad_gzip_is_refused(void **state)
{
    (void)state;
    static struct blob blob;
    blob.size = 0;
    make(&blob, 300);
    struct blob packed = gzipped(blob.data, blob.size);
    refuses(packed.data, 5, "a.bgeo", NULL, MNS_ERR_BAD_DATA, "gzip data end early");
    refuses(packed.data, packed.size / 2, "a.bgeo", NULL, MNS_ERR_BAD_DATA, "gzip data end early");
    packed.data[packed.size - 8] ^= 1; /* the checksum */
    refuses(packed.data, packed.size, "a.bgeo", NULL, MNS_ERR_BAD_DATA, "gzip data are corrupt");
}

static void bombs_do_not_go_off(void **state)
{
    (void)state;
    enum { SIZE = 8 << 20 };
    uint8_t *zeros = calloc(SIZE, 1);
    assert_non_null(zeros);
    struct blob packed = gzipped(zeros, SIZE);
    free(zeros);
    struct mns_read_params params;
    mns_read_params_init(&params);
    params.max_bytes = 1 << 20;
    refuses(packed.data, packed.size, "a.bgeo", &params, MNS_ERR_OUT_OF_MEMORY, "max_bytes");
    /* Without a limit: 40 members of 8 MiB each from 8 KiB each are no particles. */
    uint8_t *many = malloc(40 * packed.size);
    assert_non_null(many);
    for (size_t i = 0; i < 40; i++) {
        memcpy(many + i * packed.size, packed.data, packed.size);
    }
    refuses(many, 40 * packed.size, "a.bgeo", NULL, MNS_ERR_BAD_DATA, "which no particles do");
    free(many);
}
#endif

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(points_are_read),
        cmocka_unit_test(no_points_are_a_valid_set),
        cmocka_unit_test(gigantic_counts_are_refused),
        cmocka_unit_test(other_kinds_are_refused),
        cmocka_unit_test(every_cut_is_refused),
#ifdef MNS_HAVE_ZLIB
        cmocka_unit_test(gzip_is_unpacked),
        cmocka_unit_test(bad_gzip_is_refused),
        cmocka_unit_test(bombs_do_not_go_off),
#endif
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
