/* look.h: parameters in a file. */
#ifndef MENISCUS_LOOK_H
#define MENISCUS_LOOK_H

#include <meniscus/params.h>

/* Sets the parameters that the file names. Returns a status; on failure it was told why. */
int look_read(const char *path, struct mns_params *params);

/* Writes the parameters that differ from the defaults. Returns a status. */
int look_write(const char *path, const struct mns_params *params);

#endif
