/* classify_run.c: leads all particles of a step, block by block, through the arithmetic. */
#include "particles/classifier.h"

#include "core/attr.h"
#include "core/message.h"
#include "particles/sample.h"

#include <math.h>

/* VOLUME_UNIT: of what a block's volumes are whole numbers, which add up alike in any order and fit 32 bits. */
enum { JOB = 64 * CLASSIFY_BLOCK, PLACES = 4096, VOLUME_UNIT = 1 << 20 };

/* What a block reads, where it is not in arrays already. */
struct scratch {
    float velocity[3][CLASSIFY_BLOCK], density[CLASSIFY_BLOCK], before[KEEP_COUNT][CLASSIFY_BLOCK];
};

struct run {
    struct step *step;
    float *const *was, *const *is, *const *out;
    float *velocity;          /* [count][3], derived */
    const double *old_places; /* NULL: unknown */
    double *new_places;       /* NULL: velocities are given */
    float fastest2;           /* m^2/s^2: square of the speed that crosses the scene in a step */
};

static const float NOT_KNOWN = NAN;

static inline void velocity_loop(const struct mns_attr *velocity, enum mns_type type, size_t begin, size_t count, struct scratch *scratch)
{
    for (size_t i = 0; i < count; i++) {
        for (int k = 0; k < 3; k++) {
            scratch->velocity[k][i] = (float)mns_attr_get(velocity, type, 3, begin + i, k);
        }
    }
}

/* The index of a particle in the frame before, or ID_NONE. */
static inline uint32_t origin_of(const struct run *run, size_t i)
{
    return run->step->self->by_id ? run->step->self->from[i] : i < run->step->before ? (uint32_t)i : ID_NONE;
}

/* Velocities from two frames' positions, written to the derived attribute (0 where they cannot be told). */
static void derive_velocity(const struct run *run, size_t begin, size_t count, struct scratch *scratch)
{
    const struct mns_attr *position = &run->step->particles->position;
    for (size_t i = 0; i < count; i++) {
        uint32_t from = run->old_places && run->step->before > 0 ? origin_of(run, begin + i) : ID_NONE;
        for (int k = 0; k < 3; k++) {
            double place = mns_attr_get(position, position->type, 3, begin + i, k);
            double moved = from != ID_NONE ? place - run->old_places[3 * (size_t)from + (size_t)k] : NAN;
            float speed = (float)(moved / run->step->seconds);
            run->new_places[3 * (begin + i) + (size_t)k] = place;
            scratch->velocity[k][i] = speed;
            run->velocity[3 * (begin + i) + (size_t)k] = isfinite(speed) ? speed : 0;
        }
    }
}

static void load_velocity(const struct run *run, size_t begin, size_t count, struct scratch *scratch)
{
    const struct mns_attr *velocity = &run->step->particles->velocity;
    if (run->new_places) {
        derive_velocity(run, begin, count, scratch);
    } else if (velocity->type == MNS_F32) {
        velocity_loop(velocity, MNS_F32, begin, count, scratch);
    } else {
        velocity_loop(velocity, velocity->type, begin, count, scratch);
    }
    for (size_t i = 0; i < count; i++) {
        float x = scratch->velocity[0][i], y = scratch->velocity[1][i], z = scratch->velocity[2][i], sum = x * x + y * y + z * z;
        if (!(sum < INFINITY)) { /* all or nothing */
            scratch->velocity[0][i] = scratch->velocity[1][i] = scratch->velocity[2][i] = NOT_KNOWN;
        }
    }
}

static inline void density_loop(const struct mns_attr *density, enum mns_type type, size_t begin, size_t count, struct scratch *scratch)
{
    for (size_t i = 0; i < count; i++) {
        scratch->density[i] = (float)mns_attr_get(density, type, 1, begin + i, 0);
    }
}

/* Densities over that of the fluid at rest. Just emitted particles have 0 in some simulators: not known. */
static void load_density(const struct run *run, size_t begin, size_t count, struct scratch *scratch)
{
    const struct step *step = run->step;
    const struct mns_attr *density = &step->particles->density;
    const float scale = step->reference > 0 ? (float)(1 / step->reference) : 0, unit = (float)step->unit;
    if (step->sums) {
        memcpy(scratch->density, step->sums + begin, count * sizeof(float));
    } else if (!density->data) {
        memset(scratch->density, 0, count * sizeof(float));
    } else if (density->type == MNS_F32) {
        density_loop(density, MNS_F32, begin, count, scratch);
    } else {
        density_loop(density, density->type, begin, count, scratch);
    }
    for (size_t i = 0; i < count; i++) {
        float relative = scale * scratch->density[i];
        scratch->density[i] = relative > 0 && relative < INFINITY ? relative : 1;
    }
    for (size_t i = 0; step->sums && i < count; i++) {
        run->out[OUT_DENSITY][begin + i] *= scale * unit;
    }
}

/* What was remembered of a block's particles: in place where they stood side by side, else gathered. */
static void load_before(const struct run *run, size_t begin, size_t count, struct scratch *scratch, struct classify_block *block)
{
    const struct step *step = run->step;
    uint32_t first = step->before > 0 ? origin_of(run, begin) : ID_NONE;
    bool together = first != ID_NONE && first + count <= step->before;
    for (size_t i = 1; together && i < count; i++) {
        together = origin_of(run, begin + i) == first + i;
    }
    for (int k = 0; k < KEEP_COUNT; k++) {
        if (together) {
            block->before[k] = run->was[k] + first;
            continue;
        }
        for (size_t i = 0; i < count; i++) {
            uint32_t from = step->before > 0 ? origin_of(run, begin + i) : ID_NONE;
            scratch->before[k][i] = from != ID_NONE ? run->was[k][from] : k < KEEP_X ? 0 : NOT_KNOWN;
        }
        block->before[k] = scratch->before[k];
    }
}

static void count_block(const struct run *run, const struct classify_block *block, struct tally *tally)
{
    const float *vx = block->velocity[0], *vy = block->velocity[1], *vz = block->velocity[2], *foam = block->foam, *spray = block->spray;
    const float fastest2 = run->fastest2;
    int foams = 0, sprays = 0, fast = 0, volume = 0;
    for (size_t i = 0; i < block->count; i++) {
        foams += foam[i] > 0;
        sprays += spray[i] > 0;
        fast += vx[i] * vx[i] + vy[i] * vy[i] + vz[i] * vz[i] > fastest2;
        volume += (int)(foam[i] * foam[i] * foam[i] * VOLUME_UNIT + 0.5f);
    }
    tally->foam += (size_t)foams;
    tally->spray += (size_t)sprays;
    tally->fast += (size_t)fast;
    tally->foam_volume += (double)volume / VOLUME_UNIT;
}

static void run_block(const struct run *run, size_t begin, size_t count, struct tally *tally)
{
    struct scratch scratch;
    struct classify_block block = {.count = count, .density = scratch.density};
    load_velocity(run, begin, count, &scratch);
    load_density(run, begin, count, &scratch);
    load_before(run, begin, count, &scratch, &block);
    for (int k = 0; k < 3; k++) {
        block.velocity[k] = scratch.velocity[k];
        memcpy(run->is[KEEP_X + k] + begin, scratch.velocity[k], count * sizeof(float));
    }
    for (int k = 0; k < KEEP_COUNT; k++) {
        block.after[k] = run->is[k] + begin;
    }
    block.water = run->out[OUT_WATER] + begin;
    block.foam = run->out[OUT_FOAM] + begin;
    block.foam_age = run->out[OUT_AGE] + begin;
    block.spray = run->out[OUT_SPRAY] + begin;
    block.noise = run->out[OUT_NOISE] + begin;
    mns_classify_block(&run->step->rule, &block);
    count_block(run, &block, tally);
}

static void run_job(void *context, int job)
{
    const struct run *run = context;
    size_t begin = (size_t)job * JOB, left = run->step->particles->count - begin, end = begin + (left < JOB ? left : JOB);
    struct tally tally = {0};
    for (size_t i = begin; i < end; i += CLASSIFY_BLOCK) {
        run_block(run, i, end - i < CLASSIFY_BLOCK ? end - i : CLASSIFY_BLOCK, &tally);
    }
    run->step->self->tallies[job] = tally;
}

/* ---- before and after ---- */

/* Length of the diagonal of the box around a sample of the particles, metres; 0: none has a place. */
static double scene_size(const struct mns_particles *in)
{
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY}, sum = 0;
    size_t run_length = in->count / PLACES + 1;
    for (size_t run = 0; in->position.data && run * run_length < in->count; run++) {
        size_t i = mns_sample_index(run, run_length);
        for (int k = 0; i < in->count && k < 3; k++) {
            double place = mns_attr_get(&in->position, in->position.type, 3, i, k);
            low[k] = isfinite(place) ? fmin(low[k], place) : low[k];
            high[k] = isfinite(place) ? fmax(high[k], place) : high[k];
        }
    }
    for (int k = 0; k < 3; k++) {
        sum += high[k] > low[k] ? (high[k] - low[k]) * (high[k] - low[k]) : 0;
    }
    return sqrt(sum);
}

static bool reserve(mns_classifier *self, size_t count, bool places)
{
    struct memory *memory = &self->memory;
    int next = !self->now;
    bool done = true;
    for (int i = 0; i < KEEP_COUNT; i++) {
        self->kept[next][i] = mns_memory_reserve(memory, self->kept[next][i], &self->kept_room[next][i], count, sizeof(float));
        done = done && self->kept[next][i];
    }
    for (int i = 0; i < OUT_DENSITY; i++) {
        self->out[next][i] = mns_memory_reserve(memory, self->out[next][i], &self->out_room[next][i], count, sizeof(float));
        done = done && self->out[next][i];
    }
    self->tallies = mns_memory_reserve(memory, self->tallies, &self->tally_room, count / JOB + 1, sizeof(*self->tallies));
    if (places) {
        self->velocity[next] = mns_memory_reserve(memory, self->velocity[next], &self->velocity_room[next], count, 3 * sizeof(float));
        self->places[next] = mns_memory_reserve(memory, self->places[next], &self->places_room[next], count, 3 * sizeof(double));
        done = done && self->velocity[next] && self->places[next];
    }
    return done && self->tallies;
}

static void tell_speeds(const struct step *step, const struct run *run, double scene)
{
    mns_classifier *self = step->self;
    double fastest2 = 0;
    for (size_t i = 0; self->stats.fast > 0 && i < step->particles->count; i++) {
        double x = (double)run->is[KEEP_X][i], y = (double)run->is[KEEP_Y][i], z = (double)run->is[KEEP_Z][i],
               speed2 = x * x + y * y + z * z;
        fastest2 = speed2 > fastest2 ? speed2 : fastest2;
    }
    if (self->stats.fast > 0) {
        mns_classifier_warn(
            self, WARN_FAST,
            "%zu particles would cross the scene (%.3g m) in one frame of %.3g s, the fastest at %.3g m/s: are the velocities in "
            "m/s, and is the time between frames right?",
            self->stats.fast, scene, step->seconds, sqrt(fastest2));
    }
}

mns_result mns_step_run(struct step *step)
{
    mns_classifier *self = step->self;
    const struct mns_particles *in = step->particles;
    bool places = !in->velocity.data;
    if (!reserve(self, in->count, places)) {
        return mns_fail(&self->message, MNS_ERR_OUT_OF_MEMORY, "out of memory for %zu particles", in->count);
    }
    int next = !self->now;
    double scene = step->before > 0 ? scene_size(in) : 0, fastest = scene > 0 ? scene / step->seconds : 1e18;
    struct run run = {.step = step, .was = self->kept[self->now], .is = self->kept[next], .fastest2 = (float)fmin(fastest * fastest, 1e36)};
    run.out = self->out[next];
    run.velocity = self->velocity[next];
    run.new_places = places ? self->places[next] : NULL;
    run.old_places = self->has_places ? self->places[self->now] : NULL;
    int jobs = (int)((in->count + JOB - 1) / JOB);
    self->parallel.run(self->parallel.user, run_job, &run, jobs);
    for (int job = 0; job < jobs; job++) {
        const struct tally *tally = &self->tallies[job];
        self->stats.foam += tally->foam;
        self->stats.spray += tally->spray;
        self->stats.fast += tally->fast;
        self->stats.foam_volume += tally->foam_volume;
    }
    self->derived_velocity = places;
    self->has_places = places;
    self->now = next;
    tell_speeds(step, &run, scene);
    return MNS_OK;
}
