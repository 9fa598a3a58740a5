/* smooth.c: the kernels of stage smooth over simd.h. */
#include "cpu/smooth.h"

#include "cpu/simd.h"

const struct smooth_kernels SIMD_NAME(mns_smooth_kernels) = {0};
