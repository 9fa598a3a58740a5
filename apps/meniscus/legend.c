/* legend.c: the colour bar of --legend. */
#include "legend.h"

#include "font.h"
#include "program.h"

#include <math.h>
#include <stdio.h>

enum { TICKS_MAX = 12, TICKS_WANTED = 5 };

static const float white[3] = {1, 1, 1}, dark[3] = {0.06f, 0.07f, 0.08f};
static const float PLATE = 0.62f;                        /* how much of the picture the plate behind it hides */
static const float TEXT = 0.022f, TEXT_LEAST = 7;        /* height of a capital: of the picture's, and in pixels */
static const float BAR_HEIGHT = 0.36f, BAR_WIDTH = 1.3f; /* of the picture's height; in capitals */

struct ticks {
    int count;
    double values[TICKS_MAX];
    char texts[TICKS_MAX][24];
};

/* 1, 2 or 5 times a power of ten: as many steps in the extent as are wanted, or some more. */
static double nice_step(double extent)
{
    double rough = extent / TICKS_WANTED, power = pow(10, floor(log10(rough))), times = rough / power;
    return power * (times < 1.5 ? 1 : times < 3.5 ? 2 : times < 7.5 ? 5 : 10);
}

static void write_tick(char text[24], double value, double step, double largest)
{
    int digits = (int)fmax(0, -floor(log10(step) + 1e-9));
    if (largest >= 1e6 || digits > 4) {
        snprintf(text, 24, "%.3g", value);
    } else {
        snprintf(text, 24, "%.*f", digits, fabs(value) < 1e-9 * step ? 0 : value);
    }
}

static void make_ticks(struct ticks *ticks, double one, double two)
{
    double low = fmin(one, two), high = fmax(one, two), extent = high - low, largest = fmax(fabs(low), fabs(high));
    ticks->count = 0;
    if (!isfinite(extent)) {
        return;
    }
    if (!(extent > 1e-9 * largest)) { /* one value, or none that can be told apart */
        ticks->values[ticks->count] = low;
        snprintf(ticks->texts[ticks->count++], 24, "%.6g", low);
        return;
    }
    double step = nice_step(extent);
    for (double k = ceil(low / step - 1e-6); k * step <= high + 1e-6 * step && ticks->count < TICKS_MAX; k++) {
        ticks->values[ticks->count] = k * step;
        write_tick(ticks->texts[ticks->count++], k * step, step, largest);
    }
}

static void fill(const struct mns_image *image, float left, float top, float right, float bottom, const float srgb[3], float cover)
{
    for (int y = (int)floorf(top); y < (int)ceilf(bottom); y++) {
        for (int x = (int)floorf(left); x < (int)ceilf(right); x++) {
            float inside_x = fminf(right, (float)x + 1) - fmaxf(left, (float)x),
                  inside_y = fminf(bottom, (float)y + 1) - fmaxf(top, (float)y);
            font_blend(image, x, y, srgb, cover * inside_x * inside_y);
        }
    }
}

static float srgb_from_linear(float v) { return v <= 0.0031308f ? 12.92f * v : 1.055f * powf(v, 1 / 2.4f) - 0.055f; }

/* The map from bottom to top, row by row. */
static void fill_bar(const struct mns_image *image, const struct mns_colormap *map, float left, float top, float right, float bottom)
{
    for (int y = (int)floorf(top); y < (int)ceilf(bottom); y++) {
        double part = fmin(fmax((double)(bottom - (float)y - 0.5f) / (double)(bottom - top), 0), 1);
        float linear[3], srgb[3];
        mns_colormap_apply(map, &part, 1, 0, 1, linear);
        for (int c = 0; c < 3; c++) {
            srgb[c] = srgb_from_linear(linear[c]);
        }
        fill(image, left, fmaxf(top, (float)y), right, fminf(bottom, (float)y + 1), srgb, 1);
    }
}

struct layout {
    float text, line;               /* height of a capital, width of a line; pixels */
    float left, top, right, bottom; /* the plate */
    float bar_left, bar_top, bar_bottom;
    float title_baseline, labels; /* where the labels begin */
};

static struct layout lay_out(const struct mns_image *image, const struct ticks *ticks, const char *title)
{
    float width = (float)image->width, height = (float)image->height, text = fmaxf(TEXT * height, TEXT_LEAST);
    float labels = 0, pad = 0.9f * text;
    for (int i = 0; i < ticks->count; i++) {
        labels = fmaxf(labels, font_width(ticks->texts[i], text));
    }
    float inside = fmaxf(font_width(title, text), (BAR_WIDTH + 1.2f) * text + labels);
    struct layout at = {.text = text, .line = fmaxf(1, roundf(0.1f * text))};
    at.right = width - 1.2f * text;
    at.left = at.right - inside - 2 * pad;
    at.bottom = 0.5f * height * (1 + BAR_HEIGHT) + 2 * text;
    at.bar_bottom = at.bottom - 1.5f * pad;
    at.bar_top = at.bar_bottom - BAR_HEIGHT * height;
    at.title_baseline = at.bar_top - 1.4f * text;
    at.top = at.title_baseline - text - pad;
    at.bar_left = at.left + pad;
    at.labels = at.bar_left + (BAR_WIDTH + 1.2f) * text;
    return at;
}

static bool draw_on(const struct mns_image *image, const struct coloring *coloring, const struct painted *painted)
{
    char title[160];
    struct ticks ticks;
    const char *unit = coloring_unit(coloring->options);
    snprintf(title, sizeof(title), *unit ? "%.120s (%.30s)" : "%.120s%s", coloring->options->by, unit);
    make_ticks(&ticks, painted->low, painted->high);
    const struct layout at = lay_out(image, &ticks, title);
    float bar_right = at.bar_left + BAR_WIDTH * at.text;
    fill(image, at.left, at.top, at.right, at.bottom, dark, PLATE);
    fill(image, at.bar_left - at.line, at.bar_top - at.line, bar_right + at.line, at.bar_bottom + at.line, white, 1);
    fill_bar(image, &coloring->map, at.bar_left, at.bar_top, bar_right, at.bar_bottom);
    bool good = font_draw(image, title, at.bar_left, at.title_baseline, at.text, white);
    for (int i = 0; good && i < ticks.count; i++) {
        double extent = painted->high - painted->low, part = extent != 0 ? (ticks.values[i] - painted->low) / extent : 0.5;
        float y = at.bar_bottom - (float)part * (at.bar_bottom - at.bar_top);
        fill(image, bar_right, y - 0.5f * at.line, bar_right + 0.6f * at.text, y + 0.5f * at.line, white, 1);
        good = font_draw(image, ticks.texts[i], at.labels, y + 0.5f * at.text, at.text, white);
    }
    return good;
}

int legend_draw(const struct coloring *coloring, const struct painted *painted, const struct mns_output *images, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        if (images[i].layer == MNS_LAYER_BEAUTY && !draw_on(&images[i].image, coloring, painted)) {
            return program_fail("out of memory for the legend");
        }
    }
    return STATUS_DONE;
}
