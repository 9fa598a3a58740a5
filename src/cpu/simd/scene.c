/* scene.c: the kernels of stage scene over simd.h. */
#include "cpu/scene.h"

#include "cpu/simd.h"

const struct scene_kernels SIMD_NAME(mns_scene_kernels) = {0};
