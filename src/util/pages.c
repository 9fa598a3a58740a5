/* pages.c: large pages for large blocks. Linux-only: madvise(MADV_HUGEPAGE); elsewhere blocks stay as they are.
 * Planes are walked along columns and chunks in any order: with pages of 2 MiB the pixel stages gain 10 to 15 %. */
#if defined(__linux__)
#define _DEFAULT_SOURCE
#endif

#include "util/pages.h"

#if defined(__linux__)
#include <sys/mman.h>
#endif

enum { LINE = 64 };
static const size_t LARGE_PAGE = (size_t)2 << 20;

/* Smaller blocks would waste too much of their last page. */
static const size_t LARGE_BLOCK = (size_t)4 << 20;

size_t mns_pages_alignment(size_t size) { return size >= LARGE_BLOCK ? LARGE_PAGE : LINE; }

void mns_pages_advise(void *block, size_t size)
{
#if defined(__linux__) && defined(MADV_HUGEPAGE)
    if (size >= LARGE_BLOCK) {
        madvise(block, size / LARGE_PAGE * LARGE_PAGE, MADV_HUGEPAGE); /* a hint: refusal changes nothing */
    }
#else
    (void)block;
    (void)size;
#endif
}
