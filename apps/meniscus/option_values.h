/* option_values.h: values of options, and words on those that are wrong. */
#ifndef MENISCUS_OPTION_VALUES_H
#define MENISCUS_OPTION_VALUES_H

#include <meniscus/common.h>

#include <stdbool.h>

/* Fills message; returns false. */
bool option_refuse(struct mns_message *message, const char *format, ...)
#ifdef __GNUC__
    __attribute__((format(printf, 2, 3)))
#endif
    ;

/* Adds a name to a list with commas between; what finds no room is cut. */
void option_append_name(char *list, size_t size, const char *name);

/* Finite numbers with commas between, as many as asked for. */
bool option_numbers(const char *text, int count, double *out);

/* A whole number in the range at the start of the text. *end: behind it. */
bool option_whole(const char *text, long long low, long long high, long long *out, const char **end);

/* A whole number in the range. */
bool option_count(const char *text, long long low, long long high, long long *out);

#endif
