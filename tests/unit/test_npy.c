/* .npy and .npz: reading, and reading back what mns_particles_write wrote. */
#ifndef _WIN32
#define _POSIX_C_SOURCE 200809L
#endif

#include "io_test.h"

#ifndef _WIN32
#include <unistd.h>
#endif

static void add_npy(struct blob *blob, int version, const char *dictionary)
{
    const uint8_t head[] = {0x93, 'N', 'U', 'M', 'P', 'Y', (uint8_t)version, 0};
    add(blob, head, sizeof(head));
    add_integer(blob, strlen(dictionary), version == 1 ? 2 : 4, 0);
    add_text(blob, dictionary);
}

static void every_layout_is_read(void **state)
{
    (void)state;
    for (int i = 0; i < 16; i++) {
        int big = i & 1, wide = i & 2, fortran = i & 4, version = i & 8 ? 3 : 1;
        char dictionary[128];
        snprintf(dictionary, sizeof(dictionary), "{'descr': '%c%s', 'fortran_order': %s, 'shape': (2, 3), }  \n", big ? '>' : '<',
                 wide ? "f8" : "f4", fortran ? "True" : "False");
        struct blob blob = {.size = 0};
        add_npy(&blob, version, dictionary);
        static const double c_order[] = {1, 2, 3, 4, 5, 6}, fortran_order[] = {1, 4, 2, 5, 3, 6};
        for (int k = 0; k < 6; k++) {
            double v = fortran ? fortran_order[k] : c_order[k];
            if (wide) {
                add_double(&blob, v, big);
            } else {
                add_float(&blob, (float)v, big);
            }
        }
        mns_particle_set *set = read_blob(blob.data, blob.size, "a.npy", NULL);
        const struct mns_particles *particles = mns_particle_set_particles(set);
        assert_string_equal(mns_particle_set_format(set), "npy");
        assert_int_equal(particles->count, 2);
        assert_int_equal(particles->position.type, wide ? MNS_F64 : MNS_F32);
        assert_vector(particles->position, 0, 1, 2, 3);
        assert_vector(particles->position, 1, 4, 5, 6);
        mns_particle_set_destroy(&set);
        assert_null(set);
    }
}

static void no_particles_are_a_valid_set(void **state)
{
    (void)state;
    struct blob blob = {.size = 0};
    add_npy(&blob, 1, "{'descr': '<f4', 'fortran_order': False, 'shape': (0, 3), }");
    mns_particle_set *set = read_blob(blob.data, blob.size, "a.npy", NULL);
    assert_int_equal(mns_particle_set_particles(set)->count, 0);
    assert_int_equal(mns_particle_set_file_count(set), 0);
    mns_particle_set_destroy(&set);
}

static void refuse_npy(const char *dictionary, mns_result code, const char *words)
{
    struct blob blob = {.size = 0};
    add_npy(&blob, 1, dictionary);
    for (int i = 0; i < 6; i++) {
        add_float(&blob, 1.0f, 0);
    }
    refuses(blob.data, blob.size, "a.npy", NULL, code, words);
}

static void bad_arrays_are_refused(void **state)
{
    (void)state;
    refuse_npy("{'descr': '<f4', 'fortran_order': False, 'shape': (3, 3), }", MNS_ERR_BAD_DATA, "ends early: [3][3] of float32");
    refuse_npy("{'descr': '<f4', 'fortran_order': False, 'shape': (9223372036854775807, 3), }", MNS_ERR_BAD_DATA, "ends early");
    refuse_npy("{'descr': '<f4', 'fortran_order': False, 'shape': (99999999999999999999, 3), }", MNS_ERR_BAD_DATA, "shape");
    refuse_npy("{'descr': '<f4', 'fortran_order': False, 'shape': (6,), }", MNS_ERR_BAD_DATA, "[n][3]");
    refuse_npy("{'descr': '<f4', 'fortran_order': False, 'shape': (3, 2), }", MNS_ERR_BAD_DATA, "[3][2], not [n][3]");
    refuse_npy("{'descr': '<f4', 'fortran_order': False, 'shape': (1, 2, 3), }", MNS_ERR_UNSUPPORTED, "3 dimensions");
    refuse_npy("{'descr': '<i4', 'fortran_order': False, 'shape': (2, 3), }", MNS_ERR_BAD_DATA, "positions as int32");
    refuse_npy("{'descr': '<f2', 'fortran_order': False, 'shape': (2, 3), }", MNS_ERR_UNSUPPORTED, "'<f2'");
    refuse_npy("{'descr': [('x', '<f4')], 'fortran_order': False, 'shape': (2, 3), }", MNS_ERR_UNSUPPORTED, "records");
    refuse_npy("{'descr': '<f4', 'shape': (2, 3), }", MNS_ERR_BAD_DATA, "lacks");
    refuse_npy("print('hello')", MNS_ERR_BAD_DATA, "dictionary");
    refuses("\x93NUMPY\1\0\xff\xff{", 11, "a.npy", NULL, MNS_ERR_BAD_DATA, "65535 bytes");
    refuses("\x93NUMPY\7\0\xff\xff{", 11, "a.npy", NULL, MNS_ERR_UNSUPPORTED, "version 7");
}

/* Particles as an engine holds them: interleaved, with mixed types. */
struct record {
    double position[3];
    float velocity[3], density;
    uint64_t id;
};

static void check_written(const char *path, const struct mns_particles *particles, int all)
{
    struct mns_message message;
    mns_particle_set *set;
    if (mns_particles_write(path, particles, &message) != MNS_OK) {
        fail_msg("%s", message.text);
    }
    if (mns_particle_set_read(&set, path, NULL, &message) != MNS_OK) {
        fail_msg("%s", message.text);
    }
    const struct mns_particles *back = mns_particle_set_particles(set);
    assert_int_equal(back->count, particles->count);
    for (size_t i = 0; i < particles->count; i++) {
        assert_int_equal(back->position.type, MNS_F64);
        assert_vector(back->position, i, value_of(particles->position, i, 0), value_of(particles->position, i, 1),
                      value_of(particles->position, i, 2));
        if (!all) {
            continue;
        }
        assert_vector(back->velocity, i, value_of(particles->velocity, i, 0), value_of(particles->velocity, i, 1),
                      value_of(particles->velocity, i, 2));
        assert_true(value_of(back->density, i, 0) == value_of(particles->density, i, 0));
        assert_int_equal(back->id.type, MNS_U64);
        assert_memory_equal((const char *)back->id.data + i * back->id.stride, (const char *)particles->id.data + i * particles->id.stride,
                            8);
    }
    assert_null(back->radius.data);
    mns_particle_set_destroy(&set);
    assert_int_equal(remove(path), 0);
}

static void written_particles_come_back(void **state)
{
    (void)state;
    enum { COUNT = 10000 };
    struct record *records = malloc(COUNT * sizeof(*records));
    assert_non_null(records);
    for (int i = 0; i < COUNT; i++) {
        records[i] = (struct record){{i, i + 0.25, -i}, {(float)i, 0, 1}, (float)(1000 + i), UINT64_MAX - (uint64_t)i};
    }
    struct mns_particles particles;
    mns_particles_init(&particles);
    particles.count = COUNT;
    particles.position = (struct mns_attr){records->position, sizeof(*records), MNS_F64};
    particles.velocity = (struct mns_attr){records->velocity, sizeof(*records), MNS_F32};
    particles.density = (struct mns_attr){&records->density, sizeof(*records), MNS_F32};
    particles.id = (struct mns_attr){&records->id, sizeof(*records), MNS_U64};
    check_written("test_npy_written.npy", &particles, 0);
    check_written("test_npy_written.npz", &particles, 1);
    particles.count = 0;
    check_written("test_npy_written.npy", &particles, 0);
    check_written("test_npy_written.npz", &particles, 1);
    free(records);
}

static void writing_fails_cleanly(void **state)
{
    (void)state;
    const float point[3] = {1, 2, 3};
    struct mns_message message;
    struct mns_particles particles;
    mns_particles_init(&particles);
    particles.count = 1;
    assert_int_equal(mns_particles_write("a.npy", &particles, &message), MNS_ERR_INVALID_ARGUMENT);
    particles.position = (struct mns_attr){point, 0, MNS_F32};
    assert_int_equal(mns_particles_write("a.vtk", &particles, &message), MNS_ERR_UNSUPPORTED);
    assert_int_equal(mns_particles_write("no/such/folder/a.npz", &particles, &message), MNS_ERR_IO);
    assert_non_null(strstr(message.text, "no/such/folder/a.npz: cannot be written"));
    FILE *full = fopen("/dev/full", "r");
    if (full) { /* a disk without room */
        fclose(full);
        char path[] = "test_npy_full.npy";
        assert_int_equal(symlink("/dev/full", path), 0);
        assert_int_equal(mns_particles_write(path, &particles, &message), MNS_ERR_IO);
        assert_non_null(strstr(message.text, "No space left"));
        remove(path);
    }
}

static struct blob written_npz(void)
{
    const float points[] = {1, 2, 3, 4, 5, 6}, mass[] = {7, 8};
    struct blob blob = {.size = 0};
    struct mns_message message;
    struct mns_particles particles;
    mns_particles_init(&particles);
    particles.count = 2;
    particles.position = (struct mns_attr){points, 0, MNS_F32};
    particles.mass = (struct mns_attr){mass, 0, MNS_F32};
    assert_int_equal(mns_particles_write("test_npy_bad.npz", &particles, &message), MNS_OK);
    FILE *file = fopen("test_npy_bad.npz", "rb");
    assert_non_null(file);
    blob.size = fread(blob.data, 1, sizeof(blob.data), file);
    fclose(file);
    remove("test_npy_bad.npz");
    return blob;
}

static void bad_archives_are_refused(void **state)
{
    (void)state;
    struct blob good = written_npz();
    refuses(good.data, good.size - 30, "a.npz", NULL, MNS_ERR_BAD_DATA, "directory");
    for (size_t cut = 4; cut < good.size; cut += 7) { /* never a crash, always one line */
        struct mns_message message;
        mns_particle_set *set;
        assert_int_not_equal(mns_particle_set_read_memory(&set, good.data, cut, "a.npz", NULL, &message), MNS_OK);
    }
    struct blob bad = good;
    size_t central = 0;
    for (size_t i = 0; i + 4 < bad.size && central == 0; i++) {
        if (memcmp(bad.data + i, "PK\1\2", 4) == 0) {
            central = i;
        }
    }
    bad.data[central + 10] = 12; /* bzip2 */
    refuses(bad.data, bad.size, "a.npz", NULL, MNS_ERR_UNSUPPORTED, "method 12");
    bad = good;
    bad.data[central + 46] = 'q'; /* qosition */
    refuses(bad.data, bad.size, "a.npz", NULL, MNS_ERR_BAD_DATA, "no member 'position'; it has qosition, mass");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_layout_is_read),   cmocka_unit_test(no_particles_are_a_valid_set),
        cmocka_unit_test(bad_arrays_are_refused), cmocka_unit_test(written_particles_come_back),
        cmocka_unit_test(writing_fails_cleanly),  cmocka_unit_test(bad_archives_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
