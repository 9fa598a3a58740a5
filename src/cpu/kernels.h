/* kernels.h: the inner loops, chosen once by instruction set. Each stage's table stands in that stage's header with its contracts
 * and tolerances; src/cpu/scalar defines them in plain C, src/cpu/simd is the one vector source. */
#ifndef MNS_CPU_KERNELS_H
#define MNS_CPU_KERNELS_H

#include <meniscus/renderer.h>

#include "cpu/anisotropy.h"
#include "cpu/blur.h"
#include "cpu/ellipsoid.h"
#include "cpu/foam.h"
#include "cpu/noise.h"
#include "cpu/scene.h"
#include "cpu/shade.h"
#include "cpu/smooth.h"
#include "cpu/splat.h"

struct kernels {
    const struct splat_kernels *splat;
    const struct ellipsoid_kernels *ellipsoid; /* splat: particles with a shape */
    const struct smooth_kernels *smooth;
    const struct noise_kernels *noise;
    const struct blur_kernels *blur;
    const struct foam_kernels *foam;
    const struct scene_kernels *scene;
    const struct shade_kernels *shade;
    const struct anisotropy_kernels *anisotropy; /* before prepare: src/particles */
};

/* The table for an instruction set (not AUTO), or NULL when this build or this processor lacks it. */
const struct kernels *mns_kernels_get(enum mns_isa isa);

/* The best there is. */
enum mns_isa mns_isa_best(void);

#endif
