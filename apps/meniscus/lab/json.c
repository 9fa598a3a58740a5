/* json.c: a report as JSON (cJSON). */
#include "table.h"

#include <cjson/cJSON.h>
#include <math.h>

/* Six digits are more than any measure holds; null where it is not finite. */
static void add_number(cJSON *object, const char *name, double value)
{
    char text[32] = "null";
    if (isfinite(value)) {
        snprintf(text, sizeof(text), "%.6g", value);
    }
    cJSON_AddRawToObject(object, name, text);
}

static cJSON *add_item(cJSON *array)
{
    cJSON *item = cJSON_CreateObject();
    cJSON_AddItemToArray(array, item);
    return item;
}

static void add_measures(cJSON *top)
{
    cJSON *list = cJSON_AddArrayToObject(top, "measures");
    for (int m = 0; m < LAB_MEASURES; m++) {
        cJSON *item = add_item(list);
        cJSON_AddStringToObject(item, "name", lab_measures[m].name);
        cJSON_AddStringToObject(item, "unit", lab_measures[m].unit);
        cJSON_AddStringToObject(item, "help", lab_measures[m].help);
    }
}

static void add_rows(cJSON *top, const struct lab_report *report)
{
    cJSON *list = cJSON_AddArrayToObject(top, "rows");
    for (size_t i = 0; i < report->row_count; i++) {
        const struct lab_row *row = &report->rows[i];
        cJSON *item = add_item(list);
        cJSON_AddStringToObject(item, "scene", lab_scene_name(row->scene));
        cJSON_AddStringToObject(item, "filter", lab_filter_name(row->filter));
        for (int m = 0; m < LAB_MEASURES; m++) {
            if (!isnan(row->values.of[m])) {
                add_number(item, lab_measures[m].name, row->values.of[m]);
            }
        }
    }
}

static void add_claims(cJSON *top, const struct lab_report *report)
{
    cJSON *list = cJSON_AddArrayToObject(top, "claims");
    for (size_t i = 0; i < report->claim_count; i++) {
        const struct lab_claim *claim = &report->claims[i];
        cJSON *item = add_item(list);
        cJSON_AddStringToObject(item, "source", claim->source);
        cJSON_AddStringToObject(item, "claim", claim->text);
        cJSON_AddBoolToObject(item, "holds", claim->holds);
        cJSON_AddStringToObject(item, "numbers", claim->numbers);
    }
}

static void add_points(cJSON *top, const struct lab_report *report)
{
    cJSON *list = cJSON_AddArrayToObject(top, "points");
    for (size_t i = 0; i < report->point_count; i++) {
        const struct lab_point *point = &report->points[i];
        cJSON *item = add_item(list);
        cJSON_AddStringToObject(item, "filter", lab_filter_name(point->filter));
        add_number(item, "iterations", point->iterations);
        add_number(item, "sigma", point->sigma);
        add_number(item, "ms", point->ms);
        add_number(item, "normal_median", point->normal);
        add_number(item, "bumps", point->bumps);
        cJSON_AddBoolToObject(item, "best", point->best);
        cJSON_AddBoolToObject(item, "at_equal_time", lab_best_point(report, point->filter) == point);
    }
}

bool lab_write_json(FILE *out, const struct lab *lab, const struct lab_report *report)
{
    cJSON *top = cJSON_CreateObject();
    add_number(top, "width", lab->settings.width);
    add_number(top, "height", lab->settings.height);
    cJSON_AddStringToObject(top, "isa", lab->stats.isa ? lab->stats.isa : "");
    add_number(top, "threads", lab->stats.threads);
    add_number(top, "radius_pixels", lab_radius_pixels(lab));
    add_measures(top);
    add_rows(top, report);
    add_claims(top, report);
    if (report->point_count) {
        add_number(top, "equal_time_ms", report->budget_ms > 0 ? report->budget_ms : NAN);
        add_points(top, report);
    }
    char *text = cJSON_Print(top);
    cJSON_Delete(top);
    if (!text) {
        return false;
    }
    fprintf(out, "%s\n", text);
    cJSON_free(text);
    return true;
}
