/* prefetch.h: cache lines asked for ahead of time. */
#ifndef MNS_UTIL_PREFETCH_H
#define MNS_UTIL_PREFETCH_H

/* Asks for the cache line at an address, which need not be readable. */
static inline void mns_prefetch(const void *address)
{
#ifdef __GNUC__
    __builtin_prefetch(address);
#else
    (void)address;
#endif
}

#endif
