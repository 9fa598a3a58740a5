/* pages.h: large pages for large blocks. */
#ifndef MNS_UTIL_PAGES_H
#define MNS_UTIL_PAGES_H

#include <stddef.h>

/* Alignment that a block of this size should have: a large page where it pays, else 64, a cache line and the widest vector. */
size_t mns_pages_alignment(size_t size);

/* Asks the system for large pages under a block aligned as above; does nothing where there are none. */
void mns_pages_advise(void *block, size_t size);

#endif
