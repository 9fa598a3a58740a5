/* splat.c: the kernels of stage splat over simd.h. */
#include "cpu/splat.h"

#include "cpu/simd.h"

const struct splat_kernels SIMD_NAME(mns_splat_kernels) = {0};
