/* The input is an expression. */
#include "fuzz.h"

#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const char table[] = "x,y,z,type,velocity:0,velocity:1,velocity:2\n0,1,2,0,1,2,3\n4,5,6,1,0,0,0\n7,8,nan,2,1,1,1\n";
    char expression[512];
    if (size >= sizeof(expression)) {
        return 0;
    }
    if (size > 0) {
        memcpy(expression, data, size);
    }
    expression[size] = '\0';
    fuzz_read("csv", expression, (const uint8_t *)table, sizeof(table) - 1);
    return 0;
}
