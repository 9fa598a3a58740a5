/* silhouette.h: antialiased silhouettes: the last step of stage shade, on the finished picture. */
#ifndef MNS_CPU_SILHOUETTE_H
#define MNS_CPU_SILHOUETTE_H

#include "cpu/plane.h"

#include <meniscus/common.h>

struct backend;

/* What an edge is, and between what colours. */
struct silhouette {
    const struct depth_plane *depth; /* of the surface that was shaded */
    const struct plane *scene_depth; /* fluid that is not before it does not show; NULL: all does */
    float edge;                      /* metres: neighbours whose depths differ by more are apart */
    float slope;                     /* ... but for a surface this steep: metres per pixel, times the nearer depth unless orthographic */
    bool orthographic;
    const struct mns_image *image; /* finished: 3 or 4 channels, straight alpha; integers are sRGB */
};

/* Blends each pixel beside an edge with its neighbour across, in linear light and premultiplied, by the part of the pixel that the neighbour's surface
 * covers. The edge's course is taken from where it passes the rows (or columns) next to the pixel: a parabola through up to 2 * SILHOUETTE_REACH + 1
 * crossings. Of edges narrower than two pixels nothing is known, and they stay. The same bytes for any number of threads. false: out of memory. */
bool mns_silhouette_blend(struct backend *cpu, const struct silhouette *silhouette);

/* Rows on each side of a pixel in which its edge is followed: more show where flat edges step, but pass corners and small drops by. */
enum { SILHOUETTE_REACH = 8 };

#endif
