/* The parameter table: every row round-trips, ranges hold, wrong input says what would be right. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <meniscus/params.h>

#include <locale.h>
#include <math.h>
#include <string.h>

static void test_defaults_are_valid_and_round_trip(void **state)
{
    (void)state;
    struct mns_params params, copy;
    struct mns_message message;
    mns_params_init(&params);
    assert_int_equal(mns_params_check(&params, &message), MNS_OK);
    mns_params_init(&copy);
    for (size_t i = 0; i < mns_param_count(); i++) {
        char text[128];
        const struct mns_param *row = mns_param_info(i);
        assert_true(mns_params_get(&params, row->name, text, sizeof(text)) > 0);
        assert_int_equal(mns_params_set(&copy, row->name, text, &message), MNS_OK);
        assert_true(strlen(row->help) > 5 && row->unit && row->group);
    }
    assert_memory_equal(&params, &copy, sizeof(params));
    assert_null(mns_param_info(mns_param_count()));
}

static void test_wrong_values_change_nothing(void **state)
{
    (void)state;
    static const struct {
        const char *name, *value, *words;
    } cases[] = {
        {"sigma", "-1", "from 0.01 to 20 r"},
        {"sigma", "nan", "from 0.01"},
        {"sigma", "1x", "a number"},
        {"iterations", "0", "from 1 to 1000"},
        {"iterations", "1.5", "whole"},
        {"iterations", "10000", "1000"},
        {"filter", "median", "narrow-range"},
        {"floor", "maybe", "on or off"},
        {"fluid_color", "1,2", "three numbers"},
        {"thickness_scale", "3", "auto, 1, 2, 4"},
        {"sgima", "1", "'sigma'"},
        {"radius", "0", "or auto"},
        {"radius", "", "empty"},
        {"sigma", "1.5.2", "a number"},
        {"sigma", ".", "a number"},
        {"sigma", "0,5", "a number"},
    };
    for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
        struct mns_params params, before;
        struct mns_message message;
        mns_params_init(&params);
        mns_params_init(&before);
        assert_int_equal(mns_params_set(&params, cases[i].name, cases[i].value, &message), MNS_ERR_INVALID_ARGUMENT);
        assert_non_null(strstr(message.text, cases[i].words));
        assert_memory_equal(&params, &before, sizeof(params));
    }
}

static void test_colours_and_auto(void **state)
{
    (void)state;
    struct mns_params params;
    mns_params_init(&params);
    assert_int_equal(mns_params_set(&params, "background_color", "#ff8000", NULL), MNS_OK);
    assert_true(params.background_color[0] == 1.0f && fabsf(params.background_color[1] - 0.2158605f) < 1e-6f);
    assert_int_equal(mns_params_set(&params, "radius", "0.5", NULL), MNS_OK);
    assert_int_equal(mns_params_set(&params, "radius", "auto", NULL), MNS_OK);
    assert_true(params.radius == 0.0f);
}

static void test_a_program_that_writes_commas_changes_nothing(void **state)
{
    static const char *const names[] = {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8", "fr_FR.utf8", "de-DE", NULL};
    const char *set = NULL;
    for (int i = 0; names[i] && !set; i++) {
        set = setlocale(LC_NUMERIC, names[i]);
    }
    if (!set) {
        skip(); /* no such locale on this machine */
    }
    struct mns_params params;
    char text[64];
    mns_params_init(&params);
    assert_int_equal(mns_params_set(&params, "fluid_color", "0.25, 1.5,2e-1", NULL), MNS_OK);
    assert_true(params.fluid_color[0] == 0.25f && params.fluid_color[1] == 1.5f && params.fluid_color[2] == 0.2f);
    assert_int_equal(mns_params_get(&params, "fluid_color", text, sizeof(text)), 12);
    assert_string_equal(text, "0.25,1.5,0.2");
    assert_int_equal(mns_params_set(&params, "sigma", "0,5", NULL), MNS_ERR_INVALID_ARGUMENT);
    test_defaults_are_valid_and_round_trip(state);
    setlocale(LC_NUMERIC, "C");
}

static void test_check_finds_bad_fields(void **state)
{
    (void)state;
    struct mns_message message;
    struct mns_params params;
    mns_params_init(&params);
    params.sigma = NAN;
    assert_int_equal(mns_params_check(&params, &message), MNS_ERR_INVALID_ARGUMENT);
    mns_params_init(&params);
    params.thickness_scale = 3;
    assert_int_equal(mns_params_check(&params, &message), MNS_ERR_INVALID_ARGUMENT);
    mns_params_init(&params);
    params.mu = 11;
    assert_int_equal(mns_params_check(&params, &message), MNS_ERR_INVALID_ARGUMENT);
    assert_non_null(strstr(message.text, "mu"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_defaults_are_valid_and_round_trip),
        cmocka_unit_test(test_wrong_values_change_nothing),
        cmocka_unit_test(test_colours_and_auto),
        cmocka_unit_test(test_a_program_that_writes_commas_changes_nothing),
        cmocka_unit_test(test_check_finds_bad_fields),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
