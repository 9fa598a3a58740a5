/* classify_inputs.c: what a step needs to know of its particles: which they are, how large the fluid is, how dense. */
#include "particles/classifier.h"

#include "core/attr.h"
#include "core/frame.h"
#include "core/message.h"
#include "cpu/measure.h"
#include "particles/density.h"
#include "particles/sample.h"

#include <math.h>

enum { SAMPLE = 32768 };

/* The density of a fluid at rest is the 90th percentile of a frame's: surfaces and splashes have less. */
static const size_t REST_RANK[2] = {9, 10};

/* Derived densities, over what a lattice of such particles has, below which not even the densest tenth of a frame is a fluid at rest. */
static const double DENSITY_LEAST = 0.6;

/* kg/m^3, of derived densities where nothing tells what the fluid is: water. */
static const double WATER = 1000;

/* Mean number of particles in the cells around one, from which on neighbours are not searched: the radius must be wrong by a factor. */
static const double CANDIDATES_MOST = 20000;

static mns_result out_of_memory(struct step *step)
{
    return mns_fail(&step->self->message, MNS_ERR_OUT_OF_MEMORY, "out of memory for %zu particles", step->particles->count);
}

/* ---- which particle is which ---- */

static void tell_ids(mns_classifier *self, const struct id_news *news)
{
    if (news->repeated > 0) {
        mns_classifier_warn(self, WARN_REPEATED, "%zu particles have the id of another (the first such id: %lld); they share its foam",
                            news->repeated, (long long)news->first_repeated);
    }
    if (news->vanished > 0) {
        mns_classifier_warn(self, WARN_VANISHED, "%zu particles vanish from one frame to the next, with their foam", news->vanished);
    }
    if (news->returned > 0) {
        mns_classifier_warn(self, WARN_RETURNED,
                            "%zu ids come back after frames without them (the first: %lld); they count as new particles", news->returned,
                            (long long)news->first_returned);
    }
}

static mns_result match_ids(struct step *step)
{
    mns_classifier *self = step->self;
    const struct mns_particles *in = step->particles;
    struct id_news news;
    self->from = mns_memory_reserve(&self->memory, self->from, &self->from_room, in->count, sizeof(*self->from));
    if (!self->from || !mns_ids_match(&self->ids, &self->memory, &self->parallel, &in->id, in->count, self->from, &news)) {
        return out_of_memory(step);
    }
    self->stats.appeared = news.appeared;
    self->stats.vanished = news.vanished;
    self->stats.returned = news.returned;
    self->stats.repeated = news.repeated;
    tell_ids(self, &news);
    return MNS_OK;
}

mns_result mns_step_match(struct step *step)
{
    mns_classifier *self = step->self;
    size_t count = step->particles->count;
    bool by_id = step->particles->id.data != NULL;
    if (step->before > 0 && by_id != self->by_id) { /* nothing tells which particle is which */
        step->before = 0;
        mns_ids_forget(&self->ids);
    }
    self->by_id = by_id;
    if (by_id) {
        return match_ids(step);
    }
    self->stats.appeared = count > step->before ? count - step->before : 0;
    self->stats.vanished = count < step->before ? step->before - count : 0;
    if (step->before > 0 && count != step->before) {
        mns_classifier_warn(
            self, WARN_COUNT,
            "the number of particles changes from %zu to %zu and they have no ids: each is taken for the one at its place in the "
            "file, so foam may jump; an attribute of ids (role id) prevents it",
            step->before, count);
    }
    return MNS_OK;
}

/* ---- how large ---- */

static void fill_facts(const struct step *step, struct particle_facts *facts)
{
    const struct mns_particles *in = step->particles;
    double sum = 0;
    size_t counted = 0;
    for (size_t i = 0; in->radius.data && i < in->count; i++) {
        double radius = mns_attr_get(&in->radius, in->radius.type, 1, i, 0);
        if (radius > 0 && radius < INFINITY) {
            sum += radius;
            counted++;
            facts->radius_cubed_sum += radius * radius * radius;
        }
    }
    for (size_t i = 0; in->mass.data && i < in->count; i++) {
        double mass = mns_attr_get(&in->mass, in->mass.type, 1, i, 0);
        facts->mass_sum += mass > 0 && mass < INFINITY ? mass : 0;
    }
    facts->count = in->count;
    facts->has_radius = counted > 0;
    facts->has_mass = in->mass.data != NULL;
    facts->spacing = step->self->spacing;
    facts->radius = counted > 0 ? sum / (double)counted : 0.5 * facts->spacing;
}

mns_result mns_step_sizes(struct step *step, double *fluid_size, double *radius)
{
    mns_classifier *self = step->self;
    const struct mns_particles *in = step->particles;
    const struct mns_params *params = &step->params;
    bool wants_size = params->fluid_size <= 0, wants_radius = !in->density.data || params->surface_tension > 0;
    bool has_volume = params->particle_volume > 0 || (in->mass.data && params->rest_density > 0);
    bool has_radius = params->radius > 0 || in->radius.data;
    if (self->spacing <= 0 && ((wants_radius && !has_radius) || (wants_size && !has_volume))) {
        struct mns_measure measure;
        mns_result result = mns_particles_measure(in, &self->memory.allocator, &measure, &self->message);
        if (result != MNS_OK) {
            return result;
        }
        self->spacing = measure.spacing;
    }
    struct particle_facts facts = {0};
    struct frame frame = {.params = *params, .facts = &facts};
    if (wants_size || wants_radius) {
        fill_facts(step, &facts);
    }
    mns_frame_resolve_sizes(&frame);
    *fluid_size = (double)frame.fluid_size;
    *radius = (double)frame.splat_radius / (double)params->radius_scale;
    return MNS_OK;
}

/* ---- how dense ---- */

/* The REST_RANK of the known densities; 0: there are none. */
static double density_at_rest(const struct step *step, float *sample)
{
    const struct mns_particles *in = step->particles;
    size_t run_length = in->count / SAMPLE + 1, taken = 0;
    for (size_t run = 0; run * run_length < in->count; run++) {
        size_t i = mns_sample_index(run, run_length);
        if (i < in->count) {
            sample[taken] = step->sums ? step->sums[i] : (float)mns_attr_get(&in->density, in->density.type, 1, i, 0);
            taken += sample[taken] > 0 && sample[taken] < INFINITY;
        }
    }
    return taken ? (double)mns_select(sample, taken, taken * REST_RANK[0] / REST_RANK[1]) : 0;
}

/* Sums over the neighbours; none where the radius cannot be right. */
static mns_result derive(struct step *step, double radius)
{
    mns_classifier *self = step->self;
    float **sums = &self->out[!self->now][OUT_DENSITY];
    *sums = mns_memory_reserve(&self->memory, *sums, &self->out_room[!self->now][OUT_DENSITY], step->particles->count, sizeof(float));
    if (!*sums) {
        return out_of_memory(step);
    }
    mns_result result = mns_grid_fill(&self->grid, &self->memory, &self->parallel, self->threads, step->particles, DENSITY_SUPPORT * radius,
                                      &self->message);
    if (result != MNS_OK) {
        return result;
    }
    if (self->grid.candidates > CANDIDATES_MOST) {
        mns_classifier_warn(self, WARN_DENSE, "densities are left out: a particle has %.0f others within %g m; is the radius, %g m, right?",
                            self->grid.candidates, 2 * DENSITY_SUPPORT * radius, radius);
        return MNS_OK;
    }
    mns_density_sum(&self->grid, &self->parallel, *sums, step->particles->count);
    step->sums = *sums;
    self->derived_density = true;
    return MNS_OK;
}

mns_result mns_step_densities(struct step *step, double radius)
{
    mns_classifier *self = step->self;
    bool given = step->particles->density.data != NULL;
    mns_result result = given ? MNS_OK : derive(step, radius);
    self->sample = mns_memory_reserve(&self->memory, self->sample, &self->sample_room, SAMPLE + 1, sizeof(*self->sample));
    if (result != MNS_OK || !self->sample) {
        return result == MNS_OK ? out_of_memory(step) : result;
    }
    double rest = (double)step->params.rest_density;
    step->unit = rest > 0 ? rest : WATER;
    if (step->sums) {
        step->reference = fmax(density_at_rest(step, self->sample), DENSITY_LEAST);
    } else if (given) {
        step->reference = rest > 0 ? rest : density_at_rest(step, self->sample);
    }
    self->stats.rest_density = given ? step->reference : step->unit;
    return MNS_OK;
}
