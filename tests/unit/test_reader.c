/* What all readers share: telling formats, roles, dropping, limits, memory that runs out, files that cannot be read. */
#ifndef _WIN32
#define _POSIX_C_SOURCE 200809L
#endif

#include "io_test.h"

#ifndef _WIN32
#include <sys/stat.h>
#include <unistd.h>
#endif

static const char table[] = "x,y,z,V_x,V_y,V_z,rho,h\n1,2,3,4,5,6,1000,7\n4,5,6,0,0,0,999,7\n";

static void formats_are_told_from_content(void **state)
{
    (void)state;
    mns_particle_set *set =
        read_text("ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\nproperty float z\nend_header\n",
                  "misnamed.csv", NULL);
    assert_string_equal(mns_particle_set_format(set), "ply");
    mns_particle_set_destroy(&set);
    set = read_text(table, "misnamed.bgeo.data", NULL);
    assert_string_equal(mns_particle_set_format(set), "csv");
    mns_particle_set_destroy(&set);

    struct mns_read_params params;
    mns_read_params_init(&params);
    params.format = "ply";
    refuses(table, sizeof(table) - 1, "a.csv", &params, MNS_ERR_BAD_DATA, "is no PLY file");
    params.format = "abc";
    refuses(table, sizeof(table) - 1, "a.csv", &params, MNS_ERR_UNSUPPORTED, "cannot be read as 'abc': this build reads bgeo");
    refuses("\1\2\3\4", 4, "a.bgeo", NULL, MNS_ERR_BAD_DATA, "is no bgeo file, though its name says so");
    refuses("\1\2\3\4", 4, "a.jpg", NULL, MNS_ERR_BAD_DATA, "is of no format that this build reads (bgeo");
    refuses("", 0, "a.bgeo", NULL, MNS_ERR_BAD_DATA, "is empty");
}

static void formats_are_listed(void **state)
{
    (void)state;
    int csv = 0;
    size_t i = 0;
    for (; mns_read_format(i); i++) {
        csv += strcmp(mns_read_format(i), "csv") == 0;
    }
    assert_int_equal(csv, 1);
    assert_null(mns_read_format(i + 100));
    assert_null(mns_missing_feature(1000));
    assert_string_equal(mns_role_name(MNS_ROLE_VELOCITY), "velocity");
    assert_null(mns_role_name(MNS_ROLE_COUNT));
}

static void roles_are_found(void **state)
{
    (void)state;
    mns_particle_set *set = read_text(table, "a.csv", NULL);
    const struct mns_particles *particles = mns_particle_set_particles(set);
    assert_vector(particles->velocity, 0, 4, 5, 6);
    assert_true(value_of(particles->density, 1, 0) == 999.0);
    assert_null(particles->radius.data); /* h, a smoothing length, is no radius */
    assert_int_equal(find_attribute(set, "V")->role, MNS_ROLE_VELOCITY);
    assert_int_equal(find_attribute(set, "rho")->role, MNS_ROLE_DENSITY);
    assert_int_equal(find_attribute(set, "h")->role, MNS_ROLE_NONE);
    mns_particle_set_destroy(&set);
}

static void roles_can_be_said(void **state)
{
    (void)state;
    const char *roles[] = {"radius=h", "density=", "mass=rho"};
    struct mns_read_params params;
    mns_read_params_init(&params);
    params.roles = roles;
    params.role_count = 3;
    mns_particle_set *set = read_text(table, "a.csv", &params);
    const struct mns_particles *particles = mns_particle_set_particles(set);
    assert_true(value_of(particles->radius, 0, 0) == 7.0);
    assert_true(value_of(particles->mass, 0, 0) == 1000.0);
    assert_null(particles->density.data);
    mns_particle_set_destroy(&set);

    params.role_count = 1;
    roles[0] = "velocity=speed";
    refuses(table, sizeof(table) - 1, "a.csv", &params, MNS_ERR_INVALID_ARGUMENT,
            "no attribute 'speed' to be the velocity; it has position[3], V[3], rho, h");
    roles[0] = "velocity=rho";
    refuses(table, sizeof(table) - 1, "a.csv", &params, MNS_ERR_INVALID_ARGUMENT, "1 components per particle, not 3");
    struct mns_message message;
    mns_particle_set *none;
    static const char *const wrong[] = {"speed=V", "velocity", "=V", ""};
    for (size_t i = 0; i < sizeof(wrong) / sizeof(wrong[0]); i++) {
        roles[0] = wrong[i];
        assert_int_equal(mns_particle_set_read_memory(&none, table, sizeof(table) - 1, "a.csv", &params, &message),
                         MNS_ERR_INVALID_ARGUMENT);
        assert_non_null(strstr(message.text, "ROLE=NAME"));
    }
}

static void odd_positions_are_dropped(void **state)
{
    (void)state;
    const char text[] = "x,y,z,id\n1,2,3,1\nnan,2,3,2\n4,inf,6,3\n7,8,9,4\n1,2,-inf,5\n";
    struct heard heard = {0, ""};
    struct mns_read_params params;
    mns_read_params_init(&params);
    params.log = (struct mns_log){hear, &heard};
    mns_particle_set *set = read_text(text, "a.csv", &params);
    const struct mns_particles *particles = mns_particle_set_particles(set);
    assert_int_equal(particles->count, 2);
    assert_int_equal(mns_particle_set_dropped(set), 3);
    assert_int_equal(mns_particle_set_file_count(set), 5);
    assert_vector(particles->position, 1, 7, 8, 9);
    assert_true(value_of(particles->id, 1, 0) == 4.0);
    assert_int_equal(heard.count, 1);
    assert_string_equal(heard.last, "a.csv: dropped 3 of 5 particles, whose position is NaN or infinite");
    mns_particle_set_destroy(&set);
}

static void limits_hold(void **state)
{
    (void)state;
    struct mns_read_params params;
    mns_read_params_init(&params);
    params.max_bytes = 1000;
    refuses(table, sizeof(table) - 1, "a.csv", &params, MNS_ERR_OUT_OF_MEMORY, "max_bytes");
}

struct counting {
    size_t bytes, calls, fail_at;
};

static void *counted_allocate(void *user, size_t size, size_t alignment)
{
    struct counting *counting = user;
    if (counting->calls++ == counting->fail_at) {
        return NULL;
    }
    counting->bytes += size;
    return aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
}

static void counted_release(void *user, void *memory, size_t size)
{
    struct counting *counting = user;
    if (memory) {
        counting->bytes -= size;
    }
    free(memory);
}

/* Every allocation in turn fails: nothing leaks, and the code is the right one. */
static void memory_may_run_out_anywhere(void **state)
{
    (void)state;
    static const struct {
        const char *text, *name;
    } files[] = {
        {"x,y,z,u,v,w,type\n1,2,3,4,5,6,0\n4,5,6,0,0,0,1\nnan,5,6,0,0,0,1\n", "a.csv"},
        {"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\nproperty "
         "uchar green\n"
         "property uchar blue\nproperty int type\nend_header\n1 2 3 4 5 6 0\n",
         "a.ply"},
        {"# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\nPOINTS 2 float\n1 2 3 4 5 6\nPOINT_DATA 2\nSCALARS type "
         "int\nLOOKUP_TABLE t\n0 1\n"
         "FIELD f 1\nvtkGhostType 1 2 unsigned_char\n0 1\n",
         "a.vtk"},
    };
    for (size_t f = 0; f < sizeof(files) / sizeof(files[0]); f++) {
        for (size_t fail_at = 0;; fail_at++) {
            struct counting counting = {0, 0, fail_at};
            struct mns_read_params params;
            struct mns_message message;
            mns_particle_set *set;
            mns_read_params_init(&params);
            params.where = "type == 0";
            params.allocator = (struct mns_allocator){counted_allocate, counted_release, &counting};
            mns_result result = mns_particle_set_read_memory(&set, files[f].text, strlen(files[f].text), files[f].name, &params, &message);
            if (result == MNS_OK) {
                assert_true(counting.calls <= fail_at);
                assert_true(fail_at > 5);
                assert_int_equal(mns_particle_set_particles(set)->count, 1);
                mns_particle_set_destroy(&set);
                assert_int_equal(counting.bytes, 0);
                break;
            }
            assert_int_equal(result, MNS_ERR_OUT_OF_MEMORY);
            assert_non_null(strstr(message.text, "out of memory"));
            assert_null(set);
            assert_int_equal(counting.bytes, 0);
        }
    }
}

static void refuse_path(const char *path, mns_result code, const char *words)
{
    struct mns_message message;
    mns_particle_set *set;
    assert_int_equal(mns_particle_set_read(&set, path, NULL, &message), code);
    assert_null(set);
    if (strncmp(message.text, path, strlen(path)) != 0 || !strstr(message.text, words)) {
        fail_msg("'%s' says nothing of '%s'", message.text, words);
    }
}

static void files_that_cannot_be_read_are_told(void **state)
{
    (void)state;
    refuse_path("test_reader_no_such.bgeo", MNS_ERR_IO, "No such file");
#ifndef _WIN32
    refuse_path(".", MNS_ERR_IO, "is a directory");
    FILE *file = fopen("test_reader_locked.csv", "w");
    assert_non_null(file);
    fputs(table, file);
    fclose(file);
    assert_int_equal(chmod("test_reader_locked.csv", 0), 0);
    if (access("test_reader_locked.csv", R_OK) != 0) { /* root reads everything */
        refuse_path("test_reader_locked.csv", MNS_ERR_IO, "Permission denied");
    }
    remove("test_reader_locked.csv");
#endif
}

static void arrays_in_the_file_are_used_in_place(void **state)
{
    (void)state;
    enum { COUNT = 1000 };
    float points[COUNT][3];
    for (int i = 0; i < COUNT; i++) {
        for (int c = 0; c < 3; c++) {
            points[i][c] = (float)(i + c);
        }
    }
    points[3][1] = (float)NAN;
    struct mns_message message;
    struct mns_particles particles;
    mns_particles_init(&particles);
    particles.count = COUNT;
    particles.position = (struct mns_attr){points, 0, MNS_F32};
    assert_int_equal(mns_particles_write("test_reader.npy", &particles, &message), MNS_OK);

    struct counting counting = {0, 0, SIZE_MAX};
    struct mns_read_params params;
    mns_particle_set *set;
    mns_read_params_init(&params);
    params.allocator = (struct mns_allocator){counted_allocate, counted_release, &counting};
    params.where = "x < 500";
    assert_int_equal(mns_particle_set_read(&set, "test_reader.npy", &params, &message), MNS_OK);
    remove("test_reader.npy");
    assert_int_equal(mns_particle_set_particles(set)->count, 499); /* without particle 3 */
    assert_vector(mns_particle_set_particles(set)->position, 3, 4, 5, 6);
    assert_true(counting.bytes < 1000 * 12 + 4096); /* one copy, the file's own */
    mns_particle_set_destroy(&set);
    assert_int_equal(counting.bytes, 0);
}

#ifndef _WIN32
static void pipes_are_read(void **state)
{
    (void)state;
    enum { ROWS = 20000 };
    remove("test_reader_pipe.csv");
    assert_int_equal(mkfifo("test_reader_pipe.csv", 0600), 0);
    pid_t child = fork();
    if (child == 0) {
        FILE *pipe = fopen("test_reader_pipe.csv", "w");
        for (int i = 0; i < ROWS; i++) {
            fprintf(pipe, "%d %d %d\n", i, i + 1, i + 2);
        }
        fclose(pipe);
        _exit(0);
    }
    struct mns_message message;
    mns_particle_set *set;
    mns_result result = mns_particle_set_read(&set, "test_reader_pipe.csv", NULL, &message);
    remove("test_reader_pipe.csv");
    if (result != MNS_OK) {
        fail_msg("%s", message.text);
    }
    assert_int_equal(mns_particle_set_particles(set)->count, ROWS);
    assert_vector(mns_particle_set_particles(set)->position, ROWS - 1, ROWS - 1, ROWS, ROWS + 1);
    mns_particle_set_destroy(&set);
}
#endif

static void null_arguments_are_refused(void **state)
{
    (void)state;
    mns_particle_set *set = NULL;
    assert_int_equal(mns_particle_set_read(NULL, "a", NULL, NULL), MNS_ERR_INVALID_ARGUMENT);
    assert_int_equal(mns_particle_set_read(&set, NULL, NULL, NULL), MNS_ERR_INVALID_ARGUMENT);
    assert_int_equal(mns_particle_set_read_memory(&set, NULL, 5, NULL, NULL, NULL), MNS_ERR_INVALID_ARGUMENT);
    assert_int_equal(mns_particle_set_read_memory(&set, table, sizeof(table) - 1, NULL, NULL, NULL), MNS_OK);
    assert_null(mns_particle_set_attribute(set, 100));
    mns_particle_set_destroy(&set);
    mns_particle_set_destroy(&set);
    mns_particle_set_destroy(NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(formats_are_told_from_content),
        cmocka_unit_test(formats_are_listed),
        cmocka_unit_test(roles_are_found),
        cmocka_unit_test(roles_can_be_said),
        cmocka_unit_test(odd_positions_are_dropped),
        cmocka_unit_test(limits_hold),
        cmocka_unit_test(memory_may_run_out_anywhere),
        cmocka_unit_test(files_that_cannot_be_read_are_told),
        cmocka_unit_test(arrays_in_the_file_are_used_in_place),
#ifndef _WIN32
        cmocka_unit_test(pipes_are_read),
#endif
        cmocka_unit_test(null_arguments_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
