/* splat_cut.h: spheres that are not drawn whole: cut by the near or far plane or by the scene, or around the eye. */
#ifndef MNS_CPU_SPLAT_CUT_H
#define MNS_CPU_SPLAT_CUT_H

#include "cpu/splat.h"

/* The scene where a chunk may show. */
struct cut_scene {
    const struct plane *depth; /* of the picture */
    float nearest, farthest;   /* of it where the chunk may show, or wider */
};

/* As the kernels depth and thickness, for any chunk, in double precision and without hurry: few chunks of a picture need it.
 * Where the near root lies before the near plane, the depth is the near plane's.
 * scene: what thickness ends at, or NULL; a texel takes the mean over its pixels. */
size_t mns_cut_depth(const struct splat_view *view, struct splat_tile *tile, size_t chunk, float limit);
void mns_cut_thickness(const struct splat_view *view, struct splat_tile *tile, size_t chunk, const struct cut_scene *scene);

#endif
