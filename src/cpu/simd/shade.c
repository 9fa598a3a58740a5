/* shade.c: the kernels of stage shade over simd.h. */
#include "cpu/shade.h"

#include "cpu/simd.h"

const struct shade_kernels SIMD_NAME(mns_shade_kernels) = {0};
