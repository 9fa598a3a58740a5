/* blur.c: the kernels of stage blur in plain C. */
#include "cpu/blur.h"

const struct blur_kernels mns_blur_kernels_scalar = {0};
