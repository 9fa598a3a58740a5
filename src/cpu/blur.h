/* blur.h: the kernels of stage blur. */
#ifndef MNS_CPU_BLUR_H
#define MNS_CPU_BLUR_H

struct blur_kernels {
    int none;
};

extern const struct blur_kernels mns_blur_kernels_scalar, mns_blur_kernels_sse2, mns_blur_kernels_avx2, mns_blur_kernels_avx512,
    mns_blur_kernels_neon;

#endif
