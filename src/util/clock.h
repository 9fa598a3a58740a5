/* clock.h: wall time. */
#ifndef MNS_UTIL_CLOCK_H
#define MNS_UTIL_CLOCK_H

double mns_clock_ms(void); /* monotonic, from an arbitrary start */

#endif
