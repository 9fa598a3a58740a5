/* Legacy VTK: ASCII and binary, PolyData and UnstructuredGrid, the cells of 4.x and of 5.x, every kind of attribute. */
#include "io_test.h"

/* Numbers as the file in hand has them. */
static int binary;

static void put_real(struct blob *blob, const char *type, double value)
{
    char text[64];
    snprintf(text, sizeof(text), "%.9g ", value);
    if (!binary) {
        add_text(blob, text);
    } else if (strcmp(type, "double") == 0) {
        add_double(blob, value, 1);
    } else {
        add_float(blob, (float)value, 1);
    }
}

static void put_whole(struct blob *blob, int64_t value, int size)
{
    char text[64];
    snprintf(text, sizeof(text), "%lld ", (long long)value);
    if (binary) {
        add_integer(blob, (uint64_t)value, size, 1);
    } else {
        add_text(blob, text);
    }
}

static void add_points(struct blob *blob, const char *type)
{
    char line[64];
    snprintf(line, sizeof(line), "POINTS 3 %s\n", type);
    add_text(blob, line);
    for (int i = 0; i < 9; i++) {
        put_real(blob, type, i + 0.5);
    }
    add_text(blob, "\n");
}

static void add_cells(struct blob *blob, const char *keyword, int offsets)
{
    char line[64];
    snprintf(line, sizeof(line), "%s %s\n", keyword, offsets ? "4 3" : "3 6");
    add_text(blob, line);
    if (offsets) {
        add_text(blob, "OFFSETS vtktypeint64\n");
        for (int i = 0; i < 4; i++) {
            put_whole(blob, i, 8);
        }
        add_text(blob, "\nCONNECTIVITY vtktypeint64\n");
        for (int i = 0; i < 3; i++) {
            put_whole(blob, i, 8);
        }
    } else {
        for (int i = 0; i < 3; i++) {
            put_whole(blob, 1, 4);
            put_whole(blob, i, 4);
        }
    }
    add_text(blob, "\n");
    if (strcmp(keyword, "CELLS") != 0) {
        return;
    }
    add_text(blob, "CELL_TYPES 3\n");
    for (int i = 0; i < 3; i++) {
        put_whole(blob, 1, 4);
    }
    add_text(blob, "\n");
}

static void add_strings(struct blob *blob)
{
    if (binary) {
        add(blob,
            "\xc3"
            "one",
            4); /* 6 bits of length */
        add(blob,
            "\x80\x05"
            "two\n\n",
            7);
        add(blob, "\x40\0\0\0", 4);
        add(blob, "\0\0\0\0\0\0\0\1x", 9);
        add_text(blob, "\n");
    } else {
        add_text(blob, "one\ntwo%20and\n\nfour\n");
    }
}

/* Everything that stands in a file that VTK writes, and then some. */
static void make(struct blob *blob, const char *dataset, const char *points, int offsets)
{
    blob->size = 0;
    add_text(blob, offsets ? "# vtk DataFile Version 5.1\n" : "# vtk DataFile Version 3.0\n");
    add_text(blob, "made by hand\n");
    add_text(blob, binary ? "BINARY\n" : "ASCII\n");
    add_text(blob, "DATASET ");
    add_text(blob, dataset);
    add_text(blob, "\nFIELD FieldData 2\nTIME 1 1 double\n");
    put_real(blob, "double", 0.25);
    add_text(blob, "\nnotes 1 4 string\n");
    add_strings(blob);
    add_points(blob, points);
    add_text(blob, "METADATA\nINFORMATION 1\nNAME L2_NORM_RANGE LOCATION vtkDataArray\nDATA 2 0 1\n\n");
    add_cells(blob, strcmp(dataset, "POLYDATA") == 0 ? "VERTICES" : "CELLS", offsets);
    add_text(blob, "POINT_DATA 3\nSCALARS id unsigned_int 1\nLOOKUP_TABLE table\n");
    for (int i = 0; i < 3; i++) {
        put_whole(blob, 4294967295 - i, 4);
    }
    add_text(blob, "\nLOOKUP_TABLE table 1\n");
    for (int i = 0; i < 4; i++) {
        if (binary) {
            add_integer(blob, 255, 1, 1);
        } else {
            add_text(blob, "1.0 ");
        }
    }
    add_text(blob, "\nVECTORS velocity double\n");
    for (int i = 0; i < 9; i++) {
        put_real(blob, "double", -i);
    }
    add_text(blob, "\nNORMALS up float\n");
    for (int i = 0; i < 9; i++) {
        put_real(blob, "float", i % 3 == 1);
    }
    add_text(blob, "\nFIELD FieldData 3\nrest%20density 1 3 float\n");
    for (int i = 0; i < 3; i++) {
        put_real(blob, "float", 1000 + i);
    }
    add_text(blob, "\nMETADATA\nCOMPONENT_NAMES\nX\n\nNULL_ARRAY\nsmall 2 3 short\n");
    for (int i = 0; i < 6; i++) {
        put_whole(blob, i - 3, 2);
    }
    add_text(blob, "\nCELL_DATA 3\nSCALARS region char\nLOOKUP_TABLE default\n");
    for (int i = 0; i < 3; i++) {
        put_whole(blob, i, 1);
    }
    add_text(blob, "\n");
}

static void check_made(const struct blob *blob, enum mns_type points)
{
    mns_particle_set *set = read_blob(blob->data, blob->size, "a.vtk", NULL);
    const struct mns_particles *particles = mns_particle_set_particles(set);
    assert_string_equal(mns_particle_set_format(set), "vtk");
    assert_int_equal(particles->count, 3);
    assert_int_equal(particles->position.type, points);
    assert_int_equal(particles->velocity.type, MNS_F64);
    for (int i = 0; i < 3; i++) {
        assert_vector(particles->position, (size_t)i, 3 * i + 0.5, 3 * i + 1.5, 3 * i + 2.5);
        assert_vector(particles->velocity, (size_t)i, -3 * i, -3 * i - 1, -3 * i - 2);
        assert_true(value_of(particles->id, (size_t)i, 0) == 4294967295.0 - i);
    }
    const struct mns_attribute *rest = find_attribute(set, "rest density"), *few = find_attribute(set, "small"),
                               *up = find_attribute(set, "up");
    assert_non_null(rest);
    assert_true(((const float *)rest->data)[2] == 1002.0f);
    assert_non_null(few);
    assert_int_equal(few->type, MNS_I16);
    assert_int_equal(few->components, 2);
    assert_int_equal(((const int16_t *)few->data)[0], -3);
    assert_non_null(up);
    assert_true(((const float *)up->data)[7] == 1.0f);
    assert_null(find_attribute(set, "region"));
    assert_null(find_attribute(set, "TIME"));
    assert_int_equal(mns_particle_set_attribute_count(set), 6);
    mns_particle_set_destroy(&set);
}

static void every_layout_is_read(void **state)
{
    (void)state;
    static const char *const datasets[] = {"POLYDATA", "UNSTRUCTURED_GRID"};
    for (int k = 0; k < 16; k++) {
        struct blob blob;
        binary = k & 1;
        make(&blob, datasets[k >> 1 & 1], k & 4 ? "double" : "float", k >> 3);
        check_made(&blob, k & 4 ? MNS_F64 : MNS_F32);
    }
}

static const char ascii_head[] = "# vtk DataFile Version 4.2\nt\nASCII\nDATASET POLYDATA\nPOINTS 2 float\n1 2 3 4 5 6\n";

static mns_particle_set *read_ascii(const char *rest)
{
    char text[2048];
    snprintf(text, sizeof(text), "%s%s", ascii_head, rest);
    return read_text(text, "a.vtk", NULL);
}

static void kinds_of_numbers(void **state)
{
    (void)state;
    mns_particle_set *set = read_ascii(
        "POINT_DATA 2\nSCALARS a unsigned_long\nLOOKUP_TABLE default\n18446744073709551615 1e3\nSCALARS b vtkIdType 1\n"
        "LOOKUP_TABLE default\n-7 2.0\nSCALARS c bit\nLOOKUP_TABLE default\n1 0\nCOLOR_SCALARS color 3\n1 0.5 0 0 2 -1\n"
        "TEXTURE_COORDINATES t 2 float\n1 2 3 nan\nTENSORS6 s float\n1 2 3 4 5 6 7 8 9 10 11 12\nGLOBAL_IDS g vtktypeint64\n5 6\n"
        "SCALARS bare double\n0.5 1.5\n");
    assert_true(*(const uint64_t *)find_attribute(set, "a")->data == UINT64_MAX);
    assert_true(((const uint64_t *)find_attribute(set, "a")->data)[1] == 1000);
    assert_int_equal(find_attribute(set, "b")->type, MNS_I32);
    assert_int_equal(((const int32_t *)find_attribute(set, "b")->data)[0], -7);
    assert_int_equal(((const uint8_t *)find_attribute(set, "c")->data)[0], 1);
    assert_memory_equal(find_attribute(set, "color")->data, "\xff\x80\0\0\xff\0", 6);
    assert_int_equal(find_attribute(set, "s")->components, 6);
    assert_true(((const int64_t *)find_attribute(set, "g")->data)[1] == 6);
    assert_true(((const double *)find_attribute(set, "bare")->data)[1] == 1.5);
    mns_particle_set_destroy(&set);

    struct blob blob = {.size = 0};
    add_text(&blob, "# vtk DataFile Version 4.2\r\nt\r\nBINARY\r\nDATASET POLYDATA\r\nPOINTS 1 float\r\n");
    for (int i = 0; i < 3; i++) {
        add_float(&blob, (float)i, 1);
    }
    add_text(&blob,
             "\r\nPOINT_DATA 1\r\nFIELD f 2\r\nx%00y 1 1 unsigned_char\r\n!\r\nbits 9 1 bit\r\n\xa0\x80\r\nCOLOR_SCALARS color 3\r\nabc");
    set = read_blob(blob.data, blob.size, "a.vtk", NULL);
    assert_non_null(find_attribute(set, "x?y"));
    assert_memory_equal(find_attribute(set, "bits")->data, "\1\0\1\0\0\0\0\0\1", 9);
    assert_memory_equal(find_attribute(set, "color")->data, "abc", 3);
    mns_particle_set_destroy(&set);
}

static void few_or_no_particles(void **state)
{
    (void)state;
    mns_particle_set *set = read_text("# vtk DataFile Version 4.2\nt\nASCII\nDATASET POLYDATA\nPOINTS 0 float\nVERTICES 0 0\nPOINT_DATA 0\n"
                                      "SCALARS id int\nLOOKUP_TABLE default\n",
                                      "a.vtk", NULL);
    assert_int_equal(mns_particle_set_particles(set)->count, 0);
    mns_particle_set_destroy(&set);

    set = read_text("# vtk DataFile Version 4.2\nt\nASCII\nDATASET POLYDATA\nPOINTS 3 float\n1 2 3 nan 5 6 7 8 inf\n", "a.vtk", NULL);
    assert_int_equal(mns_particle_set_particles(set)->count, 1);
    assert_int_equal(mns_particle_set_dropped(set), 2);
    mns_particle_set_destroy(&set);

    struct heard heard = {0, ""};
    struct mns_read_params params;
    mns_read_params_init(&params);
    params.log = (struct mns_log){hear, &heard};
    set = read_text(
        "# vtk DataFile Version 4.2\nt\nASCII\nDATASET POLYDATA\nPOINTS 1 float\n1 2 3\nPOINT_DATA 1\nFIELD f 1\nodd 1 2 int\n4 5\n",
        "a.vtk", &params);
    assert_string_equal(heard.last, "a.vtk: 'odd' is left out: it has 2 values for 1 points");
    mns_particle_set_destroy(&set);
}

static void refuse(const char *text, mns_result code, const char *words) { refuses(text, strlen(text), "a.vtk", NULL, code, words); }

static void refuse_behind(const char *rest, mns_result code, const char *words)
{
    char text[2048];
    snprintf(text, sizeof(text), "%s%s", ascii_head, rest);
    refuse(text, code, words);
}

static void bad_headers_are_refused(void **state)
{
    (void)state;
    refuse("# vtk DataFile Version\n", MNS_ERR_BAD_DATA, "no version number");
    refuse("# vtk DataFile Version x\nt\nASCII\n", MNS_ERR_BAD_DATA, "no version number");
    refuse("# vtk DataFile Version 6.0\nt\nASCII\n", MNS_ERR_UNSUPPORTED, "version 6.0; up to 5.1 is read");
    refuse("# vtk DataFile Version 3.0\nt\nTEXT\n", MNS_ERR_BAD_DATA, "line 3: 'TEXT' where ASCII or BINARY should be");
    refuse("# vtk DataFile Version 3.0\nt\nASCII\nPOINTS 1 float\n", MNS_ERR_BAD_DATA, "line 4: 'POINTS' where DATASET should be");
    refuse("# vtk DataFile Version 3.0\nt\nASCII\nDATASET STRUCTURED_POINTS\n", MNS_ERR_UNSUPPORTED, "kind 'STRUCTURED_POINTS'");
    refuse("# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\n", MNS_ERR_BAD_DATA, "has no POINTS");
    struct mns_read_params params;
    mns_read_params_init(&params);
    params.format = "vtk";
    refuses("ply\n", 4, "a.vtk", &params, MNS_ERR_BAD_DATA, "is no legacy VTK file");
}

static void bad_bodies_are_refused(void **state)
{
    (void)state;
    refuse_behind("POINTS 1 float 1 2 3\n", MNS_ERR_BAD_DATA, "POINTS a second time");
    refuse_behind("SCALARS a int\n", MNS_ERR_BAD_DATA, "'SCALARS' where a keyword");
    refuse_behind("POINT_DATA 3\n", MNS_ERR_BAD_DATA, "POINT_DATA for 3 points where there are 2");
    refuse_behind("POINT_DATA\n", MNS_ERR_BAD_DATA, "'' where a number should be, behind POINT_DATA");
    refuse_behind("POINT_DATA 2\nNONSENSE\n", MNS_ERR_BAD_DATA, "'NONSENSE' where a keyword");
    refuse_behind("POINT_DATA 2\nSCALARS a real\n", MNS_ERR_BAD_DATA, "'real' where a type such as float should be");
    refuse_behind("POINT_DATA 2\nSCALARS a int many\n1 2\n", MNS_ERR_BAD_DATA, "'many' where the number of components of 'a' should be");
    refuse_behind("POINT_DATA 2\nSCALARS a int 0\n1 2\n", MNS_ERR_BAD_DATA, "'a' has 2 times 0 numbers");
    refuse_behind("POINT_DATA 2\nSCALARS a int\nLOOKUP_TABLE default\n1\n", MNS_ERR_BAD_DATA, "ends in 'a'");
    refuse_behind("POINT_DATA 2\nSCALARS a int\nLOOKUP_TABLE default\n1 two\n", MNS_ERR_BAD_DATA, "number 2 of 'a': 'two' is no int32");
    refuse_behind("POINT_DATA 2\nSCALARS a unsigned_char\nLOOKUP_TABLE default\n1 256\n", MNS_ERR_BAD_DATA, "'256' is no uint8");
    refuse_behind("POINT_DATA 2\nVECTORS v float\n1 2 3 4 5 6x\n", MNS_ERR_BAD_DATA, "number 6 of 'v': '6x' is no float32");
    refuse_behind("POINT_DATA 2\nFIELD f 2\na 1 2 int\n1 2\n", MNS_ERR_BAD_DATA, "ends in a FIELD, after 1 of 2 arrays");
    refuse_behind("POINT_DATA 2\nFIELD f 1\na 9999999999 99999999999 int\n1 2\n", MNS_ERR_BAD_DATA, "'a' has 99999999999 times 9999999999");
    refuse_behind("POINT_DATA 2\nFIELD f 1\na 1 -2 int\n1 2\n", MNS_ERR_BAD_DATA, "'-2' where a number should be");
    refuse_behind("FIELD f 1\na 1 2 string\none\n", MNS_ERR_BAD_DATA, "ends in 'a', which should hold 2 strings");
    refuse_behind("VERTICES 2\n", MNS_ERR_BAD_DATA, "behind cells");
    refuse_behind("VERTICES 3 2\nOFFSETS vtktypeint64\n0 1 2\nPOINT_DATA\n", MNS_ERR_BAD_DATA, "'POINT_DATA' where CONNECTIVITY should be");
    refuse_behind("VERTICES 2 4\n1 0 1\n", MNS_ERR_BAD_DATA, "ends in 'cells'");
    refuse("# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\nPOINTS 1 int\n1 2 3\n", MNS_ERR_UNSUPPORTED, "positions of type int32");
    refuse("# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\nPOINTS 1 string\n1 2 3\n", MNS_ERR_BAD_DATA,
           "POINTS that are no numbers");
    refuse("# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\nPOINTS 99999999999 float\n1 2 3\n", MNS_ERR_BAD_DATA,
           "ends in 'Points'");
    refuse("# vtk DataFile Version 3.0\nt\nBINARY\nDATASET POLYDATA\nPOINTS 99999999999 float\n1 2 3\n", MNS_ERR_BAD_DATA,
           "ends in 'Points'");
    refuse("# vtk DataFile Version 3.0\nt\nBINARY\nDATASET POLYDATA\nPOINTS 999999999999999999999 float\n1", MNS_ERR_BAD_DATA,
           "behind POINTS");
    refuse("# vtk DataFile Version 3.0\nt\nBINARY\nDATASET POLYDATA\nFIELD f 1\na 1 2 string\n\xff"
           "ab",
           MNS_ERR_BAD_DATA, "ends in 'a'");
}

/* Up to the end of the points; behind them a file may end where a section does. */
static void cuts_are_refused(void **state)
{
    (void)state;
    for (binary = 0; binary < 2; binary++) {
        struct blob blob;
        make(&blob, "UNSTRUCTURED_GRID", "float", 1);
        size_t start = 0, end = 0;
        while (memcmp(blob.data + start, "\nFIELD", 6) != 0) {
            start++;
        }
        while (memcmp(blob.data + end, "METADATA", 8) != 0) {
            end++;
        }
        for (size_t size = start; size + 4 < end; size++) {
            refuses(blob.data, size, "a.vtk", NULL, MNS_ERR_BAD_DATA, "");
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_layout_is_read),    cmocka_unit_test(kinds_of_numbers),       cmocka_unit_test(few_or_no_particles),
        cmocka_unit_test(bad_headers_are_refused), cmocka_unit_test(bad_bodies_are_refused), cmocka_unit_test(cuts_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
