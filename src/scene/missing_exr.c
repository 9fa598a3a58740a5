/* missing_exr.c: OpenEXR files in a build without OpenEXRCore. */
#include "core/message.h"
#include "scene/environment.h"

mns_result mns_light_read_exr(struct mns_image *out, const char *path, struct mns_message *message)
{
    *out = (struct mns_image){.data = NULL};
    return mns_fail(message, MNS_ERR_UNSUPPORTED, "%s: this build reads no .exr: install OpenEXR (Debian: libopenexr-dev) and build again",
                    path);
}
