/* inputs.h: from what the user named to the files of a sequence. */
#ifndef MENISCUS_INPUTS_H
#define MENISCUS_INPUTS_H

#include <stdbool.h>
#include <stddef.h>

struct input {
    char *path;       /* "-" for standard input */
    long long number; /* of the frame */
    double time;      /* seconds, as a .pvd tells; NAN: unknown */
};

struct inputs {
    struct input *list; /* [count] */
    size_t count, capacity;
    bool ordered; /* by a .pvd, so they are not sorted */
};

/* Adds what each name stands for: a file, "-", a directory, a pattern such as frame_%04d.vtk, or the steps of a .pvd. Returns a status;
 * on failure it was told why. inputs_free may always be called. */
int inputs_add(struct inputs *inputs, const char *name);

/* The same of files that may be of several series: a directory stands for all its particle files. Each is numbered by the last number in its name; -1: there
 * is none. */
int inputs_add_all(struct inputs *inputs, const char *name);

/* Sorts naturally by the numbers in the names, and numbers the frames: by the last number in each name where all have one and no two are
 * alike, else 1, 2, 3 ... */
void inputs_number(struct inputs *inputs);

/* Whether the times of all are known, and each is later than the one before. */
bool inputs_timed(const struct inputs *inputs);

void inputs_free(struct inputs *inputs);

/* Whether name is a pattern: exactly one %d or %0Nd, and %% for a percent sign. */
bool pattern_is(const char *name);

/* The name of one frame; the caller frees it. NULL: out of memory. A name that is no pattern comes back as it is. */
char *pattern_name(const char *pattern, long long number);

/* Whether the name ends in the extension, ".png", in capitals or not. */
bool name_has_extension(const char *name, const char *extension);

/* Orders "a_2" before "a_10". */
int natural_compare(const char *a, const char *b);

#endif
