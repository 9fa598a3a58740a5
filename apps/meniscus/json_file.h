/* json_file.h: JSON files in and out. */
#ifndef MENISCUS_JSON_FILE_H
#define MENISCUS_JSON_FILE_H

#include <cjson/cJSON.h>
#include <stdbool.h>

/* Reads a file whose top is an object. NULL after telling why. The caller frees it with cJSON_Delete. */
cJSON *json_read(const char *path);

/* Prints to path, "-" for standard output, and deletes json. Returns a status. json NULL: out of memory. */
int json_write(const char *path, cJSON *json);

/* Takes count finite numbers from object[name], an array, or a number where count is 1. false: told why. Absent: *has is false. */
bool json_numbers(const char *path, const cJSON *object, const char *name, int count, double *out, bool *has);

/* A number as short as reads back to the same; null where it is not finite. Adds to an object (name) or an array (name NULL). */
void json_add_number(cJSON *parent, const char *name, double value);
void json_add_vector(cJSON *object, const char *name, const double value[3]);

#endif
