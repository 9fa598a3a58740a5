/* look.h: parameters in a file. */
#ifndef MENISCUS_LOOK_H
#define MENISCUS_LOOK_H

#include <cJSON.h>
#include <meniscus/params.h>

/* Sets the parameters that the file names. Returns a status; on failure it was told why. */
int look_read(const char *path, struct mns_params *params);

/* Writes the parameters that differ from the defaults. Returns a status. */
int look_write(const char *path, const struct mns_params *params);

/* The same as text on one line, which the caller frees. NULL: out of memory. */
char *look_text(const struct mns_params *params);

/* Adds a value that mns_params_get wrote as text, as JSON has it. */
void look_add_value(cJSON *object, const char *name, const struct mns_param *row, const char *text);

/* docs/look.schema.json. Returns a status. */
int look_write_schema(const char *path);

#endif
