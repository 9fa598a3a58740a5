/* fluids.c: several fluids: their files, what is the same for all, and their drawing, back to front. */
#include "fluids.h"

#include "fluids_mix.h"
#include "load.h"
#include "program.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct fluid {
    struct options options; /* the program's, with this fluid's parameters */
    struct survey survey;
    struct inputs inputs; /* empty for the first */
    struct source *source;
    struct source_frame *frame; /* of the picture; NULL for the first */
    mns_renderer *renderer;
    mns_anisotropy *anisotropy;

    /* Of the picture in hand. */
    struct mns_params params;
    struct mns_stats stats;
};

struct fluids {
    struct fluid *list; /* [count]; the first's renderer is the drawing's */
    size_t count;
    mns_renderer *backdrop; /* holds no particles: draws what stands behind all, and encodes the finished picture */
    struct mix mix;
};

/* ---- before the first frame ---- */

static int refuse(const struct options *options)
{
    const struct mns_params *params = &options->params;
    if (options->retime > 1 || options->shutter > 0) {
        return program_usage("--retime and --shutter take one fluid, not several");
    }
    if (params->foam != MNS_FOAM_NONE || options->foam_file_count > 0) {
        return program_usage("foam is drawn of one fluid, not of several; leave --foam and --foam-particles out");
    }
    if (params->display != MNS_DISPLAY_BEAUTY && params->display != MNS_DISPLAY_OPAQUE && params->display != MNS_DISPLAY_SPHERES &&
        params->display != MNS_DISPLAY_COLOR) {
        return program_usage("of several fluids, --display shows beauty, opaque, spheres or color");
    }
    for (size_t i = 0; i < options->layer_count; i++) {
        if (!mix_takes(options->layers[i].layer)) {
            return program_usage("layer %s is of one fluid; of several there are depth, depth_raw, normal, curvature, color, thickness, "
                                 "thickness_raw, transmittance, alpha, scene_color and scene_depth",
                                 mns_layer_name(options->layers[i].layer));
        }
    }
    return STATUS_DONE;
}

static int check_numbers(const char *name, const struct inputs *inputs, const struct inputs *first)
{
    bool same = inputs->count == first->count;
    for (size_t i = 0; same && i < inputs->count; i++) {
        same = inputs->list[i].number == first->list[i].number;
        if (!strcmp(inputs->list[i].path, "-")) {
            return program_usage("-: standard input must be the only input");
        }
    }
    if (first->count == 1 && inputs->count == 1) { /* one picture, whatever the numbers */
        return STATUS_DONE;
    }
    return same ? STATUS_DONE
                : program_usage(
                      "fluid %s: its %zu frames have the numbers %lld to %lld, the first fluid's %zu %lld to %lld; they must be the "
                      "same",
                      name, inputs->count, inputs->list[0].number, inputs->list[inputs->count - 1].number, first->count,
                      first->list[0].number, first->list[first->count - 1].number);
}

static int open_fluid(struct fluid *fluid, const struct fluid_option *given, const struct inputs *first, const struct outputs *outputs)
{
    int status = inputs_add(&fluid->inputs, given->files);
    inputs_number(&fluid->inputs);
    status = status == STATUS_DONE ? check_numbers(given->name, &fluid->inputs, first) : status;
    for (size_t i = 0; status == STATUS_DONE && i < outputs->count; i++) {
        if (outputs->list[i].kind == OUTPUT_FILE) {
            status = outputs_check_place(outputs->list[i].pattern, &fluid->inputs, 1);
        }
    }
    status = status == STATUS_DONE ? survey_inputs(&fluid->survey, &fluid->inputs, &fluid->options) : status;
    return status == STATUS_DONE ? program_renderer(&fluid->renderer, &fluid->options) : status;
}

static void widen(struct survey *all, const struct survey *one)
{
    bool first = all->count == 0;
    for (int i = 0; i < 3 && one->count > 0; i++) {
        all->bounds_min[i] = first ? one->bounds_min[i] : fmin(all->bounds_min[i], one->bounds_min[i]);
        all->bounds_max[i] = first ? one->bounds_max[i] : fmax(all->bounds_max[i], one->bounds_max[i]);
        all->inner_min[i] = first ? one->inner_min[i] : fmin(all->inner_min[i], one->inner_min[i]);
        all->inner_max[i] = first ? one->inner_max[i] : fmax(all->inner_max[i], one->inner_max[i]);
    }
    all->radius = fmax(all->radius, one->radius);
    all->value_low = fmin(all->value_low, one->value_low);
    all->value_high = fmax(all->value_high, one->value_high);
    all->count += one->count;
}

/* One floor for all: under the lowest particle of any, with the cells of a fluid of their whole volume, two to its size as in the library. */
static void share_floor(struct fluids *fluids)
{
    float height = INFINITY, volume = 0;
    for (size_t i = 0; i < fluids->count; i++) {
        struct mns_params params = fluids->list[i].options.params;
        survey_fix_params(&fluids->list[i].survey, false, false, &params);
        height = params.floor_height > -1e30f ? fminf(height, params.floor_height) : height;
        volume += params.fluid_size * params.fluid_size * params.fluid_size;
    }
    for (size_t i = 0; i < fluids->count; i++) {
        struct mns_params *params = &fluids->list[i].options.params;
        params->floor_height = isfinite(height) ? height : 0;
        params->floor_cell = params->floor_cell > 0 ? params->floor_cell : volume > 0 ? cbrtf(volume) / 2 : 1;
    }
}

/* The renderer without particles. */
static int open_backdrop(struct fluids *fluids, const struct options *options)
{
    struct mns_particles none;
    mns_particles_init(&none);
    int status = program_renderer(&fluids->backdrop, options);
    if (status == STATUS_DONE && mns_renderer_prepare(fluids->backdrop, &none) != MNS_OK) {
        status = program_fail("%s", mns_renderer_message(fluids->backdrop));
    }
    return status == STATUS_DONE && !mix_create(&fluids->mix, fluids->count, options->width, options->height)
               ? program_fail("out of memory for %zu fluids of %dx%d pixels", fluids->count, options->width, options->height)
               : status;
}

int fluids_begin(struct fluids **out, const struct options *options, const struct inputs *inputs, const struct outputs *outputs,
                 struct survey *survey)
{
    *out = NULL;
    if (options->fluid_count == 0) {
        return STATUS_DONE;
    }
    struct fluids *fluids = *out = calloc(1, sizeof(*fluids));
    struct fluid *list = calloc(options->fluid_count + 1, sizeof(*list));
    if (!fluids || !list) {
        free(list);
        return program_fail("out of memory");
    }
    fluids->list = list;
    fluids->count = options->fluid_count + 1;
    list[0].options = *options;
    list[0].survey = *survey;
    int status = check_numbers("", inputs, inputs);
    for (size_t i = 0; status == STATUS_DONE && i < fluids->count; i++) {
        list[i].options = *options;
        list[i].options.params = i > 0 ? options->fluids[i - 1].params : options->params;
        status = refuse(&list[i].options);
        if (status == STATUS_DONE &&
            (list[i].options.params.display == MNS_DISPLAY_COLOR) != (options->params.display == MNS_DISPLAY_COLOR)) {
            status = program_usage("display color is for all fluids or for none");
        }
        status = status == STATUS_DONE && i > 0 ? open_fluid(&list[i], &options->fluids[i - 1], inputs, outputs) : status;
        status = status == STATUS_DONE ? program_anisotropy(&list[i].anisotropy, &list[i].options) : status;
        if (status == STATUS_DONE && i > 0) {
            widen(survey, &list[i].survey);
        }
    }
    share_floor(fluids);
    return status == STATUS_DONE ? open_backdrop(fluids, options) : status;
}

void fluids_end(struct fluids *fluids)
{
    for (size_t i = 0; fluids && i < fluids->count; i++) {
        struct fluid *fluid = &fluids->list[i];
        inputs_free(&fluid->inputs);
        mns_anisotropy_destroy(&fluid->anisotropy);
        if (i > 0) {
            mns_renderer_destroy(&fluid->renderer);
        }
    }
    if (fluids) {
        mns_renderer_destroy(&fluids->backdrop);
        mix_destroy(&fluids->mix);
        free(fluids->list);
        free(fluids);
    }
}

/* ---- frames ---- */

int fluids_start(struct fluids *fluids, const bool *wanted, const struct coloring *coloring)
{
    for (size_t i = 1; fluids && i < fluids->count; i++) {
        struct fluid *fluid = &fluids->list[i];
        fluid->source = source_start(&fluid->inputs, wanted, &fluid->options, coloring);
        if (!fluid->source) {
            return STATUS_FAILED;
        }
    }
    return STATUS_DONE;
}

void fluids_stop(struct fluids *fluids)
{
    for (size_t i = 1; fluids && i < fluids->count; i++) {
        source_stop(fluids->list[i].source);
        fluids->list[i].source = NULL;
        fluids->list[i].frame = NULL;
    }
}

const struct source_frame *fluids_next(struct fluids *fluids)
{
    const struct source_frame *bad = NULL;
    for (size_t i = 1; fluids && i < fluids->count; i++) {
        struct fluid *fluid = &fluids->list[i];
        source_release(fluid->source, fluid->frame);
        fluid->frame = source_next(fluid->source);
        if (fluid->frame && fluid->frame->set) {
            load_tell(&fluid->frame->notes, fluid->inputs.list[fluid->frame->input].path, &fluid->options);
        } else if (!bad) {
            bad = fluid->frame;
        }
    }
    return bad;
}

/* ---- one picture ---- */

static int prepare(struct fluid *fluid, mns_renderer *renderer, const struct mns_particles *particles, const char *name)
{
    struct mns_particles shaped = *particles;
    fluid->renderer = renderer;
    fluid->params = fluid->options.params;
    survey_fix_params(&fluid->survey, particles->radius.data != NULL, particles->mass.data != NULL, &fluid->params);
    fluid->params.exposure = 0; /* the finished picture's */
    mns_stats_init(&fluid->stats);
    if (fluid->anisotropy) {
        if (mns_anisotropy_step(fluid->anisotropy, particles, &fluid->params) != MNS_OK) {
            return program_fail("%s: %s", name, mns_anisotropy_message(fluid->anisotropy));
        }
        mns_anisotropy_attach(fluid->anisotropy, &shaped);
    }
    return mns_renderer_prepare(renderer, &shaped) == MNS_OK ? STATUS_DONE : program_fail("%s: %s", name, mns_renderer_message(renderer));
}

/* What all draws of a picture share. */
struct shared {
    const char *name;
    struct mns_frame frame; /* camera, environment, objects */
};

static int draw(const struct shared *shared, mns_renderer *renderer, const struct mns_params *params, const struct mns_scene *scene,
                const struct mns_output *outputs, size_t count)
{
    struct mns_frame frame = shared->frame;
    frame.params = params;
    frame.scene = scene;
    frame.objects = scene ? NULL : frame.objects;
    frame.outputs = outputs;
    frame.output_count = count;
    return mns_renderer_draw(renderer, &frame) == MNS_OK ? STATUS_DONE
                                                         : program_fail("%s: %s", shared->name, mns_renderer_message(renderer));
}

/* What stands behind all, with the shadow of each. */
static int draw_scene(struct fluids *fluids, const struct shared *shared)
{
    struct mix *mix = &fluids->mix;
    struct mns_params params = fluids->list[0].params;
    params.display = MNS_DISPLAY_BEAUTY;
    struct mns_output outputs[2];
    mix_scene_outputs(mix, outputs);
    int status = draw(shared, fluids->backdrop, &params, NULL, outputs, 2);
    mix_begin(mix);
    for (size_t i = 0; status == STATUS_DONE && i < fluids->count && (params.floor || shared->frame.objects); i++) {
        status = draw(shared, fluids->list[i].renderer, &fluids->list[i].params, NULL, mix_shadow_output(mix, outputs), 1);
        if (status == STATUS_DONE) {
            mix_add_shadow(mix);
        }
    }
    return status;
}

/* Each by itself over the scene: its depth, its colours, the layers that are asked for. */
static int draw_each(struct fluids *fluids, const struct shared *shared, const struct mns_scene *scene, const struct mns_output *images,
                     size_t image_count)
{
    for (size_t i = 0; i < fluids->count; i++) {
        struct fluid *fluid = &fluids->list[i];
        struct mns_output outputs[MIX_OUTPUTS];
        size_t count = mix_outputs(&fluids->mix, i, images, image_count, outputs);
        int status = count ? draw(shared, fluid->renderer, &fluid->params, scene, outputs, count) : program_fail("out of memory");
        if (status != STATUS_DONE) {
            return status;
        }
        mns_renderer_stats(fluid->renderer, &fluid->stats);
        mix_add_layers(&fluids->mix, i, outputs, count, images, image_count);
    }
    mix_end_layers(&fluids->mix, images, image_count);
    return STATUS_DONE;
}

/* From the farthest to the nearest: each over what is behind it. The farthest of all stand over the scene, as they were drawn already. */
static int draw_in_order(struct fluids *fluids, const struct shared *shared)
{
    struct mix *mix = &fluids->mix;
    mix_order(mix);
    for (int rank = 1; rank <= (int)fluids->count; rank++) {
        bool any = false;
        struct mns_scene behind = mix_scene(mix);
        for (size_t i = 0; i < fluids->count; i++) {
            if (!mix_has_rank(mix, i, rank)) {
                continue;
            }
            struct mns_output output = mix_beauty(mix, i);
            int status = rank > 1 ? draw(shared, fluids->list[i].renderer, &fluids->list[i].params, &behind, &output, 1) : STATUS_DONE;
            if (status != STATUS_DONE) {
                return status;
            }
            mix_take(mix, i, rank);
            any = true;
        }
        if (!any) {
            return STATUS_DONE;
        }
        mix_next(mix);
    }
    return STATUS_DONE;
}

static int encode(struct fluids *fluids, const struct shared *shared, const struct mns_output *beauty, bool transparent)
{
    const struct options *options = &fluids->list[0].options;
    struct mns_params params = options->params;
    if (params.display == MNS_DISPLAY_COLOR) { /* as the legend has them */
        params.exposure = 0;
        params.tone_map = MNS_TONE_MAP_NONE;
    }
    params.display = MNS_DISPLAY_BEAUTY;
    params.antialias = 0;
    struct mns_scene scene = mix_scene(&fluids->mix);
    int status = draw(shared, fluids->backdrop, &params, &scene, beauty, 1);
    if (status == STATUS_DONE && transparent) {
        mix_write_alpha(&fluids->mix, &beauty->image);
    }
    return status;
}

static void sum_stats(const struct fluids *fluids, struct mns_stats *stats)
{
    *stats = fluids->list[0].stats;
    for (size_t i = 1; i < fluids->count; i++) {
        const struct mns_stats *more = &fluids->list[i].stats;
        stats->measure.count += more->measure.count;
        stats->particles_visible += more->particles_visible;
        stats->particles_splatted += more->particles_splatted;
        stats->pixels_covered += more->pixels_covered;
        stats->prepare_ms += more->prepare_ms;
        stats->draw_ms += more->draw_ms;
        stats->bytes += more->bytes;
        stats->peak_bytes += more->peak_bytes;
        for (int k = 0; k < stats->stage_count && k < more->stage_count; k++) {
            stats->stage_ms[k] += more->stage_ms[k];
        }
    }
}

int fluids_draw(const struct drawing *drawing, const struct mns_particles *particles, const struct moment *moment,
                const struct mns_output *images, size_t image_count, struct mns_stats *stats)
{
    struct fluids *fluids = drawing->fluids;
    struct shared shared = {.name = moment->name};
    struct mns_camera camera;
    int status = prepare(&fluids->list[0], drawing->renderer, particles, moment->name);
    for (size_t i = 1; status == STATUS_DONE && i < fluids->count; i++) {
        struct fluid *fluid = &fluids->list[i];
        status = prepare(fluid, fluid->renderer, &fluid->frame->particles, fluid->inputs.list[fluid->frame->input].path);
    }
    status = status == STATUS_DONE ? draw_camera(drawing, stats, moment, &camera) : status;
    mns_frame_init(&shared.frame);
    shared.frame.camera = &camera;
    shared.frame.params = &fluids->list[0].params;
    if (status == STATUS_DONE) {
        status = scenery_draw(drawing->scenery, fluids->backdrop, (long long)moment->number, &shared.frame);
    }
    bool transparent = fluids->list[0].params.background == MNS_BACKGROUND_TRANSPARENT;
    status = status == STATUS_DONE ? draw_scene(fluids, &shared) : status;
    struct mns_scene scene = mix_scene(&fluids->mix);
    status = status == STATUS_DONE ? draw_each(fluids, &shared, transparent ? NULL : &scene, images, image_count) : status;
    if (status == STATUS_DONE && transparent) {
        mix_pile(&fluids->mix);
    } else if (status == STATUS_DONE) {
        status = draw_in_order(fluids, &shared);
    }
    for (size_t i = 0; status == STATUS_DONE && i < image_count; i++) {
        if (images[i].layer == MNS_LAYER_BEAUTY) {
            status = encode(fluids, &shared, &images[i], transparent);
        }
    }
    sum_stats(fluids, stats);
    return status;
}
