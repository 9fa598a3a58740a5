/* pictures.h: what the filters look like. */
#ifndef MENISCUS_LAB_PICTURES_H
#define MENISCUS_LAB_PICTURES_H

#include "report.h"

/* Writes for each selected scene FOLDER/SCENE-FILTER.png, the lit surface, and FOLDER/SCENE-FILTER-normal.png; and FOLDER/SCENE.png, a sheet
 * of the lit ones at half size, in the order of the table, three side by side. The folder must be there. */
mns_result lab_write_pictures(struct lab *lab, const struct lab_selection *selection, const char *folder);

#endif
