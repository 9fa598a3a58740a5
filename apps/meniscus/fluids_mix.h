/* fluids_mix.h: the images of several fluids put into one, in linear light. */
#ifndef MENISCUS_FLUIDS_MIX_H
#define MENISCUS_FLUIDS_MIX_H

#include <meniscus/meniscus.h>

#include <stdbool.h>

enum { MIX_OUTPUTS = MNS_LAYER_COUNT };

struct mix {
    size_t count; /* fluids */
    int width, height;

    /* All [height][width][...] */
    float *behind[2];              /* [4]: what is behind the rank in hand, and what will be behind the next */
    float *open;                   /* [3]: the scene without shadows; later, transmittance of all */
    float *shaded;                 /* [3]: with one fluid's */
    float *scene_depth;            /* opaque things; +inf */
    float *nearest;                /* depth of the nearest fluid so far; +inf */
    float **beauty;                /* [count], [4] */
    float **depth;                 /* [count] */
    unsigned char **rank;          /* [count]: 1 for the farthest of the pixel's, 2 for the next; 0: it is not there */
    float *layer[MNS_LAYER_COUNT]; /* of one fluid; NULL until asked for */
};

bool mix_create(struct mix *mix, size_t count, int width, int height); /* false: out of memory; mix_destroy may be called */
void mix_destroy(struct mix *mix);

/* Whether the layer of several fluids is defined. */
bool mix_takes(enum mns_layer layer);

/* Where the scene without shadows is drawn; then mix_begin; then each fluid's scene, and mix_add_shadow. */
void mix_scene_outputs(struct mix *mix, struct mns_output outputs[2]);
void mix_begin(struct mix *mix);
const struct mns_output *mix_shadow_output(struct mix *mix, struct mns_output *out);
void mix_add_shadow(struct mix *mix);

/* What a fluid is drawn over now. */
struct mns_scene mix_scene(struct mix *mix);

/* What fluid i is drawn into first: its depth and beauty, and what the images ask for. Returns how many; 0: out of memory. */
size_t mix_outputs(struct mix *mix, size_t i, const struct mns_output *images, size_t image_count, struct mns_output outputs[MIX_OUTPUTS]);
void mix_add_layers(struct mix *mix, size_t i, const struct mns_output *outputs, size_t count, const struct mns_output *images,
                    size_t image_count);
void mix_end_layers(struct mix *mix, const struct mns_output *images, size_t image_count);

/* Ranks the fluids per pixel by their depths. A fluid is also at the pixels beside it, where its antialiased silhouette is. */
void mix_order(struct mix *mix);
bool mix_has_rank(const struct mix *mix, size_t i, int rank);
struct mns_output mix_beauty(struct mix *mix, size_t i);

/* Takes fluid i where it has the rank. */
void mix_take(struct mix *mix, size_t i, int rank);
void mix_next(struct mix *mix); /* what was taken is behind the next rank */

/* All beauties over each other, by straight alpha, over nothing: colours and alpha are then what is "behind". */
void mix_pile(struct mix *mix);
void mix_write_alpha(const struct mix *mix, const struct mns_image *image); /* where it has a fourth channel */

#endif
