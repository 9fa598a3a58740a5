/* json_file.c: JSON files in and out (cJSON). */
#include "json_file.h"

#include "program.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { FILE_MAX = 16 << 20 /* bytes; a camera per frame of a long film takes a tenth */ };

/* The whole file with a NUL behind it, or NULL after telling why. */
static char *load(const char *path, size_t *size)
{
    FILE *file = fopen(path, "rb");
    if (!file) {
        program_fail("%s: cannot be opened: %s", path, strerror(errno));
        return NULL;
    }
    char *text = NULL;
    size_t capacity = 0, used = 0, got;
    do {
        capacity = capacity ? 2 * capacity : 1 << 14;
        char *grown = capacity <= FILE_MAX ? realloc(text, capacity + 1) : NULL;
        if (!grown) {
            program_fail("%s: is too large for a JSON file of ours (%d bytes)", path, (int)FILE_MAX);
            free(text);
            fclose(file);
            return NULL;
        }
        text = grown;
        errno = 0;
        got = fread(text + used, 1, capacity - used, file);
        used += got;
    } while (used == capacity);
    if (ferror(file)) {
        program_fail("%s: cannot be read: %s", path, strerror(errno ? errno : EIO));
        free(text);
        text = NULL;
    } else {
        text[used] = '\0';
        *size = used;
    }
    fclose(file);
    return text;
}

cJSON *json_read(const char *path)
{
    size_t size;
    char *text = load(path, &size);
    if (!text) {
        return NULL;
    }
    const char *end = NULL;
    cJSON *json = cJSON_ParseWithLengthOpts(text, size + 1, &end, 1);
    if (!json) {
        int line = 1;
        for (const char *at = text; at < end; at++) {
            line += *at == '\n';
        }
        program_fail("%s: line %d: is no JSON", path, line);
    } else if (!cJSON_IsObject(json)) {
        program_fail("%s: must hold a JSON object { ... }", path);
        cJSON_Delete(json);
        json = NULL;
    }
    free(text);
    return json;
}

int json_write(const char *path, cJSON *json)
{
    char *text = json ? cJSON_Print(json) : NULL;
    cJSON_Delete(json);
    size_t length = text ? strlen(text) : 0;
    char *line = text ? realloc(text, length + 2) : NULL;
    if (!line) {
        cJSON_free(text);
        return program_fail("%s: out of memory", path);
    }
    memcpy(line + length, "\n", 2);
    int status = program_write_file(path, line);
    free(line);
    return status;
}

bool json_numbers(const char *path, const cJSON *object, const char *name, int count, double *out, bool *has)
{
    const cJSON *value = cJSON_GetObjectItemCaseSensitive(object, name);
    *has = value != NULL;
    if (!value) {
        return true;
    }
    bool good = count == 1 ? cJSON_IsNumber(value) : cJSON_IsArray(value) && cJSON_GetArraySize(value) == count;
    for (int i = 0; good && i < count; i++) {
        const cJSON *item = count == 1 ? value : cJSON_GetArrayItem(value, i);
        good = cJSON_IsNumber(item) && isfinite(item->valuedouble);
        out[i] = good ? item->valuedouble : 0;
    }
    if (!good && count == 1) {
        program_fail("%s: \"%s\" must be a number", path, name);
    } else if (!good) {
        program_fail("%s: \"%s\" must be an array of %d numbers", path, name, count);
    }
    return good;
}

void json_add_number(cJSON *parent, const char *name, double value)
{
    char text[32] = "null";
    int fewest = fabs(value) < 1e15 && value == floor(value) ? 15 : 6; /* whole numbers without an exponent */
    for (int digits = fewest; isfinite(value) && digits <= 17; digits++) {
        snprintf(text, sizeof(text), "%.*g", digits, value);
        if (strtod(text, NULL) == value) {
            break;
        }
    }
    cJSON *item = cJSON_CreateRaw(text);
    if (name) {
        cJSON_AddItemToObject(parent, name, item);
    } else {
        cJSON_AddItemToArray(parent, item);
    }
}

void json_add_vector(cJSON *object, const char *name, const double value[3])
{
    cJSON *array = cJSON_AddArrayToObject(object, name);
    for (int i = 0; i < 3; i++) {
        json_add_number(array, NULL, value[i]);
    }
}
