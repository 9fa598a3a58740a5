/* plan.c: which pictures are drawn, and which inputs they need. */
#include "plan.h"

#include "program.h"

#include <stdlib.h>
#include <string.h>

int plan_make(struct plan *plan, const struct inputs *inputs, const struct options *options)
{
    *plan = (struct plan){.shots = calloc(inputs->count, sizeof(*plan->shots)), .needed = calloc(inputs->count, sizeof(*plan->needed))};
    if (!plan->shots || !plan->needed) {
        return program_fail("out of memory");
    }
    long long lowest = inputs->list[0].number, highest = lowest;
    for (size_t i = 0; i < inputs->count; i++) {
        lowest = inputs->list[i].number < lowest ? inputs->list[i].number : lowest;
        highest = inputs->list[i].number > highest ? inputs->list[i].number : highest;
    }
    long long first = options->has_first ? options->first : lowest, last = options->has_last ? options->last : highest;
    for (size_t i = 0; i < inputs->count; i++) {
        long long number = inputs->list[i].number;
        if (number >= first && number <= last && (number - first) % options->step == 0) {
            plan->shots[plan->count++] = (struct shot){.input = i, .number = number};
        }
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

void plan_needs(struct plan *plan, const struct inputs *inputs)
{
    memset(plan->needed, 0, inputs->count * sizeof(*plan->needed));
    for (size_t i = 0; i < plan->count; i++) {
        plan->needed[plan->shots[i].input] = true;
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
