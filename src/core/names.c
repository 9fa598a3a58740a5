/* names.c: what the caller may have meant. */
#include "core/names.h"

#include <string.h>

int mns_name_distance(const char *a, const char *b)
{
    int row[64];
    int length = (int)strlen(b);
    if (length > 63) {
        return length;
    }
    for (int j = 0; j <= length; j++) {
        row[j] = j;
    }
    for (int i = 1; *a; i++, a++) {
        int diagonal = row[0];
        row[0] = i;
        for (int j = 1; j <= length; j++) {
            int above = row[j], replaced = diagonal + (*a != b[j - 1]);
            int inserted = (row[j - 1] < above ? row[j - 1] : above) + 1;
            row[j] = replaced < inserted ? replaced : inserted;
            diagonal = above;
        }
    }
    return row[length];
}
