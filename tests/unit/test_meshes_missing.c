/* A build that draws no meshes says what to install. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include <meniscus/scene.h>

static void test_says_what_to_install(void **state)
{
    (void)state;
    struct mns_message message;
    mns_meshes *meshes = (mns_meshes *)(void *)&message;
    assert_int_equal(mns_meshes_create(&meshes, NULL, &message), MNS_ERR_UNSUPPORTED);
    assert_null(meshes);
    assert_non_null(strstr(message.text, "libassimp-dev libembree-dev libstb-dev"));
    mns_meshes_destroy(&meshes);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_says_what_to_install)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
