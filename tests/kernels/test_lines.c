/* Rows as lines side by side, by every instruction set: there and back. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "cpu/kernels.h"

#include <string.h>

enum { COUNT = 48, STRIDE = COUNT + 16 };

static _Alignas(64) float rows[LINES][STRIDE], again[LINES][STRIDE], lines[COUNT][LINES];

/* The first pixels of a row are the first of its line; rows that are not in the picture are read, never written. */
static void test_rows_become_lines_and_rows_again(void **state)
{
    (void)state;
    for (int i = 0; i < LINES * STRIDE; i++) {
        rows[i / STRIDE][i % STRIDE] = (float)(i + 1);
    }
    for (int isa = MNS_ISA_SCALAR; isa <= MNS_ISA_NEON; isa++) {
        const struct kernels *kernels = mns_kernels_get((enum mns_isa)isa);
        for (int across = 8; kernels && across <= LINES; across += 8) {
            memset(again, 0, sizeof(again));
            kernels->smooth->lines->gather(rows[0], STRIDE, COUNT, lines[0]);
            kernels->smooth->lines->scatter(lines[0], COUNT, across, again[0], STRIDE);
            for (int line = 0; line < LINES; line++) {
                for (int i = 0; i < STRIDE; i++) {
                    assert_true(i >= COUNT || lines[i][line] == rows[line][i]);
                    assert_true(again[line][i] == (i < COUNT && line < across ? rows[line][i] : 0));
                }
            }
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_rows_become_lines_and_rows_again)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
