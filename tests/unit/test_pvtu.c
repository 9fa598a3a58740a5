/* Parallel VTK files and ParaView's collections: files that name others. */
#ifndef _WIN32
#define _POSIX_C_SOURCE 200809L
#endif

#include "io_test.h"

#ifndef _WIN32
#include <sys/stat.h>
#include <unistd.h>
#define make_folder(path) mkdir(path, 0777)
#else
#include <direct.h>
#define make_folder(path) _mkdir(path)
#define rmdir             _rmdir
#endif

#define FOLDER "test_pvtu_files"

static const char *const files[] = {"a.vtp",   "sub/b.vtp", "loop.pvtp", "nested.pvtp", "all.pvtp", "bad.pvtp",
                                    "all.vtm", "all.vtpc",  "loop.vtm",  "all.pvd",     "loop.pvd", "of_pvtp.pvd"};

static void path_of(char out[256], const char *name) { snprintf(out, 256, FOLDER "/%s", name); }

static void write_file(const char *name, const char *text)
{
    char path[256];
    path_of(path, name);
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(text, 1, strlen(text), file), strlen(text));
    assert_int_equal(fclose(file), 0);
}

static void write_piece(const char *name, int first, int count)
{
    char text[2048];
    int used = snprintf(text, sizeof(text),
                        "<VTKFile type=\"PolyData\"><PolyData><Piece NumberOfPoints=\"%d\"><PointData><DataArray type=\"Int32\" "
                        "Name=\"id\" format=\"ascii\">",
                        count);
    for (int i = 0; i < count; i++) {
        used += snprintf(text + used, sizeof(text) - (size_t)used, "%d ", first + i);
    }
    used +=
        snprintf(text + used, sizeof(text) - (size_t)used, "</DataArray></PointData><Points><DataArray type=\"Float32\" format=\"ascii\">");
    for (int i = 0; i < count; i++) {
        used += snprintf(text + used, sizeof(text) - (size_t)used, "%d 0 1 ", first + i);
    }
    snprintf(text + used, sizeof(text) - (size_t)used, "</DataArray></Points></Piece></PolyData></VTKFile>");
    write_file(name, text);
}

#define PARALLEL(pieces)                                                                                                                   \
    "<VTKFile type=\"PPolyData\"><PPolyData GhostLevel=\"0\"><PPointData><PDataArray type=\"Int32\" Name=\"id\"/></PPointData>" pieces     \
    "</PPolyData></VTKFile>"
#define BLOCKS(type, blocks) "<VTKFile type=\"" type "\"><" type ">" blocks "</" type "></VTKFile>"
#define SERIES(steps)        "<?xml version=\"1.0\"?><VTKFile type=\"Collection\" version=\"0.1\"><Collection>" steps "</Collection></VTKFile>"

static int set_up(void **state)
{
    (void)state;
    make_folder(FOLDER);
    make_folder(FOLDER "/sub");
    write_piece("a.vtp", 0, 3);
    write_piece("sub/b.vtp", 3, 2);
    write_file("all.pvtp", PARALLEL("<Piece Source=\"a.vtp\"/><Piece Source=\"sub/b.vtp\"/>"));
    write_file("all.vtm",
               BLOCKS("vtkMultiBlockDataSet", "<Block index=\"0\"><DataSet index=\"0\" file=\"a.vtp\"/><DataSet index=\"1\"/></Block>"
                                              "<DataSet index=\"1\" file=\"sub/b.vtp\"/>"));
    write_file("all.vtpc", BLOCKS("vtkPartitionedDataSetCollection",
                                  "<Partitions index=\"0\"><DataSet file=\"a.vtp\"/></Partitions><Partitions index=\"1\">"
                                  "<DataSet file=\"sub/b.vtp\"/></Partitions>"));
    write_file("loop.vtm", BLOCKS("vtkMultiBlockDataSet", "<DataSet file=\"loop.vtm\"/>"));
    write_file("loop.pvtp", PARALLEL("<Piece Source=\"loop.pvtp\"/>"));
    write_file("nested.pvtp", PARALLEL("<Piece Source=\"all.pvtp\"/>"));
    write_file("bad.pvtp", PARALLEL("<Piece Source=\"a.vtp\"/><Piece Source=\"missing.vtp\"/>"));
    write_file("all.pvd",
               SERIES("<DataSet timestep=\"2.5\" part=\"0\" file=\"sub/b.vtp\"/><DataSet timestep=\"1\" part=\"0\" file=\"a.vtp\"/>"
                      "<DataSet timestep=\"1\" part=\"1\" file=\"sub/b.vtp\"/><DataSet timestep=\"-3e-1\" file=\"all.pvtp\"/>"
                      "<DataSet timestep=\"7\" file=\"/abs/c&amp;d.vtu\"/>"));
    write_file("loop.pvd", SERIES("<DataSet timestep=\"0\" file=\"loop.pvd\"/>"));
    write_file("of_pvtp.pvd", SERIES("<DataSet timestep=\"1\" file=\"a.vtp\"/><DataSet timestep=\"1\" file=\"sub/b.vtp\"/>"
                                     "<DataSet timestep=\"2\" file=\"a.vtp\"/>"));
    return 0;
}

static int tear_down(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof(files) / sizeof(files[0]); i++) {
        char path[256];
        path_of(path, files[i]);
        remove(path);
    }
    rmdir(FOLDER "/sub");
    rmdir(FOLDER);
    return 0;
}

static void reads_five(const char *name, const char *format)
{
    char path[256];
    struct mns_message message;
    mns_particle_set *set;
    path_of(path, name);
    if (mns_particle_set_read(&set, path, NULL, &message) != MNS_OK) {
        fail_msg("%s", message.text);
    }
    assert_string_equal(mns_particle_set_format(set), format);
    assert_int_equal(mns_particle_set_particles(set)->count, 5);
    for (int i = 0; i < 5; i++) {
        assert_vector(mns_particle_set_particles(set)->position, (size_t)i, i, 0, 1);
        assert_true(value_of(mns_particle_set_particles(set)->id, (size_t)i, 0) == i);
    }
    mns_particle_set_destroy(&set);
}

static void pieces_are_one_set(void **state)
{
    (void)state;
    reads_five("all.pvtp", "pvtu");
    reads_five("all.vtm", "pvtu");
    reads_five("all.vtpc", "pvtu");
}

static void a_collection_is_its_first_time(void **state)
{
    (void)state;
    reads_five("all.pvd", "pvd");     /* its earliest is all.pvtp */
    reads_five("of_pvtp.pvd", "pvd"); /* two parts of time 1 */
}

static void fails(const char *name, mns_result code, const char *words)
{
    char path[256];
    struct mns_message message;
    mns_particle_set *set;
    path_of(path, name);
    mns_result result = mns_particle_set_read(&set, path, NULL, &message);
    assert_null(set);
    if (result != code || !strstr(message.text, words)) {
        fail_msg("wanted code %d with '%s', got %d: '%s'", code, words, result, message.text);
    }
}

static void circles_are_refused(void **state)
{
    (void)state;
    fails("loop.pvtp", MNS_ERR_BAD_DATA, "loop.pvtp: is named as a piece, but has pieces itself");
    fails("loop.vtm", MNS_ERR_BAD_DATA, "loop.vtm: is named as a piece, but has pieces itself");
    fails("nested.pvtp", MNS_ERR_BAD_DATA, "all.pvtp: is named as a piece, but has pieces itself");
    fails("loop.pvd", MNS_ERR_BAD_DATA, "loop.pvd: is named by another file");
    fails("bad.pvtp", MNS_ERR_IO, FOLDER "/missing.vtp: cannot be opened");
}

static void refuse(const char *text, const char *name, mns_result code, const char *words)
{
    refuses(text, strlen(text), name, NULL, code, words);
}

static void bad_files_are_refused(void **state)
{
    (void)state;
    refuse(PARALLEL("<Piece Source=\"a.vtp\"/>"), "a.pvtp", MNS_ERR_UNSUPPORTED,
           "names another file (a.vtp), which reading from memory does not open");
    refuse(PARALLEL("<Piece/>"), "a.pvtp", MNS_ERR_BAD_DATA, "has a <Piece> without Source=\"FILE\"");
    refuse("<VTKFile type=\"PPolyData\"></VTKFile>", "a.pvtp", MNS_ERR_BAD_DATA,
           "has no element that names pieces, such as <PUnstructuredGrid>");
    refuse("<VTKFile type=\"PPolyData\"><PPolyData>", "a.pvtp", MNS_ERR_BAD_DATA, "line 1 of the XML: ");
    refuse("<VTKFile type=\"Collection\"></VTKFile>", "a.pvd", MNS_ERR_BAD_DATA, "has no <Collection>");
    refuse(SERIES(""), "a.pvd", MNS_ERR_BAD_DATA, "its <Collection> has no <DataSet>");
    refuse(SERIES("<DataSet timestep=\"0\"/>"), "a.pvd", MNS_ERR_BAD_DATA, "<DataSet> 1 has no file=\"FILE\"");
    refuse(SERIES("<DataSet timestep=\"1s\" file=\"a\"/>"), "a.pvd", MNS_ERR_BAD_DATA,
           "<DataSet> 1 has timestep=\"1s\" where a number should be");
    refuse(SERIES("<DataSet timestep=\"nan\" file=\"a\"/>"), "a.pvd", MNS_ERR_BAD_DATA, "timestep=\"nan\"");
    refuse(SERIES("<DataSet file=\"a\"/>"), "a.pvd", MNS_ERR_UNSUPPORTED, "names another file (a)");
}

static void time_steps_are_listed(void **state)
{
    (void)state;
    static const struct mns_pvd_step wanted[] = {
        {-0.3, FOLDER "/all.pvtp"}, {1, FOLDER "/a.vtp"}, {1, FOLDER "/sub/b.vtp"}, {2.5, FOLDER "/sub/b.vtp"}, {7, "/abs/c&d.vtu"}};
    mns_pvd *pvd;
    struct mns_message message;
    assert_int_equal(mns_pvd_read(&pvd, FOLDER "/all.pvd", &message), MNS_OK);
    assert_int_equal(mns_pvd_count(pvd), 5);
    for (size_t i = 0; i < 5; i++) {
        assert_true(mns_pvd_get(pvd, i)->time == wanted[i].time);
        assert_string_equal(mns_pvd_get(pvd, i)->path, wanted[i].path);
    }
    assert_null(mns_pvd_get(pvd, 5));
    mns_pvd_destroy(&pvd);
    assert_null(pvd);
    mns_pvd_destroy(&pvd);
    mns_pvd_destroy(NULL);

    assert_int_equal(mns_pvd_read(&pvd, FOLDER "/none.pvd", &message), MNS_ERR_IO);
    assert_null(pvd);
    assert_non_null(strstr(message.text, FOLDER "/none.pvd: cannot be opened"));
    assert_int_equal(mns_pvd_read(&pvd, FOLDER "/a.vtp", NULL), MNS_ERR_BAD_DATA);
    assert_null(pvd);
    assert_int_equal(mns_pvd_read(NULL, "a.pvd", &message), MNS_ERR_INVALID_ARGUMENT);
    assert_int_equal(mns_pvd_read(&pvd, NULL, &message), MNS_ERR_INVALID_ARGUMENT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pieces_are_one_set),    cmocka_unit_test(a_collection_is_its_first_time), cmocka_unit_test(circles_are_refused),
        cmocka_unit_test(bad_files_are_refused), cmocka_unit_test(time_steps_are_listed),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
