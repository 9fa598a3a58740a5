/* stats.c: what the renderer and the program measured, as JSON. */
#include "stats.h"

#include "json_file.h"
#include "program.h"

#include <math.h>

/* Milliseconds to the microsecond: the clocks tell no more. */
static double rounded(double ms) { return round(ms * 1000) / 1000; }

cJSON *stats_create(const struct options *options)
{
    cJSON *stats = cJSON_CreateObject();
    json_add_number(stats, "width", options->width);
    json_add_number(stats, "height", options->height);
    cJSON_AddArrayToObject(stats, "frames");
    return stats;
}

void stats_add_stages(cJSON *object, int count, const char *const *names, const double *ms)
{
    cJSON *stages = cJSON_AddObjectToObject(object, "stages");
    for (int i = 0; i < count; i++) {
        json_add_number(stages, names[i], rounded(ms[i]));
    }
}

void stats_add_frame(cJSON *stats, long long number, const char *input, const struct mns_stats *measured, struct frame_times times)
{
    cJSON *frames = cJSON_GetObjectItemCaseSensitive(stats, "frames"), *frame = cJSON_CreateObject();
    cJSON_AddItemToArray(frames, frame);
    json_add_number(frame, "frame", (double)number);
    cJSON_AddStringToObject(frame, "input", input);
    cJSON_AddStringToObject(frame, "backend", measured->backend);
    cJSON_AddStringToObject(frame, "isa", measured->isa);
    json_add_number(frame, "threads", measured->threads);
    json_add_number(frame, "particles", (double)measured->measure.count);
    json_add_number(frame, "particles_visible", (double)measured->particles_visible);
    json_add_number(frame, "particles_splatted", (double)measured->particles_splatted);
    json_add_number(frame, "pixels_covered", (double)measured->pixels_covered);
    json_add_number(frame, "read_ms", rounded(times.read_ms));
    json_add_number(frame, "prepare_ms", rounded(measured->prepare_ms));
    json_add_number(frame, "draw_ms", rounded(measured->draw_ms));
    json_add_number(frame, "write_ms", rounded(times.write_ms));
    stats_add_stages(frame, measured->stage_count, measured->stage_name, measured->stage_ms);
    json_add_number(frame, "bytes", (double)measured->bytes);
    json_add_number(frame, "peak_bytes", (double)measured->peak_bytes);
}

int stats_write(const char *path, cJSON *stats, size_t failed)
{
    json_add_number(stats, "failed", (double)failed);
    json_add_number(stats, "peak_memory_bytes", program_peak_memory());
    return json_write(path, stats);
}
