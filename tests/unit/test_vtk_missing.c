/* A build without expat says what it lacks. */
#include "io_test.h"

static void xml_is_refused_by_name(void **state)
{
    (void)state;
    static const char text[] = "<?xml version=\"1.0\"?><VTKFile type=\"UnstructuredGrid\"></VTKFile>";
    mns_pvd *pvd;
    struct mns_message message;
    refuses(text, sizeof(text) - 1, "a.vtu", NULL, MNS_ERR_UNSUPPORTED,
            "is a VTK XML file, which this build cannot read: build with expat");
    assert_int_equal(mns_pvd_read(&pvd, "a.pvd", &message), MNS_ERR_UNSUPPORTED);
    assert_null(pvd);
    assert_non_null(strstr(message.text, "a.pvd: is a VTK XML file"));
    int listed = 0;
    for (size_t i = 0; mns_missing_feature(i); i++) {
        listed += strstr(mns_missing_feature(i), "expat") != NULL;
    }
    assert_int_equal(listed, 1);
    for (size_t i = 0; mns_read_format(i); i++) {
        assert_string_not_equal(mns_read_format(i), "vtu");
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(xml_is_refused_by_name)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
