/* coloring.c: colours of particles by a number that each has. */
#include "coloring.h"

#include "program.h"
#include "survey.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SAMPLE = 65536 /* values that a range is taken from */ };

static const double OUTER = 0.005; /* part of the values on each side that are beyond the range */

int coloring_begin(struct coloring *coloring, const struct options *options)
{
    *coloring = (struct coloring){.options = &options->color};
    const char *map = options->color.map ? options->color.map : "viridis";
    struct mns_message message;
    bool is_file = strchr(map, '.') || strchr(map, '/');
    mns_result result = is_file ? mns_colormap_read(&coloring->map, map, &message) : mns_colormap_find(&coloring->map, map, &message);
    if (result != MNS_OK) {
        return is_file ? program_fail("%s", message.text) : program_usage("--colormap: %s, and files", message.text);
    }
    return STATUS_DONE;
}

void coloring_survey(struct coloring *coloring, const struct survey *survey)
{
    const struct color_options *options = coloring->options;
    coloring->fixed = survey || (options->has_low && options->has_high);
    coloring->low = options->has_low ? options->low : survey ? survey->value_low : 0;
    coloring->high = options->has_high ? options->high : survey ? survey->value_high : 0;
}

static int compare(const void *a, const void *b)
{
    double one = *(const double *)a, two = *(const double *)b;
    return (one > two) - (one < two);
}

/* Leaves the sample's values in values. Returns how many are numbers. */
static size_t take_sample(double *values, size_t count)
{
    size_t step = count / SAMPLE + 1, kept = 0;
    for (size_t i = 0; i < count; i += step) {
        if (isfinite(values[i])) {
            values[kept++] = values[i];
        }
    }
    return kept;
}

static void range_of(double *values, size_t count, double *low, double *high)
{
    size_t kept = take_sample(values, count);
    *low = INFINITY;
    *high = -INFINITY;
    if (kept > 0) {
        size_t outer = (size_t)(OUTER * (double)kept);
        qsort(values, kept, sizeof(*values), compare);
        *low = values[outer];
        *high = values[kept - 1 - outer];
    }
}

static double *values_of(const char *expression, const mns_particle_set *set, const char *name, mns_result *result,
                         struct mns_message *message)
{
    size_t count = mns_particle_set_particles(set)->count;
    double *values = malloc((count ? count : 1) * sizeof(*values));
    *result = values ? mns_particle_set_evaluate(set, name, expression, values, message) : MNS_ERR_OUT_OF_MEMORY;
    if (!values) {
        snprintf(message->text, sizeof(message->text), "%s: out of memory for the values of %zu particles", name, count);
    }
    if (*result != MNS_OK) {
        free(values);
        return NULL;
    }
    return values;
}

mns_result coloring_range(const char *expression, const mns_particle_set *set, const char *name, double *low, double *high,
                          struct mns_message *message)
{
    mns_result result;
    double *values = values_of(expression, set, name, &result, message);
    if (values) {
        range_of(values, mns_particle_set_particles(set)->count, low, high);
        free(values);
    }
    return result;
}

/* The range that one frame gives where there is no sequence's. */
static mns_result own_range(const struct coloring *coloring, const mns_particle_set *set, const char *name, struct painted *painted,
                            struct mns_message *message)
{
    const struct color_options *options = coloring->options;
    mns_result result = coloring_range(options->by, set, name, &painted->low, &painted->high, message);
    painted->low = options->has_low ? options->low : painted->low;
    painted->high = options->has_high ? options->high : painted->high;
    return result;
}

mns_result coloring_paint(const struct coloring *coloring, const mns_particle_set *set, const char *name, struct painted *painted,
                          struct mns_particles *particles, struct mns_message *message)
{
    *painted = (struct painted){.low = coloring->low, .high = coloring->high};
    mns_result result = coloring->fixed ? MNS_OK : own_range(coloring, set, name, painted, message);
    double *values = result == MNS_OK ? values_of(coloring->options->by, set, name, &result, message) : NULL;
    if (!values) {
        return result;
    }
    painted->colors = malloc((particles->count ? particles->count : 1) * 3 * sizeof(*painted->colors));
    if (painted->colors) {
        mns_colormap_apply(&coloring->map, values, particles->count, painted->low, painted->high, painted->colors);
        particles->color = (struct mns_attr){.data = painted->colors, .type = MNS_F32};
    } else {
        snprintf(message->text, sizeof(message->text), "%s: out of memory for the colours of %zu particles", name, particles->count);
        result = MNS_ERR_OUT_OF_MEMORY;
    }
    free(values);
    return result;
}

void painted_free(struct painted *painted)
{
    free(painted->colors);
    *painted = (struct painted){0};
}

const char *coloring_unit(const struct color_options *options)
{
    static const struct {
        const char *name, *unit;
    } units[] = {{"velocity", "m/s"}, {"density", "kg/m^3"}, {"radius", "m"}, {"mass", "kg"}, {"position", "m"}, {"x", "m"}, {"y", "m"},
                 {"z", "m"}};
    size_t length = strcspn(options->by, ".");
    for (size_t i = 0; !options->units && i < sizeof(units) / sizeof(units[0]); i++) {
        if (strlen(units[i].name) == length && !strncmp(units[i].name, options->by, length)) {
            return units[i].unit;
        }
    }
    return options->units ? options->units : "";
}
