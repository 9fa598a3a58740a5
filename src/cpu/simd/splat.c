/* splat.c: the kernels of stage splat: plain C compiled for the instruction set. */
#include "cpu/simd.h"

#define mns_splat_kernels_scalar SIMD_NAME(mns_splat_kernels)
#include "cpu/scalar/splat.c"
