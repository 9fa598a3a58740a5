/* Expressions that pick particles. */
#include "io_test.h"

/* Eight particles: x = 0 to 7, type = x mod 3, velocity = (x, -x, 0), "my name" = x / 2. */
static const char table[] = "x,y,z,type,velocity:0,velocity:1,velocity:2,rho,my name\n"
                            "0,0,1,0,0,0,0,nan,0\n1,0,1,1,1,-1,0,100,.5\n2,0,1,2,2,-2,0,200,1\n3,0,1,0,3,-3,0,300,1.5\n"
                            "4,0,1,1,4,-4,0,400,2\n5,0,1,2,5,-5,0,500,2.5\n6,0,1,0,6,-6,0,600,3\n7,0,1,1,7,-7,0,700,3.5\n";

/* The x of those kept, as digits. */
static void picks(const char *where, const char *wanted)
{
    struct mns_read_params params;
    char kept[16];
    mns_read_params_init(&params);
    params.where = where;
    mns_particle_set *set = read_text(table, "a.csv", &params);
    const struct mns_particles *particles = mns_particle_set_particles(set);
    for (size_t i = 0; i < particles->count; i++) {
        kept[i] = (char)('0' + (int)value_of(particles->position, i, 0));
        assert_true(value_of(particles->velocity, i, 1) == -value_of(particles->position, i, 0)); /* all arrays move together */
    }
    kept[particles->count] = '\0';
    if (strcmp(kept, wanted) != 0) {
        fail_msg("'%s' keeps %s, not %s", where, kept, wanted);
    }
    assert_int_equal(mns_particle_set_file_count(set), 8);
    mns_particle_set_destroy(&set);
}

static void operators_mean_what_they_do_in_c(void **state)
{
    (void)state;
    picks("type == 0", "036");
    picks("type==0&&x>0", "36");
    picks("type != 0", "12457");
    picks("x < 2 || x >= 6", "0167");
    picks("x <= 2 && !(type == 1)", "02");
    picks("x + 1 * 2 == 5", "3");
    picks("(x + 1) * 2 == 6", "2");
    picks("x - 1 - 1 == 1", "3");
    picks("x / 2 / 2 == 1", "4");
    picks("-x > -2", "01");
    picks("--x == 2", "2");
    picks("!type", "036");
    picks("!!x", "1234567");
    picks("x == 1 || x == 2 && type == 0", "1");
    picks("1", "01234567");
    picks("0", "");
    picks("1e0 < x && x < .25e1", "2");
}

static void names_are_found(void **state)
{
    (void)state;
    picks("velocity.x == 3", "3");
    picks("velocity.0 == 3", "3");
    picks("velocity.y < -5.5", "67");
    picks("velocity > 9", "7"); /* 7 sqrt(2) = 9.9 */
    picks("'my name' == 1.5", "3");
    picks("\"my name\" == 1.5", "3");
    picks("position.x == 3", "3");
    picks("z == 1 && y == 0", "01234567");
    picks("rho > 550", "67");
    picks("density > 550", "67"); /* by role */
    picks("rho", "1234567");      /* NaN is not true */
    picks("rho != rho", "0");
}

static void refuse(const char *where, const char *words)
{
    struct mns_read_params params;
    mns_read_params_init(&params);
    params.where = where;
    refuses(table, sizeof(table) - 1, "a.csv", &params, MNS_ERR_INVALID_ARGUMENT, words);
}

static void faults_are_told_with_their_place(void **state)
{
    (void)state;
    refuse("type == 0 && vel > 2", "column 14: no attribute 'vel'; there is position[3], type, velocity[3], rho, my name");
    refuse("", "column 1: the expression ends too early");
    refuse("x <", "column 4: the expression ends too early");
    refuse("x = 3", "'=' is no comparison");
    refuse("(x > 3", "column 7: ')' is missing");
    refuse("x > 3)", "column 6: an operator should stand here");
    refuse("1 < x < 3", "do not chain");
    refuse("velocity.q > 1", "no such component");
    refuse("velocity.3 > 1", "no such component");
    refuse("velocity.xy > 1", "no such component");
    refuse("'my name > 1", "quote is not closed");
    refuse("x > $", "column 5: a number, a name or '('");
    refuse("x y", "an operator should stand here");
}

static void long_expressions_are_refused(void **state)
{
    (void)state;
    char where[4000];
    memset(where, '(', sizeof(where));
    where[sizeof(where) - 1] = '\0';
    refuse(where, "nested too deeply");
    memset(where, '-', sizeof(where) - 1);
    refuse(where, "nested too deeply");
    size_t n = 0;
    for (int i = 0; i < 400; i++) {
        n += (size_t)snprintf(where + n, sizeof(where) - n, "x+");
    }
    where[n - 1] = '\0';
    refuse(where, "too long");
    n = 0;
    for (int i = 0; i < 60; i++) {
        n += (size_t)snprintf(where + n, sizeof(where) - n, "x+(");
    }
    refuse(where, "too long");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(operators_mean_what_they_do_in_c),
        cmocka_unit_test(names_are_found),
        cmocka_unit_test(faults_are_told_with_their_place),
        cmocka_unit_test(long_expressions_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
