/* survey.c: what is the same for all frames of a sequence. */
#include "survey.h"

#include "coloring.h"
#include "load.h"
#include "program.h"

#include <math.h>
#include <string.h>

enum { FRAMES = 3 };

/* As in the library: with fewer particles the estimated spacing says less about the volume than the radius does. */
enum { SPACING_COUNT = 1000 };

/* The middle one of up to three values above 0; 0: none. */
static double median(double values[FRAMES], int count)
{
    double sorted[FRAMES];
    int used = 0;
    for (int i = 0; i < count; i++) {
        if (values[i] > 0) {
            int at = used++;
            for (; at > 0 && sorted[at - 1] > values[i]; at--) {
                sorted[at] = sorted[at - 1];
            }
            sorted[at] = values[i];
        }
    }
    return used ? sorted[used / 2] : 0;
}

static void merge(struct survey *survey, const struct mns_measure measures[FRAMES], int count)
{
    *survey = (struct survey){0};
    double radii[FRAMES] = {0}, spacings[FRAMES] = {0};
    bool any = false;
    for (int k = 0; k < count; k++) {
        const struct mns_measure *measure = &measures[k];
        radii[k] = measure->radius;
        spacings[k] = measure->spacing;
        survey->count = measure->count > survey->count ? measure->count : survey->count;
        for (int i = 0; i < 3 && measure->count > 0; i++) {
            survey->bounds_min[i] = any ? fmin(survey->bounds_min[i], measure->bounds_min[i]) : measure->bounds_min[i];
            survey->bounds_max[i] = any ? fmax(survey->bounds_max[i], measure->bounds_max[i]) : measure->bounds_max[i];
            survey->inner_min[i] = any ? fmin(survey->inner_min[i], measure->inner_min[i]) : measure->inner_min[i];
            survey->inner_max[i] = any ? fmax(survey->inner_max[i], measure->inner_max[i]) : measure->inner_max[i];
        }
        any = any || measure->count > 0;
    }
    survey->radius = median(radii, count);
    survey->spacing = median(spacings, count);
}

void survey_from_measure(struct survey *survey, const struct mns_measure *measure) { merge(survey, measure, 1); }

/* Widens the range of values by one set's. */
static mns_result add_values(struct survey *survey, const struct options *options, const mns_particle_set *set, const char *path,
                             struct mns_message *message)
{
    double low, high;
    mns_result result = coloring_range(options->color.by, set, path, &low, &high, message);
    if (result == MNS_OK) {
        survey->value_low = fmin(survey->value_low, low);
        survey->value_high = fmax(survey->value_high, high);
    }
    return result;
}

int survey_inputs(struct survey *survey, const struct inputs *inputs, const struct options *options)
{
    const size_t chosen[FRAMES] = {0, (inputs->count - 1) / 2, inputs->count - 1};
    struct options silent = *options; /* the frames are read again, with their warnings, to be drawn */
    silent.quiet = true;
    silent.verbose = false;
    struct mns_measure measures[FRAMES];
    struct mns_message message = {""};
    struct survey values = {.value_low = INFINITY, .value_high = -INFINITY};
    int count = 0;
    for (int k = 0; k < FRAMES; k++) {
        if (k > 0 && chosen[k] == chosen[k - 1]) {
            continue;
        }
        mns_particle_set *set;
        mns_result result = load_particles(&set, inputs->list[chosen[k]].path, &silent, &message);
        if (result == MNS_OK) {
            result = mns_particles_measure(mns_particle_set_particles(set), NULL, &measures[count], &message);
            if (result == MNS_OK && options->color.by) {
                result = add_values(&values, options, set, inputs->list[chosen[k]].path, &message);
            }
            mns_particle_set_destroy(&set);
        }
        count += result == MNS_OK;
    }
    if (count == 0) {
        return program_fail("%s", message.text);
    }
    merge(survey, measures, count);
    survey->value_low = values.value_low;
    survey->value_high = values.value_high;
    return STATUS_DONE;
}

void survey_fix_params(const struct survey *survey, bool own_radii, bool own_volumes, struct mns_params *params)
{
    double radius = params->radius > 0 ? (double)params->radius : survey->radius;
    if (!(radius > 0)) {
        return; /* too few particles anywhere to tell anything */
    }
    double spacing = survey->count >= SPACING_COUNT && survey->spacing > 0 ? survey->spacing : 2 * radius;
    double volume = params->particle_volume > 0 ? (double)params->particle_volume : spacing * spacing * spacing;
    bool given_radii = own_radii && params->radius <= 0;
    bool given_volumes = own_volumes && params->rest_density > 0;
    if (params->floor_height < -1e30f) { /* auto */
        params->floor_height = (float)(survey->bounds_min[params->up_axis] - radius * (double)params->radius_scale);
    }
    if (params->fluid_size <= 0 && !given_volumes) {
        params->fluid_size = (float)cbrt(volume * (double)survey->count);
    }
    if (!given_radii && !given_volumes) {
        params->particle_volume = (float)volume;
    }
    if (!given_radii) {
        params->radius = (float)radius;
    }
}
