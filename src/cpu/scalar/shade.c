/* shade.c: the kernels of stage shade in plain C. */
#include "cpu/shade.h"

const struct shade_kernels mns_shade_kernels_scalar = {0};
