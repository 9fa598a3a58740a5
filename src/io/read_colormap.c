/* read_colormap.c: colour maps as text: a colour per line. */
#include "core/message.h"
#include "io/reader.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { COLORS_MAX = 65536, LINE_MAX_SIZE = 512 };

struct colors {
    float (*list)[3]; /* [capacity] */
    size_t count, capacity;
    float largest;
};

static bool is_separator(char c) { return c == ' ' || c == '\t' || c == ',' || c == ';' || c == '\r' || c == '\n'; }

/* The numbers of a line, at most 4; -1: something else is there. */
static int take_numbers(const char *line, double out[4])
{
    const char *at = line, *end = line + strcspn(line, "#");
    int count = 0;
    for (;;) {
        while (at < end && is_separator(*at)) {
            at++;
        }
        if (at == end) {
            return count;
        }
        const char *stop = count < 4 ? mns_parse_double(at, end, &out[count]) : NULL;
        if (!stop || (stop < end && !is_separator(*stop))) {
            return -1;
        }
        at = stop;
        count++;
    }
}

static bool add_color(struct colors *colors, const double rgb[3])
{
    if (colors->count == colors->capacity) {
        size_t capacity = colors->capacity ? 2 * colors->capacity : 256;
        float(*grown)[3] = realloc(colors->list, capacity * sizeof(*grown));
        if (!grown) {
            return false;
        }
        colors->list = grown;
        colors->capacity = capacity;
    }
    for (int c = 0; c < 3; c++) {
        float value = (float)rgb[c];
        colors->list[colors->count][c] = value;
        colors->largest = value > colors->largest ? value : colors->largest;
    }
    colors->count++;
    return true;
}

static mns_result read_lines(FILE *file, const char *path, struct colors *colors, struct mns_message *message)
{
    char line[LINE_MAX_SIZE];
    for (int number = 1; fgets(line, sizeof(line), file); number++) {
        double numbers[4];
        int count = take_numbers(line, numbers);
        const double *rgb = count == 4 ? numbers + 1 : numbers;
        if (count == 0) {
            continue;
        }
        bool good = count >= 3 && (strchr(line, '\n') || feof(file));
        for (int c = 0; good && c < 3; c++) {
            good = rgb[c] >= 0 && rgb[c] <= 255;
        }
        if (!good) {
            return mns_fail(message, MNS_ERR_BAD_DATA, "%s: line %d is no colour: three numbers of 0 to 1, or of 0 to 255", path, number);
        }
        if (colors->count == COLORS_MAX) {
            return mns_fail(message, MNS_ERR_BAD_DATA, "%s: has more than %d colours", path, (int)COLORS_MAX);
        }
        if (!add_color(colors, rgb)) {
            return mns_fail(message, MNS_ERR_OUT_OF_MEMORY, "%s: out of memory", path);
        }
    }
    if (ferror(file)) {
        return mns_fail(message, MNS_ERR_IO, "%s: cannot be read: %s", path, strerror(errno ? errno : EIO));
    }
    return MNS_OK;
}

mns_result mns_colormap_read(struct mns_colormap *out, const char *path, struct mns_message *message)
{
    if (!out || !path) {
        return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "mns_colormap_read: out or path is NULL");
    }
    FILE *file = fopen(path, "r");
    if (!file) {
        return mns_fail(message, MNS_ERR_IO, "%s: cannot be opened: %s", path, strerror(errno));
    }
    struct colors colors = {0};
    errno = 0;
    mns_result result = read_lines(file, path, &colors, message);
    fclose(file);
    if (result == MNS_OK && colors.count < 2) {
        result = mns_fail(message, MNS_ERR_BAD_DATA, "%s: has %zu colours; a map needs at least 2", path, colors.count);
    }
    for (size_t i = 0; result == MNS_OK && colors.largest > 1 && i < colors.count; i++) {
        for (int c = 0; c < 3; c++) {
            colors.list[i][c] /= 255;
        }
    }
    result = result == MNS_OK ? mns_colormap_make(out, colors.list[0], colors.count, message) : result;
    free(colors.list);
    return result;
}
