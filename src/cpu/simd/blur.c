/* blur.c: the kernels of stage blur over simd.h. */
#include "cpu/blur.h"

#include "cpu/simd.h"

const struct blur_kernels SIMD_NAME(mns_blur_kernels) = {0};
