/* option_color.h: options of colours. Each function has the shape of struct option_row's apply. */
#ifndef MENISCUS_OPTION_COLOR_H
#define MENISCUS_OPTION_COLOR_H

#include "options.h"

bool option_set_color_by(struct options *options, const char *value, struct mns_message *message);
bool option_set_colormap(struct options *options, const char *value, struct mns_message *message);
bool option_set_range(struct options *options, const char *value, struct mns_message *message);
bool option_set_legend(struct options *options, const char *value, struct mns_message *message);
bool option_set_units(struct options *options, const char *value, struct mns_message *message);

#endif
