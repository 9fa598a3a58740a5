/* names.h: what the user may have meant. */
#ifndef MENISCUS_NAMES_H
#define MENISCUS_NAMES_H

#include <stddef.h>

/* Edits that turn a into b (Levenshtein); b has at most 63 characters. */
size_t names_distance(const char *a, const char *b);

#endif
