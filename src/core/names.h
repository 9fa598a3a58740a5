/* names.h: what the caller may have meant. */
#ifndef MNS_CORE_NAMES_H
#define MNS_CORE_NAMES_H

/* Edits that turn a into b (Levenshtein), for names b of up to 63 characters. */
int mns_name_distance(const char *a, const char *b);

#endif
