/* option_layer.h: options of layers. Each function has the shape of struct option_row's apply. */
#ifndef MENISCUS_OPTION_LAYER_H
#define MENISCUS_OPTION_LAYER_H

#include "options.h"

bool option_set_layer(struct options *options, const char *value, struct mns_message *message);
bool option_set_layers(struct options *options, const char *value, struct mns_message *message);
bool option_set_exr_type(struct options *options, const char *value, struct mns_message *message);

#endif
