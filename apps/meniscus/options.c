/* options.c: parses the command line by the table in option_table.c. */
#include "options.h"

#include "look.h"
#include "names.h"
#include "option_fluid.h"
#include "option_table.h"
#include "preset.h"
#include "program.h"

#include <stdlib.h>
#include <string.h>

static int fail_unknown(enum command command, const char *name)
{
    const char *nearest = NULL, *program = option_command_name(command);
    size_t best = 0;
    for (const struct option_row *row = option_table; row->name; row++) {
        size_t edits = names_distance(name, row->name);
        if (!strcmp(row->name, name)) {
            return program_usage("'%s' is no option of %s; 'meniscus %s --help' lists its options", name, program, program);
        }
        if ((row->commands & (unsigned)command) && (!nearest || edits < best)) {
            best = edits;
            nearest = row->name;
        }
    }
    if (nearest && best <= 3 && best < strlen(nearest) / 2) {
        return program_usage("unknown option '%s'; did you mean '%s'?", name, nearest);
    }
    return program_usage("unknown option '%s'; 'meniscus %s --help' lists the options", name, program);
}

/* The row of "--name" or "--name=value", or of "-o", "-oVALUE". *value: what stands behind it in the same argument, or NULL. */
static const struct option_row *find(enum command command, const char *argument, const char **value)
{
    const char *equals = strchr(argument, '=');
    size_t length = equals ? (size_t)(equals - argument) : strlen(argument);
    *value = NULL;
    for (const struct option_row *row = option_table; row->name; row++) {
        if (!(row->commands & (unsigned)command)) {
            continue;
        }
        if (strlen(row->name) == length && !strncmp(row->name, argument, length)) {
            *value = equals ? equals + 1 : NULL;
            return row;
        }
        if (row->letter && argument[0] == '-' && argument[1] == row->letter) {
            *value = argument[2] ? argument + 2 : NULL;
            return row;
        }
    }
    return NULL;
}

/* Takes one option and its value. *at: its place, moved to the last argument that was used. */
static int take_option(struct options *options, int *at, int count, char **arguments)
{
    const char *argument = arguments[*at], *value;
    const struct option_row *row = find(options->command, argument, &value);
    if (!row) {
        char name[80];
        snprintf(name, sizeof(name), "%.*s", (int)strcspn(argument, "="), argument);
        return fail_unknown(options->command, name);
    }
    if (!row->argument && value) {
        return program_usage("%s takes no value", row->name);
    }
    if (row->argument && !value) {
        if (*at + 1 >= count) {
            return program_usage("%s needs a value: %s %s", row->name, row->name, row->argument);
        }
        value = arguments[++*at];
    }
    struct mns_message message = {""};
    if (!option_apply(options, row, value, &message)) {
        return program_usage("%s: %s", row->name, message.text);
    }
    return STATUS_DONE;
}

static int apply_parameters(struct options *options)
{
    struct mns_message message;
    if (options->color.by) { /* the water's own tint would hide them */
        options->params.display = MNS_DISPLAY_COLOR;
    }
    for (size_t i = 0; i < options->preset_count; i++) {
        preset_apply(options->presets[i], &options->params);
    }
    for (size_t i = 0; i < options->look_count; i++) {
        int status = look_read(options->looks[i], &options->params);
        if (status != STATUS_DONE) {
            return status;
        }
    }
    for (size_t i = 0; i < options->setting_count; i++) {
        if (!options->settings[i].fluid) { /* checked when it was parsed */
            mns_params_set(&options->params, options->settings[i].name, options->settings[i].value, NULL);
        }
    }
    if (!option_fluids_resolve(options, &message)) {
        return program_usage("--set: %s", message.text);
    }
    return mns_params_check(&options->params, &message) == MNS_OK ? STATUS_DONE : program_usage("%s", message.text);
}

int options_parse(struct options *options, enum command command, int count, char **arguments)
{
    size_t room = (size_t)count + 1;
    *options = (struct options){.command = command,
                                .width = 1920,
                                .height = 1080,
                                .camera.fov = 45,
                                .step = 1,
                                .retime = 1,
                                .shutter_samples = 8,
                                .crf = -1,
                                .mesh_scale = 1,
                                .fps = {30, 1},
                                .repeat = 20,
                                .warmup = 3};
    if (command == COMMAND_LAB) { /* many small pictures */
        options->width = 640;
        options->height = 480;
        options->repeat = 3;
    }
    mns_params_init(&options->params);
    options->inputs = calloc(room, sizeof(*options->inputs));
    options->roles = calloc(room, sizeof(*options->roles));
    options->presets = calloc(room, sizeof(*options->presets));
    options->looks = calloc(room, sizeof(*options->looks));
    options->meshes = calloc(room, sizeof(*options->meshes));
    options->foam_files = calloc(room, sizeof(*options->foam_files));
    options->fluids = calloc(room, sizeof(*options->fluids));
    options->settings = calloc(2 * room, sizeof(*options->settings)); /* --sun and --background set two */
    if (!options->inputs || !options->roles || !options->presets || !options->looks || !options->meshes || !options->foam_files ||
        !options->fluids || !options->settings) {
        return program_fail("out of memory");
    }
    bool only_inputs = false;
    for (int i = 0; i < count; i++) {
        const char *argument = arguments[i];
        if (only_inputs || argument[0] != '-' || !argument[1]) {
            options->inputs[options->input_count++] = argument;
        } else if (!strcmp(argument, "--")) {
            only_inputs = true;
        } else {
            int status = take_option(options, &i, count, arguments);
            if (status != STATUS_DONE) {
                return status;
            }
        }
    }
    const struct color_options *color = &options->color;
    if (!options->help && !color->by && (color->map || color->units || color->has_low || color->has_high || color->legend)) {
        return program_usage("--colormap, --range, --legend and --units need --color-by");
    }
    return options->help ? STATUS_DONE : apply_parameters(options);
}

void options_free(struct options *options)
{
    free((void *)options->inputs);
    free((void *)options->roles);
    free((void *)options->presets);
    free((void *)options->looks);
    free(options->meshes);
    free((void *)options->foam_files);
    free(options->fluids);
    free(options->settings);
    free(options->keys);
}
