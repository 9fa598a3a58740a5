/* outputs.h: where the images of a picture go: their shapes, names and files. */
#ifndef MENISCUS_OUTPUTS_H
#define MENISCUS_OUTPUTS_H

#include "inputs.h"
#include "options.h"
#include "video.h"

enum { OUTPUT_MAX = MNS_LAYER_COUNT + 1 };

enum output_kind {
    OUTPUT_FILE,
    OUTPUT_STREAM_PNG,
    OUTPUT_STREAM_RGBA,
    OUTPUT_VIDEO,
    OUTPUT_EXR_LAYER /* in the file of the first output */
};

struct output {
    enum output_kind kind;
    const char *pattern; /* a name or a pattern */
    enum mns_layer layer;
    struct mns_image shape; /* without memory */
};

struct outputs {
    struct output list[OUTPUT_MAX];
    size_t count;
    const struct encoder *encoder; /* of the video; NULL: none, or a .y4m */
    struct video *video;           /* once it is open */
    bool exr_float;                /* colours too */
    char *look;                    /* what an .exr tells of its parameters; NULL: none */
};

/* Plans the outputs. pictures: how many will be drawn. Returns a status; on failure it was told why. */
int outputs_plan(struct outputs *outputs, const struct options *options, const struct inputs *inputs, size_t pictures);

/* Opens what takes all pictures, and ends it: whole says that none is missing. Return a status; on failure it was told why. */
int outputs_open(struct outputs *outputs, const struct options *options);
int outputs_close(struct outputs *outputs, bool whole);

/* Whether pictures must be written one after the other, in their order. */
bool outputs_in_order(const struct outputs *outputs);

/* One picture's images, with their memory: what mns_renderer_draw is given. Returns a status. */
int outputs_images(const struct outputs *outputs, struct mns_output images[OUTPUT_MAX]);
void outputs_free_images(const struct outputs *outputs, struct mns_output images[OUTPUT_MAX]);
size_t outputs_bytes(const struct outputs *outputs); /* of one picture's images */

bool outputs_exist(const struct outputs *outputs, long long number); /* all the files of this picture, whole */

/* Whether a picture's file tells of its camera. */
bool outputs_tell_camera(const struct outputs *outputs);

/* Writes one picture. camera: NULL where it is not known. Tells nothing, and may be called in any thread; false: message says why. */
bool outputs_write(const struct outputs *outputs, const struct mns_output images[OUTPUT_MAX], long long number,
                   const struct mns_camera *camera, struct mns_message *message);

/* Whether `frames` files can be made under this name or pattern: it has numbers, names no input, and its folder takes files. Returns a status. */
int outputs_check_place(const char *pattern, const struct inputs *inputs, size_t frames);

#endif
