/* scenery.c: the meshes around the fluid. */
#include "scenery.h"

#include "inputs.h"
#include "program.h"

#include <meniscus/scene.h>

#include <stdlib.h>

struct scenery {
    const struct options *options;
    mns_meshes *meshes; /* NULL: none */
    mns_environment *environment;
    long long number; /* of the frame whose meshes are held, of those that change */
    bool has_frame;
};

static int read_mesh(struct scenery *scenery, size_t i, const char *path)
{
    const struct options *options = scenery->options;
    struct mns_mesh_params params;
    struct mns_message message;
    mns_mesh_params_init(&params);
    params.container = options->meshes[i].container;
    params.scale = options->mesh_scale;
    params.world_up_axis = options->params.up_axis;
    params.up_axis = options->has_mesh_up ? options->mesh_up : params.world_up_axis;
    return mns_meshes_read(scenery->meshes, (int)i, path, &params, &message) == MNS_OK ? STATUS_DONE : program_fail("%s", message.text);
}

/* Reads the meshes that change, as they are in a frame; or those that do not. */
static int read_meshes(struct scenery *scenery, bool changing, long long number)
{
    const struct options *options = scenery->options;
    int status = STATUS_DONE;
    for (size_t i = 0; status == STATUS_DONE && i < options->mesh_count; i++) {
        if (pattern_is(options->meshes[i].path) == changing) {
            char *path = pattern_name(options->meshes[i].path, number);
            status = path ? read_mesh(scenery, i, path) : program_fail("%s: out of memory", options->meshes[i].path);
            free(path);
        }
    }
    return status;
}

int scenery_create(struct scenery **out, const struct options *options)
{
    *out = NULL;
    if (options->mesh_count == 0 && !options->environment) {
        return STATUS_DONE;
    }
    struct scenery *scenery = calloc(1, sizeof(*scenery));
    if (!scenery) {
        return program_fail("out of memory");
    }
    *out = scenery;
    scenery->options = options;
    struct mns_meshes_params params;
    struct mns_message message;
    if (options->environment && mns_environment_read(&scenery->environment, options->environment, &message) != MNS_OK) {
        return program_fail("%s", message.text);
    }
    if (options->mesh_count == 0) {
        return STATUS_DONE;
    }
    mns_meshes_params_init(&params);
    params.threads = options->threads;
    if (mns_meshes_create(&scenery->meshes, &params, &message) != MNS_OK) {
        return program_fail("%s: %s", options->meshes[0].path, message.text);
    }
    return read_meshes(scenery, false, 0);
}

void scenery_destroy(struct scenery *scenery)
{
    if (scenery) {
        mns_meshes_destroy(&scenery->meshes);
        mns_environment_destroy(&scenery->environment);
        free(scenery);
    }
}

int scenery_draw(struct scenery *scenery, mns_renderer *renderer, long long number, struct mns_frame *frame)
{
    if (!scenery) {
        return STATUS_DONE;
    }
    frame->environment = scenery->environment;
    if (!scenery->meshes) {
        return STATUS_DONE;
    }
    if (!scenery->has_frame || scenery->number != number) {
        int status = read_meshes(scenery, true, number);
        if (status != STATUS_DONE) {
            return status;
        }
        scenery->number = number;
        scenery->has_frame = true;
    }
    struct mns_light light;
    struct mns_message message;
    mns_light_init(&light);
    if (mns_renderer_light(renderer, frame, &light) != MNS_OK) {
        return program_fail("%s", mns_renderer_message(renderer));
    }
    if (mns_meshes_draw(scenery->meshes, frame->camera, &light, &frame->objects, &message) != MNS_OK) {
        return program_fail("%s", message.text);
    }
    return STATUS_DONE;
}
