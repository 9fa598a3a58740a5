/* smooth.c: the kernels of stage smooth in plain C, gathered from each filter's file. */
#include "cpu/smooth.h"

const struct smooth_kernels mns_smooth_kernels_scalar = {
    .resample = &mns_resample_kernels_scalar,
    .narrow_range = &mns_narrow_range_kernels_scalar,
    .gaussian = &mns_gaussian_kernels_scalar,
    .bilateral = &mns_bilateral_kernels_scalar,
    .plane_fit = &mns_plane_fit_kernels_scalar,
    .lines = &mns_line_kernels_scalar,
    .spline = &mns_spline_kernels_scalar,
    .flow = &mns_flow_kernels_scalar,
    .implicit_flow = &mns_implicit_flow_kernels_scalar,
};
