/* smooth.c: the kernels of stage smooth over simd.h, gathered from each filter's file. */
#include "cpu/smooth.h"

#include "cpu/simd.h"

const struct smooth_kernels SIMD_NAME(mns_smooth_kernels) = {
    .resample = &SIMD_NAME(mns_resample_kernels),
    .narrow_range = &SIMD_NAME(mns_narrow_range_kernels),
    .gaussian = &SIMD_NAME(mns_gaussian_kernels),
    .bilateral = &SIMD_NAME(mns_bilateral_kernels),
    .plane_fit = &SIMD_NAME(mns_plane_fit_kernels),
    .lines = &SIMD_NAME(mns_line_kernels),
    .spline = &SIMD_NAME(mns_spline_kernels),
    .flow = &SIMD_NAME(mns_flow_kernels),
    .implicit_flow = &SIMD_NAME(mns_implicit_flow_kernels),
};
