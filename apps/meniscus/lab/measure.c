/* measure.c: what is measured on a smoothed surface. */
#include "measure.h"

#include "highpass.h"
#include "vector.h"

#include <stdlib.h>
#include <string.h>

static const double BAND = 3 * 0.7; /* r: three sigma of [TY18], whose effect beside a silhouette is looked for */

const struct lab_measure_info lab_measures[LAB_MEASURES] = {
    [LAB_DRIFT] = {"drift", "drift", "r", "mean depth error"},
    [LAB_DEPTH_RMS] = {"depth_rms", "rms", "r", "root mean square of the depth error"},
    [LAB_DEPTH_WORST] = {"depth_worst", "worst", "r", "largest depth error"},
    [LAB_NORMAL_MEDIAN] = {"normal_median", "normal", "deg", "error of the normal: the median over the pixels"},
    [LAB_NORMAL_95] = {"normal_95", "95 %", "deg", "error of the normal: 95 % of the pixels are better"},
    [LAB_BUMPS] = {"bumps", "bumps", "deg",
                   "what is left of the particles: RMS deviation of the normal, less what is smooth over 1.5 spacings"},
    [LAB_STREAKS] = {"streaks", "streaks", "", "directions of the bumps: 1 along the picture's axes, 0 even, -1 along the diagonals"},
    [LAB_EDGE] = {"edge", "edge", "px", "how far the silhouette moved"},
    [LAB_BESIDE_DEPTH] = {"beside_depth", "beside", "r", "RMS depth error within 3 sigma (2.1 r) beside the silhouette"},
    [LAB_BESIDE_NORMAL] = {"beside_normal", "b-normal", "deg", "median error of the normal there"},
    [LAB_RIM] = {"rim", "rim", "", "curvature of a sphere's rim, times the radius: 1 is right, 0 flat"},
    [LAB_BORDER] = {"border", "border", "deg",
                    "error of the normal within 3.6 r of the picture's edge, where nothing else is measured: 95 % are better"},
    [LAB_DISTANCE] = {"distance", "distance", "",
                      "part of the bumps left at half the distance over that at twice the distance: 1 is right"},
    [LAB_FLICKER_DEPTH] = {"flicker_depth", "flicker", "r", "RMS change of depth when everything moves by a third of a pixel, moved back"},
    [LAB_FLICKER_NORMAL] = {"flicker_normal", "f-normal", "deg", "RMS change of the normal then"},
    [LAB_MS] = {"ms", "ms", "ms", "milliseconds of stage smooth: the least of some draws"},
};

struct lab_values lab_values_none(void)
{
    struct lab_values values;
    for (int i = 0; i < LAB_MEASURES; i++) {
        values.of[i] = NAN;
    }
    return values;
}

static size_t pixel_count(const struct lab_reference *reference) { return (size_t)reference->view.width * (size_t)reference->view.height; }

/* ---- the residual ---- */

bool lab_residual_make(struct lab_residual *out, const struct lab_reference *reference, const float *depth, const float *normal)
{
    size_t pixels = pixel_count(reference);
    *out = (struct lab_residual){.reference = reference, .error = calloc(pixels, sizeof(float))};
    bool good = out->error != NULL;
    for (int k = 0; k < 3; k++) {
        out->turn[k] = calloc(pixels, sizeof(float));
        good = good && out->turn[k];
    }
    for (size_t i = 0; good && i < pixels; i++) {
        if (reference->body[i] >= 0) {
            out->error[i] = (float)((double)(depth[i] - reference->depth[i]) * (double)reference->cosine[i] / reference->radius);
            for (int k = 0; k < 3; k++) {
                out->turn[k][i] = normal[3 * i + (size_t)k] - reference->normal[i][k];
            }
        }
    }
    return good;
}

void lab_residual_free(struct lab_residual *residual)
{
    free(residual->error);
    for (int k = 0; k < 3; k++) {
        free(residual->turn[k]);
    }
    memset(residual, 0, sizeof(*residual));
}

static double turn_squared(const struct lab_residual *residual, size_t i)
{
    double x = (double)residual->turn[0][i], y = (double)residual->turn[1][i], z = (double)residual->turn[2][i];
    return x * x + y * y + z * z;
}

/* The angle between two unit vectors, from the length of their difference. */
static double angle_of(double squared) { return degrees(2 * asin(fmin(0.5 * sqrt(squared), 1))); }

/* ---- quantiles of angles ---- */

enum { BINS = 18000 }; /* of a hundredth of a degree */

struct histogram {
    size_t count, bin[BINS];
};

static void histogram_add(struct histogram *histogram, double angle)
{
    int bin = isfinite(angle) ? (int)(angle * (BINS / 180.0)) : BINS - 1;
    histogram->bin[bin < BINS ? bin : BINS - 1]++;
    histogram->count++;
}

static double histogram_quantile(const struct histogram *histogram, double part)
{
    double wanted = part * (double)histogram->count, seen = 0;
    for (int i = 0; i < BINS; i++) {
        double next = seen + (double)histogram->bin[i];
        if (next >= wanted && histogram->bin[i]) {
            return (i + (wanted - seen) / (next - seen)) * (180.0 / BINS);
        }
        seen = next;
    }
    return NAN; /* nothing was added */
}

/* ---- measures of one picture ---- */

static void measure_depth(const struct lab_residual *residual, struct lab_values *out)
{
    double count = 0, sum = 0, squares = 0, worst = 0;
    for (size_t i = 0; i < pixel_count(residual->reference); i++) {
        if (lab_reference_counts(residual->reference, i)) {
            double error = (double)residual->error[i];
            count++;
            sum += error;
            squares += error * error;
            worst = fabs(error) > worst ? fabs(error) : worst;
        }
    }
    out->of[LAB_DRIFT] = sum / count;
    out->of[LAB_DEPTH_RMS] = sqrt(squares / count);
    out->of[LAB_DEPTH_WORST] = worst;
}

static void measure_normals(const struct lab_residual *residual, struct histogram *angles, struct lab_values *out)
{
    memset(angles, 0, sizeof(*angles));
    for (size_t i = 0; i < pixel_count(residual->reference); i++) {
        if (lab_reference_counts(residual->reference, i)) {
            histogram_add(angles, angle_of(turn_squared(residual, i)));
        }
    }
    out->of[LAB_NORMAL_MEDIAN] = histogram_quantile(angles, 0.5);
    out->of[LAB_NORMAL_95] = histogram_quantile(angles, 0.95);
}

static void measure_border(const struct lab_residual *residual, struct histogram *angles, struct lab_values *out)
{
    memset(angles, 0, sizeof(*angles));
    for (size_t i = 0; i < pixel_count(residual->reference); i++) {
        if (lab_reference_is_told(residual->reference, i) && lab_reference_at_border(residual->reference, i)) {
            histogram_add(angles, angle_of(turn_squared(residual, i)));
        }
    }
    out->of[LAB_BORDER] = histogram_quantile(angles, 0.95); /* NAN where the scene ends before the picture does */
}

/* Pixels whose side of the silhouette changed. */
static void measure_edge(const struct lab_reference *reference, const float *raw, const float *depth, struct lab_values *out)
{
    double moved = 0;
    for (size_t i = 0; i < pixel_count(reference); i++) {
        moved += (raw[i] < reference->split[i]) != (depth[i] < reference->split[i]);
    }
    out->of[LAB_EDGE] = moved / lab_reference_silhouette_length(reference);
}

static void measure_beside(const struct lab_residual *residual, struct histogram *angles, struct lab_values *out)
{
    const struct lab_reference *reference = residual->reference;
    double count = 0, squares = 0;
    memset(angles, 0, sizeof(*angles));
    for (size_t i = 0; i < pixel_count(reference); i++) {
        double away = -(double)reference->silhouette[i];
        if (reference->body[i] == 0 && away < lab_reference_pixels(reference, i, BAND * reference->radius)) {
            count++;
            squares += (double)residual->error[i] * (double)residual->error[i];
            histogram_add(angles, angle_of(turn_squared(residual, i)));
        }
    }
    out->of[LAB_BESIDE_DEPTH] = sqrt(squares / count);
    out->of[LAB_BESIDE_NORMAL] = histogram_quantile(angles, 0.5);
}

/* The tilt of a normal away from the direction to the eye, in the plane of the true normal, radians. */
static double tilt_of(const double normal[3], const double axis[3], const double truth[3])
{
    double radial[3];
    add_scaled(radial, truth, -dot(truth, axis), axis);
    normalise(radial);
    return atan2(dot(normal, radial), dot(normal, axis));
}

/* On a sphere the tilt grows by 1 / radius along the way; so the curvature times the radius is the slope of the tilt over the true tilt, here of the
 * line that fits best. The outermost pixel, whose normal is told from one side only, is left out. */
static void measure_rim(const struct lab_residual *residual, struct lab_values *out)
{
    const struct lab_reference *reference = residual->reference;
    double axis[3] = {0, 0, 1}, n = 0, x = 0, y = 0, xx = 0, xy = 0;
    for (size_t i = 0; i < pixel_count(reference); i++) {
        double inside = (double)reference->silhouette[i];
        if (!lab_reference_is_front(reference, i) || inside < 1 || inside > lab_reference_pixels(reference, i, BAND * reference->radius)) {
            continue;
        }
        double truth[3], normal[3];
        for (int k = 0; k < 3; k++) {
            truth[k] = (double)reference->normal[i][k];
            normal[k] = truth[k] + (double)residual->turn[k][i];
        }
        double right = tilt_of(truth, axis, truth), is = tilt_of(normal, axis, truth);
        n++;
        x += right;
        y += is;
        xx += right * right;
        xy += right * is;
    }
    out->of[LAB_RIM] = (n * xy - x * y) / (n * xx - x * x);
}

/* Where bumps are looked for: everywhere, or on both sides of the silhouette, if there are two. */
static bool is_bumpy_place(const struct lab_reference *reference, size_t i)
{
    return lab_reference_counts(reference, i) &&
           (reference->scene.bodies < 2 ||
            fabs((double)reference->silhouette[i]) < lab_reference_pixels(reference, i, 2 * BAND * reference->radius));
}

/* cos(4 a) of each deviation's direction a in the picture, weighted by its square. */
static bool measure_bumps(const struct lab_residual *residual, struct lab_values *out)
{
    const struct lab_reference *reference = residual->reference;
    struct lab_highpass high;
    if (!lab_highpass_make(&high, residual)) {
        return false;
    }
    double count = 0, squares = 0, fourfold = 0, planar = 0;
    for (size_t i = 0; i < pixel_count(reference); i++) {
        if (is_bumpy_place(reference, i)) {
            double x = (double)high.turn[0][i], y = (double)high.turn[1][i], z = (double)high.turn[2][i];
            double xx = x * x, yy = y * y, sum = xx + yy;
            count++;
            squares += sum + z * z;
            planar += sum;
            fourfold += sum > 0 ? ((xx - yy) * (xx - yy) - 4 * xx * yy) / sum : 0;
        }
    }
    out->of[LAB_BUMPS] = degrees(sqrt(squares / count));
    out->of[LAB_STREAKS] = planar > 0 ? fourfold / planar : 0;
    lab_highpass_free(&high);
    return true;
}

bool lab_measure(const struct lab_residual *residual, const float *raw, const float *depth, struct lab_values *out)
{
    const struct lab_reference *reference = residual->reference;
    unsigned tells = reference->scene.tells;
    struct histogram *angles = malloc(sizeof(*angles));
    if (!angles) {
        return false;
    }
    measure_depth(residual, out);
    measure_normals(residual, angles, out);
    measure_border(residual, angles, out);
    if (tells & LAB_TELLS_EDGE) {
        measure_edge(reference, raw, depth, out);
    }
    if (tells & LAB_TELLS_BESIDE) {
        measure_beside(residual, angles, out);
    }
    if (tells & LAB_TELLS_RIM) {
        measure_rim(residual, out);
    }
    free(angles);
    return measure_bumps(residual, out);
}

/* ---- flicker ---- */

/* Weights of four samples at -1, 0, 1, 2 for the place t in [0, 1): the cubic that goes through them (Catmull and Rom). */
static void cubic_weights(double t, double out[4])
{
    out[0] = 0.5 * t * ((2 - t) * t - 1);
    out[1] = 0.5 * (t * t * (3 * t - 5) + 2);
    out[2] = 0.5 * t * ((4 - 3 * t) * t + 1);
    out[3] = 0.5 * t * t * (t - 1);
}

struct place {
    size_t first, stride; /* of the 4 x 4 samples */
    double across[4], down[4];
};

static double sample(const float *plane, const struct place *place)
{
    double sum = 0;
    for (size_t y = 0; y < 4; y++) {
        for (size_t x = 0; x < 4; x++) {
            sum += place->down[y] * place->across[x] * (double)plane[place->first + y * place->stride + x];
        }
    }
    return sum;
}

/* Whether all samples lie on the body of a pixel of the other picture. */
static bool is_on(const struct lab_reference *reference, const struct place *place, int body)
{
    for (size_t y = 0; y < 4; y++) {
        for (size_t x = 0; x < 4; x++) {
            size_t i = place->first + y * place->stride + x;
            if (reference->body[i] != body || !lab_reference_counts(reference, i)) {
                return false;
            }
        }
    }
    return true;
}

void lab_measure_flicker(const struct lab_residual *from, const struct lab_residual *to, double right, double down, struct lab_values *out)
{
    int width = to->reference->view.width, height = to->reference->view.height;
    int whole_x = (int)floor(-right), whole_y = (int)floor(-down);
    struct place place = {.stride = (size_t)width};
    double count = 0, depth = 0, normal = 0;
    cubic_weights(-right - whole_x, place.across);
    cubic_weights(-down - whole_y, place.down);
    for (int y = 0; y < height; y++) {
        for (int x = 0; x < width; x++) {
            int left = x + whole_x - 1, top = y + whole_y - 1;
            size_t i = (size_t)y * (size_t)width + (size_t)x;
            if (left < 0 || top < 0 || left + 4 > width || top + 4 > height || !lab_reference_counts(to->reference, i)) {
                continue;
            }
            place.first = (size_t)top * (size_t)width + (size_t)left;
            if (is_on(from->reference, &place, to->reference->body[i])) {
                double change = (double)to->error[i] - sample(from->error, &place);
                count++;
                depth += change * change;
                for (int k = 0; k < 3; k++) {
                    double turn = (double)to->turn[k][i] - sample(from->turn[k], &place);
                    normal += turn * turn;
                }
            }
        }
    }
    out->of[LAB_FLICKER_DEPTH] = sqrt(depth / count);
    out->of[LAB_FLICKER_NORMAL] = degrees(sqrt(normal / count));
}
