/* shade.h: the kernels of stage shade. */
#ifndef MNS_CPU_SHADE_H
#define MNS_CPU_SHADE_H

struct shade_kernels {
    int none;
};

extern const struct shade_kernels mns_shade_kernels_scalar, mns_shade_kernels_sse2, mns_shade_kernels_avx2, mns_shade_kernels_avx512,
    mns_shade_kernels_neon;

#endif
