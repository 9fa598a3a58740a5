/* table.c: a report as text and CSV. */
#include "table.h"

#include <math.h>
#include <string.h>

enum { NAME_WIDTH = 26, COLUMN_WIDTH = 9 };

static bool scene_has(const struct lab_report *report, int scene, int measure)
{
    for (size_t i = 0; i < report->row_count; i++) {
        if (report->rows[i].scene == scene && !isnan(report->rows[i].values.of[measure])) {
            return true;
        }
    }
    return false;
}

static void write_heads(FILE *out, const struct lab_report *report, int scene)
{
    for (int units = 0; units < 2; units++) {
        fprintf(out, "  %-*s", NAME_WIDTH, units ? "" : "filter");
        for (int m = 0; m < LAB_MEASURES; m++) {
            if (scene_has(report, scene, m)) {
                fprintf(out, "%*s", COLUMN_WIDTH, units ? lab_measures[m].unit : lab_measures[m].head);
            }
        }
        fputc('\n', out);
    }
}

/* A value in a column, "-" where there is none. */
static void write_value(FILE *out, double value)
{
    if (isnan(value)) {
        fprintf(out, "%*s", COLUMN_WIDTH, "-");
    } else {
        fprintf(out, "%*.*f", COLUMN_WIDTH, fabs(value) < 99.5 ? 3 : 1, value);
    }
}

static void write_scene(FILE *out, const struct lab_report *report, int scene)
{
    fprintf(out, "\n%s: %s\n", lab_scene_name(scene), lab_scene_text(scene));
    write_heads(out, report, scene);
    for (size_t i = 0; i < report->row_count; i++) {
        const struct lab_row *row = &report->rows[i];
        if (row->scene != scene) {
            continue;
        }
        fprintf(out, "  %-*s", NAME_WIDTH, lab_filter_name(row->filter));
        for (int m = 0; m < LAB_MEASURES; m++) {
            if (scene_has(report, scene, m)) {
                write_value(out, row->values.of[m]);
            }
        }
        fputc('\n', out);
    }
}

const struct lab_point *lab_best_point(const struct lab_report *report, int filter)
{
    const struct lab_point *best = NULL;
    for (size_t i = 0; i < report->point_count; i++) {
        const struct lab_point *point = &report->points[i];
        if (point->filter == filter && point->ms <= report->budget_ms && (!best || point->normal < best->normal)) {
            best = point;
        }
    }
    return best;
}

static void write_equal_time(FILE *out, const struct lab_report *report)
{
    fprintf(out, "\nat equal time: the best of each filter in %g ms, on waves\n  %-*s%9s%9s%9s%9s%9s\n", report->budget_ms, NAME_WIDTH,
            "filter", "ms", "times", "sigma", "normal", "bumps");
    for (int filter = 0; filter < lab_filter_count(); filter++) {
        const struct lab_point *point = lab_best_point(report, filter);
        if (point) {
            fprintf(out, "  %-*s", NAME_WIDTH, lab_filter_name(filter));
            write_value(out, point->ms);
            write_value(out, point->iterations ? (double)point->iterations : (double)NAN);
            write_value(out, point->sigma);
            write_value(out, point->normal);
            write_value(out, point->bumps);
            fputc('\n', out);
        }
    }
}

static void write_claims(FILE *out, const struct lab_report *report)
{
    fprintf(out, "\nwhat the papers say\n");
    for (size_t i = 0; i < report->claim_count; i++) {
        const struct lab_claim *claim = &report->claims[i];
        fprintf(out, "  %s  %-10s %s\n                    %s\n", claim->holds ? "PASS" : "FAIL", claim->source, claim->text,
                claim->numbers);
    }
}

void lab_write_legend(FILE *out)
{
    for (int m = 0; m < LAB_MEASURES; m++) {
        const struct lab_measure_info *info = &lab_measures[m];
        fprintf(out, "  %-9s %-15s %s%s%s\n", info->head, info->name, info->help, *info->unit ? ", " : "", info->unit);
    }
}

void lab_write_text(FILE *out, const struct lab *lab, const struct lab_report *report)
{
    fprintf(out, "%dx%d, %s, %d threads; r: the splat radius, %.1f pixels in the middle of most scenes\n", lab->settings.width,
            lab->settings.height, lab->stats.isa ? lab->stats.isa : "", lab->stats.threads, lab_radius_pixels(lab));
    for (int scene = 0; scene < lab_scene_count(); scene++) {
        if (scene_has(report, scene, LAB_DEPTH_RMS)) {
            write_scene(out, report, scene);
        }
    }
    if (report->budget_ms > 0) {
        write_equal_time(out, report);
    }
    if (report->claim_count) {
        write_claims(out, report);
    }
    fprintf(out, "\ncolumns\n");
    lab_write_legend(out);
}

void lab_write_csv(FILE *out, const struct lab_report *report)
{
    fprintf(out, "scene,filter");
    for (int m = 0; m < LAB_MEASURES; m++) {
        fprintf(out, ",%s", lab_measures[m].name);
    }
    fputc('\n', out);
    for (size_t i = 0; i < report->row_count; i++) {
        const struct lab_row *row = &report->rows[i];
        fprintf(out, "%s,%s", lab_scene_name(row->scene), lab_filter_name(row->filter));
        for (int m = 0; m < LAB_MEASURES; m++) {
            fputc(',', out);
            if (!isnan(row->values.of[m])) {
                fprintf(out, "%.6g", row->values.of[m]);
            }
        }
        fputc('\n', out);
    }
}
