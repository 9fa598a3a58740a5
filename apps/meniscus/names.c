/* names.c: what the user may have meant. */
#include "names.h"

#include <string.h>

size_t names_distance(const char *a, const char *b)
{
    enum { LONGEST = 63 };
    size_t row[LONGEST + 1], length = strlen(b);
    if (length > LONGEST) {
        return length;
    }
    for (size_t j = 0; j <= length; j++) {
        row[j] = j;
    }
    for (size_t i = 1; *a; i++, a++) {
        size_t diagonal = row[0];
        row[0] = i;
        for (size_t j = 1; j <= length; j++) {
            size_t above = row[j], replaced = diagonal + (*a != b[j - 1]);
            size_t inserted = (row[j - 1] < above ? row[j - 1] : above) + 1;
            row[j] = replaced < inserted ? replaced : inserted;
            diagonal = above;
        }
    }
    return row[length];
}
