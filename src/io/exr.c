/* exr.c: defaults of OpenEXR files, and the word of builds without OpenEXR. */
#include "core/message.h"
#include "io/writer.h"

#include <string.h>

void mns_exr_params_init_sized(struct mns_exr_params *params, size_t size)
{
    const struct mns_exr_params defaults = {.struct_size = size};
    memset(params, 0, size);
    memcpy(params, &defaults, size < sizeof(defaults) ? size : sizeof(defaults));
}

#ifndef MNS_HAVE_EXR
mns_result mns_exr_write(const char *path, const struct mns_exr_layer *layers, size_t layer_count, const struct mns_exr_params *params,
                         struct mns_message *message)
{
    (void)layers, (void)layer_count, (void)params;
    return mns_fail(message, MNS_ERR_UNSUPPORTED, "%s: this build writes no .exr: build with OpenEXR (libopenexr-dev)", path ? path : "");
}
#endif
