/* report.c: every filter in every scene. */
#include "report.h"

#include <stdlib.h>
#include <string.h>

size_t lab_row_runs(const struct lab_selection *selection)
{
    size_t filters = 0, scenes = 0;
    for (int i = 0; i < lab_filter_count(); i++) {
        filters += lab_selected(selection->filters, i);
    }
    for (int i = 0; i < lab_scene_count(); i++) {
        scenes += lab_selected(selection->scenes, i);
    }
    return filters * scenes;
}

static mns_result add_row(struct lab *lab, struct lab_report *report, int scene, int filter)
{
    struct lab_row *row = &report->rows[report->row_count];
    struct mns_params params = lab_params(lab, filter);
    *row = (struct lab_row){.scene = scene, .filter = filter};
    mns_result result = lab_run(lab, &params, &row->values);
    row->left = row->values.of[LAB_BUMPS] / lab->unsmoothed.of[LAB_BUMPS];
    report->row_count += result == MNS_OK;
    return result;
}

static const struct lab_row *find_row(const struct lab_report *report, int scene, int filter)
{
    for (size_t i = 0; i < report->row_count; i++) {
        if (report->rows[i].scene == scene && report->rows[i].filter == filter) {
            return &report->rows[i];
        }
    }
    return NULL;
}

/* The part of the bumps left near over that left far, in the rows of the nearest scene. */
static void compare_distances(struct lab_report *report)
{
    int near = lab_scene_find("waves-near"), far = lab_scene_find("waves-far");
    for (size_t i = 0; i < report->row_count; i++) {
        struct lab_row *row = &report->rows[i];
        const struct lab_row *other = row->scene == near ? find_row(report, far, row->filter) : NULL;
        if (other) {
            row->values.of[LAB_DISTANCE] = row->left / other->left;
        }
    }
}

mns_result lab_report_rows(struct lab *lab, const struct lab_selection *selection, struct lab_report *report)
{
    mns_result result = MNS_OK;
    report->rows = calloc(lab_row_runs(selection) + 1, sizeof(*report->rows));
    if (!report->rows) {
        return lab_fail(lab, MNS_ERR_OUT_OF_MEMORY);
    }
    for (int scene = 0; result == MNS_OK && scene < lab_scene_count(); scene++) {
        result = lab_selected(selection->scenes, scene) ? lab_enter(lab, scene) : MNS_OK;
        for (int filter = 0; result == MNS_OK && lab->scene == scene && filter < lab_filter_count(); filter++) {
            result = lab_selected(selection->filters, filter) ? add_row(lab, report, scene, filter) : MNS_OK;
        }
    }
    compare_distances(report);
    return result;
}

void lab_report_free(struct lab_report *report)
{
    free(report->rows);
    free(report->claims);
    free(report->points);
    memset(report, 0, sizeof(*report));
}
