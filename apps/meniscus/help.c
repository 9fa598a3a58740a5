/* help.c: help texts and docs/options.md, made from the table of options and the table of parameters. */
#include "lab/table.h"
#include "option_table.h"
#include "preset.h"
#include "program.h"
#include "sample.h"

#include <string.h>

static const enum command commands[] = {COMMAND_RENDER, COMMAND_INFO, COMMAND_CONVERT, COMMAND_BENCH, COMMAND_SAMPLE, COMMAND_LAB};

enum { COMMANDS = sizeof(commands) / sizeof(commands[0]) };

static const char *usage_of(enum command command)
{
    return command == COMMAND_RENDER    ? "meniscus render INPUT... -o OUTPUT [options]"
           : command == COMMAND_INFO    ? "meniscus info INPUT... [options]"
           : command == COMMAND_CONVERT ? "meniscus convert INPUT... -o OUTPUT [options]"
           : command == COMMAND_BENCH   ? "meniscus bench INPUT... [options]"
           : command == COMMAND_SAMPLE  ? "meniscus sample NAME --particles N -o FILE [options]"
                                        : "meniscus lab [papers] [options]";
}

static const char *text_of(enum command command)
{
    return command == COMMAND_RENDER
               ? "Draws pictures from particle files. INPUT: files, a directory, a pattern (frame_%04d.vtk), a .pvd, a case file (.json), "
                 "or - for standard input."
           : command == COMMAND_INFO ? "Tells what files hold: count, attributes, bounds, radius, format."
           : command == COMMAND_CONVERT
               ? "Writes the particles of files in another format, with all their attributes. Where a format lacks a type, docs/formats.md "
                 "tells what becomes of it."
           : command == COMMAND_BENCH
               ? "Measures the time per stage, without file access: the median over new views of a prepared particle set. A case file "
                 "(.json) brings its view."
           : command == COMMAND_SAMPLE
               ? "Makes particles with position, velocity, density and id: exactly N of them, and the same ones every time."
               : "Measures every filter on particles whose surface is known in closed form, and tells whether what the papers say of "
                 "them holds. All lengths are in r, the splat radius.";
}

/* "--output OUTPUT" or "-o, --output OUTPUT". */
static void option_words(const struct option_row *row, char *out, size_t size)
{
    char letter[8] = "";
    if (row->letter) {
        snprintf(letter, sizeof(letter), "-%c, ", row->letter);
    }
    snprintf(out, size, "%s%s%s%s", letter, row->name, row->argument ? " " : "", row->argument ? row->argument : "");
}

static void default_of(const struct mns_param *row, char *out, size_t size)
{
    struct mns_params defaults;
    mns_params_init(&defaults);
    mns_params_get(&defaults, row->name, out, size);
}

/* "0.1 to 10 r", "on or off", "sky, color, transparent". */
static void values_of(const struct mns_param *row, char *out, size_t size)
{
    const char *space = *row->unit ? " " : "", *automatic = row->has_auto ? ", auto" : "";
    if (row->type == MNS_PARAM_BOOL) {
        snprintf(out, size, "on, off");
    } else if (row->type == MNS_PARAM_ENUM) {
        out[0] = '\0';
        for (int i = 0; row->choices[i]; i++) {
            size_t used = strlen(out);
            if (*row->choices[i]) {
                snprintf(out + used, size - used, "%s%s", used ? ", " : "", row->choices[i]);
            }
        }
    } else {
        snprintf(out, size, "%s%g to %g%s%s%s", row->components == 3 ? "R,G,B: " : "", row->minimum, row->maximum, space, row->unit,
                 automatic);
    }
}

/* Every parameter, with a heading before each group, in one of two notations. */
static void list_parameters(FILE *out, bool markdown)
{
    const char *group = "";
    for (size_t i = 0; i < mns_param_count(); i++) {
        const struct mns_param *row = mns_param_info(i);
        char value[96], values[128];
        default_of(row, value, sizeof(value));
        values_of(row, values, sizeof(values));
        if (strcmp(group, row->group) != 0) {
            group = row->group;
            fprintf(out, markdown ? "\n### %s\n\n| name | default | values | meaning |\n|---|---|---|---|\n" : " %s\n", group);
        }
        if (markdown) {
            fprintf(out, "| `%s` | %s | %s | %s |\n", row->name, value, values, row->help);
        } else {
            fprintf(out, "  %-20s %s (%s; %s)\n", row->name, row->help, value, values);
        }
    }
}

static void print_parameters(FILE *out)
{
    fprintf(out, "\nParameters for --set NAME=VALUE and look files (default; range or choices; r: splat radius, L: the fluid's size):\n");
    list_parameters(out, false);
}

/* In one of two notations, as the parameters. */
static void list_presets(FILE *out, bool markdown)
{
    for (const struct preset *preset = presets; preset->name; preset++) {
        fprintf(out, markdown ? "| `%s` | %s |" : "  %-24s %s", preset->name, preset->help);
        for (size_t i = 0; markdown && i < sizeof(preset->settings) / sizeof(preset->settings[0]) && preset->settings[i].name; i++) {
            fprintf(out, "%s`%s=%s`", i ? ", " : " ", preset->settings[i].name, preset->settings[i].value);
        }
        fputs(markdown ? " |\n" : "\n", out);
    }
}

static void print_lab(FILE *out)
{
    fprintf(out, "\nScenes:\n");
    for (int i = 0; i < lab_scene_count(); i++) {
        fprintf(out, "  %-24s %s\n", lab_scene_name(i), lab_scene_text(i));
    }
    fprintf(out, "\nColumns (in text; in JSON and CSV):\n");
    lab_write_legend(out);
}

void options_help(FILE *out, enum command command)
{
    fprintf(out, "usage: %s\n\n%s\n\nOptions:\n", usage_of(command), text_of(command));
    for (const struct option_row *row = option_table; row->name; row++) {
        char words[64];
        option_words(row, words, sizeof(words));
        if (row->commands & (unsigned)command) {
            fprintf(out, "  %-24s %s\n", words, row->help);
        }
    }
    if (command == COMMAND_SAMPLE) {
        fprintf(out, "\nNames:\n");
        for (const struct sample_shape *shape = sample_shapes; shape->name; shape++) {
            fprintf(out, "  %-24s %s\n", shape->name, shape->help);
        }
    }
    if (command == COMMAND_LAB) {
        print_lab(out);
    }
    if (command == COMMAND_RENDER || command == COMMAND_BENCH) {
        fprintf(out, "\nPresets:\n");
        list_presets(out, false);
        print_parameters(out);
    }
}

/* Text in a table's cell, where a bar would end it. */
static void print_cell(FILE *out, const char *text)
{
    for (; *text; text++) {
        fputs(*text == '|' ? "\\|" : (char[]){*text, '\0'}, out);
    }
}

static void markdown_options(FILE *out, enum command command)
{
    fprintf(out, "\n## %s\n\n    %s\n\n%s\n\n| option | meaning |\n|---|---|\n", option_command_name(command), usage_of(command),
            text_of(command));
    for (const struct option_row *row = option_table; row->name; row++) {
        char words[64];
        option_words(row, words, sizeof(words));
        if (row->commands & (unsigned)command) {
            fputs("| `", out);
            print_cell(out, words);
            fputs("` | ", out);
            print_cell(out, row->help);
            fputs(" |\n", out);
        }
    }
}

static void markdown_parameters(FILE *out)
{
    fprintf(out, "\n## Parameters\n\nFor `--set NAME=VALUE`, look files and `mns_params_set`. Lengths in r are multiples of the splat "
                 "radius R = radius * "
                 "radius_scale,\nlengths in L of the fluid's own size, the cube root of its rest volume. Colours are linear R,G,B, or "
                 "RRGGBB in sRGB.\n");
    list_parameters(out, true);
}

void options_markdown(FILE *out)
{
    fprintf(out, "# Options and parameters\n\nWritten by `meniscus --help-options` from the program's own tables; a test keeps this page "
                 "up to date.\n");
    for (int i = 0; i < COMMANDS; i++) {
        markdown_options(out, commands[i]);
    }
    fprintf(out, "\n## Presets\n\nFor `--preset NAME`; look files and options change what a preset sets.\n\n| name | look | parameters "
                 "|\n|---|---|---|\n");
    list_presets(out, true);
    markdown_parameters(out);
}
