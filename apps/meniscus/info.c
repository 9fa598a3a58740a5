/* info.c: `meniscus info`: what files hold. */
#include "inputs.h"
#include "json_file.h"
#include "load.h"
#include "program.h"

#include <string.h>

struct facts {
    const char *path;
    const mns_particle_set *set;
    struct mns_measure measure;
};

static void add_json(cJSON *files, const struct facts *facts)
{
    cJSON *file = cJSON_CreateObject();
    cJSON_AddItemToArray(files, file);
    cJSON_AddStringToObject(file, "path", facts->path);
    cJSON_AddStringToObject(file, "format", mns_particle_set_format(facts->set));
    json_add_number(file, "particles", (double)facts->measure.count);
    cJSON *attributes = cJSON_AddArrayToObject(file, "attributes");
    for (size_t i = 0; i < mns_particle_set_attribute_count(facts->set); i++) {
        const struct mns_attribute *attribute = mns_particle_set_attribute(facts->set, i);
        cJSON *item = cJSON_CreateObject();
        cJSON_AddItemToArray(attributes, item);
        cJSON_AddStringToObject(item, "name", attribute->name);
        cJSON_AddStringToObject(item, "type", mns_type_name(attribute->type));
        json_add_number(item, "components", attribute->components);
    }
    cJSON *bounds = cJSON_AddObjectToObject(file, "bounds");
    json_add_vector(bounds, "min", facts->measure.bounds_min);
    json_add_vector(bounds, "max", facts->measure.bounds_max);
    json_add_number(file, "radius", facts->measure.radius);
}

static void print_text(const struct facts *facts)
{
    const struct mns_measure *measure = &facts->measure;
    const double *low = measure->bounds_min, *high = measure->bounds_max;
    printf("%s\n  format      %s\n  particles   %zu", facts->path, mns_particle_set_format(facts->set), measure->count);
    if (mns_particle_set_file_count(facts->set) != measure->count) {
        printf(" of %zu", mns_particle_set_file_count(facts->set));
    }
    printf("\n  bounds      %.6g %.6g %.6g to %.6g %.6g %.6g\n", low[0], low[1], low[2], high[0], high[1], high[2]);
    printf("  radius      %.6g (%s)\n", measure->radius,
           mns_particle_set_particles(facts->set)->radius.data ? "median of the file's"
           : measure->radius > 0                               ? "estimated"
                                                               : "unknown");
    for (size_t i = 0; i < mns_particle_set_attribute_count(facts->set); i++) {
        const struct mns_attribute *attribute = mns_particle_set_attribute(facts->set, i);
        char type[48], role[64] = "";
        char count[16] = "";
        if (attribute->components > 1) {
            snprintf(count, sizeof(count), "[%d]", attribute->components);
        }
        snprintf(type, sizeof(type), "%s%s", mns_type_name(attribute->type), count);
        if (attribute->role != MNS_ROLE_NONE && strcmp(mns_role_name(attribute->role), attribute->name) != 0) {
            snprintf(role, sizeof(role), " (used as %s)", mns_role_name(attribute->role));
        }
        printf("  %-11s %-12s %s%s\n", i ? "" : "attributes", type, attribute->name, role);
    }
}

static int tell_file(const char *path, const struct options *options, cJSON *files)
{
    struct mns_message message;
    mns_particle_set *set;
    if (load_particles(&set, path, options, &message) != MNS_OK) {
        return program_fail("%s", message.text);
    }
    struct facts facts = {.path = path, .set = set};
    int status = STATUS_DONE;
    if (mns_particles_measure(mns_particle_set_particles(set), NULL, &facts.measure, &message) != MNS_OK) {
        status = program_fail("%s: %s", path, message.text);
    } else if (files) {
        add_json(files, &facts);
    } else {
        print_text(&facts);
    }
    mns_particle_set_destroy(&set);
    return status;
}

int command_info(struct options *options)
{
    struct inputs inputs = {0};
    int status = options->input_count ? STATUS_DONE : program_usage("info needs an input: meniscus info INPUT...");
    for (size_t i = 0; status == STATUS_DONE && i < options->input_count; i++) {
        status = inputs_add(&inputs, options->inputs[i]);
    }
    cJSON *json = options->json ? cJSON_CreateObject() : NULL, *files = json ? cJSON_AddArrayToObject(json, "files") : NULL;
    for (size_t i = 0; status == STATUS_DONE && i < inputs.count; i++) {
        status = tell_file(inputs.list[i].path, options, files);
    }
    inputs_free(&inputs);
    if (status == STATUS_DONE && json) {
        return json_write("-", json);
    }
    cJSON_Delete(json);
    return status == STATUS_DONE && !program_flush() ? STATUS_FAILED : status;
}
