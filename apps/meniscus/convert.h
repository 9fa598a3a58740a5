/* convert.h: what is known of the particle formats that are written. */
#ifndef MENISCUS_CONVERT_H
#define MENISCUS_CONVERT_H

/* Whether this build writes particles under such a name, or a pattern. Returns a status. */
int convert_check_format(const char *path);

#endif
