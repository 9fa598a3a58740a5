/* highpass.c: the part of a deviation that changes from particle to particle. The Gaussian is three running means, after which none could
 * tell the difference. */
#include "highpass.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double SMOOTH = 1.5; /* spacings: a particle's bump is gone, a wave of 10 spacings stays */

enum { PASSES = 3 };

/* The running mean of count values `step` apart, 2 reach + 1 of them at a time, 0 beyond the ends. line: room for count values. */
static void mean_line(float *values, size_t step, int count, int reach, double *line)
{
    double sum = 0, scale = 1.0 / (2 * reach + 1);
    for (int i = 0; i < count; i++) {
        line[i] = (double)values[(size_t)i * step];
    }
    for (int i = 0; i < reach && i < count; i++) {
        sum += line[i];
    }
    for (int i = 0; i < count; i++) {
        sum += i + reach < count ? line[i + reach] : 0;
        values[(size_t)i * step] = (float)(sum * scale);
        sum -= i - reach >= 0 ? line[i - reach] : 0;
    }
}

static void blur(float *plane, int width, int height, int reach, double *line)
{
    for (int pass = 0; pass < PASSES; pass++) {
        for (int y = 0; y < height; y++) {
            mean_line(plane + (size_t)y * (size_t)width, 1, width, reach, line);
        }
        for (int x = 0; x < width; x++) {
            mean_line(plane + x, (size_t)width, height, reach, line);
        }
    }
}

/* Takes the smooth part out of a plane. weight: 1 where pixels count, blurred: weight blurred; low: room for a plane. */
static void subtract_smooth(float *plane, const float *weight, const float *blurred, const struct lab_view *view, int reach, float *low,
                            double *line)
{
    size_t pixels = (size_t)view->width * (size_t)view->height;
    for (size_t i = 0; i < pixels; i++) {
        low[i] = weight[i] > 0 ? plane[i] : 0;
    }
    blur(low, view->width, view->height, reach, line);
    for (size_t i = 0; i < pixels; i++) {
        plane[i] = weight[i] > 0 ? plane[i] - low[i] / blurred[i] : 0;
    }
}

bool lab_highpass_make(struct lab_highpass *out, const struct lab_residual *residual)
{
    const struct lab_reference *reference = residual->reference;
    const struct lab_view *view = &reference->view;
    size_t pixels = (size_t)view->width * (size_t)view->height;
    float *weight = malloc(pixels * sizeof(float)), *blurred = malloc(pixels * sizeof(float)), *low = malloc(pixels * sizeof(float));
    double *line = malloc((size_t)(view->width > view->height ? view->width : view->height) * sizeof(double));
    /* Means over 2 n + 1 values have variance n (n + 1) / 3 each. */
    int reach = (int)lround(SMOOTH * view->focal / reference->scene.distance - 0.5);
    bool good = weight && blurred && low && line;
    memset(out, 0, sizeof(*out));
    for (size_t i = 0; good && i < pixels; i++) {
        weight[i] = blurred[i] = lab_reference_counts(reference, i) ? 1 : 0;
    }
    if (good) {
        blur(blurred, view->width, view->height, reach, line);
    }
    for (int k = 0; good && k < 3; k++) {
        out->turn[k] = malloc(pixels * sizeof(float));
        good = out->turn[k] != NULL;
        if (good) {
            memcpy(out->turn[k], residual->turn[k], pixels * sizeof(float));
            subtract_smooth(out->turn[k], weight, blurred, view, reach, low, line);
        }
    }
    free(line);
    free(weight);
    free(blurred);
    free(low);
    return good;
}

void lab_highpass_free(struct lab_highpass *high)
{
    for (int k = 0; k < 3; k++) {
        free(high->turn[k]);
    }
    memset(high, 0, sizeof(*high));
}
