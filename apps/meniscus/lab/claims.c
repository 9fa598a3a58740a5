/* claims.c: what the papers say of the filters, measured. A claim that does not hold is a finding, not a fault. */
#include "report.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void decide(struct lab_claim *claim, bool holds, const char *format, ...)
#ifdef __GNUC__
    __attribute__((format(printf, 3, 4)))
#endif
    ;

static void decide(struct lab_claim *claim, bool holds, const char *format, ...)
{
    va_list arguments;
    claim->holds = holds;
    va_start(arguments, format);
    vsnprintf(claim->numbers, sizeof(claim->numbers), format, arguments);
    va_end(arguments);
}

/* Measures in a scene by its name. */
static mns_result run_in(struct lab *lab, const char *scene, const struct mns_params *params, struct lab_values *out)
{
    mns_result result = lab_enter(lab, lab_scene_find(scene));
    return result == MNS_OK ? lab_run(lab, params, out) : result;
}

/* A measure of a filter, as the settings have it, in a scene. */
struct probe {
    const char *scene;
    enum mns_filter filter;
    enum lab_measure measure;
};

enum { PROBES_MAX = 4 };

static mns_result run_probes(struct lab *lab, const struct probe *probes, int count, double out[PROBES_MAX])
{
    mns_result result = MNS_OK;
    for (int i = 0; i < count; i++) {
        struct lab_values values = lab_values_none();
        struct mns_params params = lab_params(lab, (int)probes[i].filter);
        result = result == MNS_OK ? run_in(lab, probes[i].scene, &params, &values) : result;
        out[i] = values.of[probes[i].measure];
    }
    return result;
}

static mns_result claim_bias(struct lab *lab, struct lab_claim *claim)
{
    static const double times = 2; /* what is bent is worse than that, and what is not is better */
    struct lab_values with = lab_values_none(), without = with;
    struct mns_params params = lab_params(lab, MNS_FILTER_NARROW_RANGE);
    params.bias_correction = 1;
    mns_result result = run_in(lab, "drop-45", &params, &with);
    params.bias_correction = 0;
    result = result == MNS_OK ? run_in(lab, "drop-45", &params, &without) : result;
    double on = with.of[LAB_BESIDE_NORMAL], off = without.of[LAB_BESIDE_NORMAL], elsewhere = with.of[LAB_NORMAL_MEDIAN];
    decide(claim, on < times * elsewhere && off > times * elsewhere,
           "error of the normal beside the drop %.2f deg with it, %.2f deg without, %.2f deg elsewhere (bound: %g times that)", on, off,
           elsewhere, times);
    return result;
}

/* 95 % of the normals of narrow-range on the steepest plane are as good as that, without and with dynamic range. */
static mns_result cracks(struct lab *lab, double delta, double out[2])
{
    struct mns_params params = lab_params(lab, MNS_FILTER_NARROW_RANGE);
    mns_result result = MNS_OK;
    params.delta = (float)delta;
    params.mu = fminf(params.mu, params.delta);
    for (int on = 0; result == MNS_OK && on < 2; on++) {
        struct lab_values values;
        params.dynamic_range = on;
        result = run_in(lab, "plane-80", &params, &values);
        out[on] = values.of[LAB_NORMAL_95];
    }
    return result;
}

static mns_result claim_range(struct lab *lab, struct lab_claim *claim)
{
    static const double times = 1.5, papers = 10, narrow = 3; /* r */
    double wide_range[2] = {NAN, NAN}, narrow_range[2] = {NAN, NAN};
    mns_result result = cracks(lab, papers, wide_range);
    result = result == MNS_OK ? cracks(lab, narrow, narrow_range) : result;
    decide(claim, wide_range[0] > times * wide_range[1],
           "tilt 80 deg, 95 %% of the normals: at delta %g r within %.2f deg with it, %.2f deg without (bound: %g times); at delta %g r "
           "%.2f and "
           "%.2f deg",
           papers, wide_range[1], wide_range[0], times, narrow, narrow_range[1], narrow_range[0]);
    return result;
}

static mns_result claim_rim(struct lab *lab, struct lab_claim *claim)
{
    static const struct probe probes[] = {
        {"drop-0", MNS_FILTER_BILATERAL, LAB_RIM}, {"drop-0", MNS_FILTER_NARROW_RANGE, LAB_RIM}, {"drop-0", MNS_FILTER_NONE, LAB_RIM}};
    static const double half = 0.5; /* of the curvature: less is flattened */
    double rim[PROBES_MAX];
    mns_result result = run_probes(lab, probes, 3, rim);
    decide(claim, rim[0] < half && rim[1] >= half,
           "curvature of the rim times the radius: bilateral %.2f, narrow-range %.2f, unsmoothed %.2f (bound: %g)", rim[0], rim[1], rim[2],
           half);
    return result;
}

static mns_result claim_joined(struct lab *lab, struct lab_claim *claim)
{
    static const struct probe probes[] = {{"drop-0", MNS_FILTER_GAUSSIAN, LAB_BESIDE_DEPTH},
                                          {"drop-0", MNS_FILTER_BILATERAL, LAB_BESIDE_DEPTH},
                                          {"drop-0", MNS_FILTER_NARROW_RANGE, LAB_BESIDE_DEPTH}};
    static const double apart = 1; /* r */
    double error[PROBES_MAX];
    mns_result result = run_probes(lab, probes, 3, error);
    decide(claim, error[0] > apart && error[1] < apart && error[2] < apart,
           "depth error of the plane beside the drop: gaussian %.2f r, bilateral %.2f r, narrow-range %.2f r (bound: %g r)", error[0],
           error[1], error[2], apart);
    return result;
}

static mns_result claim_grazing(struct lab *lab, struct lab_claim *claim)
{
    static const struct probe probes[] = {{"plane-0", MNS_FILTER_BILATERAL, LAB_BUMPS},
                                          {"plane-0", MNS_FILTER_NARROW_RANGE, LAB_BUMPS},
                                          {"plane-80", MNS_FILTER_BILATERAL, LAB_BUMPS},
                                          {"plane-80", MNS_FILTER_NARROW_RANGE, LAB_BUMPS}};
    static const double times = 2;
    double bumps[PROBES_MAX];
    mns_result result = run_probes(lab, probes, 4, bumps);
    decide(claim, bumps[2] > times * bumps[3] && bumps[0] < times * bumps[1],
           "bumps at tilt 0 and 80 deg: bilateral %.2f and %.2f deg, narrow-range %.2f and %.2f deg (bound: %g times)", bumps[0], bumps[2],
           bumps[1], bumps[3], times);
    return result;
}

static mns_result claim_plane_fit(struct lab *lab, struct lab_claim *claim)
{
    static const struct probe probes[] = {{"drop-0", MNS_FILTER_PLANE_FIT, LAB_RIM},
                                          {"drop-0", MNS_FILTER_BILATERAL, LAB_RIM},
                                          {"waves", MNS_FILTER_PLANE_FIT, LAB_BUMPS},
                                          {"waves", MNS_FILTER_CURVATURE_FLOW, LAB_BUMPS}};
    double found[PROBES_MAX];
    mns_result result = run_probes(lab, probes, 4, found);
    decide(claim, found[0] > found[1] && found[2] > found[3],
           "curvature of the rim: plane-fit %.2f, bilateral %.2f; bumps on waves: plane-fit %.2f deg, curvature-flow %.2f deg", found[0],
           found[1], found[2], found[3]);
    return result;
}

/* ---- distance ---- */

/* The part of the unsmoothed surface's bumps that a filter leaves. */
static mns_result bumps_left(struct lab *lab, const char *scene, int filter, double *out)
{
    struct lab_values values = lab_values_none();
    struct mns_params params = lab_params(lab, filter);
    mns_result result = run_in(lab, scene, &params, &values);
    *out = values.of[LAB_BUMPS] / lab->unsmoothed.of[LAB_BUMPS];
    return result;
}

/* Whether the part that a filter leaves of the bumps depends on the distance: over four times the distance, by more than its square root. */
static mns_result test_distance(struct lab *lab, struct lab_claim *claim, int filter, bool depends)
{
    static const double times = 2, smooths = 0.5; /* a filter that leaves more than that of everything tells nothing */
    double near, far = NAN;
    mns_result result = bumps_left(lab, "waves-near", filter, &near);
    result = result == MNS_OK ? bumps_left(lab, "waves-far", filter, &far) : result;
    double ratio = near / far;
    bool same = ratio < times && ratio > 1 / times;
    decide(claim, far < smooths && (depends ? ratio > times : same),
           "bumps left at half the distance %.1f %%, at twice the distance %.1f %%: ratio %.2f (bound: %g)", 100 * near, 100 * far, ratio,
           times);
    return result;
}

static mns_result claim_flow_distance(struct lab *lab, struct lab_claim *claim)
{
    return test_distance(lab, claim, MNS_FILTER_CURVATURE_FLOW, true);
}

static mns_result claim_adaptive_distance(struct lab *lab, struct lab_claim *claim)
{
    return test_distance(lab, claim, MNS_FILTER_ADAPTIVE_CURVATURE_FLOW, false);
}

static mns_result claim_implicit_distance(struct lab *lab, struct lab_claim *claim)
{
    return test_distance(lab, claim, MNS_FILTER_IMPLICIT_CURVATURE_FLOW, false);
}

/* ---- six iterations ---- */

enum { ITERATIONS_MAX = 20 };

/* A bilateral filter on its way to as few bumps as `wanted`. */
struct approach {
    int iterations; /* the first number that gets there; 0: none does */
    double at_six;  /* bumps after six */
};

static mns_result approach(struct lab *lab, int filter, double wanted, struct approach *out)
{
    struct mns_params params = lab_params(lab, filter);
    params.sigma = 0.7f; /* [TY18]; [LGS09] does not say which */
    params.kernel_cut = 3;
    *out = (struct approach){.at_six = NAN};
    mns_result result = MNS_OK;
    for (int i = 1; result == MNS_OK && i <= ITERATIONS_MAX && (!out->iterations || i <= 6); i++) {
        struct lab_values values;
        params.iterations = i;
        result = run_in(lab, "waves", &params, &values);
        out->iterations = !out->iterations && values.of[LAB_BUMPS] <= wanted ? i : out->iterations;
        out->at_six = i == 6 ? values.of[LAB_BUMPS] : out->at_six;
    }
    return result;
}

static mns_result claim_six(struct lab *lab, struct lab_claim *claim)
{
    static const int few = 5, many = 7; /* about six */
    struct mns_params params = lab_params(lab, MNS_FILTER_CURVATURE_FLOW);
    struct lab_values flow = lab_values_none();
    struct approach lines = {0}, square = {0};
    params.iterations = 100; /* [LGS09] table 1, full resolution */
    mns_result result = run_in(lab, "waves", &params, &flow);
    double bumps = flow.of[LAB_BUMPS];
    result = result == MNS_OK ? approach(lab, MNS_FILTER_BILATERAL_1D, bumps, &lines) : result;
    result = result == MNS_OK ? approach(lab, MNS_FILTER_BILATERAL, bumps, &square) : result;
    decide(
        claim, lines.iterations >= few && lines.iterations <= many,
        "bumps after 100 steps of curvature-flow: %.2f deg; bilateral-1d gets there in %d iterations (%.2f deg after 6), bilateral in %d "
        "(%.2f deg after 6); 0: not within %d",
        bumps, lines.iterations, lines.at_six, square.iterations, square.at_six, ITERATIONS_MAX);
    return result;
}

/* ---- the clean-up pass ---- */

/* Root mean square angle between two pictures' normals near the silhouette, degrees. */
static double difference(const struct lab_reference *reference, const float *a, const float *b)
{
    double count = 0, squares = 0, band = 6 * reference->radius;
    for (size_t i = 0; i < (size_t)reference->view.width * (size_t)reference->view.height; i++) {
        if (lab_reference_counts(reference, i) && fabs((double)reference->silhouette[i]) < lab_reference_pixels(reference, i, band)) {
            count++;
            for (size_t k = 3 * i; k < 3 * i + 3; k++) {
                squares += (double)(a[k] - b[k]) * (double)(a[k] - b[k]);
            }
        }
    }
    return sqrt(squares / count) * (180 / 3.14159265358979323846);
}

static mns_result claim_cleanup(struct lab *lab, struct lab_claim *claim)
{
    static const double half = 0.5; /* of what sets rows and columns apart from two dimensions must go */
    size_t floats = 3 * (size_t)lab->settings.width * (size_t)lab->settings.height;
    float *square = malloc(floats * sizeof(*square));
    double away[2] = {NAN, NAN};
    mns_result result = square ? lab_enter(lab, lab_scene_find("drop-45")) : lab_fail(lab, MNS_ERR_OUT_OF_MEMORY);
    for (int filter = MNS_FILTER_NARROW_RANGE; result == MNS_OK && filter <= MNS_FILTER_NARROW_RANGE_1D_CLEANUP; filter++) {
        struct mns_params params = lab_params(lab, filter);
        result = lab_draw(lab, &params, 0, 1, NULL);
        if (result == MNS_OK && filter == MNS_FILTER_NARROW_RANGE) {
            memcpy(square, lab->normal, floats * sizeof(*square));
        } else if (result == MNS_OK) {
            away[filter - MNS_FILTER_NARROW_RANGE_1D] = difference(&lab->reference[0], square, lab->normal);
        }
    }
    free(square);
    decide(claim, away[1] < half * away[0],
           "normals within 6 r of the drop's silhouette differ from those of the 2-D filter by %.2f deg without it, %.2f deg with it "
           "(bound: %g times)",
           away[0], away[1], half);
    return result;
}

/* ---- the list ---- */

static const struct {
    const char *source, *text;
    mns_result (*test)(struct lab *lab, struct lab_claim *claim);
} claims[] = {
    {"[TY18] 3.1", "the Gaussian joins a drop to the surface behind it, bilateral and narrow-range do not", claim_joined},
    {"[TY18] 3.1", "bilateral flattens the rim of a drop, narrow-range does not", claim_rim},
    {"[TY18] 3.2", "an inclined plane bends beside a drop, and bias correction mends it", claim_bias},
    {"[TY18] 3.3", "dynamic range closes the cracks at grazing angles", claim_range},
    {"[TY18] 3.4", "a clean-up pass takes out what rows and columns leave", claim_cleanup},
    {"[TY18] 2", "bilateral leaves surfaces rough at grazing angles", claim_grazing},
    {"[TY18] 2", "plane-fit flattens less than bilateral, and is rougher than curvature flow", claim_plane_fit},
    {"[LGS09] 5", "six bilateral iterations look like curvature flow", claim_six},
    {"[BSW10] 4", "curvature flow smooths far surfaces more than near ones", claim_flow_distance},
    {"[BSW10] 4", "adaptive curvature flow smooths alike at every distance", claim_adaptive_distance},
    {"ours", "implicit curvature flow smooths alike at every distance", claim_implicit_distance},
};

enum { CLAIMS = sizeof(claims) / sizeof(claims[0]) };

size_t lab_claim_runs(void) { return 2 * CLAIMS + 2 * ITERATIONS_MAX; }

mns_result lab_report_claims(struct lab *lab, struct lab_report *report)
{
    report->claims = calloc(CLAIMS, sizeof(*report->claims));
    mns_result result = report->claims ? MNS_OK : lab_fail(lab, MNS_ERR_OUT_OF_MEMORY);
    for (int i = 0; result == MNS_OK && i < CLAIMS; i++) {
        struct lab_claim *claim = &report->claims[i];
        claim->source = claims[i].source;
        claim->text = claims[i].text;
        result = claims[i].test(lab, claim);
        report->claim_count += result == MNS_OK;
    }
    return result;
}
