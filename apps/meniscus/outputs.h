/* outputs.h: the images of a frame: their memory, names and files. */
#ifndef MENISCUS_OUTPUTS_H
#define MENISCUS_OUTPUTS_H

#include "inputs.h"
#include "options.h"

enum output_kind { OUTPUT_FILE, OUTPUT_STREAM_PNG, OUTPUT_STREAM_RGBA };

struct output {
    enum output_kind kind;
    const char *pattern; /* a name or a pattern */
};

struct outputs {
    struct output list[MNS_LAYER_COUNT + 1];
    struct mns_output images[MNS_LAYER_COUNT + 1]; /* what mns_renderer_draw is given */
    size_t count;
};

/* Plans the outputs and gets their memory. frames: how many will be drawn. Returns a status; outputs_free may always be called. */
int outputs_plan(struct outputs *outputs, const struct options *options, const struct inputs *inputs, size_t frames);
void outputs_free(struct outputs *outputs);

bool outputs_exist(const struct outputs *outputs, long long number); /* all the files of this frame */
int outputs_write(const struct outputs *outputs, long long number);  /* a status */

#endif
