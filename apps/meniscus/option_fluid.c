/* option_fluid.c: options of several fluids. */
#include "option_fluid.h"

#include "names.h"
#include "option_values.h"

#include <stdio.h>
#include <string.h>

bool option_set_fluid(struct options *options, const char *value, struct mns_message *message)
{
    static const char letters[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-";
    size_t length = strspn(value, letters);
    if (length == 0 || length >= FLUID_NAME_MAX || value[length] != '=' || !value[length + 1]) {
        return option_refuse(message, "'%s' must be NAME=FILES, with a name of letters, digits, _ and -, at most %d", value,
                             FLUID_NAME_MAX - 1);
    }
    struct fluid_option *fluid = &options->fluids[options->fluid_count];
    memcpy(fluid->name, value, length); /* the rest is zeros */
    fluid->files = value + length + 1;
    for (size_t i = 0; i < options->fluid_count; i++) {
        if (!strcmp(options->fluids[i].name, fluid->name)) {
            return option_refuse(message, "fluid '%s' is named twice; several files of one are a folder or a pattern", fluid->name);
        }
    }
    options->fluid_count++;
    return options->fluid_count <= FLUIDS_MAX || option_refuse(message, "%d fluids are the most that can be given", FLUIDS_MAX);
}

bool option_set_of_fluid(struct options *options, const char *value, struct mns_message *message)
{
    const char *name = strchr(value, '.') + 1, *equals = strchr(name, '=');
    char word[64];
    struct mns_params scratch;
    snprintf(word, sizeof(word), "%.*s", (int)(equals - name), name);
    mns_params_init(&scratch);
    if (mns_params_set(&scratch, word, equals + 1, message) != MNS_OK) {
        return false;
    }
    const struct mns_param *row = mns_param_find(word);
    if (!strcmp(row->group, "scene") && strcmp(row->name, "shadow") != 0) {
        return option_refuse(message, "%s is of the scene, which all fluids share; leave '%.*s' out", row->name, (int)(name - value),
                             value);
    }
    options->settings[options->setting_count++] = (struct setting){.fluid = value, .name = row->name, .value = equals + 1};
    return true;
}

/* NULL: message says what may have been meant. */
static struct fluid_option *find(struct options *options, const char *setting, struct mns_message *message)
{
    char name[64];
    struct fluid_option *nearest = NULL;
    snprintf(name, sizeof(name), "%.*s", (int)strcspn(setting, "."), setting);
    for (size_t i = 0; i < options->fluid_count; i++) {
        struct fluid_option *fluid = &options->fluids[i];
        nearest = !nearest || names_distance(name, fluid->name) < names_distance(name, nearest->name) ? fluid : nearest;
    }
    if (nearest && !strcmp(nearest->name, name)) {
        return nearest;
    }
    if (nearest) {
        option_refuse(message, "there is no fluid '%s'; did you mean '%s'?", name, nearest->name);
    } else {
        option_refuse(message, "there is no fluid '%s'; --fluid %s=FILES names it", name, name);
    }
    return NULL;
}

bool option_fluids_resolve(struct options *options, struct mns_message *message)
{
    for (size_t i = 0; i < options->fluid_count; i++) {
        options->fluids[i].params = options->params;
    }
    for (size_t i = 0; i < options->setting_count; i++) {
        const struct setting *setting = &options->settings[i];
        if (setting->fluid) {
            struct fluid_option *fluid = find(options, setting->fluid, message);
            if (!fluid) {
                return false;
            }
            mns_params_set(&fluid->params, setting->name, setting->value, NULL); /* checked when it was parsed */
        }
    }
    for (size_t i = 0; i < options->fluid_count; i++) {
        struct mns_message why;
        if (mns_params_check(&options->fluids[i].params, &why) != MNS_OK) {
            return option_refuse(message, "fluid %s: %.900s", options->fluids[i].name, why.text);
        }
    }
    if (options->fluid_count > 0 && options->input_count == 0) {
        options->params = options->fluids[0].params;
        options->inputs[options->input_count++] = options->fluids[0].files;
        options->fluid_count--;
        memmove(options->fluids, options->fluids + 1, options->fluid_count * sizeof(*options->fluids));
    }
    return true;
}
