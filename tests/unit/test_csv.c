/* CSV and XYZ in the dialects that programs write. */
#include "io_test.h"

static void check_two(const char *text, const char *name)
{
    mns_particle_set *set = read_text(text, name, NULL);
    const struct mns_particles *particles = mns_particle_set_particles(set);
    assert_string_equal(mns_particle_set_format(set), "csv");
    assert_int_equal(particles->count, 2);
    assert_vector(particles->position, 0, 1, 2.5, -3);
    assert_vector(particles->position, 1, 4, 5, 6e-1);
    mns_particle_set_destroy(&set);
}

static void dialects_are_read(void **state)
{
    (void)state;
    check_two("x,y,z\n1,2.5,-3\n4,5,6e-1\n", "a.csv");
    check_two("X;Y;Z\r\n1;2.5;-3\r\n4;5;6e-1\r\n", "a.csv");
    check_two("x\ty\tz\n1\t2.5\t-3\n4\t5\t6e-1", "a.tsv");
    check_two("  x   y z \n 1  2.5\t-3\n4 5 6e-1 \n\n", "a.txt");
    check_two("1,2.5,-3\n4,5,6e-1\n", "a.csv");
    check_two("1 2.5 -3\n4 5 6e-1\n", "a.xyz");
    check_two("# x y z\n# another\n1 2.5 -3\n\n4 5 6e-1\n", "a.txt");
    check_two("\xef\xbb\xbf"
              "x,y,z\n1,2.5,-3\n4,5,6e-1\n",
              "a.csv");
    check_two("\"Points:0\",\"Points:1\",\"Points:2\"\n1,2.5,-3\n4,5,6e-1\n", "a.csv");
    check_two("id,Points_2,Points_0,Points_1\n7,-3,1,2.5\n8,6e-1,4,5\n", "a.csv");
    check_two("Pos.x [m];Pos.y [m];Pos.z [m];\n1;2.5;-3;\n4;5;6e-1;\n", "a.csv");
    check_two("px,py,pz\n1,2.5,-3\n4,5,6e-1\n", "a.csv");
    check_two("\"1\",\"2.5\",\"-3\"\n\"4\",\"5\",\"6e-1\"\n", "a.csv");
    check_two("2\ncomment\nO 1 2.5 -3\nH 4 5 6e-1\n", "a.xyz");
    check_two("2\n\n1 2.5 -3\n4 5 6e-1\n", "a.xyz");
    check_two(" 2 \n10 20\n1 1 2.5 -3\n2 4 5 6e-1\n", "a.xyz");
    check_two("1 2.5 -3\n4 5 6e-1\n", "no extension");
}

static void columns_become_vectors(void **state)
{
    (void)state;
    mns_particle_set *set =
        read_text("\"velocity:0\",\"velocity:1\",\"velocity:2\",\"density\",\"id\",\"Points:0\",\"Points:1\",\"Points:2\"\n"
                  "1,2,3,1000.5,9007199254740993,0,0,0\n4,5,6,999,2,1,1,1\n",
                  "a.csv", NULL);
    const struct mns_particles *particles = mns_particle_set_particles(set);
    assert_int_equal(mns_particle_set_attribute_count(set), 4);
    assert_vector(particles->velocity, 1, 4, 5, 6);
    assert_true(value_of(particles->density, 0, 0) == 1000.5);
    assert_int_equal((int)value_of(particles->id, 1, 0), 2);
    assert_int_equal(particles->id.type, MNS_I64);
    mns_particle_set_destroy(&set);

    set = read_text("x,y,z,u,v,w,s_0,s_1,n1,e\n1,2,3,4,5,6,7,8,9,\n", "a.csv", NULL);
    particles = mns_particle_set_particles(set);
    assert_vector(particles->velocity, 0, 4, 5, 6);
    assert_int_equal(find_attribute(set, "s")->components, 2);
    assert_int_equal(find_attribute(set, "n1")->type, MNS_I64);
    assert_true(isnan(*(const double *)find_attribute(set, "e")->data));
    mns_particle_set_destroy(&set);
}

static void xyz_types_are_kept(void **state)
{
    (void)state;
    mns_particle_set *set = read_text("3\nAtoms. Timestep: 5\n1 1 2 3\n2 4 5 6\n1 7 8 9\n", "a.xyz", NULL);
    const struct mns_attribute *type = find_attribute(set, "type");
    assert_non_null(type);
    assert_int_equal(type->type, MNS_I64);
    assert_int_equal(((const int64_t *)type->data)[1], 2);
    mns_particle_set_destroy(&set);
}

static void text_columns_are_left_out(void **state)
{
    (void)state;
    struct heard heard = {0, ""};
    struct mns_read_params params;
    mns_read_params_init(&params);
    params.log = (struct mns_log){hear, &heard};
    mns_particle_set *set = read_text("name,x,y,z\nwater,1,2,3\n\"a, b\",4,5,6\n", "a.csv", &params);
    assert_vector(mns_particle_set_particles(set)->position, 1, 4, 5, 6);
    assert_int_equal(mns_particle_set_attribute_count(set), 1);
    assert_int_equal(heard.count, 1);
    assert_non_null(strstr(heard.last, "'name' is left out"));
    mns_particle_set_destroy(&set);
}

static void only_the_first_frame_is_read(void **state)
{
    (void)state;
    struct heard heard = {0, ""};
    struct mns_read_params params;
    mns_read_params_init(&params);
    params.log = (struct mns_log){hear, &heard};
    mns_particle_set *set = read_text("1\na\n1 2 3\n1\nb\n4 5 6\n", "a.xyz", &params);
    assert_int_equal(mns_particle_set_particles(set)->count, 1);
    assert_int_equal(heard.count, 1);
    mns_particle_set_destroy(&set);
}

static void no_rows_are_a_valid_set(void **state)
{
    (void)state;
    static const char *const empty[] = {"x,y,z\n", "x,y,z", "0\ncomment\n", "0\n"};
    struct mns_read_params params;
    mns_read_params_init(&params);
    params.format = "csv";
    for (size_t i = 0; i < sizeof(empty) / sizeof(empty[0]); i++) {
        mns_particle_set *set = read_text(empty[i], "a.csv", &params);
        assert_int_equal(mns_particle_set_particles(set)->count, 0);
        mns_particle_set_destroy(&set);
    }
    mns_particle_set *set = read_text("\n\"id\",\"Points:0\",\"Points:1\",\"Points:2\"\n\n", "a.csv", NULL); /* told from its content */
    assert_int_equal(mns_particle_set_particles(set)->count, 0);
    mns_particle_set_destroy(&set);
}

static void refuse(const char *text, const char *words) { refuses(text, strlen(text), "a.csv", NULL, MNS_ERR_BAD_DATA, words); }

static void bad_tables_are_refused(void **state)
{
    (void)state;
    refuse("x,y,z\n1,2,3\n1,2\n", "line 3 has less than the 3 fields");
    refuse("x,y,z\n1,2,3\n1,2,3,4\n", "line 3 has more than the 3 fields");
    refuse("x y z\n1 2 3\n1 2 3 4\n", "line 3 has more than the 3 fields");
    refuse("x,y,z\n1,2,3\n\n1,two,3\n", "line 4, column 2 (y): 'two' is no number");
    refuse("x,y,z\n1,2,3\n1,2m,3\n", "line 3, column 2 (y): '2m' is no number");
    refuse("x,y,z,w\n1,2,3\n", "line 2 has 3 fields where the first line names 4");
    refuse("a,b,c\n1,2,3\n", "has no positions; it has a, b, c");
    refuse("5\ncomment\n1 2 3\n4 5 6\n", "the 5 rows of 3 fields");
    refuse("3\ncomment\n1.00000 2.000000 3.00000\n4.00000 5.0000000 6.000000\n", "ends early: 2 of 3");
    refuse("9223372036854775807\ncomment\n1 2 3\n", "ends early");
}

/* A header of many names over rows of one field must not ask for the product. */
static void crooked_tables_ask_for_no_memory(void **state)
{
    (void)state;
    static struct blob blob;
    blob.size = 0;
    for (int i = 0; i < 900; i++) {
        add_text(&blob, "1,");
    }
    for (int i = 0; i < 5000; i++) {
        add_text(&blob, "\n1");
    }
    refuses(blob.data, blob.size, "a.csv", NULL, MNS_ERR_BAD_DATA, "rows of 901 fields");
}

static void positions_can_be_named(void **state)
{
    (void)state;
    const char *const roles[] = {"position=rest"};
    struct mns_read_params params;
    mns_read_params_init(&params);
    params.roles = roles;
    params.role_count = 1;
    mns_particle_set *set = read_text("rest.x,rest.y,rest.z\n1,2,3\n", "a.csv", &params);
    assert_vector(mns_particle_set_particles(set)->position, 0, 1, 2, 3);
    mns_particle_set_destroy(&set);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(dialects_are_read),
        cmocka_unit_test(columns_become_vectors),
        cmocka_unit_test(xyz_types_are_kept),
        cmocka_unit_test(text_columns_are_left_out),
        cmocka_unit_test(only_the_first_frame_is_read),
        cmocka_unit_test(no_rows_are_a_valid_set),
        cmocka_unit_test(bad_tables_are_refused),
        cmocka_unit_test(crooked_tables_ask_for_no_memory),
        cmocka_unit_test(positions_can_be_named),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
