/* clock.c: wall time. timespec_get is C11; where POSIX gives a monotonic clock, that one. */
#if !defined(_WIN32)
#define _POSIX_C_SOURCE 200809L
#endif

#include "util/clock.h"

#include <time.h>

double mns_clock_ms(void)
{
    struct timespec now;
#ifdef CLOCK_MONOTONIC
    clock_gettime(CLOCK_MONOTONIC, &now);
#else
    timespec_get(&now, TIME_UTC);
#endif
    return (double)now.tv_sec * 1e3 + (double)now.tv_nsec * 1e-6;
}
