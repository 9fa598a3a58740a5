/* splat_cut.h: spheres that are not drawn whole: cut by the near or far plane or by the scene, or around the eye. */
#ifndef MNS_CPU_SPLAT_CUT_H
#define MNS_CPU_SPLAT_CUT_H

#include "cpu/splat.h"

/* The scene about one tile. */
struct cut_scene {
    const struct plane *depth;              /* of the picture */
    struct depth_range ranges[TILE_BLOCKS]; /* in each 16 x 8 pixels of the tile; none: from DEPTH_EMPTY to 0 */
};

/* The range of the scene's depth in pixels x0 to x1, y0 to y1 from the tile's corner, inclusive; they may reach out of the tile. */
struct depth_range mns_cut_range(const struct cut_scene *scene, int x0, int x1, int y0, int y1);

/* As the kernels depth and thickness, for any chunk, in double precision and without hurry: few spheres of a picture need it.
 * Where the near root lies before the near plane, the depth is the near plane's.
 * which: bit i for particle i of the chunk. scene: what thickness ends at, or NULL; a texel takes the mean over its pixels. */
size_t mns_cut_depth(const struct splat_view *view, struct splat_tile *tile, size_t chunk, float limit);
void mns_cut_thickness(const struct splat_view *view, struct splat_tile *tile, size_t chunk, uint64_t which, const struct cut_scene *scene);

#endif
