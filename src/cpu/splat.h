/* splat.h: the kernels of stage splat. */
#ifndef MNS_CPU_SPLAT_H
#define MNS_CPU_SPLAT_H

struct splat_kernels {
    int none;
};

extern const struct splat_kernels mns_splat_kernels_scalar, mns_splat_kernels_sse2, mns_splat_kernels_avx2, mns_splat_kernels_avx512,
    mns_splat_kernels_neon;

#endif
