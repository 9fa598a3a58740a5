/* smooth.h: the kernels of stage smooth. */
#ifndef MNS_CPU_SMOOTH_H
#define MNS_CPU_SMOOTH_H

struct smooth_kernels {
    int none;
};

extern const struct smooth_kernels mns_smooth_kernels_scalar, mns_smooth_kernels_sse2, mns_smooth_kernels_avx2, mns_smooth_kernels_avx512,
    mns_smooth_kernels_neon;

#endif
