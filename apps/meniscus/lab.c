/* lab.c: `meniscus lab`: measures the filters on surfaces known in closed form, and tells whether what the papers say of them holds. */
#include "lab/pictures.h"
#include "lab/plot.h"
#include "lab/table.h"
#include "options.h"
#include "program.h"
#include "progress.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static bool proceed(void *user)
{
    progress_step(user, "run");
    return !program_signal();
}

static struct lab_selection selection_of(const struct options *options)
{
    struct lab_selection all = {(1UL << lab_filter_count()) - 1, (1UL << lab_scene_count()) - 1};
    return (struct lab_selection){options->lab_filters ? options->lab_filters : all.filters,
                                  options->lab_scenes ? options->lab_scenes : all.scenes};
}

/* Claims compare certain filters in certain scenes: where some are chosen, others were not asked for. */
static bool wants_claims(const struct options *options) { return !options->lab_filters && !options->lab_scenes; }

static bool wants_points(const struct options *options) { return options->plot || options->equal_time > 0; }

static size_t run_count(const struct options *options, const struct lab_selection *selection)
{
    return lab_row_runs(selection) + (wants_claims(options) ? lab_claim_runs() : 0) +
           (wants_points(options) ? lab_point_runs(selection) : 0);
}

static mns_result measure(struct lab *lab, const struct options *options, const struct lab_selection *selection, struct lab_report *report)
{
    mns_result result = lab_report_rows(lab, selection, report);
    if (result == MNS_OK && wants_claims(options)) {
        result = lab_report_claims(lab, report);
    }
    if (result == MNS_OK && wants_points(options)) {
        report->budget_ms = options->equal_time;
        result = lab_report_points(lab, selection, report);
    }
    if (result == MNS_OK && options->pictures) {
        result = lab_write_pictures(lab, selection, options->pictures);
    }
    return result;
}

enum form { FORM_TEXT, FORM_JSON, FORM_CSV, FORM_PLOT };

/* Writes the report to a file, in memory first: files appear whole or not at all. */
static int write_report(const char *path, enum form form, const struct lab *lab, const struct lab_report *report)
{
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    bool good = out != NULL;
    if (good && form == FORM_JSON) {
        good = lab_write_json(out, lab, report);
    } else if (good && form == FORM_CSV) {
        lab_write_csv(out, report);
    } else if (good && form == FORM_PLOT) {
        lab_write_plot(out, report);
    } else if (good) {
        lab_write_text(out, lab, report);
    }
    good = out && fclose(out) == 0 && good;
    int status = good ? program_write_file(path, text) : program_fail("%s: out of memory", path);
    free(text);
    return status;
}

static int write_results(const struct options *options, const struct lab *lab, const struct lab_report *report)
{
    enum form form = options->json ? FORM_JSON : options->csv ? FORM_CSV : FORM_TEXT;
    int status = write_report(options->output ? options->output : "-", form, lab, report);
    return status == STATUS_DONE && options->plot ? write_report(options->plot, FORM_PLOT, lab, report) : status;
}

/* Whether everything can be written in the end; makes the folder for pictures. */
static int check_places(const struct options *options)
{
    int status = options->output ? program_check_place(options->output) : STATUS_DONE;
    status = status == STATUS_DONE && options->plot ? program_check_place(options->plot) : status;
    if (status == STATUS_DONE && options->pictures && mkdir(options->pictures, 0777) != 0 && errno != EEXIST) {
        return program_fail("%s: cannot be made: %s", options->pictures, strerror(errno));
    }
    return status;
}

static int run_lab(struct lab *lab, const struct options *options)
{
    struct lab_selection selection = selection_of(options);
    struct lab_report report = {0};
    struct progress progress;
    progress_begin(&progress, run_count(options, &selection), options->quiet);
    lab->settings.proceed = proceed;
    lab->settings.user = &progress;
    mns_result result = measure(lab, options, &selection, &report);
    progress_clear();
    int status = program_signal()   ? program_stopped()
                 : result == MNS_OK ? write_results(options, lab, &report)
                                    : program_fail("lab: %s", lab->message.text);
    lab_report_free(&report);
    return status;
}

int command_lab(struct options *options)
{
    if (options->input_count == 1 && !strcmp(options->inputs[0], "papers")) {
        return command_lab_papers(options);
    }
    if (options->input_count) {
        return program_usage("lab makes its own scenes and takes no '%s', only papers; --scenes and --filter choose", options->inputs[0]);
    }
    if (options->json && options->csv) {
        return program_usage("--json and --csv exclude each other");
    }
    if (options->width < LAB_WIDTH_MIN || options->height < LAB_HEIGHT_MIN) {
        return program_usage("--size: %dx%d does not hold the scenes; it must be at least %dx%d", options->width, options->height,
                             (int)LAB_WIDTH_MIN, (int)LAB_HEIGHT_MIN);
    }
    int status = program_check_picture(options->width, options->height);
    status = status == STATUS_DONE ? check_places(options) : status;
    if (status != STATUS_DONE) {
        return status;
    }
    program_catch_interrupts();
    struct lab lab;
    struct lab_settings settings = {.width = options->width,
                                    .height = options->height,
                                    .params = options->params,
                                    .isa = options->isa,
                                    .threads = options->threads,
                                    .repeat = (int)options->repeat};
    mns_result result = lab_create(&lab, &settings);
    status = result == MNS_OK ? run_lab(&lab, options) : program_fail("lab: %s", lab.message.text);
    lab_destroy(&lab);
    return status;
}
