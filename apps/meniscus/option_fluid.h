/* option_fluid.h: options of several fluids. */
#ifndef MENISCUS_OPTION_FLUID_H
#define MENISCUS_OPTION_FLUID_H

#include "options.h"

bool option_set_fluid(struct options *options, const char *value, struct mns_message *message);

/* --set FLUID.PARAMETER=VALUE. */
bool option_set_of_fluid(struct options *options, const char *value, struct mns_message *message);

/* Applies the settings of single fluids, once those of all are; where no input is given the first fluid is it. */
bool option_fluids_resolve(struct options *options, struct mns_message *message);

#endif
