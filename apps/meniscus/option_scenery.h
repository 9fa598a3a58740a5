/* option_scenery.h: options of what stands around the fluid. */
#ifndef MENISCUS_OPTION_SCENERY_H
#define MENISCUS_OPTION_SCENERY_H

#include "options.h"

bool option_set_foam_particles(struct options *options, const char *value, struct mns_message *message);
bool option_set_mesh(struct options *options, const char *value, struct mns_message *message);
bool option_set_container(struct options *options, const char *value, struct mns_message *message);
bool option_set_environment(struct options *options, const char *value, struct mns_message *message);
bool option_set_mesh_scale(struct options *options, const char *value, struct mns_message *message);
bool option_set_mesh_up(struct options *options, const char *value, struct mns_message *message);

#endif
