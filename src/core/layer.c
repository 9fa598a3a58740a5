/* layer.c: names and shapes of the layers. */
#include "core/frame.h"

#include <string.h>

/* In the order of enum mns_layer. */
static const struct {
    const char *name;
    int channels;
} layers[MNS_LAYER_COUNT] = {
    {"beauty", 4},
    {"depth_raw", 1},
    {"depth", 1},
    {"thickness_raw", 1},
    {"thickness", 1},
    {"normal", 3},
    {"curvature", 1},
    {"color", 3},
    {"transmittance", 3},
    {"alpha", 1},
    {"scene_color", 3},
    {"scene_depth", 1},
    {"noise", 1},
    {"foam_depth", 1},
    {"foam_thickness", 1},
    {"foam_front_thickness", 1},
    {"thickness_front", 1},
    {"thickness_back", 1},
    {"velocity", 3},
    {"motion", 2},
    {"id", 1},
    {"position", 3},
};

const char *mns_layer_name(enum mns_layer layer) { return (unsigned)layer < MNS_LAYER_COUNT ? layers[layer].name : NULL; }

int mns_layer_channels(enum mns_layer layer) { return (unsigned)layer < MNS_LAYER_COUNT ? layers[layer].channels : 0; }

mns_result mns_layer_find(const char *name, enum mns_layer *out)
{
    for (int i = 0; i < MNS_LAYER_COUNT; i++) {
        if (!strcmp(layers[i].name, name)) {
            *out = (enum mns_layer)i;
            return MNS_OK;
        }
    }
    return MNS_ERR_INVALID_ARGUMENT;
}

const struct mns_image *mns_frame_output(const struct frame *frame, enum mns_layer layer)
{
    for (size_t i = 0; i < frame->output_count; i++) {
        if (frame->outputs[i].layer == layer) {
            return &frame->outputs[i].image;
        }
    }
    return NULL;
}
