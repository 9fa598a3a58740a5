/* PLY: ASCII and binary of both byte orders. */
#include "io_test.h"

static const char header[] =
    "element tag 2\nproperty list uchar int ids\nproperty short s\nelement vertex 3\nproperty float x\nproperty float y\n"
    "property float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nproperty double density\n"
    "property int id\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";

static void make(struct blob *blob, const char *kind)
{
    int ascii = strcmp(kind, "ascii") == 0, big = strcmp(kind, "binary_big_endian") == 0;
    blob->size = 0;
    add_text(blob, "ply\nformat ");
    add_text(blob, kind);
    add_text(blob, " 1.0\ncomment made by hand\n");
    add_text(blob, header);
    if (ascii) {
        add_text(blob, "2 7 8 1\n0 2\n0 1 2 255 0 128 1000.25 -5\n3 4 5 255 0 128 1001.25 -4\n6 7 8 255 0 128 1002.25 -3\n3 0 1 2\n");
        return;
    }
    add_integer(blob, 2, 1, big);
    add_integer(blob, 7, 4, big);
    add_integer(blob, 8, 4, big);
    add_integer(blob, 1, 2, big);
    add_integer(blob, 0, 1, big);
    add_integer(blob, 2, 2, big);
    for (int i = 0; i < 3; i++) {
        for (int c = 0; c < 3; c++) {
            add_float(blob, (float)(3 * i + c), big);
        }
        add_integer(blob, 0xff, 1, big);
        add_integer(blob, 0, 1, big);
        add_integer(blob, 128, 1, big);
        add_double(blob, 1000.25 + i, big);
        add_integer(blob, (uint64_t)(int64_t)(i - 5), 4, big);
    }
    add_integer(blob, 3, 1, big);
    for (int i = 0; i < 3; i++) {
        add_integer(blob, (uint64_t)i, 4, big);
    }
}

static void every_encoding_is_read(void **state)
{
    (void)state;
    static const char *const kinds[] = {"ascii", "binary_little_endian", "binary_big_endian"};
    for (int k = 0; k < 3; k++) {
        struct blob blob;
        make(&blob, kinds[k]);
        mns_particle_set *set = read_blob(blob.data, blob.size, "a.ply", NULL);
        const struct mns_particles *particles = mns_particle_set_particles(set);
        assert_string_equal(mns_particle_set_format(set), "ply");
        assert_int_equal(particles->count, 3);
        for (int i = 0; i < 3; i++) {
            assert_vector(particles->position, (size_t)i, 3 * i, 3 * i + 1, 3 * i + 2);
            assert_vector(particles->color, (size_t)i, 1, 0, 0.2158605); /* 128 of sRGB, in linear light */
            assert_true(value_of(particles->density, (size_t)i, 0) == 1000.25 + i);
            assert_true(value_of(particles->id, (size_t)i, 0) == i - 5);
        }
        mns_particle_set_destroy(&set);
    }
}

static void lists_in_vertices_are_skipped(void **state)
{
    (void)state;
    const char ascii[] =
        "ply\nformat ascii 1.0\nelement vertex 2\nproperty double x\nproperty list int float tail\nproperty double y\nproperty double z\n"
        "end_header\n1 2 9 9 2 3\n4 0 5 6\n";
    mns_particle_set *set = read_text(ascii, "a.ply", NULL);
    assert_vector(mns_particle_set_particles(set)->position, 0, 1, 2, 3);
    assert_vector(mns_particle_set_particles(set)->position, 1, 4, 5, 6);
    assert_int_equal(mns_particle_set_particles(set)->position.type, MNS_F64);
    mns_particle_set_destroy(&set);

    struct blob blob = {.size = 0};
    add_text(&blob,
             "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty float x\nproperty list ushort float tail\nproperty float y\n"
             "property float z\nend_header\n");
    add_float(&blob, 1, 0);
    add_integer(&blob, 1, 2, 0);
    add_float(&blob, 9, 0);
    add_float(&blob, 2, 0);
    add_float(&blob, 3, 0);
    set = read_blob(blob.data, blob.size, "a.ply", NULL);
    assert_vector(mns_particle_set_particles(set)->position, 0, 1, 2, 3);
    mns_particle_set_destroy(&set);
}

static void refuse(const char *text, mns_result code, const char *words) { refuses(text, strlen(text), "a.ply", NULL, code, words); }

static void bad_files_are_refused(void **state)
{
    (void)state;
    refuse("ply\nformat ascii 1.0\n", MNS_ERR_BAD_DATA, "'end_header' is missing");
    refuse("ply\nend_header\n", MNS_ERR_BAD_DATA, "no 'format' line");
    refuse("ply\nformat odd 1.0\nend_header\n", MNS_ERR_BAD_DATA, "line 2 of the PLY header");
    refuse("ply\nformat ascii 1.0\nelement face 0\nend_header\n", MNS_ERR_BAD_DATA, "no element 'vertex'");
    refuse("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n1\n", MNS_ERR_BAD_DATA, "no x, y and z");
    refuse("ply\nformat ascii 1.0\nelement vertex 99999999999\nproperty float x\nend_header\n1\n", MNS_ERR_BAD_DATA, "ends early");
    refuse("ply\nformat ascii 1.0\nelement vertex 99999999999999999999\nproperty float x\nend_header\n1\n", MNS_ERR_BAD_DATA, "line 3");
    refuse(
        "ply\nformat binary_big_endian 1.0\nelement vertex 4000000000\nproperty float x\nproperty float y\nproperty float z\nend_header\n1",
        MNS_ERR_BAD_DATA, "ends early");
    refuse("ply\nformat ascii 1.0\nelement vertex 1\nproperty int x\nproperty int y\nproperty int z\nend_header\n1 2 3\n",
           MNS_ERR_UNSUPPORTED, "int32");
    refuse("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n1 two 3\n",
           MNS_ERR_BAD_DATA, "'two' where a number should be");
}

static void every_cut_is_refused(void **state)
{
    (void)state;
    static const char *const kinds[] = {"ascii", "binary_little_endian"};
    for (int k = 0; k < 2; k++) {
        struct blob blob;
        make(&blob, kinds[k]);
        size_t face = k == 0 ? strlen("3 0 1 2\n") : 13;
        for (size_t size = 5; size < blob.size - face - 4; size++) {
            refuses(blob.data, size, "a.ply", NULL, MNS_ERR_BAD_DATA, "");
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_encoding_is_read),
        cmocka_unit_test(lists_in_vertices_are_skipped),
        cmocka_unit_test(bad_files_are_refused),
        cmocka_unit_test(every_cut_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
