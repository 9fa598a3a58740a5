/* Bounded cursors, byte order, and numbers in text. */
#include "io/reader.h"

#include "io_test.h"

#include <math.h>

static void cursor_stops_at_the_end(void **state)
{
    (void)state;
    const uint8_t data[] = {1, 2, 3, 4, 5};
    struct cursor cursor = {{data, sizeof(data)}, 0};
    const uint8_t *p;
    uint16_t u16;
    uint32_t u32;
    assert_true(mns_take_u16be(&cursor, &u16));
    assert_int_equal(u16, 0x0102);
    assert_false(mns_take_u32be(&cursor, &u32));
    assert_int_equal(cursor.at, 2);
    assert_false(mns_take(&cursor, SIZE_MAX, &p));
    assert_true(mns_take(&cursor, 3, &p));
    assert_int_equal(p[2], 5);
    assert_true(mns_take(&cursor, 0, &p));
    assert_false(mns_take_u16be(&cursor, &u16));
}

static void lines_end_in_any_way(void **state)
{
    (void)state;
    const char text[] = "one\r\n\ntwo\nlast";
    struct cursor cursor = {{(const uint8_t *)text, sizeof(text) - 1}, 0};
    static const char *const lines[] = {"one", "", "two", "last"};
    struct bytes line;
    for (int i = 0; i < 4; i++) {
        assert_true(mns_take_line(&cursor, &line));
        assert_int_equal(line.size, strlen(lines[i]));
        assert_memory_equal(line.data, lines[i], line.size);
    }
    assert_false(mns_take_line(&cursor, &line));
}

static void elements_are_swapped(void **state)
{
    (void)state;
    const uint8_t in[] = {0xff, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16};
    uint64_t u64[2];
    uint32_t u32[4];
    uint16_t u16[8];
    mns_copy_elements(u64, in + 1, 2, MNS_U64, true); /* unaligned on purpose */
    mns_copy_elements(u32, in + 1, 4, MNS_F32, true);
    mns_copy_elements(u16, in + 1, 8, MNS_I16, false);
    assert_true(u64[0] == 0x0102030405060708u && u64[1] == 0x090a0b0c0d0e0f10u);
    assert_int_equal(u32[3], 0x0d0e0f10);
    assert_int_equal(u16[1], 0x0403);
}

/* Against the C library. */
static void check_number(const char *text)
{
    char *stop;
    double value, wanted = strtod(text, &stop);
    const char *end = mns_parse_double(text, text + strlen(text), &value);
    assert_ptr_equal(end, stop);
    if (memcmp(&value, &wanted, sizeof(value)) != 0 && !(isnan(value) && isnan(wanted))) {
        fail_msg("'%s' gives %.17g, not %.17g", text, value, wanted);
    }
}

static void numbers_are_rounded_correctly(void **state)
{
    (void)state;
    static const char *const numbers[] = {"0",
                                          "-0",
                                          "1",
                                          "-1.5",
                                          "+2.25",
                                          ".5",
                                          "5.",
                                          "1e5",
                                          "1E-5",
                                          "1e+05",
                                          "123456789012345678",
                                          "0.1",
                                          "0.30000000000000004",
                                          "2.2250738585072014e-308",
                                          "4.9406564584124654e-324",
                                          "2.4703282292062327e-324",
                                          "1.7976931348623157e308",
                                          "1e400",
                                          "-1e400",
                                          "1e-400",
                                          "9007199254740993",
                                          "9007199254740992.5",
                                          "0.000000000000000000000000000001234567",
                                          "8.5000000000000000000000000000001e22",
                                          "123456789012345678901234567890",
                                          "1e23",
                                          "8.98846567431158e307",
                                          "1e22",
                                          "1e-22",
                                          "3.14159265358979323846264338327950288",
                                          "nan",
                                          "inf",
                                          "-inf",
                                          "infinity",
                                          "NaN",
                                          "1.0e",
                                          "1e+",
                                          "7,5",
                                          "1..2",
                                          "9007199254740993e0",
                                          "5e-324",
                                          "1e99999999999999999999",
                                          "0.00000000000000000000000000000000000000000000000000000000000001e62"};
    for (size_t i = 0; i < sizeof(numbers) / sizeof(numbers[0]); i++) {
        check_number(numbers[i]);
    }
}

/* As in CSV, which knows no hexadecimal numbers. */
static void hexadecimal_is_not_read(void **state)
{
    (void)state;
    const char *text = "0x10";
    double value;
    assert_ptr_equal(mns_parse_double(text, text + 4, &value), text + 1);
}

/* Doubles printed with 17 digits come back as they were; with 9, as the C library reads them. */
static void random_numbers_come_back(void **state)
{
    (void)state;
    uint64_t random = 1;
    for (int i = 0; i < 200000; i++) {
        double value, back;
        char text[64];
        random = random * 6364136223846793005u + 1442695040888963407u;
        uint64_t bits = i % 2 ? random : (random & 0x800fffffffffffffu) | (uint64_t)(1023 - 20 + (random >> 58) % 40) << 52;
        memcpy(&value, &bits, sizeof(value));
        if (!isfinite(value)) {
            continue;
        }
        int length = snprintf(text, sizeof(text), "%.17g", value);
        assert_ptr_equal(mns_parse_double(text, text + length, &back), text + length);
        assert_memory_equal(&back, &value, sizeof(value));
        snprintf(text, sizeof(text), "%.9g", value);
        check_number(text);
    }
}

static void no_number_is_refused(void **state)
{
    (void)state;
    static const char *const wrong[] = {"", "-", "+", ".", "e5", "abc", "-.e", "\"1\"", "--1", "in", "na"};
    double value;
    for (size_t i = 0; i < sizeof(wrong) / sizeof(wrong[0]); i++) {
        assert_null(mns_parse_double(wrong[i], wrong[i] + strlen(wrong[i]), &value));
    }
}

static void numbers_end_where_told(void **state)
{
    (void)state;
    const char *text = "12345";
    double value;
    assert_ptr_equal(mns_parse_double(text, text + 3, &value), text + 3);
    assert_true(value == 123.0);
    assert_ptr_equal(mns_parse_double("1e5", &"1e5"[2], &value) != NULL ? text : NULL, text);
    assert_true(value == 1.0);
}

static void long_numbers_are_taken(void **state)
{
    (void)state;
    char text[3000];
    double value;
    memset(text, '3', sizeof(text));
    text[1] = '.';
    assert_ptr_equal(mns_parse_double(text, text + sizeof(text), &value), text + sizeof(text));
    assert_true(fabs(value - 10.0 / 3.0) < 1e-15);
    memset(text, '0', sizeof(text));
    text[1] = '.';
    text[2999] = '7';
    assert_ptr_equal(mns_parse_double(text, text + sizeof(text), &value), text + sizeof(text));
    assert_true(value == 0.0);
}

static void fortran_exponents_are_taken(void **state)
{
    (void)state;
    double value;
    const char *text = "1.25D+02";
    assert_non_null(mns_parse_double(text, text + 8, &value));
    assert_true(value == 125.0);
    text = "1.2345678901234567890d-300";
    assert_non_null(mns_parse_double(text, text + strlen(text), &value));
    assert_true(value == 1.2345678901234567890e-300);
}

static void whole_numbers_are_checked(void **state)
{
    (void)state;
    int64_t value;
    const char *text = "-9223372036854775808 ";
    assert_ptr_equal(mns_parse_int64(text, text + strlen(text), &value), text + 20);
    assert_true(value == INT64_MIN);
    text = "9223372036854775807";
    assert_non_null(mns_parse_int64(text, text + strlen(text), &value));
    assert_true(value == INT64_MAX);
    text = "9223372036854775808";
    assert_null(mns_parse_int64(text, text + strlen(text), &value));
    text = "99999999999999999999999";
    assert_null(mns_parse_int64(text, text + strlen(text), &value));
    text = "-0";
    assert_non_null(mns_parse_int64(text, text + 2, &value));
    assert_true(value == 0);
    assert_null(mns_parse_int64("x", &"x"[1], &value));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cursor_stops_at_the_end),   cmocka_unit_test(lines_end_in_any_way),
        cmocka_unit_test(elements_are_swapped),      cmocka_unit_test(numbers_are_rounded_correctly),
        cmocka_unit_test(random_numbers_come_back),  cmocka_unit_test(hexadecimal_is_not_read),
        cmocka_unit_test(no_number_is_refused),      cmocka_unit_test(numbers_end_where_told),
        cmocka_unit_test(long_numbers_are_taken),    cmocka_unit_test(fortran_exponents_are_taken),
        cmocka_unit_test(whole_numbers_are_checked),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
