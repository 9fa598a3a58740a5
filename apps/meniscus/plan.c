/* plan.c: which pictures are drawn, and which inputs they need. */
#include "plan.h"

#include "program.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* A time closer to a frame's than this part of a step is the frame's: files give times in a few digits. */
static const double SAME = 1e-3;

/* Picture `part` of those of input i. Where times are known, pictures are evenly spaced in time; else from frame to frame. */
static struct shot shot_of(const struct inputs *inputs, size_t i, int part, int parts, bool timed)
{
    struct shot shot = {.input = i, .fraction = (double)part / parts, .step = 1.0 / parts, .number = parts * inputs->list[i].number + part};
    size_t last = inputs->count - 1;
    if (!timed || parts == 1) {
        return shot;
    }
    double whole = inputs->list[last].time - inputs->list[0].time, step = whole / (double)last;
    double time = inputs->list[0].time + ((double)i + shot.fraction) * step;
    size_t at = 0;
    while (at < last && inputs->list[at + 1].time <= time + SAME * step) {
        at++;
    }
    double interval = at < last ? inputs->list[at + 1].time - inputs->list[at].time : step;
    shot.input = at;
    shot.fraction = at < last ? (time - inputs->list[at].time) / interval : 0;
    shot.fraction = shot.fraction > SAME ? shot.fraction : 0;
    shot.step = step / parts / interval;
    return shot;
}

static bool add_shots(struct plan *plan, const struct inputs *inputs, const struct options *options, long long first, long long last)
{
    bool timed = inputs_timed(inputs);
    size_t parts = (size_t)options->retime;
    plan->shots = inputs->count <= SIZE_MAX / parts ? calloc(inputs->count * parts, sizeof(*plan->shots)) : NULL;
    plan->needed = calloc(inputs->count, sizeof(*plan->needed));
    for (size_t i = 0; plan->shots && i < inputs->count; i++) {
        long long number = inputs->list[i].number;
        if (number < first || number > last || (number - first) % options->step != 0) {
            continue;
        }
        int count = i + 1 < inputs->count ? options->retime : 1;
        for (int part = 0; part < count; part++) {
            plan->shots[plan->count++] = shot_of(inputs, i, part, options->retime, timed);
        }
    }
    return plan->shots && plan->needed;
}

int plan_make(struct plan *plan, const struct inputs *inputs, const struct options *options)
{
    *plan = (struct plan){.count = 0};
    long long lowest = inputs->list[0].number, highest = lowest;
    for (size_t i = 0; i < inputs->count; i++) {
        lowest = inputs->list[i].number < lowest ? inputs->list[i].number : lowest;
        highest = inputs->list[i].number > highest ? inputs->list[i].number : highest;
    }
    if (!add_shots(plan, inputs, options, options->has_first ? options->first : lowest, options->has_last ? options->last : highest)) {
        return program_fail("out of memory");
    }
    return plan->count
               ? STATUS_DONE
               : program_usage("--frames chooses none of the %zu frames, whose numbers are %lld to %lld", inputs->count, lowest, highest);
}

void plan_resume(struct plan *plan, const struct outputs *outputs)
{
    size_t left = 0;
    bool all = false; /* of a video, all pictures or none */
    for (size_t i = 0; outputs_in_order(outputs) && i < plan->count; i++) {
        all = all || !outputs_exist(outputs, plan->shots[i].number);
    }
    for (size_t i = 0; i < plan->count; i++) {
        if (all || !outputs_exist(outputs, plan->shots[i].number)) {
            plan->shots[left++] = plan->shots[i];
        }
    }
    plan->skipped = plan->count - left;
    plan->count = left;
}

bool shot_moves(const struct shot *shot, const struct options *options) { return shot->fraction > 0 || options->shutter > 0; }

void plan_needs(struct plan *plan, const struct inputs *inputs, const struct options *options)
{
    memset(plan->needed, 0, inputs->count * sizeof(*plan->needed));
    for (size_t i = 0; i < plan->count; i++) {
        const struct shot *shot = &plan->shots[i];
        plan->needed[shot->input] = true;
        if (shot_moves(shot, options) && shot->input + 1 < inputs->count) {
            plan->needed[shot->input + 1] = true;
        }
    }
}

void plan_reach_back(struct plan *plan, const struct inputs *inputs, size_t depth)
{
    size_t reach = 0;
    for (size_t i = inputs->count; i-- > 0;) {
        if (plan->needed[i]) {
            reach = depth;
        } else if (reach > 0) {
            plan->needed[i] = true;
            reach--;
        }
    }
}

void plan_free(struct plan *plan)
{
    free(plan->shots);
    free(plan->needed);
    *plan = (struct plan){0};
}
