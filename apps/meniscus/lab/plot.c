/* plot.c: error against time, as SVG. */
#include "plot.h"

#include <math.h>
#include <stdlib.h>

/* The paper and what is left around the axes, in SVG's pixels. */
static const double WIDTH = 960, HEIGHT = 560, LEFT = 70, RIGHT = 270, TOP = 50, BOTTOM = 60;

/* Colours that differ to most eyes (Okabe and Ito), then dashes. */
static const char *const colors[] = {"#000000", "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#7f7f7f"};
enum { COLORS = sizeof(colors) / sizeof(colors[0]) };

static const double FASTEST = 0.01; /* ms: what is less is no filter, and has no place on an axis of powers */

struct axes {
    double ms[2], error[2]; /* lowest and highest of what is shown */
};

static bool is_shown(const struct lab_point *point) { return point->ms >= FASTEST && point->normal > 0; }

static void widen(double range[2], double value)
{
    range[0] = fmin(range[0], value);
    range[1] = fmax(range[1], value);
}

static struct axes axes_of(const struct lab_report *report)
{
    struct axes axes = {{INFINITY, 0}, {INFINITY, 0}};
    for (size_t i = 0; i < report->point_count; i++) {
        if (is_shown(&report->points[i])) {
            widen(axes.ms, report->points[i].ms);
            widen(axes.error, report->points[i].normal);
        }
    }
    if (axes.ms[1] <= 0) { /* nothing to show */
        return (struct axes){{1, 10}, {1, 10}};
    }
    static const double room = 1.15; /* beyond the outermost points */
    axes.ms[0] /= room;
    axes.ms[1] *= room;
    axes.error[0] /= room;
    axes.error[1] *= room;
    return axes;
}

static double place(const double range[2], double value) { return log(value / range[0]) / log(range[1] / range[0]); }

static double across(const struct axes *axes, double ms) { return LEFT + place(axes->ms, ms) * (WIDTH - LEFT - RIGHT); }

static double up(const struct axes *axes, double error) { return HEIGHT - BOTTOM - place(axes->error, error) * (HEIGHT - TOP - BOTTOM); }

/* Lines at 1, 2 and 5 times the powers of ten. */
static void write_grid(FILE *out, const struct axes *axes)
{
    static const double steps[] = {1, 2, 5};
    for (int power = -2; power < 5; power++) {
        for (int i = 0; i < 3; i++) {
            double value = steps[i] * pow(10, power), x = across(axes, value), y = up(axes, value);
            if (value > axes->ms[0] && value < axes->ms[1]) {
                fprintf(out, "<path class='grid' d='M%.1f %.1fV%.1f'/><text x='%.1f' y='%.1f' text-anchor='middle'>%g</text>\n", x, TOP,
                        HEIGHT - BOTTOM, x, HEIGHT - BOTTOM + 18, value);
            }
            if (value > axes->error[0] && value < axes->error[1]) {
                fprintf(out, "<path class='grid' d='M%.1f %.1fH%.1f'/><text x='%.1f' y='%.1f' text-anchor='end'>%g</text>\n", LEFT, y,
                        WIDTH - RIGHT, LEFT - 8, y + 4, value);
            }
        }
    }
}

static int compare_time(const void *a, const void *b)
{
    double x = ((const struct lab_point *)a)->ms, y = ((const struct lab_point *)b)->ms;
    return x < y ? -1 : x > y;
}

/* A filter's best settings by rising time, into room for all points. Returns how many. */
static size_t best_points(const struct lab_report *report, int filter, struct lab_point *out)
{
    size_t count = 0;
    for (size_t i = 0; i < report->point_count; i++) {
        if (report->points[i].filter == filter && report->points[i].best && is_shown(&report->points[i])) {
            out[count++] = report->points[i];
        }
    }
    qsort(out, count, sizeof(*out), compare_time);
    return count;
}

static void write_curve(FILE *out, const struct axes *axes, int filter, int line, const struct lab_point *points, size_t count)
{
    const char *color = colors[line % COLORS];
    double y = TOP + 10 + 22 * line;
    fprintf(out, "<g stroke='%s' fill='%s'%s><path fill='none' stroke-width='2' d='", color, color,
            line < COLORS ? "" : " stroke-dasharray='6 3'");
    for (size_t i = 0; i < count; i++) {
        fprintf(out, "%s%.1f %.1f", i ? "L" : "M", across(axes, points[i].ms), up(axes, points[i].normal));
    }
    fprintf(out, "'/>\n");
    for (size_t i = 0; i < count; i++) {
        fprintf(out,
                "<circle stroke='none' cx='%.1f' cy='%.1f' r='4'><title>%s: %d times, sigma %g r: %.2f ms, %.2f deg</title></circle>\n",
                across(axes, points[i].ms), up(axes, points[i].normal), lab_filter_name(filter), points[i].iterations, points[i].sigma,
                points[i].ms, points[i].normal);
    }
    fprintf(out, "<path stroke-width='2' d='M%.1f %.1fh24'/></g><text x='%.1f' y='%.1f'>%s</text>\n", WIDTH - RIGHT + 20, y,
            WIDTH - RIGHT + 52, y + 4, lab_filter_name(filter));
}

static void write_frame(FILE *out, const struct axes *axes)
{
    double middle_x = 0.5 * (LEFT + WIDTH - RIGHT), middle_y = 0.5 * (TOP + HEIGHT - BOTTOM);
    fprintf(out,
            "<svg xmlns='http://www.w3.org/2000/svg' width='%g' height='%g' viewBox='0 0 %g %g' font-family='sans-serif' font-size='13'>\n"
            "<style>.grid{stroke:#ddd}</style><rect width='100%%' height='100%%' fill='#fff'/>\n"
            "<text x='%.1f' y='28' text-anchor='middle' font-size='16'>Error against time on the waves</text>\n",
            WIDTH, HEIGHT, WIDTH, HEIGHT, middle_x);
    write_grid(out, axes);
    fprintf(out, "<rect x='%g' y='%g' width='%g' height='%g' fill='none' stroke='#000'/>\n", LEFT, TOP, WIDTH - LEFT - RIGHT,
            HEIGHT - TOP - BOTTOM);
    fprintf(out,
            "<text x='%.1f' y='%.1f' text-anchor='middle'>stage smooth, milliseconds</text>\n"
            "<text text-anchor='middle' transform='translate(20 %.1f) rotate(-90)'>median error of the normal, degrees</text>\n",
            middle_x, HEIGHT - 18, middle_y);
}

void lab_write_plot(FILE *out, const struct lab_report *report)
{
    struct axes axes = axes_of(report);
    struct lab_point *points = calloc(report->point_count + 1, sizeof(*points));
    int line = 0;
    write_frame(out, &axes);
    for (int filter = 0; points && filter < lab_filter_count(); filter++) {
        size_t count = best_points(report, filter, points);
        if (count) {
            write_curve(out, &axes, filter, line++, points, count);
        }
    }
    fprintf(out, "</svg>\n");
    free(points);
}
