/* exr_file.h: the layers of a picture in one OpenEXR file. */
#ifndef MENISCUS_EXR_FILE_H
#define MENISCUS_EXR_FILE_H

#include "outputs.h"

/* Whether this build writes a file of this name as OpenEXR. */
bool exr_file_is(const char *path);

/* Writes those images whose outputs go into the file of outputs->list[index], with camera (NULL: unknown) and look. false: message says why. */
bool exr_file_write(const char *path, const struct outputs *outputs, size_t index, const struct mns_output *images,
                    const struct mns_camera *camera, struct mns_message *message);

#endif
