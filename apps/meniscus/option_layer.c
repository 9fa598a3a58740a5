/* option_layer.c: options of layers. */
#include "option_layer.h"

#include "exr_file.h"
#include "names.h"
#include "option_values.h"

#include <string.h>

static bool refuse_name(const char *name, struct mns_message *message)
{
    char list[512] = "";
    const char *nearest = mns_layer_name(MNS_LAYER_BEAUTY);
    for (int i = 0; i < MNS_LAYER_COUNT; i++) {
        const char *other = mns_layer_name((enum mns_layer)i);
        option_append_name(list, sizeof(list), other);
        nearest = names_distance(name, other) < names_distance(name, nearest) ? other : nearest;
    }
    return option_refuse(message, "there is no layer '%s'; did you mean '%s'? There are %s", name, nearest, list);
}

/* name: of length bytes. path NULL: into the .exr OUTPUT. */
static bool add_layer(struct options *options, const char *name, size_t length, const char *path, struct mns_message *message)
{
    char word[64];
    enum mns_layer layer;
    snprintf(word, sizeof(word), "%.*s", (int)(length < sizeof(word) ? length : sizeof(word) - 1), name);
    if (mns_layer_find(word, &layer) != MNS_OK) {
        return refuse_name(word, message);
    }
    for (size_t i = 0; i < options->layer_count; i++) {
        if (options->layers[i].layer == layer) {
            return option_refuse(message, "layer %s is asked for twice", word);
        }
    }
    options->layers[options->layer_count++] = (struct layer_file){.layer = layer, .path = path};
    return true;
}

bool option_set_layer(struct options *options, const char *value, struct mns_message *message)
{
    const char *equals = strchr(value, '=');
    if (!equals || equals == value || !equals[1]) {
        return option_refuse(message, "'%s' must be NAME=FILE", value);
    }
    if (!name_has_extension(equals + 1, ".npy") && !exr_file_is(equals + 1)) {
        return option_refuse(message, "'%s': layers are written as .npy or .exr", equals + 1);
    }
    return add_layer(options, value, (size_t)(equals - value), equals + 1, message);
}

bool option_set_layers(struct options *options, const char *value, struct mns_message *message)
{
    for (const char *at = value;; at++) {
        size_t length = strcspn(at, ",");
        if (!add_layer(options, at, length, NULL, message)) {
            return false;
        }
        at += length;
        if (!*at) {
            return true;
        }
    }
}

bool option_set_exr_type(struct options *options, const char *value, struct mns_message *message)
{
    options->exr_float = !strcmp(value, "float");
    return options->exr_float || !strcmp(value, "half") || option_refuse(message, "'%s' is none of half and float", value);
}
