/* plane_fit.h: the kernel of the plane-fit filter. */
#ifndef MNS_CPU_SMOOTH_PLANE_FIT_H
#define MNS_CPU_SMOOTH_PLANE_FIT_H

#include "cpu/smooth/window.h"

/* What the kernel needs beyond depth. */
struct plane_fit {
    const float *normal[3]; /* unit normals in image space (core/frame.h: struct view) of the depth that is filtered, pixel (x, y) at
                               [y * stride + x] with the depth's stride and border; finite everywhere */
    float step_x, step_y;   /* 1 / view.fx, 1 / view.fy */
    float cx, cy;           /* pixels */
    bool orthographic;
};

/* Where the mean normal is within this cosine of a right angle to the ray (a degree), the ray meets the plane nowhere that means anything, and the
 * mean depth is taken. */
#define PLANE_FIT_GRAZING 0.0175f

/* With tap weights as the bilateral filter's (bilateral.h) and p a tap's position, n its normal: the depth at which the pixel's ray v meets the
 * plane through the mean of p with the mean of n as its normal, z = (n . p) / (n . v) where v has depth 1. Never farther than delta from the mean
 * depth, nor nearer than half of it.
 *
 * window_filter.fit is set. In the blocks that disc_plain is for (window.h) every tap counts. Tolerance against plain C, for one pass on
 * equal input: 4e-7 of the depth plus 1e-4 of delta: a relative error of 1e-5 in the means counts 1 / cosine of the angle to the ray. At the limit
 * PLANE_FIT_GRAZING a pixel may fall on its other side: less than one in 1000 of the worst depths. */
struct plane_fit_kernels {
    window_function *disc, *disc_plain;
};

extern const struct plane_fit_kernels mns_plane_fit_kernels_scalar, mns_plane_fit_kernels_sse2, mns_plane_fit_kernels_avx2,
    mns_plane_fit_kernels_avx512, mns_plane_fit_kernels_neon;

#endif
