/* convert.c: `meniscus convert`: particle files from one format to another, with all their attributes. */
#include "convert.h"

#include "plan.h"
#include "program.h"
#include "progress.h"
#include "source.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>

int convert_check_format(const char *path)
{
    size_t length = strlen(path);
    length -= length > 3 && !strcasecmp(path + length - 3, ".gz") ? 3 : 0;
    char list[96] = "";
    for (size_t i = 0; mns_particles_write_format(i); i++) {
        const char *format = mns_particles_write_format(i);
        size_t n = strlen(format), used = strlen(list);
        bool packed = path[length] != '\0' && strcmp(format, "bgeo") != 0;
        if (length > n + 1 && path[length - n - 1] == '.' && !strncasecmp(path + length - n, format, n) && !packed) {
            return STATUS_DONE;
        }
        snprintf(list + used, sizeof(list) - used, "%s.%s", used ? ", " : "", format);
    }
    return program_usage("%s: particles are written as %s", path, list);
}

static int find_inputs(struct inputs *inputs, const struct options *options)
{
    if (options->input_count == 0 || !options->output) {
        return program_usage("convert needs an input and an output: meniscus convert INPUT... -o OUTPUT");
    }
    int status = convert_check_format(options->output);
    for (size_t i = 0; status == STATUS_DONE && i < options->input_count; i++) {
        status = inputs_add(inputs, options->inputs[i]);
    }
    inputs_number(inputs);
    return status;
}

static int write_frame(const mns_particle_set *set, const struct input *input, const struct options *options)
{
    const struct mns_log log = program_log(options);
    struct mns_message message;
    char *name = pattern_name(options->output, input->number);
    int status = name ? STATUS_DONE : program_fail("%s: out of memory", options->output);
    if (name && mns_particle_set_write(name, set, &log, &message) != MNS_OK) {
        status = program_fail("%s", message.text);
    } else if (name && options->verbose) {
        program_say("%s: %zu particles to %s", input->path, mns_particle_set_particles(set)->count, name);
    }
    free(name);
    return status;
}

/* *failed: counts the frames that could not be read. */
static int convert_frame(const struct source_frame *frame, const struct input *input, const struct options *options, size_t *failed)
{
    if (frame->set) {
        load_tell(&frame->notes, input->path, options);
        return write_frame(frame->set, input, options);
    }
    ++*failed;
    if (!options->keep_going) {
        return program_fail("%s", frame->message.text);
    }
    program_warn("%s", frame->message.text);
    return STATUS_DONE;
}

static int convert_frames(const struct inputs *inputs, const struct plan *plan, const struct options *options, size_t *failed)
{
    struct progress progress;
    struct source *source = source_start(inputs, plan->needed, options, NULL);
    int status = source ? STATUS_DONE : STATUS_FAILED;
    progress_begin(&progress, plan->count, options->quiet);
    while (status == STATUS_DONE && !program_signal()) {
        struct source_frame *frame = source_next(source);
        if (!frame) {
            break;
        }
        const struct input *input = &inputs->list[frame->input];
        status = convert_frame(frame, input, options, failed);
        progress_step(&progress, input->path);
        source_release(source, frame);
    }
    progress_clear();
    source_stop(source);
    return status;
}

int command_convert(struct options *options)
{
    struct inputs inputs = {0};
    struct plan plan = {0};
    size_t failed = 0;
    program_catch_interrupts();
    int status = find_inputs(&inputs, options);
    status = status == STATUS_DONE ? plan_make(&plan, &inputs, options) : status;
    status = status == STATUS_DONE ? outputs_check_place(options->output, &inputs, plan.count) : status;
    if (status == STATUS_DONE) {
        plan_needs(&plan, &inputs, options);
        status = convert_frames(&inputs, &plan, options, &failed);
    }
    if (status == STATUS_DONE && program_signal()) {
        status = program_stopped();
    } else if (status == STATUS_DONE && failed) {
        status = program_fail("%zu of %zu frames could not be read and were skipped", failed, plan.count);
    }
    plan_free(&plan);
    inputs_free(&inputs);
    return status;
}
