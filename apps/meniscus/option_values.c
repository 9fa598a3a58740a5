/* option_values.c: values of options, and words on those that are wrong. */
#include "option_values.h"

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

bool option_refuse(struct mns_message *message, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message->text, sizeof(message->text), format, arguments);
    va_end(arguments);
    return false;
}

void option_append_name(char *list, size_t size, const char *name)
{
    size_t used = strlen(list);
    snprintf(list + used, size - used, "%s%s", used ? ", " : "", name);
}

bool option_numbers(const char *text, int count, double *out)
{
    for (int i = 0; i < count; i++) {
        char *end;
        out[i] = strtod(text, &end);
        if (end == text || !isfinite(out[i]) || *end != (i + 1 < count ? ',' : '\0')) {
            return false;
        }
        text = end + 1;
    }
    return true;
}

bool option_whole(const char *text, long long low, long long high, long long *out, const char **end)
{
    char *stop;
    errno = 0;
    if (*text != '-' && (*text < '0' || *text > '9')) { /* strtoll takes blanks and a plus */
        return false;
    }
    *out = strtoll(text, &stop, 10);
    *end = stop;
    return stop != text && errno == 0 && *out >= low && *out <= high;
}

bool option_count(const char *text, long long low, long long high, long long *out)
{
    const char *end;
    return option_whole(text, low, high, out, &end) && !*end;
}
