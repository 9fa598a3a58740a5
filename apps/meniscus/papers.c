/* papers.c: `meniscus lab papers`: the settings of the papers' tables on sample scenes of as many particles, our milliseconds beside theirs.
 *
 * Their scenes are not to be had and their programs ran on graphics cards: the figures tell how far a processor is from that, no more. */
#include "load.h"
#include "options.h"
#include "program.h"
#include "progress.h"
#include "sample.h"

#include <stdlib.h>
#include <string.h>

/* What a table times. */
enum timed { TIMED_FRAME, TIMED_FILTER };

struct table {
    const char *source, *hardware, *note;
    enum timed timed;
    int width, height; /* pixels */
};

enum { LGS09_1, LGS09_2, BSW10_1, TY18_1, TABLES };

static const struct table tables[TABLES] = {
    [LGS09_1] = {"[LGS09] table 1", "GeForce 8800 GTS 512", "whole frame", TIMED_FRAME, 1024, 768},
    [LGS09_2] = {"[LGS09] table 2", "GeForce 8800 GTS 512", "whole frame; the flow's settings are not stated: half size, 40 steps",
                 TIMED_FRAME, 1024, 768},
    [BSW10_1] = {"[BSW10] table 1", "GeForce GTX 280", "whole frame without foam; smoothing at half size; 20k to 64k particles",
                 TIMED_FRAME, 1280, 720},
    [TY18_1] = {"[TY18] table 1", "GTX 1080", "the filter alone; the picture's size is not stated: 1920x1080", TIMED_FILTER, 1920, 1080},
};

/* One figure of a table. */
struct entry {
    int table;
    const char *name, *sample;
    size_t particles;
    int filter, iterations;
    int scale; /* of the smoothing: 1, 2, 4 */
    double paper_ms;
};

#define LGS09_SCENE(name, sample, bilateral, quarter, half, full)                                                                          \
    {LGS09_1, name, sample, 64000, MNS_FILTER_BILATERAL_1D, 1, 1, bilateral},                                                              \
        {LGS09_1, name, sample, 64000, MNS_FILTER_CURVATURE_FLOW, 15, 4, quarter},                                                         \
        {LGS09_1, name, sample, 64000, MNS_FILTER_CURVATURE_FLOW, 40, 2, half},                                                            \
    {                                                                                                                                      \
        LGS09_1, name, sample, 64000, MNS_FILTER_CURVATURE_FLOW, 100, 1, full                                                              \
    }

/* Three iterations of each, of the last two and the clean-up; 100 steps of curvature flow ([TY18] fig. 9). */
#define TY18_SCENE(name, sample, particles, bilateral, plane, flow, whole, line, cleanup)                                                  \
    {TY18_1, name, sample, particles, MNS_FILTER_BILATERAL, 3, 1, bilateral},                                                              \
        {TY18_1, name, sample, particles, MNS_FILTER_PLANE_FIT, 3, 1, plane},                                                              \
        {TY18_1, name, sample, particles, MNS_FILTER_CURVATURE_FLOW, 100, 1, flow},                                                        \
        {TY18_1, name, sample, particles, MNS_FILTER_NARROW_RANGE, 3, 1, whole},                                                           \
        {TY18_1, name, sample, particles, MNS_FILTER_NARROW_RANGE_1D, 3, 1, line},                                                         \
    {                                                                                                                                      \
        TY18_1, name, sample, particles, MNS_FILTER_NARROW_RANGE_1D_CLEANUP, 2, 1, cleanup                                                 \
    }

static const struct entry entries[] = {
    LGS09_SCENE("corridor", "crown", 18.1, 17.5, 19.6, 50.0),
    LGS09_SCENE("logo", "waves", 22.7, 23.3, 28.6, 50.0),
    {LGS09_2, "not stated", "crown", 64000, MNS_FILTER_CURVATURE_FLOW, 40, 2, 27.8},
    {LGS09_2, "not stated", "crown", 64000, MNS_FILTER_BILATERAL_1D, 1, 1, 25.6},
    {LGS09_2, "not stated", "crown", 64000, MNS_FILTER_BILATERAL_1D, 2, 1, 31.3},
    {LGS09_2, "not stated", "crown", 64000, MNS_FILTER_BILATERAL_1D, 4, 1, 38.5},
    {LGS09_2, "not stated", "crown", 64000, MNS_FILTER_BILATERAL_1D, 6, 1, 47.6},
    {BSW10_1, "waterfall", "crown", 64000, MNS_FILTER_ADAPTIVE_CURVATURE_FLOW, 256, 2, 14},
    {BSW10_1, "corridor", "waves", 64000, MNS_FILTER_ADAPTIVE_CURVATURE_FLOW, 256, 2, 12},
    {BSW10_1, "bamboo", "drop", 64000, MNS_FILTER_ADAPTIVE_CURVATURE_FLOW, 256, 2, 13},
    TY18_SCENE("armadillo", "crown", 368000, 0.40, 0.70, 5.02, 0.53, 0.51, 0.46),
    TY18_SCENE("bunny", "sphere", 333000, 0.46, 0.90, 5.50, 0.68, 0.58, 0.52),
    TY18_SCENE("emitter", "waves", 350000, 1.03, 1.95, 6.05, 1.58, 1.25, 1.21),
    TY18_SCENE("drop", "drop", 65000, 0.68, 1.51, 5.30, 1.23, 0.62, 0.54),
    TY18_SCENE("lucy", "crown", 135000, 0.48, 0.93, 4.34, 0.72, 0.62, 0.56),
    TY18_SCENE("tori", "block", 135000, 0.38, 0.72, 4.82, 0.53, 0.50, 0.46),
    TY18_SCENE("balls", "sphere", 180000, 0.62, 1.32, 5.80, 1.04, 0.67, 0.58),
};

enum { ENTRIES = sizeof(entries) / sizeof(entries[0]) };

struct papers {
    const struct options *options;
    mns_renderer *renderer;
    const struct entry *loaded; /* whose particles are prepared */
    unsigned char *picture;     /* the largest of the tables, RGBA8 */
    struct mns_stats stats;
    double ms[ENTRIES];
};

static int load(struct papers *papers, const struct entry *entry)
{
    if (papers->loaded && papers->loaded->particles == entry->particles && !strcmp(papers->loaded->sample, entry->sample)) {
        return STATUS_DONE;
    }
    struct sample_sink sink;
    int status = sample_fill(&sink, sample_find(entry->sample), entry->particles, "lab papers");
    if (status == STATUS_DONE) {
        struct mns_particles particles;
        mns_particles_init(&particles);
        particles.count = sink.kept;
        particles.position = (struct mns_attr){.data = sink.position, .type = MNS_F32};
        if (mns_renderer_prepare(papers->renderer, &particles) != MNS_OK) {
            status = program_fail("lab papers: %s", mns_renderer_message(papers->renderer));
        }
    }
    sample_free(&sink);
    papers->loaded = status == STATUS_DONE ? entry : NULL;
    mns_renderer_stats(papers->renderer, &papers->stats);
    return status;
}

static double stage_ms(const struct mns_stats *stats, const char *name)
{
    for (int i = 0; i < stats->stage_count; i++) {
        if (!strcmp(stats->stage_name[i], name)) {
            return stats->stage_ms[i];
        }
    }
    return 0;
}

/* The least of some draws: of the whole frame, or of its stage smooth. */
static int time_entry(struct papers *papers, size_t index)
{
    const struct entry *entry = &entries[index];
    const struct table *table = &tables[entry->table];
    const struct mns_measure *measure = &papers->stats.measure;
    int status = load(papers, entry);
    if (status != STATUS_DONE) {
        return status;
    }
    struct mns_params params = papers->options->params;
    params.filter = entry->filter;
    params.iterations = entry->iterations;
    params.smooth_scale = entry->scale;
    struct mns_camera camera;
    mns_camera_init(&camera, table->width, table->height);
    struct mns_output picture = {
        .layer = MNS_LAYER_BEAUTY,
        .image = {.data = papers->picture, .width = camera.width, .height = camera.height, .channels = 4, .pixel = MNS_PIXEL_U8}};
    struct mns_frame frame;
    mns_frame_init(&frame);
    frame.camera = &camera;
    frame.params = &params;
    frame.outputs = &picture;
    frame.output_count = 1;
    mns_result result = mns_camera_frame(&camera, measure->inner_min, measure->inner_max, measure->radius, 1, 45);
    for (long long i = 0; result == MNS_OK && i <= papers->options->repeat; i++) { /* the first warms up */
        result = mns_renderer_draw(papers->renderer, &frame);
        mns_renderer_stats(papers->renderer, &papers->stats);
        double ms = table->timed == TIMED_FRAME ? papers->stats.draw_ms : stage_ms(&papers->stats, "smooth");
        papers->ms[index] = i < 2 || ms < papers->ms[index] ? ms : papers->ms[index];
    }
    return result == MNS_OK ? STATUS_DONE : program_fail("lab papers: %s", mns_renderer_message(papers->renderer));
}

static void print_results(const struct papers *papers)
{
    static const char *const sizes[] = {"", "full", "half", "", "quarter"};
    printf("ours: %s, %d threads, on sample scenes; theirs: their scenes, on a graphics card\n", papers->stats.isa, papers->stats.threads);
    for (int i = 0; i < ENTRIES; i++) {
        const struct entry *entry = &entries[i];
        const struct table *table = &tables[entry->table];
        const char *filter = mns_param_find("filter")->choices[entry->filter];
        if (i == 0 || entries[i - 1].table != entry->table) {
            printf("\n%s, %s, %dx%d: %s\n  %-12s %-8s%9s  %-24s%6s  %-8s%10s%10s%8s\n", table->source, table->hardware, table->width,
                   table->height, table->note, "scene", "sample", "particles", "filter", "times", "size", "theirs ms", "ours ms", "ratio");
        }
        printf("  %-12s %-8s%9zu  %-24s%6d  %-8s%10.2f%10.2f%8.2f\n", entry->name, entry->sample, entry->particles, filter,
               entry->iterations, sizes[entry->scale], entry->paper_ms, papers->ms[i], papers->ms[i] / entry->paper_ms);
    }
}

int command_lab_papers(struct options *options)
{
    if (options->json || options->csv || options->output || options->plot || options->pictures || options->lab_filters ||
        options->lab_scenes) {
        return program_usage("lab papers prints text and takes no choice of filters, scenes or files");
    }
    struct papers papers = {.options = options};
    struct progress progress;
    mns_stats_init(&papers.stats);
    papers.picture = malloc((size_t)4 * 1920 * 1080); /* [TY18]'s, the largest */
    int status = papers.picture ? program_renderer(&papers.renderer, options) : program_fail("lab papers: out of memory");
    program_catch_interrupts();
    progress_begin(&progress, ENTRIES, options->quiet);
    for (size_t i = 0; status == STATUS_DONE && i < ENTRIES; i++) {
        status = program_signal() ? program_stopped() : time_entry(&papers, i);
        progress_step(&progress, "figure");
    }
    progress_clear();
    if (status == STATUS_DONE) {
        print_results(&papers);
    }
    mns_renderer_destroy(&papers.renderer);
    free(papers.picture);
    return status == STATUS_DONE && !program_flush() ? STATUS_FAILED : status;
}
