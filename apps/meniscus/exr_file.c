/* exr_file.c: the layers of a picture in one OpenEXR file. */
#include "exr_file.h"

#include <string.h>

bool exr_file_is(const char *path) { return name_has_extension(path, ".exr"); }

/* A letter for each channel, by which compositors know what they are. */
static const char *letters_of(enum mns_layer layer)
{
    switch (layer) {
    case MNS_LAYER_BEAUTY: return "RGBA";
    case MNS_LAYER_COLOR:
    case MNS_LAYER_TRANSMITTANCE:
    case MNS_LAYER_SCENE_COLOR: return "RGB";
    case MNS_LAYER_ALPHA: return "A";
    case MNS_LAYER_DEPTH_RAW:
    case MNS_LAYER_DEPTH:
    case MNS_LAYER_SCENE_DEPTH: return "Z";
    default: return mns_layer_channels(layer) == 3 ? "XYZ" : mns_layer_channels(layer) == 2 ? "XY" : "Y";
    }
}

bool exr_file_write(const char *path, const struct outputs *outputs, size_t index, const struct mns_output *images,
                    const struct mns_camera *camera, struct mns_message *message)
{
    struct mns_exr_layer layers[OUTPUT_MAX];
    const struct mns_exr_note notes[] = {{"software", "Meniscus"}, {"meniscus.look", outputs->look ? outputs->look : "{}"}};
    size_t count = 0;
    for (size_t i = 0; i < outputs->count; i++) {
        const struct output *output = &outputs->list[i];
        if (i != index && (index != 0 || output->kind != OUTPUT_EXR_LAYER)) {
            continue;
        }
        const char *name = output->layer == MNS_LAYER_BEAUTY ? "" : mns_layer_name(output->layer);
        layers[count++] = (struct mns_exr_layer){.name = name, .channels = letters_of(output->layer), .image = &images[i].image};
    }
    struct mns_exr_params params;
    mns_exr_params_init(&params);
    params.half = !outputs->exr_float;
    params.camera = camera;
    params.notes = notes;
    params.note_count = sizeof(notes) / sizeof(notes[0]);
    return mns_exr_write(path, layers, count, &params, message) == MNS_OK;
}
