/* read_pvd.c: ParaView's collections (.pvd): files and their times. As a particle file: all parts of the first time. */
#include "core/message.h"
#include "io/set.h"
#include "io/vtk_array.h"
#include "io/vtk_xml.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct step {
    double time;
    size_t place; /* in the file, which decides between equal times */
    char *file;   /* as it is written */
};

struct steps {
    struct read_context *context;
    struct step *items;
    size_t count, capacity;
    bool has_collection, in_collection;
};

static const char *const types[] = {"Collection", NULL};

static int probe(struct bytes head) { return mns_xml_probe(head, types); }

static mns_result start_step(struct steps *steps, const char *const *attributes)
{
    const char *time = mns_xml_get(attributes, "timestep"), *file = mns_xml_get(attributes, "file");
    struct step step = {.place = steps->count};
    if (!file || file[0] == '\0') {
        return mns_read_fail(steps->context, MNS_ERR_BAD_DATA, "<DataSet> %zu has no file=\"FILE\"", steps->count + 1);
    }
    if (time) {
        const char *end = time + strlen(time), *after = mns_parse_double(time, end, &step.time);
        if (!after || after != end || !isfinite(step.time)) {
            return mns_read_fail(steps->context, MNS_ERR_BAD_DATA, "<DataSet> %zu has timestep=\"%.60s\" where a number should be",
                                 steps->count + 1, time);
        }
    }
    struct step *items = mns_vtk_grow(steps->context, steps->items, &steps->capacity, steps->count, sizeof(*items));
    if (!items) {
        return MNS_ERR_OUT_OF_MEMORY;
    }
    steps->items = items;
    size_t size = strlen(file) + 1;
    step.file = mns_read_alloc(steps->context, size, 1);
    if (!step.file) {
        return MNS_ERR_OUT_OF_MEMORY;
    }
    memcpy(step.file, file, size);
    items[steps->count++] = step;
    return MNS_OK;
}

static mns_result start(struct vtk_xml *xml, const char *name, const char *const *attributes)
{
    struct steps *steps = xml->user;
    if (xml->depth == 1) {
        steps->in_collection = strcmp(name, types[0]) == 0;
        steps->has_collection |= steps->in_collection;
    }
    return xml->depth == 2 && steps->in_collection && strcmp(name, "DataSet") == 0 ? start_step(steps, attributes) : MNS_OK;
}

static int compare(const void *a, const void *b)
{
    const struct step *first = a, *second = b;
    if (first->time != second->time) {
        return first->time < second->time ? -1 : 1;
    }
    return first->place < second->place ? -1 : first->place > second->place;
}

/* Whatever comes of it, *steps is freed with free_steps. */
static mns_result parse_steps(struct read_context *context, struct bytes file, struct steps *steps)
{
    *steps = (struct steps){.context = context};
    struct vtk_xml xml = {.context = context, .file = file, .types = types, .user = steps, .start = start};
    mns_result result = mns_xml_parse(&xml);
    if (result == MNS_OK && !steps->has_collection) {
        return mns_read_fail(context, MNS_ERR_BAD_DATA, "has no <Collection>");
    }
    if (result == MNS_OK && steps->count == 0) {
        return mns_read_fail(context, MNS_ERR_BAD_DATA, "names no files: its <Collection> has no <DataSet>");
    }
    if (result == MNS_OK) {
        qsort(steps->items, steps->count, sizeof(*steps->items), compare);
    }
    return result;
}

static void free_steps(struct steps *steps)
{
    for (size_t i = 0; i < steps->count; i++) {
        mns_read_free(steps->context, steps->items[i].file, strlen(steps->items[i].file) + 1, 1);
    }
    if (steps->capacity > 0) {
        mns_read_free(steps->context, steps->items, steps->capacity, sizeof(*steps->items));
    }
}

static mns_result read_pvd(struct read_context *context, struct bytes file)
{
    struct steps steps;
    if (context->depth > 0) {
        return mns_read_fail(context, MNS_ERR_BAD_DATA, "is named by another file, but is a .pvd, which only names files itself");
    }
    mns_result result = parse_steps(context, file, &steps);
    for (size_t i = 0; i < steps.count && result == MNS_OK && steps.items[i].time == steps.items[0].time; i++) {
        result = mns_read_referenced(context, steps.items[i].file);
    }
    free_steps(&steps);
    return result;
}

const struct mns_reader mns_reader_pvd = {"pvd", "pvd", probe, read_pvd};

/* ---- time steps ---- */

struct mns_pvd {
    mns_particle_set owner; /* of the memory */
    struct mns_pvd_step *steps;
    size_t count, capacity;
};

static struct read_context context_of(mns_pvd *pvd, const char *path, const struct mns_read_params *params, struct mns_message *message)
{
    return (struct read_context){.path = path, .may_open = true, .params = params, .message = message, .set = &pvd->owner};
}

static mns_result take_steps(struct read_context *context, mns_pvd *pvd, const struct steps *steps)
{
    pvd->steps = mns_read_alloc(context, steps->count, sizeof(*pvd->steps));
    if (!pvd->steps) {
        return MNS_ERR_OUT_OF_MEMORY;
    }
    pvd->capacity = steps->count;
    for (size_t i = 0; i < steps->count; i++) {
        char *path = mns_read_beside(context, steps->items[i].file);
        if (!path) {
            return MNS_ERR_OUT_OF_MEMORY;
        }
        pvd->steps[pvd->count++] = (struct mns_pvd_step){steps->items[i].time, path};
    }
    return MNS_OK;
}

mns_result mns_pvd_read(mns_pvd **out, const char *path, struct mns_message *message)
{
    struct mns_message unread;
    struct mns_read_params params;
    struct memory memory;
    struct bytes file;
    struct steps steps;
    if (!message) {
        message = &unread;
    }
    if (!out) {
        return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "mns_pvd_read: out is NULL");
    }
    *out = NULL;
    if (!path) {
        return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "mns_pvd_read: path is NULL");
    }
    mns_memory_init(&memory, NULL);
    mns_pvd *pvd = mns_memory_get(&memory, 1, sizeof(*pvd));
    if (!pvd) {
        return mns_fail(message, MNS_ERR_OUT_OF_MEMORY, "%s: out of memory", path);
    }
    *pvd = (mns_pvd){.owner = {.memory = memory}};
    mns_read_params_init(&params);
    struct read_context context = context_of(pvd, path, &params, message);
    mns_result result = mns_read_file(&context, path, &file);
    if (result == MNS_OK) {
        result = parse_steps(&context, file, &steps);
        if (result == MNS_OK) {
            result = take_steps(&context, pvd, &steps);
        }
        free_steps(&steps);
        mns_read_free(&context, (void *)(uintptr_t)file.data, file.size, 1);
    }
    if (result != MNS_OK) {
        mns_pvd_destroy(&pvd);
    }
    *out = pvd;
    return result;
}

size_t mns_pvd_count(const mns_pvd *pvd) { return pvd->count; }

const struct mns_pvd_step *mns_pvd_get(const mns_pvd *pvd, size_t index) { return index < pvd->count ? &pvd->steps[index] : NULL; }

void mns_pvd_destroy(mns_pvd **pvd)
{
    if (!pvd || !*pvd) {
        return;
    }
    struct memory memory = (*pvd)->owner.memory;
    for (size_t i = 0; i < (*pvd)->count; i++) {
        const char *path = (*pvd)->steps[i].path;
        mns_memory_put(&memory, (void *)(uintptr_t)path, strlen(path) + 1, 1);
    }
    if ((*pvd)->capacity > 0) {
        mns_memory_put(&memory, (*pvd)->steps, (*pvd)->capacity * sizeof(*(*pvd)->steps), 1);
    }
    mns_memory_put(&memory, *pvd, 1, sizeof(**pvd));
    *pvd = NULL;
}
