/* report.h: everything that the lab finds out, before it is printed or drawn. */
#ifndef MENISCUS_LAB_REPORT_H
#define MENISCUS_LAB_REPORT_H

#include "run.h"

/* What is measured; a bit for each filter and each scene by its number. */
struct lab_selection {
    unsigned long filters, scenes;
};

static inline bool lab_selected(unsigned long bits, int number) { return bits >> number & 1; }

/* A filter in a scene. */
struct lab_row {
    int scene, filter;
    struct lab_values values;
    double left; /* part of the unsmoothed surface's bumps that the filter leaves */
};

/* What a paper says of the filters, and what was measured. */
struct lab_claim {
    const char *source; /* "[TY18] 3.2" */
    const char *text;
    bool holds;
    char numbers[320]; /* that decide, and the bounds */
};

/* A filter with other settings, in the scene "waves": what it costs and what it brings. */
struct lab_point {
    int filter, iterations; /* 0: its own number */
    double sigma;           /* r: of the kernel or of the flow; NAN: it has none */
    double ms, normal, bumps;
    bool best; /* of its filter: none that is as fast has a smaller error of the normal */
};

struct lab_report {
    struct lab_row *rows;
    struct lab_claim *claims;
    struct lab_point *points;
    size_t row_count, claim_count, point_count;
    double budget_ms; /* of the comparison at equal time; 0: none */
};

/* Each adds its part to a report that began with zeros. The reason of a failure is in lab->message. lab_report_free may always be called. */
mns_result lab_report_rows(struct lab *lab, const struct lab_selection *selection, struct lab_report *report);
mns_result lab_report_claims(struct lab *lab, struct lab_report *report);
mns_result lab_report_points(struct lab *lab, const struct lab_selection *selection, struct lab_report *report);
void lab_report_free(struct lab_report *report);

/* Runs that each of the three takes: for a progress bar. */
size_t lab_row_runs(const struct lab_selection *selection);
size_t lab_claim_runs(void); /* at most */
size_t lab_point_runs(const struct lab_selection *selection);

#endif
