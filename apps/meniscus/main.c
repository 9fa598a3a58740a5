/* main.c: `meniscus`: picks the command. */
#include "look.h"
#include "options.h"
#include "program.h"

#include <stdio.h>
#include <string.h>

static const struct {
    const char *name;
    enum command command;
    int (*run)(struct options *options);
    const char *summary;
} commands[] = {
    {"render", COMMAND_RENDER, command_render, "pictures from particle files"},
    {"info", COMMAND_INFO, command_info, "what a file holds"},
    {"convert", COMMAND_CONVERT, command_convert, "particle files from one format to another"},
    {"bench", COMMAND_BENCH, command_bench, "milliseconds per stage"},
    {"sample", COMMAND_SAMPLE, command_sample, "procedural particle sets of any size"},
    {"lab", COMMAND_LAB, command_lab, "measures the filters on surfaces known in closed form"},
};

enum { COMMANDS = sizeof(commands) / sizeof(commands[0]) };

static void print_help(FILE *out)
{
    fputs("usage: meniscus COMMAND ...\n\nPictures of fluids from simulation particles, in screen space.\n\n", out);
    for (int i = 0; i < COMMANDS; i++) {
        fprintf(out, "  meniscus %-8s %s\n", commands[i].name, commands[i].summary);
    }
    fputs("  meniscus COMMAND --help, --help, --version, --help-options (docs/options.md), --help-look-schema (docs/look.schema.json)\n\n"
          "Try:\n  meniscus sample crown --particles 300k -o crown.npz\n  meniscus render crown.npz -o crown.png\n",
          out);
}

static void print_names(const char *head, const char *(*name_of)(size_t index))
{
    printf("%s", head);
    for (size_t i = 0; name_of(i); i++) {
        printf("%s%s", i ? ", " : "", name_of(i));
    }
    printf("%s\n", name_of(0) ? "" : "nothing");
}

static void print_version(void)
{
    uint32_t version = mns_version();
    printf("meniscus %u.%u.%u\n", (unsigned)(version / 1000000), (unsigned)(version / 1000 % 1000), (unsigned)(version % 1000));
    print_names("reads: ", mns_read_format);
    print_names("writes images: ", mns_image_write_format);
    print_names("writes particles: ", mns_particles_write_format);
    print_names("not in this build: ", mns_missing_feature);
    printf("instruction sets:");
    for (int i = MNS_ISA_SCALAR; mns_isa_name((enum mns_isa)i); i++) {
        if (mns_isa_available((enum mns_isa)i)) {
            printf(" %s", mns_isa_name((enum mns_isa)i));
        }
    }
    printf("\n");
}

static int run(int which, int count, char **arguments)
{
    struct options options;
    int status = options_parse(&options, commands[which].command, count, arguments);
    if (status == STATUS_DONE && options.help) {
        options_help(stdout, options.command);
        status = program_flush() ? STATUS_DONE : STATUS_FAILED;
    } else if (status == STATUS_DONE) {
        status = commands[which].run(&options);
    }
    options_free(&options);
    return status;
}

int main(int count, char **arguments)
{
    const char *word = count > 1 ? arguments[1] : "";
    program_ignore_write_signals();
    for (int i = 0; i < COMMANDS; i++) {
        if (!strcmp(word, commands[i].name)) {
            return run(i, count - 2, arguments + 2);
        }
    }
    if (!strcmp(word, "--help") || !strcmp(word, "-h")) {
        print_help(stdout);
    } else if (!strcmp(word, "--version")) {
        print_version();
    } else if (!strcmp(word, "--help-options")) {
        options_markdown(stdout);
    } else if (!strcmp(word, "--help-look-schema")) {
        return look_write_schema("-");
    } else if (count < 2) {
        print_help(stderr);
        return STATUS_USAGE;
    } else {
        return program_usage("unknown command '%s'; there are render, info, convert, bench, sample and lab, and --help", word);
    }
    return program_flush() ? STATUS_DONE : STATUS_FAILED;
}
