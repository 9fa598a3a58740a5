/* Particles written in every format come back as they were: types, components, bytes, names; what a format lacks is told. */
#ifndef _WIN32
#define _POSIX_C_SOURCE 200809L
#endif

#include "io_test.h"

#include <unistd.h>

enum { COUNT = 60000 /* more than a block of every writer */, RECORD = 24 + 4 + 1 + 2 + 2 + 4 + 4 + 8 + 8 + 24 + 3 + 8 };

/* A binary PLY of all types: positions float64, a vector of 3 and one of 2, colours. */
static uint8_t *make_source(size_t count, size_t *size)
{
    char header[1024];
    int length =
        snprintf(header, sizeof(header),
                 "ply\nformat binary_little_endian 1.0\nelement vertex %zu\nproperty double x\nproperty double y\nproperty double "
                 "z\nproperty float density\nproperty char kind\nproperty short s\nproperty ushort us\nproperty int i\nproperty uint "
                 "ui\nproperty int64 big\nproperty uint64 id\nproperty double velocity_x\nproperty double velocity_y\nproperty double "
                 "velocity_z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nproperty float pair_0\nproperty float "
                 "pair_1\nend_header\n",
                 count);
    uint8_t *data = malloc((size_t)length + count * RECORD);
    assert_non_null(data);
    memcpy(data, header, (size_t)length);
    uint8_t *at = data + length;
    uint64_t state = 12345;
    for (size_t i = 0; i < count; i++, at += RECORD) {
        for (size_t k = 0; k < RECORD; k++) { /* any bytes are whole numbers */
            state = state * 6364136223846793005u + 1442695040888963407u;
            at[k] = (uint8_t)(state >> 56);
        }
        const double position[3] = {(double)i, 0.1 * (double)i, -3e7 - (double)i}, velocity[3] = {1.0 / 3.0, (double)i, -0.0};
        const float density = 1000.0f + (float)i, pair[2] = {(float)i, -1};
        memcpy(at, position, 24);
        memcpy(at + 24, &density, 4);
        memcpy(at + 57, velocity, 24);
        memcpy(at + 84, pair, 8);
    }
    *size = (size_t)length + count * RECORD;
    return data;
}

static mns_particle_set *source_set(size_t count)
{
    size_t size;
    uint8_t *data = make_source(count, &size);
    mns_particle_set *set = read_blob(data, size, "source.ply", NULL);
    free(data);
    return set;
}

static mns_particle_set *through(const mns_particle_set *set, const char *path, struct heard *heard)
{
    struct mns_message message;
    struct mns_log log = {.message = hear, .user = heard};
    mns_particle_set *back = NULL;
    if (mns_particle_set_write(path, set, &log, &message) != MNS_OK || mns_particle_set_read(&back, path, NULL, &message) != MNS_OK) {
        fail_msg("%s", message.text);
    }
    assert_int_equal(mns_particle_set_particles(back)->count, mns_particle_set_particles(set)->count);
    assert_int_equal(remove(path), 0);
    return back;
}

static void assert_same(const mns_particle_set *a, const mns_particle_set *b, const char *name)
{
    const struct mns_attribute *one = find_attribute(a, name), *two = find_attribute(b, name);
    assert_non_null(one);
    if (!two) {
        fail_msg("'%s' is lost", name);
    }
    assert_int_equal(one->type, two->type);
    assert_int_equal(one->components, two->components);
    size_t bytes = mns_type_size(one->type) * (size_t)one->components * mns_particle_set_particles(a)->count;
    assert_memory_equal(one->data, two->data, bytes);
}

static void everything_is_kept(void **state)
{
    (void)state;
    static const char *const paths[] = {"test_write.npz", "test_write.vtp"};
    const size_t counts[] = {COUNT, 1, 0};
    for (size_t k = 0; k < 3; k++) {
        mns_particle_set *set = source_set(counts[k]);
        assert_int_equal(find_attribute(set, "velocity")->components, 3);
        assert_int_equal(find_attribute(set, "pair")->components, 2);
        for (size_t p = 0; p < 2; p++) {
            struct heard heard = {0};
            mns_particle_set *back = through(set, paths[p], &heard);
            assert_int_equal(heard.count, 0);
            for (size_t i = 0; i < mns_particle_set_attribute_count(set) && counts[k] > 0; i++) {
                assert_same(set, back, mns_particle_set_attribute(set, i)->name);
            }
            assert_true(counts[k] == 0 || mns_particle_set_attribute_count(back) == mns_particle_set_attribute_count(set));
            mns_particle_set_destroy(&back);
        }
        mns_particle_set_destroy(&set);
    }
}

static void ply_keeps_all_but_64_bits(void **state)
{
    (void)state;
    mns_particle_set *set = source_set(COUNT);
    struct heard heard = {0};
    mns_particle_set *back = through(set, "test_write.ply", &heard);
    static const char *const same[] = {"position", "density", "kind", "s", "us", "i", "ui", "velocity", "red", "color", "pair"};
    for (size_t i = 0; i < sizeof(same) / sizeof(same[0]); i++) {
        assert_same(set, back, same[i]);
    }
    assert_int_equal(heard.count, 2); /* random 64 bits fit nothing */
    assert_non_null(strstr(heard.last, "test_write.ply: 'id' is left out"));
    assert_null(find_attribute(back, "big"));
    mns_particle_set_destroy(&back);
    mns_particle_set_destroy(&set);
}

/* Whole numbers of 64 bits that are small. */
static void small_ids_are_narrowed(void **state)
{
    (void)state;
    const float points[] = {1, 2, 3, 4, 5, 6};
    const int64_t ids[] = {-7, 2147483647}, wide[] = {9007199254740991, 0}, wider[] = {9007199254740993, 0};
    struct mns_message message;
    struct mns_particles particles;
    mns_particle_set *set;
    mns_particles_init(&particles);
    particles.count = 2;
    particles.position = (struct mns_attr){points, 0, MNS_F32};
    const struct {
        const char *path;
        const int64_t *ids;
        enum mns_type type; /* MNS_U8: left out */
    } cases[] = {{"test_write.ply", ids, MNS_I32},  {"test_write.bgeo", ids, MNS_I32}, {"test_write.ply", wide, MNS_F64},
                 {"test_write.bgeo", wide, MNS_U8}, {"test_write.ply", wider, MNS_U8}, {"test_write.vtp", wider, MNS_I64}};
    for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
        particles.id = (struct mns_attr){cases[i].ids, 0, MNS_I64};
        assert_int_equal(mns_particles_write(cases[i].path, &particles, &message), MNS_OK);
        assert_int_equal(mns_particle_set_read(&set, cases[i].path, NULL, &message), MNS_OK);
        const struct mns_attribute *id = find_attribute(set, "id");
        assert_true((id == NULL) == (cases[i].type == MNS_U8));
        if (id) {
            assert_int_equal(id->type, cases[i].type);
            assert_true(value_of((struct mns_attr){id->data, mns_type_size(id->type), id->type}, 0, 0) == (double)cases[i].ids[0]);
        }
        mns_particle_set_destroy(&set);
        remove(cases[i].path);
    }
}

static void bgeo_keeps_what_it_can(void **state)
{
    (void)state;
    mns_particle_set *set = source_set(COUNT);
    struct heard heard = {0};
    mns_particle_set *back = through(set, "test_write.bgeo", &heard);
    assert_same(set, back, "density");
    assert_same(set, back, "i");
    assert_same(set, back, "pair");
    assert_int_equal(heard.count, 5); /* position and velocity rounded; ui, big and id left out */
    const struct mns_particles *particles = mns_particle_set_particles(back);
    assert_vector(particles->velocity, 7, (double)(1.0f / 3.0f), 7, 0);
    assert_vector(particles->position, 7, 7, (double)0.7f, (double)(-3e7f - 7));
    assert_true(value_of((struct mns_attr){find_attribute(back, "us")->data, 4, MNS_I32}, 9, 0) ==
                value_of((struct mns_attr){find_attribute(set, "us")->data, 2, MNS_U16}, 9, 0));
    mns_particle_set_destroy(&back);
    mns_particle_set_destroy(&set);
}

static void joined_vectors_are_not_written(void **state)
{
    (void)state;
    mns_particle_set *set = read_text("x,y,z,vx,vy,vz\n1,2,3,4.5,5.5,6.5\n7,8,9,1,2,3\n", "a.csv", NULL);
    struct heard heard = {0};
    assert_non_null(find_attribute(set, "velocity"));
    mns_particle_set *back = through(set, "test_write.npz", &heard);
    assert_int_equal(mns_particle_set_attribute_count(back), mns_particle_set_attribute_count(set)); /* joined again, not twice there */
    assert_vector(mns_particle_set_particles(back)->velocity, 0, 4.5, 5.5, 6.5);
    mns_particle_set_destroy(&back);
    mns_particle_set_destroy(&set);
}

/* Names that would break XML, end a header's line or leave the folder, and two that become the same. */
static void strange_names_do_no_harm(void **state)
{
    (void)state;
    mns_particle_set *set = read_text("x;y;z;a<b>&\"c\";../../d;.._.._d;two words\n1;2;3;4;5;6;7\n1;2;3;4;5;6;7\n", "a.csv", NULL);
    static const char *const paths[] = {"test_write.npz", "test_write.vtp", "test_write.ply", "test_write.bgeo"};
    for (size_t p = 0; p < 4; p++) {
        struct heard heard = {0};
        mns_particle_set *back = through(set, paths[p], &heard);
        assert_int_equal(mns_particle_set_attribute_count(back), mns_particle_set_attribute_count(set));
        assert_non_null(find_attribute(back, ".._.._d"));
        assert_non_null(find_attribute(back, ".._.._d_2"));
        assert_non_null(find_attribute(back, p == 2 ? "two_words" : "two words"));
        assert_non_null(find_attribute(back, "a<b>&\"c\""));
        mns_particle_set_destroy(&back);
    }
    mns_particle_set_destroy(&set);
}

static void a_full_disk_is_told(void **state)
{
    (void)state;
    FILE *full = fopen("/dev/full", "r");
    if (!full) {
        skip();
    }
    fclose(full);
    mns_particle_set *set = source_set(COUNT);
    for (size_t i = 0; mns_particles_write_format(i); i++) {
        struct mns_message message;
        char path[64];
        snprintf(path, sizeof(path), "test_write_full.%s", mns_particles_write_format(i));
        assert_int_equal(symlink("/dev/full", path), 0);
        assert_int_equal(mns_particle_set_write(path, set, NULL, &message), MNS_ERR_IO);
        assert_non_null(strstr(message.text, "No space left"));
        remove(path);
    }
    mns_particle_set_destroy(&set);
}

static void other_names_are_refused(void **state)
{
    (void)state;
    mns_particle_set *set = source_set(1);
    struct mns_message message;
    static const char *const paths[] = {"a.vtk", "npz", ".npz", "a.npz.gz", "a", ""};
    for (size_t i = 0; i < sizeof(paths) / sizeof(paths[0]); i++) {
        assert_int_equal(mns_particle_set_write(paths[i], set, NULL, &message), MNS_ERR_UNSUPPORTED);
        assert_non_null(strstr(message.text, "written as .npz, .npy, .ply, .vtp or .bgeo"));
    }
    assert_int_equal(mns_particle_set_write("no/such/a.vtp", set, NULL, &message), MNS_ERR_IO);
    assert_int_equal(mns_particle_set_write(NULL, set, NULL, &message), MNS_ERR_INVALID_ARGUMENT);
    assert_int_equal(mns_particle_set_write("a.npz", NULL, NULL, &message), MNS_ERR_INVALID_ARGUMENT);
    mns_particle_set_destroy(&set);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(everything_is_kept),       cmocka_unit_test(ply_keeps_all_but_64_bits),
        cmocka_unit_test(small_ids_are_narrowed),   cmocka_unit_test(bgeo_keeps_what_it_can),
        cmocka_unit_test(strange_names_do_no_harm), cmocka_unit_test(joined_vectors_are_not_written),
        cmocka_unit_test(a_full_disk_is_told),      cmocka_unit_test(other_names_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
