/* smooth.h: the kernels of stage smooth: those of each filter (cpu/smooth). */
#ifndef MNS_CPU_SMOOTH_H
#define MNS_CPU_SMOOTH_H

#include "cpu/smooth/bilateral.h"
#include "cpu/smooth/gaussian.h"
#include "cpu/smooth/flow.h"
#include "cpu/smooth/implicit_flow.h"
#include "cpu/smooth/lines.h"
#include "cpu/smooth/narrow_range.h"
#include "cpu/smooth/plane_fit.h"
#include "cpu/smooth/resample.h"
#include "cpu/smooth/spline.h"

struct smooth_kernels {
    const struct resample_kernels *resample;
    const struct narrow_range_kernels *narrow_range;
    const struct gaussian_kernels *gaussian;
    const struct bilateral_kernels *bilateral;
    const struct plane_fit_kernels *plane_fit;
    const struct line_kernels *lines; /* of all that solve rows and columns */
    const struct spline_kernels *spline;
    const struct flow_kernels *flow;
    const struct implicit_flow_kernels *implicit_flow;
};

extern const struct smooth_kernels mns_smooth_kernels_scalar, mns_smooth_kernels_sse2, mns_smooth_kernels_avx2, mns_smooth_kernels_avx512,
    mns_smooth_kernels_neon;

#endif
