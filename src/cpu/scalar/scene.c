/* scene.c: the kernels of stage scene in plain C. */
#include "cpu/scene.h"

const struct scene_kernels mns_scene_kernels_scalar = {0};
