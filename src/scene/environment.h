/* environment.h: picture files of light. */
#ifndef MNS_SCENE_ENVIRONMENT_H
#define MNS_SCENE_ENVIRONMENT_H

#include <meniscus/common.h>

/* A float32 picture of 3 channels in memory of malloc. On failure out->data is NULL. */
mns_result mns_light_read(struct mns_image *out, const char *path, struct mns_message *message);

/* The same of an OpenEXR file; in a build without OpenEXRCore, says so. */
mns_result mns_light_read_exr(struct mns_image *out, const char *path, struct mns_message *message);

#endif
