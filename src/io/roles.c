/* roles.c: which attribute is what. Names differ between simulators; the table below knows them. */
#include "core/message.h"
#include "io/set.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const char *const role_names[MNS_ROLE_COUNT] = {"none", "position", "velocity", "density", "radius", "mass", "id", "color"};

const char *mns_role_name(enum mns_role role) { return (unsigned)role < MNS_ROLE_COUNT ? role_names[role] : NULL; }

/* Known names, compared without regard to case; the first that a file has wins. */
struct known {
    int min_components, max_components;
    const char *names[16];
};
static const struct known known[MNS_ROLE_COUNT] = {
    [MNS_ROLE_POSITION] = {3, 3, {"position"}},
    [MNS_ROLE_VELOCITY] = {3, 4, {"velocity", "vel", "v", "velocities", "u", "particle_velocity", "fluid_velocity"}},
    [MNS_ROLE_DENSITY] = {1, 1, {"density", "rho", "rhop", "densities", "dens", "particle_density", "mass_density"}},
    [MNS_ROLE_RADIUS] = {1, 1, {"radius", "radii", "pscale", "particle_radius", "particleradius", "particle radius", "rad"}},
    [MNS_ROLE_MASS] = {1, 1, {"mass", "m", "masses", "particle_mass"}},
    [MNS_ROLE_ID] = {1,
                     1,
                     {"id", "ids", "gid", "idp", "particle_id", "particleid", "particleids", "particle id", "pid", "globalids",
                      "globalpointids", "global_id", "index"}},
    [MNS_ROLE_COLOR] = {3, 4, {"color", "cd", "colour", "rgb", "rgba", "colors", "col"}},
};

/* Scalars that make a vector together. */
struct triple {
    enum mns_role role;
    const char *names[3];
};
static const struct triple triples[] = {
    {MNS_ROLE_VELOCITY, {"u", "v", "w"}},
    {MNS_ROLE_VELOCITY, {"vx", "vy", "vz"}},
    {MNS_ROLE_VELOCITY, {"velx", "vely", "velz"}},
    {MNS_ROLE_VELOCITY, {"vel_x", "vel_y", "vel_z"}},
    {MNS_ROLE_VELOCITY, {"velocity_x", "velocity_y", "velocity_z"}},
    {MNS_ROLE_COLOR, {"red", "green", "blue"}},
    {MNS_ROLE_COLOR, {"r", "g", "b"}},
    {MNS_ROLE_COLOR, {"diffuse_red", "diffuse_green", "diffuse_blue"}},
};

static char lower(char c) { return c >= 'A' && c <= 'Z' ? (char)(c - 'A' + 'a') : c; }

static bool same_name(const char *a, const char *b)
{
    for (; *a && lower(*a) == lower(*b); a++, b++) {
        continue;
    }
    return *a == *b;
}

static struct attribute *find_nocase(const mns_particle_set *set, const char *name, int min_components, int max_components)
{
    for (size_t i = 0; i < set->listed_count; i++) {
        struct attribute *attribute = &set->attributes[i];
        if (attribute->is.components >= min_components && attribute->is.components <= max_components &&
            same_name(attribute->is.name, name)) {
            return attribute;
        }
    }
    return NULL;
}

static struct attribute *find_known(const mns_particle_set *set, const struct known *role)
{
    for (size_t i = 0; i < sizeof(role->names) / sizeof(role->names[0]) && role->names[i]; i++) {
        struct attribute *attribute = find_nocase(set, role->names[i], role->min_components, role->max_components);
        if (attribute) {
            return attribute;
        }
    }
    return NULL;
}

static void interleave(uint8_t *out, const uint8_t *const in[3], size_t count, size_t size)
{
    if (size == 4) {
        for (size_t i = 0; i < count; i++) {
            for (size_t c = 0; c < 3; c++) {
                memcpy(out + (3 * i + c) * 4, in[c] + 4 * i, 4);
            }
        }
    } else if (size == 8) {
        for (size_t i = 0; i < count; i++) {
            for (size_t c = 0; c < 3; c++) {
                memcpy(out + (3 * i + c) * 8, in[c] + 8 * i, 8);
            }
        }
    } else {
        for (size_t i = 0; i < count; i++) {
            for (size_t c = 0; c < 3; c++) {
                memcpy(out + (3 * i + c) * size, in[c] + size * i, size);
            }
        }
    }
}

/* Makes u, v, w into a velocity. *out: the joined attribute, NULL when the file has no such three. */
static mns_result join(struct read_context *context, enum mns_role role, struct attribute **out)
{
    mns_particle_set *set = context->set;
    *out = NULL;
    for (size_t t = 0; t < sizeof(triples) / sizeof(triples[0]); t++) {
        const struct attribute *part[3];
        const uint8_t *in[3];
        if (triples[t].role != role) {
            continue;
        }
        for (int c = 0; c < 3; c++) {
            part[c] = find_nocase(set, triples[t].names[c], 1, 1);
        }
        if (!part[0] || !part[1] || !part[2] || part[1]->is.type != part[0]->is.type || part[2]->is.type != part[0]->is.type) {
            continue;
        }
        for (int c = 0; c < 3; c++) {
            in[c] = part[c]->data;
        }
        if (mns_set_find(set, role_names[role], strlen(role_names[role]))) {
            continue;
        }
        enum mns_type type = part[0]->is.type;
        struct attribute *joined = mns_set_extra(context, role_names[role], type, 3, false);
        if (!joined) {
            return MNS_ERR_OUT_OF_MEMORY;
        }
        interleave(joined->data, in, set->count, mns_type_size(type));
        joined->joined = true;
        *out = joined;
        return MNS_OK;
    }
    return MNS_OK;
}

/* Splits "ROLE=NAME". */
static mns_result parse_override(struct read_context *context, const char *text, enum mns_role *role, const char **name)
{
    const char *equals = strchr(text, '=');
    size_t length = equals ? (size_t)(equals - text) : 0;
    for (int r = MNS_ROLE_POSITION; equals && r < MNS_ROLE_COUNT; r++) {
        if (strlen(role_names[r]) == length && memcmp(role_names[r], text, length) == 0) {
            *role = (enum mns_role)r;
            *name = equals + 1;
            return MNS_OK;
        }
    }
    return mns_fail(context->message, MNS_ERR_INVALID_ARGUMENT,
                    "attribute '%s': wanted ROLE=NAME with ROLE one of position, velocity, density, radius, mass, id, color", text);
}

static mns_result apply_override(struct read_context *context, enum mns_role role, const char *name)
{
    mns_particle_set *set = context->set;
    const struct known *wanted = &known[role];
    char names[640];
    for (size_t i = 0; i < set->listed_count; i++) {
        if (set->attributes[i].is.role == role) {
            set->attributes[i].is.role = MNS_ROLE_NONE;
        }
    }
    if (*name == '\0' && role == MNS_ROLE_POSITION) {
        return mns_read_fail(context, MNS_ERR_INVALID_ARGUMENT, "attribute 'position=': positions cannot be left out");
    }
    if (*name == '\0') {
        return MNS_OK;
    }
    struct attribute *attribute = mns_set_find(set, name, strlen(name));
    if (!attribute && set->count == 0) {
        return MNS_OK;
    }
    if (!attribute) {
        mns_set_list(set, names, sizeof(names));
        return mns_read_fail(context, MNS_ERR_INVALID_ARGUMENT, "has no attribute '%s' to be the %s; it has %s", name, role_names[role],
                             names);
    }
    if (attribute->is.components < wanted->min_components || attribute->is.components > wanted->max_components) {
        return mns_read_fail(context, MNS_ERR_INVALID_ARGUMENT, "'%s' cannot be the %s: it has %d components per particle, not %d", name,
                             role_names[role], attribute->is.components, wanted->min_components);
    }
    if (role == MNS_ROLE_POSITION && attribute->is.type != MNS_F32 && attribute->is.type != MNS_F64) {
        return mns_read_fail(context, MNS_ERR_INVALID_ARGUMENT, "'%s' cannot be the position: it is %s, not float32 or float64", name,
                             mns_type_name(attribute->is.type));
    }
    attribute->is.role = role;
    return MNS_OK;
}

mns_result mns_roles_assign(struct read_context *context)
{
    const struct mns_read_params *params = context->params;
    bool decided[MNS_ROLE_COUNT] = {false};
    for (size_t i = 0; i < params->role_count; i++) {
        enum mns_role role = MNS_ROLE_NONE;
        const char *name = "";
        mns_result result = parse_override(context, params->roles[i], &role, &name);
        if (result == MNS_OK) {
            result = apply_override(context, role, name);
        }
        if (result != MNS_OK) {
            return result;
        }
        decided[role] = true;
    }
    for (int r = MNS_ROLE_POSITION; r < MNS_ROLE_COUNT; r++) {
        if (decided[r]) {
            continue;
        }
        struct attribute *attribute = find_known(context->set, &known[r]);
        if (!attribute) {
            mns_result result = join(context, (enum mns_role)r, &attribute);
            if (result != MNS_OK) {
                return result;
            }
        }
        if (attribute && attribute->is.role == MNS_ROLE_NONE) {
            attribute->is.role = (enum mns_role)r;
        }
    }
    return MNS_OK;
}

/* ---- what the renderer takes ---- */

#define CONVERT(from, to, expression)                                                                                                      \
    do {                                                                                                                                   \
        const from *in = (const from *)source;                                                                                             \
        to *out = (to *)target;                                                                                                            \
        for (size_t i = 0; i < count; i++) {                                                                                               \
            const from v = in[i];                                                                                                          \
            out[i] = expression;                                                                                                           \
        }                                                                                                                                  \
    } while (0)

static void to_double(void *target, const void *source, size_t count, enum mns_type type)
{
    switch (type) {
    case MNS_F32: CONVERT(float, double, (double)v); break;
    case MNS_F64: CONVERT(double, double, v); break;
    case MNS_I8: CONVERT(int8_t, double, (double)v); break;
    case MNS_U8: CONVERT(uint8_t, double, (double)v); break;
    case MNS_I16: CONVERT(int16_t, double, (double)v); break;
    case MNS_U16: CONVERT(uint16_t, double, (double)v); break;
    case MNS_I32: CONVERT(int32_t, double, (double)v); break;
    case MNS_U32: CONVERT(uint32_t, double, (double)v); break;
    case MNS_I64: CONVERT(int64_t, double, (double)v); break;
    case MNS_U64: CONVERT(uint64_t, double, (double)v); break;
    }
}

/* Ids that a text file gave as numbers. What is no whole number of 64 bits becomes 0. */
static void to_id(void *target, const void *source, size_t count, enum mns_type type)
{
    const double limit = 9.2e18;
    if (type == MNS_F32) {
        CONVERT(float, int64_t, (double)v > -limit && (double)v < limit ? (int64_t)v : 0);
    } else {
        CONVERT(double, int64_t, v > -limit && v < limit ? (int64_t)v : 0);
    }
}

static float linear_from_srgb(double v)
{
    v = v < 0.0 ? 0.0 : v > 1.0 ? 1.0 : v;
    return (float)(v <= 0.04045 ? v / 12.92 : pow((v + 0.055) / 1.055, 2.4));
}

/* Whole-number colours are sRGB: uint16 up to 65535, all others up to 255. Ours are linear. */
static void to_linear(float *target, const void *source, size_t count, enum mns_type type)
{
    double values[256];
    if (type == MNS_U8) {
        float table[256];
        for (int i = 0; i < 256; i++) {
            table[i] = linear_from_srgb(i / 255.0);
        }
        const uint8_t *in = source;
        for (size_t i = 0; i < count; i++) {
            target[i] = table[in[i]];
        }
        return;
    }
    double white = type == MNS_U16 ? 65535.0 : 255.0;
    for (size_t start = 0; start < count; start += 256) {
        size_t n = count - start < 256 ? count - start : 256;
        to_double(values, (const uint8_t *)source + start * mns_type_size(type), n, type);
        for (size_t i = 0; i < n; i++) {
            target[start + i] = linear_from_srgb(values[i] / white);
        }
    }
}

static bool is_float(enum mns_type type) { return type == MNS_F32 || type == MNS_F64; }

static struct mns_attr view_of(const struct mns_attribute *attribute)
{
    size_t size = mns_type_size(attribute->type);
    return (struct mns_attr){attribute->data, size * (size_t)attribute->components, attribute->type};
}

/* A hidden array of the attribute's values in a type that particles may have. */
static mns_result convert(struct read_context *context, size_t index, struct mns_attr *out)
{
    mns_particle_set *set = context->set;
    const struct mns_attribute from = set->attributes[index].is;
    size_t components = (size_t)from.components, values = set->count * components;
    enum mns_type type = from.role == MNS_ROLE_ID ? MNS_I64 : from.role == MNS_ROLE_COLOR ? MNS_F32 : MNS_F64;
    struct attribute *added = mns_set_extra(context, "", type, from.components, true);
    if (!added) {
        return MNS_ERR_OUT_OF_MEMORY;
    }
    if (type == MNS_I64) {
        to_id(added->data, from.data, values, from.type);
    } else if (type == MNS_F32) {
        to_linear((float *)(void *)added->data, from.data, values, from.type);
    } else {
        to_double(added->data, from.data, values, from.type);
    }
    *out = view_of(&added->is);
    return MNS_OK;
}

mns_result mns_roles_views(struct read_context *context)
{
    mns_particle_set *set = context->set;
    struct mns_particles *particles = &set->particles;
    struct mns_attr *const views[MNS_ROLE_COUNT] = {
        [MNS_ROLE_POSITION] = &particles->position, [MNS_ROLE_VELOCITY] = &particles->velocity, [MNS_ROLE_DENSITY] = &particles->density,
        [MNS_ROLE_RADIUS] = &particles->radius,     [MNS_ROLE_MASS] = &particles->mass,         [MNS_ROLE_ID] = &particles->id,
        [MNS_ROLE_COLOR] = &particles->color,
    };
    particles->count = set->count;
    for (size_t i = 0; i < set->listed_count; i++) {
        const struct mns_attribute *attribute = &set->attributes[i].is;
        struct mns_attr *view = views[attribute->role];
        if (!view || set->count == 0) {
            continue;
        }
        *view = view_of(attribute);
        if ((attribute->role == MNS_ROLE_ID) == is_float(attribute->type)) {
            mns_result result = convert(context, i, view);
            if (result != MNS_OK) {
                return result;
            }
        }
    }
    return MNS_OK;
}
