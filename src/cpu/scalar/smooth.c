/* smooth.c: the kernels of stage smooth in plain C. */
#include "cpu/smooth.h"

const struct smooth_kernels mns_smooth_kernels_scalar = {0};
