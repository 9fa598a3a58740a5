/* sweep.c: what filters cost and bring with other settings, so that they can be compared at equal time. */
#include "report.h"

#include <math.h>
#include <stdlib.h>

/* Multiples of the settings' sigma, and numbers of iterations; each filter has some of either. 0 ends a list. */
static const double sigmas[] = {0.5, 0.7, 1, 1.4, 0};
static const double own_sigma[] = {1, 0};
static const int passes[] = {1, 2, 3, 4, 6, 0}; /* 6: the most of [LGS09] table 2 */
static const int steps[] = {10, 15, 25, 40, 70, 100, 200, 0};
static const int splittings[] = {1, 2, 4, 6, 0};
static const int own_number[] = {-1, 0};

struct ladder {
    const int *iterations;
    const double *sigmas;
    float *sigma; /* the parameter that the multiples change; NULL: none */
};

static struct ladder ladder_of(struct mns_params *params)
{
    switch (params->filter) {
    case MNS_FILTER_NONE: return (struct ladder){own_number, own_sigma, NULL};
    case MNS_FILTER_CURVATURE_FLOW: return (struct ladder){steps, own_sigma, NULL};
    case MNS_FILTER_ADAPTIVE_CURVATURE_FLOW: return (struct ladder){own_number, sigmas, &params->flow_sigma};
    case MNS_FILTER_IMPLICIT_CURVATURE_FLOW: return (struct ladder){splittings, sigmas, &params->flow_sigma};
    default: return (struct ladder){passes, sigmas, &params->sigma};
    }
}

static size_t ladder_length(const struct ladder *ladder)
{
    size_t iterations = 0, multiples = 0;
    while (ladder->iterations[iterations]) {
        iterations++;
    }
    while (ladder->sigmas[multiples] > 0) {
        multiples++;
    }
    return iterations * multiples;
}

size_t lab_point_runs(const struct lab_selection *selection)
{
    size_t runs = 0;
    for (int filter = 0; filter < lab_filter_count(); filter++) {
        struct mns_params params = {.filter = filter};
        struct ladder ladder = ladder_of(&params);
        runs += lab_selected(selection->filters, filter) ? ladder_length(&ladder) : 0;
    }
    return runs;
}

static mns_result add_point(struct lab *lab, const struct mns_params *params, double sigma, struct lab_report *report)
{
    struct lab_values values;
    mns_result result = lab_run(lab, params, &values);
    report->points[report->point_count] = (struct lab_point){.filter = params->filter,
                                                             .iterations = params->iterations,
                                                             .sigma = sigma,
                                                             .ms = values.of[LAB_MS],
                                                             .normal = values.of[LAB_NORMAL_MEDIAN],
                                                             .bumps = values.of[LAB_BUMPS]};
    report->point_count += result == MNS_OK;
    return result;
}

static mns_result sweep_filter(struct lab *lab, int filter, struct lab_report *report)
{
    mns_result result = MNS_OK;
    struct mns_params params = lab_params(lab, filter);
    struct ladder ladder = ladder_of(&params);
    float sigma = ladder.sigma ? *ladder.sigma : 0;
    for (const double *multiple = ladder.sigmas; *multiple > 0; multiple++) {
        for (const int *number = ladder.iterations; result == MNS_OK && *number; number++) {
            params.iterations = *number > 0 ? *number : lab->settings.params.iterations;
            if (ladder.sigma) {
                *ladder.sigma = (float)(*multiple * (double)sigma);
            }
            result = add_point(lab, &params, ladder.sigma ? (double)*ladder.sigma : (double)NAN, report);
        }
    }
    return result;
}

static void mark_best(struct lab_report *report)
{
    for (size_t i = 0; i < report->point_count; i++) {
        struct lab_point *point = &report->points[i];
        point->best = true;
        for (size_t j = 0; j < report->point_count; j++) {
            const struct lab_point *other = &report->points[j];
            point->best = point->best && !(other->filter == point->filter && other->ms <= point->ms && other->normal < point->normal);
        }
    }
}

mns_result lab_report_points(struct lab *lab, const struct lab_selection *selection, struct lab_report *report)
{
    report->points = calloc(lab_point_runs(selection) + 1, sizeof(*report->points));
    mns_result result = report->points ? lab_enter(lab, lab_scene_find("waves")) : lab_fail(lab, MNS_ERR_OUT_OF_MEMORY);
    for (int filter = 0; result == MNS_OK && filter < lab_filter_count(); filter++) {
        result = lab_selected(selection->filters, filter) ? sweep_filter(lab, filter, report) : MNS_OK;
    }
    mark_best(report);
    return result;
}
