/* motion.c: particles between two frames. */
#include "motion.h"

#include "program.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

static const uint32_t NONE = UINT32_MAX;

/* What is interpolated, and how. */
enum way { STRAIGHT, CURVED, COPIED };

static const struct row {
    size_t offset; /* in struct mns_particles */
    int components;
    enum way way;
    bool optional; /* absent means the value that follows; others must be in both frames */
    float absent;
    bool fades; /* goes to 0 where a particle vanishes */
} rows[] = {
    {offsetof(struct mns_particles, position), 3, CURVED, false, 0, false},
    {offsetof(struct mns_particles, radius), 1, STRAIGHT, false, 0, false},
    {offsetof(struct mns_particles, mass), 1, STRAIGHT, false, 0, false},
    {offsetof(struct mns_particles, color), 3, STRAIGHT, false, 0, false},
    {offsetof(struct mns_particles, velocity), 3, STRAIGHT, false, 0, false},
    {offsetof(struct mns_particles, density), 1, STRAIGHT, false, 0, false},
    {offsetof(struct mns_particles, id), 1, COPIED, false, 0, false},
    {offsetof(struct mns_particles, water), 1, STRAIGHT, true, 1, true},
    {offsetof(struct mns_particles, foam), 1, STRAIGHT, true, 0, true},
    {offsetof(struct mns_particles, foam_age), 1, STRAIGHT, true, 0, false},
    {offsetof(struct mns_particles, spray), 1, STRAIGHT, true, 0, true},
    {offsetof(struct mns_particles, noise), 1, STRAIGHT, true, 1, false},
    {offsetof(struct mns_particles, shape), 6, STRAIGHT, false, 0, false},
    {offsetof(struct mns_particles, kind), 1, COPIED, false, 0, false},
};

enum { ROWS = sizeof(rows) / sizeof(rows[0]), POSITION = 0 };

struct array {
    void *data;
    size_t size; /* bytes */
};

struct motion {
    const struct mns_particles *from, *to; /* to NULL: none */
    struct mns_particles out;
    struct array arrays[ROWS], match, fresh, links, slots;
    size_t fresh_count; /* particles of to that have no partner */
    double seconds;     /* by which velocities are multiplied; 0: they are not used */
};

struct motion *motion_create(void) { return calloc(1, sizeof(struct motion)); }

void motion_destroy(struct motion *motion)
{
    if (!motion) {
        return;
    }
    for (size_t i = 0; i < ROWS; i++) {
        free(motion->arrays[i].data);
    }
    free(motion->match.data);
    free(motion->fresh.data);
    free(motion->links.data);
    free(motion->slots.data);
    free(motion);
}

double motion_seconds(const struct motion *motion) { return motion->seconds; }

/* Makes room for count elements, whose contents are lost; NULL after telling why. */
static void *room(struct array *array, size_t count, size_t element)
{
    size_t size = count * element + 1; /* never NULL for none */
    if (size > array->size) {
        free(array->data);
        array->data = malloc(size);
        array->size = array->data ? size : 0;
    }
    if (!array->data) {
        program_fail("out of memory for %zu particles between frames", count);
    }
    return array->data;
}

/* ---- elements ---- */

static const struct mns_attr *attr_of(const struct mns_particles *particles, const struct row *row)
{
    return (const struct mns_attr *)(const void *)((const char *)particles + row->offset);
}

static const void *place_of(const struct mns_attr *attr, int components, size_t i, int c)
{
    size_t size = mns_type_size(attr->type), stride = attr->stride ? attr->stride : size * (size_t)components;
    return (const char *)attr->data + i * stride + (size_t)c * size;
}

#define AS(type, out)                                                                                                                      \
    do {                                                                                                                                   \
        type value;                                                                                                                        \
        memcpy(&value, at, sizeof(value));                                                                                                 \
        return (out)value;                                                                                                                 \
    } while (0)
#define BY_TYPE(out)                                                                                                                       \
    switch (attr->type) {                                                                                                                  \
    case MNS_F32: AS(float, out);                                                                                                          \
    case MNS_F64: AS(double, out);                                                                                                         \
    case MNS_I8: AS(int8_t, out);                                                                                                          \
    case MNS_U8: AS(uint8_t, out);                                                                                                         \
    case MNS_I16: AS(int16_t, out);                                                                                                        \
    case MNS_U16: AS(uint16_t, out);                                                                                                       \
    case MNS_I32: AS(int32_t, out);                                                                                                        \
    case MNS_U32: AS(uint32_t, out);                                                                                                       \
    case MNS_I64: AS(int64_t, out);                                                                                                        \
    case MNS_U64: AS(uint64_t, out);                                                                                                       \
    }                                                                                                                                      \
    return 0

static double element(const struct mns_attr *attr, int components, size_t i, int c)
{
    const void *at = place_of(attr, components, i, c);
    BY_TYPE(double);
}

/* Ids as whole numbers; those of a float type that hold none are all alike. */
static int64_t whole_element(const struct mns_attr *attr, size_t i)
{
    if (attr->type == MNS_F32 || attr->type == MNS_F64) {
        double value = element(attr, 1, i, 0);
        return value > -9e18 && value < 9e18 ? (int64_t)value : INT64_MIN;
    }
    const void *at = place_of(attr, 1, i, 0);
    BY_TYPE(int64_t);
}

static void vector(const struct mns_attr *attr, size_t i, double out[3])
{
    for (int c = 0; c < 3; c++) {
        out[c] = element(attr, 3, i, c);
    }
}

/* ---- partners ---- */

/* Of the particles of one id in `to`: any of them, which tells the id, and the first that has no partner; the next one is in links. */
struct slot {
    uint32_t any, first;
};

static struct slot *find(struct slot *slots, size_t mask, const struct mns_attr *ids, int64_t id)
{
    size_t at = (size_t)(((uint64_t)id * UINT64_C(0x9e3779b97f4a7c15)) >> 20) & mask; /* the golden ratio's bits spread runs of ids */
    while (slots[at].any != NONE && whole_element(ids, slots[at].any) != id) {
        at = (at + 1) & mask;
    }
    return &slots[at];
}

/* Partners by id; of several particles of one id, the k-th of `from` and the k-th of `to`. */
static bool match_ids(struct motion *motion, uint32_t *match)
{
    const struct mns_attr *from = &motion->from->id, *to = &motion->to->id;
    size_t slot_count = 16;
    while (slot_count < 2 * motion->to->count) {
        slot_count *= 2;
    }
    struct slot *slots = room(&motion->slots, slot_count, sizeof(*slots));
    uint32_t *links = room(&motion->links, motion->to->count, sizeof(*links));
    if (!slots || !links) {
        return false;
    }
    memset(slots, 0xff, slot_count * sizeof(*slots));
    for (size_t i = motion->to->count; i-- > 0;) {
        struct slot *slot = find(slots, slot_count - 1, to, whole_element(to, i));
        links[i] = slot->first;
        *slot = (struct slot){.any = (uint32_t)i, .first = (uint32_t)i};
    }
    for (size_t i = 0; i < motion->from->count; i++) {
        struct slot *slot = find(slots, slot_count - 1, to, whole_element(from, i));
        match[i] = slot->any != NONE ? slot->first : NONE;
        slot->first = match[i] != NONE ? links[match[i]] : NONE;
    }
    return true;
}

static void match_indices(const struct motion *motion, uint32_t *match)
{
    for (size_t i = 0; i < motion->from->count; i++) {
        match[i] = i < motion->to->count ? (uint32_t)i : NONE;
    }
}

/* The distance between partners. */
static double distance(const struct motion *motion, size_t i, size_t j, double d[3])
{
    double a[3], b[3];
    vector(&motion->from->position, i, a);
    vector(&motion->to->position, j, b);
    for (int c = 0; c < 3; c++) {
        d[c] = b[c] - a[c];
    }
    return sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
}

/* The longest side of the box around the particles of both frames. */
static double extent_of(const struct motion *motion)
{
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY}, longest = 0;
    const struct mns_particles *const frames[2] = {motion->from, motion->to};
    for (int f = 0; f < 2; f++) {
        for (size_t i = 0; i < frames[f]->count; i++) {
            double at[3];
            vector(&frames[f]->position, i, at);
            for (int c = 0; c < 3; c++) {
                low[c] = at[c] < low[c] ? at[c] : low[c];
                high[c] = at[c] > high[c] ? at[c] : high[c];
            }
        }
    }
    for (int c = 0; c < 3; c++) {
        longest = fmax(longest, high[c] - low[c]);
    }
    return longest;
}

/* Parts partners that are half the fluid's size from each other, unless most are: a particle that leaves a periodic box on one side and comes in on the
 * other, or whose id is used anew. */
static void part_far(const struct motion *motion, uint32_t *match)
{
    double sum = 0, d[3], far = 0.5 * extent_of(motion);
    size_t count = 0;
    for (size_t i = 0; i < motion->from->count; i++) {
        double size = match[i] != NONE ? distance(motion, i, match[i], d) : NAN;
        if (isfinite(size)) {
            sum += size;
            count++;
        }
    }
    far = fmax(far, count ? 4 * sum / (double)count : 0);
    for (size_t i = 0; i < motion->from->count; i++) {
        if (match[i] != NONE && !(distance(motion, i, match[i], d) <= far)) {
            match[i] = NONE;
        }
    }
}

static bool has_velocities(const struct motion *motion) { return motion->from->velocity.data && motion->to->velocity.data; }

/* Twice the mean velocity of partners. */
static void twice_velocity(const struct motion *motion, size_t i, size_t j, double out[3])
{
    double v[3], w[3];
    vector(&motion->from->velocity, i, v);
    vector(&motion->to->velocity, j, w);
    for (int c = 0; c < 3; c++) {
        out[c] = v[c] + w[c];
    }
}

/* The time step is the factor from mean velocity v to displacement d, by least squares, and so of the file's own units. Velocities that explain less than
 * a quarter of the displacements are of something else: 0. */
static double fit_seconds(const struct motion *motion, const uint32_t *match)
{
    double dd = 0, dv = 0, vv = 0;
    for (size_t i = 0; has_velocities(motion) && i < motion->from->count; i++) {
        if (match[i] == NONE) {
            continue;
        }
        double d[3], v[3];
        distance(motion, i, match[i], d);
        twice_velocity(motion, i, match[i], v);
        double along = 0.5 * (d[0] * v[0] + d[1] * v[1] + d[2] * v[2]), square = 0.25 * (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
        if (isfinite(along) && isfinite(square)) {
            dd += d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
            dv += along;
            vv += square;
        }
    }
    return dv > 0 && dv * dv >= 0.25 * dd * vv ? dv / vv : 0;
}

/* Lists the particles of `to` that no one of `from` is the partner of. */
static bool find_fresh(struct motion *motion, const uint32_t *match)
{
    uint32_t *fresh = room(&motion->fresh, motion->to->count, sizeof(*fresh));
    uint32_t *taken = room(&motion->links, motion->to->count, sizeof(*taken));
    if (!fresh || !taken) {
        return false;
    }
    memset(taken, 0, motion->to->count * sizeof(*taken));
    for (size_t i = 0; i < motion->from->count; i++) {
        if (match[i] != NONE) {
            taken[match[i]] = 1;
        }
    }
    for (size_t j = 0; j < motion->to->count; j++) {
        if (!taken[j]) {
            fresh[motion->fresh_count++] = (uint32_t)j;
        }
    }
    return true;
}

int motion_between(struct motion *motion, const struct mns_particles *from, const struct mns_particles *to, double seconds)
{
    motion->from = from;
    motion->to = to;
    motion->fresh_count = 0;
    motion->seconds = from->velocity.data ? seconds : 0;
    uint32_t *match = room(&motion->match, from->count, sizeof(*match));
    if (!match) {
        return STATUS_FAILED;
    }
    if (!to) {
        memset(match, 0xff, from->count * sizeof(*match));
        return STATUS_DONE;
    }
    if (!from->id.data || !to->id.data) {
        match_indices(motion, match);
    } else if (!match_ids(motion, match)) {
        return STATUS_FAILED;
    }
    part_far(motion, match);
    motion->seconds = fit_seconds(motion, match);
    return find_fresh(motion, match) ? STATUS_DONE : STATUS_FAILED;
}

/* ---- in between ---- */

/* A value of a particle that is in one frame alone: it goes on by its velocity for `after` seconds. */
static double lone(const struct motion *motion, const struct row *row, const struct mns_particles *in, size_t i, int c, double after)
{
    const struct mns_attr *attr = attr_of(in, row);
    double value = attr->data ? element(attr, row->components, i, c) : (double)row->absent;
    return row->way == CURVED && motion->seconds > 0 ? value + after * element(&in->velocity, 3, i, c) : value;
}

static double both(const struct motion *motion, const struct row *row, size_t i, size_t j, int c, double t)
{
    const struct mns_attr *from = attr_of(motion->from, row), *to = attr_of(motion->to, row);
    double a = from->data ? element(from, row->components, i, c) : (double)row->absent;
    double b = to->data ? element(to, row->components, j, c) : (double)row->absent;
    if (row->way != CURVED || motion->seconds <= 0) {
        return a + t * (b - a);
    }
    double va = motion->seconds * element(&motion->from->velocity, 3, i, c), vb = motion->seconds * element(&motion->to->velocity, 3, j, c);
    return a + t * (va + t * (3 * (b - a) - 2 * va - vb + t * (2 * (a - b) + va + vb)));
}

static void store(void *data, enum mns_type type, size_t index, double value)
{
    if (type == MNS_F64) {
        ((double *)data)[index] = value;
    } else {
        ((float *)data)[index] = (float)value;
    }
}

static void fill(const struct motion *motion, const struct row *row, void *data, enum mns_type type, double t)
{
    const uint32_t *match = motion->match.data, *fresh = motion->fresh.data;
    size_t n = motion->from->count, components = (size_t)row->components;
    double leaving = motion->to && row->fades ? 1 - t : 1, coming = row->fades ? t : 1;
    for (size_t i = 0; i < n * components; i++) {
        size_t k = i / components;
        int c = (int)(i % components);
        store(data, type, i,
              match[k] != NONE ? both(motion, row, k, match[k], c, t)
                               : leaving * lone(motion, row, motion->from, k, c, t * motion->seconds));
    }
    for (size_t i = 0; i < motion->fresh_count * components; i++) {
        double value = lone(motion, row, motion->to, fresh[i / components], (int)(i % components), (t - 1) * motion->seconds);
        store(data, type, n * components + i, coming * value);
    }
}

static void copy(const struct motion *motion, const struct row *row, int64_t *data)
{
    const uint32_t *fresh = motion->fresh.data;
    for (size_t i = 0; i < motion->from->count; i++) {
        data[i] = whole_element(attr_of(motion->from, row), i);
    }
    for (size_t i = 0; i < motion->fresh_count; i++) {
        data[motion->from->count + i] = whole_element(attr_of(motion->to, row), fresh[i]);
    }
}

/* Whether the particles in between have it: both frames do, but for a frame without particles. */
static bool is_there(const struct motion *motion, const struct row *row)
{
    bool from = attr_of(motion->from, row)->data, to = motion->to && attr_of(motion->to, row)->data;
    bool in_from = from || motion->from->count == 0, in_to = to || !motion->to || motion->to->count == 0;
    bool fading = row->absent > 0 && row->fades && motion->to; /* water: what vanishes and appears has it */
    return row->optional ? from || to || fading : (from || to) && in_from && in_to;
}

static bool make(struct motion *motion, size_t which, double t)
{
    const struct row *row = &rows[which];
    struct mns_attr *out = (struct mns_attr *)(void *)((char *)&motion->out + row->offset);
    *out = (struct mns_attr){.type = row->way == COPIED ? MNS_I64 : MNS_F32};
    if (!is_there(motion, row)) {
        return true;
    }
    bool is_double = attr_of(motion->from, row)->type == MNS_F64 || (motion->to && attr_of(motion->to, row)->type == MNS_F64);
    out->type = which == POSITION && is_double ? MNS_F64 : out->type;
    void *data = room(&motion->arrays[which], motion->out.count * (size_t)row->components, mns_type_size(out->type));
    if (!data) {
        return false;
    }
    if (row->way == COPIED) {
        copy(motion, row, data);
    } else {
        fill(motion, row, data, out->type, t);
    }
    out->data = data;
    return true;
}

const struct mns_particles *motion_at(struct motion *motion, double t)
{
    if (t <= 0) {
        return motion->from;
    }
    mns_particles_init(&motion->out);
    motion->out.count = motion->from->count + motion->fresh_count;
    for (size_t i = 0; i < ROWS; i++) {
        if (!make(motion, i, t)) {
            return NULL;
        }
    }
    return &motion->out;
}
