/* table.h: a report as text, JSON and CSV. */
#ifndef MENISCUS_LAB_TABLE_H
#define MENISCUS_LAB_TABLE_H

#include "report.h"

#include <stdio.h>

/* For people: a table per scene, the claims, the comparison at equal time, what the columns mean. */
void lab_write_text(FILE *out, const struct lab *lab, const struct lab_report *report);

/* Everything, for programs. false: out of memory. */
bool lab_write_json(FILE *out, const struct lab *lab, const struct lab_report *report);

/* A line per scene and filter; a measure that means nothing there is empty. */
void lab_write_csv(FILE *out, const struct lab_report *report);

/* The measures: a name and a line for each. */
void lab_write_legend(FILE *out);

/* The best that a filter does in the budget; NULL: nothing. */
const struct lab_point *lab_best_point(const struct lab_report *report, int filter);

#endif
