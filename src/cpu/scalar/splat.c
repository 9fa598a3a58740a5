/* splat.c: the kernels of stage splat in plain C. */
#include "cpu/splat.h"

const struct splat_kernels mns_splat_kernels_scalar = {0};
