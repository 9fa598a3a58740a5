/* diffuse.c: a simulation's own foam, spray and bubbles: which files they are in, what they are, and their way to the renderer. */
#include "diffuse.h"

#include "program.h"

#include <meniscus/io.h>

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

struct diffuse {
    struct inputs files;
    const struct options *options;

    /* The frame's particles, side by side. [capacity] */
    size_t count, capacity;
    float (*position)[3], (*velocity)[3], *radius;
    uint8_t *kind;
    long long *id;
    bool has_radius, has_velocity; /* all of them */
};

/* ---- files ---- */

static bool is_frame(const struct inputs *inputs, long long number)
{
    for (size_t i = 0; i < inputs->count; i++) {
        if (inputs->list[i].number == number) {
            return true;
        }
    }
    return false;
}

/* Files first to the last one: of one name that the user gave. */
static int check_name(const struct inputs *files, size_t first, const char *name, const struct inputs *inputs,
                      const struct options *options)
{
    size_t unmatched = 0;
    const char *example = NULL;
    for (size_t i = first; i < files->count; i++) {
        if (files->list[i].number < 0) {
            return program_usage("%s: there is no number in the name, so it belongs to no frame", files->list[i].path);
        }
        if (!is_frame(inputs, files->list[i].number)) {
            example = example ? example : files->list[i].path;
            unmatched++;
        }
    }
    if (unmatched == files->count - first) {
        return program_usage("%s: %s matches no frame: the inputs have the numbers %lld to %lld", name,
                             unmatched == 1 ? "it" : "not one of the files", inputs->list[0].number,
                             inputs->list[inputs->count - 1].number);
    }
    if (unmatched > 0 && !options->quiet && inputs->count > 1) {
        program_warn("%s: %zu of %zu files match no frame, %s first", name, unmatched, files->count - first, example);
    }
    return STATUS_DONE;
}

int diffuse_begin(struct diffuse **out, const struct options *options, const struct inputs *inputs)
{
    *out = NULL;
    if (options->foam_file_count == 0) {
        return STATUS_DONE;
    }
    if (options->params.foam == MNS_FOAM_NOISE) {
        return program_usage("--foam-particles are drawn by --foam layered, not by --foam noise");
    }
    struct diffuse *diffuse = *out = calloc(1, sizeof(*diffuse));
    if (!diffuse) {
        return program_fail("out of memory");
    }
    diffuse->options = options;
    int status = STATUS_DONE;
    for (size_t i = 0; status == STATUS_DONE && i < options->foam_file_count; i++) {
        size_t first = diffuse->files.count;
        status = inputs_add_all(&diffuse->files, options->foam_files[i]);
        status = status == STATUS_DONE ? check_name(&diffuse->files, first, options->foam_files[i], inputs, options) : status;
    }
    return status;
}

void diffuse_end(struct diffuse *diffuse)
{
    if (!diffuse) {
        return;
    }
    inputs_free(&diffuse->files);
    free(diffuse->position);
    free(diffuse->velocity);
    free(diffuse->radius);
    free(diffuse->kind);
    free(diffuse->id);
    free(diffuse);
}

/* ---- particles ---- */

static bool name_has(const char *path, const char *part)
{
    const char *base = strrchr(path, '/');
    size_t length = strlen(part);
    for (base = base ? base + 1 : path; *base; base++) {
        size_t same = 0;
        while (same < length && tolower((unsigned char)base[same]) == part[same]) {
            same++;
        }
        if (same == length) {
            return true;
        }
    }
    return false;
}

/* By the file's name, where the particles do not say it themselves. */
static enum mns_kind kind_of_file(const char *path)
{
    return name_has(path, "spray") ? MNS_KIND_SPRAY : name_has(path, "bubble") ? MNS_KIND_BUBBLE : MNS_KIND_FOAM;
}

static bool reserve(struct diffuse *d, size_t count)
{
    if (count <= d->capacity) {
        return true;
    }
    void **arrays[] = {(void **)&d->position, (void **)&d->velocity, (void **)&d->radius, (void **)&d->kind, (void **)&d->id};
    const size_t sizes[] = {sizeof(*d->position), sizeof(*d->velocity), sizeof(*d->radius), sizeof(*d->kind), sizeof(*d->id)};
    for (size_t i = 0; i < sizeof(arrays) / sizeof(arrays[0]); i++) {
        void *grown = realloc(*arrays[i], count * sizes[i]);
        if (!grown) {
            return false;
        }
        *arrays[i] = grown;
    }
    d->capacity = count;
    return true;
}

static double value_at(const void *data, enum mns_type type, size_t i)
{
    switch (type) {
    case MNS_F32: return (double)((const float *)data)[i];
    case MNS_F64: return ((const double *)data)[i];
    case MNS_I8: return ((const int8_t *)data)[i];
    case MNS_U8: return ((const uint8_t *)data)[i];
    case MNS_I16: return ((const int16_t *)data)[i];
    case MNS_U16: return ((const uint16_t *)data)[i];
    case MNS_I32: return ((const int32_t *)data)[i];
    case MNS_U32: return ((const uint32_t *)data)[i];
    case MNS_I64: return (double)((const int64_t *)data)[i];
    case MNS_U64: return (double)((const uint64_t *)data)[i];
    }
    return 0;
}

static void add_kinds(struct diffuse *d, const mns_particle_set *set, const char *path, size_t count)
{
    const struct mns_attribute *kinds = NULL;
    for (size_t i = 0; i < mns_particle_set_attribute_count(set); i++) {
        const struct mns_attribute *attribute = mns_particle_set_attribute(set, i);
        kinds = !strcmp(attribute->name, "kind") && attribute->components == 1 ? attribute : kinds;
    }
    enum mns_kind all = kind_of_file(path);
    for (size_t i = 0; i < count; i++) {
        double kind = kinds ? value_at(kinds->data, kinds->type, i) : (double)all;
        d->kind[d->count + i] = (uint8_t)(kind == MNS_KIND_SPRAY    ? MNS_KIND_SPRAY
                                          : kind == MNS_KIND_BUBBLE ? MNS_KIND_BUBBLE
                                                                    : MNS_KIND_FOAM);
    }
}

/* Element c of particle i of an attribute that the reader made: packed. */
static double element(const struct mns_attr *attr, int components, size_t i, int c)
{
    size_t size = mns_type_size(attr->type), stride = attr->stride ? attr->stride : size * (size_t)components;
    double whole[2]; /* aligned for every type */
    memcpy(whole, (const char *)attr->data + stride * i + size * (size_t)c, size);
    return value_at(whole, attr->type, 0);
}

static int add_file(struct diffuse *d, const char *path)
{
    mns_particle_set *set;
    struct mns_message message;
    if (mns_particle_set_read(&set, path, NULL, &message) != MNS_OK) {
        return program_fail("%s", message.text);
    }
    const struct mns_particles *in = mns_particle_set_particles(set);
    if (!reserve(d, d->count + in->count)) {
        mns_particle_set_destroy(&set);
        return program_fail("%s: out of memory", path);
    }
    for (size_t i = 0; i < in->count; i++) {
        size_t at = d->count + i;
        for (int c = 0; c < 3; c++) {
            d->position[at][c] = (float)element(&in->position, 3, i, c);
            d->velocity[at][c] = in->velocity.data ? (float)element(&in->velocity, 3, i, c) : 0;
        }
        d->radius[at] = in->radius.data ? (float)element(&in->radius, 1, i, 0) : 0;
        d->id[at] = in->id.data ? (long long)element(&in->id, 1, i, 0) : (long long)i;
    }
    add_kinds(d, set, path, in->count);
    d->has_radius = d->has_radius && (in->radius.data || in->count == 0);
    d->has_velocity = d->has_velocity && (in->velocity.data || in->count == 0);
    d->count += in->count;
    mns_particle_set_destroy(&set);
    return STATUS_DONE;
}

int diffuse_prepare(struct diffuse *diffuse, mns_renderer *renderer, long long number)
{
    if (!diffuse) {
        return STATUS_DONE;
    }
    diffuse->count = 0;
    diffuse->has_radius = diffuse->has_velocity = true;
    const char *name = NULL;
    for (size_t i = 0; i < diffuse->files.count; i++) {
        const struct input *file = &diffuse->files.list[i];
        int status = file->number == number ? add_file(diffuse, file->path) : STATUS_DONE;
        if (status != STATUS_DONE) {
            return status;
        }
        name = file->number == number ? file->path : name;
    }
    struct mns_particles particles;
    mns_particles_init(&particles);
    particles.count = diffuse->count;
    particles.position = (struct mns_attr){.data = diffuse->position, .type = MNS_F32};
    particles.kind = (struct mns_attr){.data = diffuse->kind, .type = MNS_U8};
    particles.id = (struct mns_attr){.data = diffuse->id, .type = MNS_I64};
    if (diffuse->has_radius) {
        particles.radius = (struct mns_attr){.data = diffuse->radius, .type = MNS_F32};
    }
    if (diffuse->has_velocity) {
        particles.velocity = (struct mns_attr){.data = diffuse->velocity, .type = MNS_F32};
    }
    if (mns_renderer_prepare_diffuse(renderer, &particles) != MNS_OK) {
        return program_fail("%s: %s", name, mns_renderer_message(renderer));
    }
    if (diffuse->options->verbose) {
        program_say("frame %lld: %zu diffuse particles", number, diffuse->count);
    }
    return STATUS_DONE;
}
