/* pattern.c: names with one %d, and the natural order of names with numbers. What the user wrote never reaches printf. */
#include "inputs.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* The conversion at text ("%d", "%04d"): its length and width, or 0 when there is none. */
static size_t conversion(const char *text, int *width)
{
    size_t length = 1;
    *width = 0;
    if (text[length] == '0') {
        for (length++; text[length] >= '0' && text[length] <= '9'; length++) {
            *width = *width < 100 ? *width * 10 + (text[length] - '0') : *width;
        }
    }
    return text[length] == 'd' && *width <= 20 ? length + 1 : 0;
}

bool pattern_is(const char *name)
{
    int conversions = 0, width;
    for (const char *at = strchr(name, '%'); at; at = strchr(at, '%')) {
        size_t length = at[1] == '%' ? 2 : conversion(at, &width);
        if (!length) {
            return false;
        }
        conversions += at[1] != '%';
        at += length;
    }
    return conversions == 1;
}

char *pattern_name(const char *pattern, long long number)
{
    bool filled = pattern_is(pattern);
    size_t size = strlen(pattern) + 32, used = 0;
    char *name = malloc(size);
    for (const char *at = pattern; name && *at;) {
        int width;
        if (!filled || *at != '%') {
            name[used++] = *at++;
        } else if (at[1] == '%') {
            name[used++] = '%';
            at += 2;
        } else {
            size_t length = conversion(at, &width);
            used += (size_t)snprintf(name + used, size - used, "%0*lld", width, number);
            at += length;
        }
    }
    if (name) {
        name[used] = '\0';
    }
    return name;
}

bool name_has_extension(const char *name, const char *extension)
{
    const char *dot = strrchr(name, '.');
    return dot && !strchr(dot, '/') && !strcasecmp(dot, extension);
}

static bool is_digit(char c) { return c >= '0' && c <= '9'; }

int natural_compare(const char *a, const char *b)
{
    const char *whole_a = a, *whole_b = b;
    while (*a && *b) {
        if (is_digit(*a) && is_digit(*b)) {
            a += strspn(a, "0");
            b += strspn(b, "0");
            size_t digits_a = strspn(a, "0123456789"), digits_b = strspn(b, "0123456789");
            int order = digits_a != digits_b ? (digits_a < digits_b ? -1 : 1) : strncmp(a, b, digits_a);
            if (order) {
                return order;
            }
            a += digits_a;
            b += digits_b;
        } else if (*a != *b) {
            break;
        } else {
            a++;
            b++;
        }
    }
    int order = (int)(unsigned char)*a - (int)(unsigned char)*b;
    return order ? order : strcmp(whole_a, whole_b);
}
