/* bench.c: `meniscus bench`: steady-state time per stage, with no file access in the loop. Every frame is a new view: the camera turns by a
 * little, so that nothing can be kept from the frame before but what belongs to the particles. */
#include "inputs.h"
#include "json_file.h"
#include "load.h"
#include "look.h"
#include "program.h"
#include "stats.h"
#include "survey.h"
#include "view.h"

#include <stdlib.h>
#include <string.h>

enum { PREPARES = 3 };

static const double TURN = 0.05; /* degrees from view to view */

struct bench {
    const struct options *options;
    const char *path;
    mns_renderer *renderer;
    struct survey survey;
    struct mns_output picture;  /* RGBA8 */
    mns_classifier *classifier; /* NULL: no foam */
    mns_anisotropy *anisotropy; /* NULL: spheres */
    double classify_ms;         /* the best of PREPARES */
    double prepare_ms;          /* the same */
    double anisotropy_ms;       /* the same */
    double *frame_ms;           /* [options->repeat], sorted in the end */
    double *stage_ms;           /* [MNS_STAGE_MAX][options->repeat], the same */
    struct mns_stats stats;     /* of the last frame */
};

static int compare(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

static double median(const double *sorted, size_t count)
{
    return count % 2 ? sorted[count / 2] : 0.5 * (sorted[count / 2 - 1] + sorted[count / 2]);
}

static int draw(struct bench *bench, double index)
{
    struct options turned = *bench->options;
    turned.camera.orbit += TURN;
    struct mns_camera camera;
    int status = view_camera(&camera, &turned, &bench->survey, index, 0);
    if (status != STATUS_DONE) {
        return status;
    }
    struct mns_frame frame;
    mns_frame_init(&frame);
    frame.camera = &camera;
    frame.params = &turned.params;
    frame.outputs = &bench->picture;
    frame.output_count = 1;
    if (mns_renderer_draw(bench->renderer, &frame) != MNS_OK) {
        return program_fail("%s: %s", bench->path, mns_renderer_message(bench->renderer));
    }
    mns_renderer_stats(bench->renderer, &bench->stats);
    return STATUS_DONE;
}

/* Classifies the set as if it were the next frame of a sequence. */
static int classify(struct bench *bench, int i, struct mns_particles *particles)
{
    if (!bench->classifier) {
        return STATUS_DONE;
    }
    struct mns_class_stats stats;
    mns_class_stats_init(&stats);
    if (mns_classifier_step(bench->classifier, particles, i / 30.0, &bench->options->params) != MNS_OK) {
        return program_fail("%s: %s", bench->path, mns_classifier_message(bench->classifier));
    }
    mns_classifier_attach(bench->classifier, particles);
    mns_classifier_stats(bench->classifier, &stats);
    bench->classify_ms = i == 0 || stats.step_ms < bench->classify_ms ? stats.step_ms : bench->classify_ms;
    return STATUS_DONE;
}

/* Gives the set's particles shapes. */
static int find_shapes(struct bench *bench, int i, struct mns_particles *particles)
{
    if (!bench->anisotropy) {
        return STATUS_DONE;
    }
    struct mns_shape_stats stats;
    mns_shape_stats_init(&stats);
    if (mns_anisotropy_step(bench->anisotropy, particles, &bench->options->params) != MNS_OK) {
        return program_fail("%s: %s", bench->path, mns_anisotropy_message(bench->anisotropy));
    }
    mns_anisotropy_attach(bench->anisotropy, particles);
    mns_anisotropy_stats(bench->anisotropy, &stats);
    bench->anisotropy_ms = i == 0 || stats.step_ms < bench->anisotropy_ms ? stats.step_ms : bench->anisotropy_ms;
    return STATUS_DONE;
}

static int prepare(struct bench *bench, const struct mns_particles *given)
{
    for (int i = 0; i < PREPARES; i++) {
        struct mns_particles particles = *given;
        if (classify(bench, i, &particles) != STATUS_DONE || find_shapes(bench, i, &particles) != STATUS_DONE) {
            return STATUS_FAILED;
        }
        if (mns_renderer_prepare(bench->renderer, &particles) != MNS_OK) {
            return program_fail("%s: %s", bench->path, mns_renderer_message(bench->renderer));
        }
        mns_renderer_stats(bench->renderer, &bench->stats);
        survey_from_measure(&bench->survey, &bench->stats.measure);
        int status = draw(bench, -1); /* the shadow of a new set counts as preparing it */
        if (status != STATUS_DONE) {
            return status;
        }
        bench->prepare_ms = i == 0 || bench->stats.prepare_ms < bench->prepare_ms ? bench->stats.prepare_ms : bench->prepare_ms;
    }
    return STATUS_DONE;
}

static int measure(struct bench *bench)
{
    size_t repeat = (size_t)bench->options->repeat;
    long long first = -bench->options->warmup;
    int status = STATUS_DONE;
    for (long long i = first; status == STATUS_DONE && i < bench->options->repeat && !program_signal(); i++) {
        status = draw(bench, (double)(i - first));
        if (i < 0) {
            continue;
        }
        bench->frame_ms[i] = bench->stats.draw_ms;
        for (int stage = 0; stage < bench->stats.stage_count; stage++) {
            bench->stage_ms[(size_t)stage * repeat + (size_t)i] = bench->stats.stage_ms[stage];
        }
    }
    if (status == STATUS_DONE && program_signal()) {
        return program_stopped();
    }
    qsort(bench->frame_ms, repeat, sizeof(*bench->frame_ms), compare);
    for (int stage = 0; stage < MNS_STAGE_MAX; stage++) {
        qsort(bench->stage_ms + (size_t)stage * repeat, repeat, sizeof(*bench->stage_ms), compare);
    }
    return status;
}

static void tell(const struct bench *bench, cJSON *list)
{
    const struct options *options = bench->options;
    const struct mns_stats *stats = &bench->stats;
    size_t repeat = (size_t)options->repeat;
    double stages[MNS_STAGE_MAX], middle = median(bench->frame_ms, repeat);
    char filter[64];
    mns_params_get(&options->params, "filter", filter, sizeof(filter));
    for (int stage = 0; stage < stats->stage_count; stage++) {
        stages[stage] = median(bench->stage_ms + (size_t)stage * repeat, repeat);
    }
    if (!list) {
        printf("%s\n  %zu particles, %dx%d, %s %s, %d threads, %s, %zu frames\n", bench->path, stats->measure.count, options->width,
               options->height, stats->backend, stats->isa, stats->threads, filter, repeat);
        if (bench->classifier) {
            printf("  classify %7.2f ms per new particle set\n", bench->classify_ms);
        }
        if (bench->anisotropy) {
            printf("  anisotropy %5.2f ms per new particle set\n", bench->anisotropy_ms);
        }
        printf("  prepare %8.2f ms per new particle set\n  frame   %8.2f ms per new view (median; best %.2f, worst %.2f)\n",
               bench->prepare_ms, middle, bench->frame_ms[0], bench->frame_ms[repeat - 1]);
        for (int stage = 0; stage < stats->stage_count; stage++) {
            printf("    %-10s %8.2f ms\n", stats->stage_name[stage], stages[stage]);
        }
        printf("  memory  %8.1f MiB at most\n", (double)stats->peak_bytes / 1048576);
        return;
    }
    cJSON *item = cJSON_CreateObject();
    cJSON_AddItemToArray(list, item);
    cJSON_AddStringToObject(item, "path", bench->path);
    json_add_number(item, "particles", (double)stats->measure.count);
    json_add_number(item, "width", options->width);
    json_add_number(item, "height", options->height);
    cJSON_AddStringToObject(item, "backend", stats->backend);
    json_add_number(item, "threads", stats->threads);
    cJSON_AddStringToObject(item, "isa", stats->isa);
    cJSON_AddStringToObject(item, "filter", filter);
    if (bench->classifier) {
        json_add_number(item, "classify_ms", bench->classify_ms);
    }
    if (bench->anisotropy) {
        json_add_number(item, "anisotropy_ms", bench->anisotropy_ms);
    }
    json_add_number(item, "prepare_ms", bench->prepare_ms);
    cJSON *frame = cJSON_AddObjectToObject(item, "frame_ms");
    json_add_number(frame, "min", bench->frame_ms[0]);
    json_add_number(frame, "median", middle);
    json_add_number(frame, "max", bench->frame_ms[repeat - 1]);
    stats_add_stages(item, stats->stage_count, stats->stage_name, stages);
    json_add_number(item, "peak_bytes", (double)stats->peak_bytes);
}

static int create(struct bench *bench)
{
    const struct options *options = bench->options;
    size_t repeat = (size_t)options->repeat;
    mns_stats_init(&bench->stats);
    bench->picture = (struct mns_output){
        .layer = MNS_LAYER_BEAUTY,
        .image = {.width = options->width, .height = options->height, .channels = 4, .pixel = MNS_PIXEL_U8},
    };
    bench->picture.image.data = malloc(4 * (size_t)options->width * (size_t)options->height);
    bench->frame_ms = calloc(repeat, sizeof(*bench->frame_ms));
    bench->stage_ms = calloc(repeat * MNS_STAGE_MAX, sizeof(*bench->stage_ms));
    if (!bench->picture.image.data || !bench->frame_ms || !bench->stage_ms) {
        return program_fail("%s: out of memory", bench->path);
    }
    if (options->params.foam != MNS_FOAM_NONE && program_classifier(&bench->classifier, options) != STATUS_DONE) {
        return STATUS_FAILED;
    }
    int status = program_anisotropy(&bench->anisotropy, options);
    return status == STATUS_DONE ? program_renderer(&bench->renderer, options) : status;
}

static int bench_file(const struct options *options, const char *path, cJSON *list)
{
    struct bench bench = {.options = options, .path = path};
    struct mns_message message;
    mns_particle_set *set;
    if (program_check_picture(options->width, options->height) != STATUS_DONE) {
        return STATUS_FAILED;
    }
    if (load_particles(&set, path, options, &message) != MNS_OK) {
        return program_fail("%s", message.text);
    }
    int status = create(&bench);
    status = status == STATUS_DONE ? prepare(&bench, mns_particle_set_particles(set)) : status;
    mns_particle_set_destroy(&set);
    status = status == STATUS_DONE ? measure(&bench) : status;
    if (status == STATUS_DONE) {
        tell(&bench, list);
    }
    mns_renderer_destroy(&bench.renderer);
    mns_classifier_destroy(&bench.classifier);
    mns_anisotropy_destroy(&bench.anisotropy);
    free(bench.picture.image.data);
    free(bench.frame_ms);
    free(bench.stage_ms);
    return status;
}

/* A name on the command line: a case file with its own view, or particle files. */
static int bench_name(const struct options *options, const char *name, cJSON *list)
{
    struct options own = *options;
    struct inputs inputs = {0};
    char *particles = NULL;
    int status = view_is_case(name) ? view_read_case(&own, name, &particles) : STATUS_DONE;
    status = status == STATUS_DONE ? inputs_add(&inputs, particles ? particles : name) : status;
    for (size_t i = 0; status == STATUS_DONE && i < inputs.count; i++) {
        status = bench_file(&own, inputs.list[i].path, list);
    }
    inputs_free(&inputs);
    free(particles);
    return status;
}

int command_bench(struct options *options)
{
    int status = options->input_count ? STATUS_DONE : program_usage("bench needs an input: meniscus bench INPUT...");
    program_catch_interrupts();
    cJSON *list = options->json ? cJSON_CreateArray() : NULL;
    status = status == STATUS_DONE && options->camera_file ? view_read_camera(options, options->camera_file) : status;
    status = status == STATUS_DONE && options->save_look ? look_write(options->save_look, &options->params) : status;
    for (size_t i = 0; status == STATUS_DONE && i < options->input_count; i++) {
        status = bench_name(options, options->inputs[i], list);
    }
    if (status == STATUS_DONE && list) {
        return json_write("-", list);
    }
    cJSON_Delete(list);
    return status == STATUS_DONE && !program_flush() ? STATUS_FAILED : status;
}
