/* kernels.c: one table of inner loops per instruction set, and which of them this processor runs. */
#include "cpu/kernels.h"

#include <stddef.h>

/* Each stage's table of an instruction set, gathered. */
#define KERNELS(isa)                                                                                                                       \
    {                                                                                                                                      \
        &mns_splat_kernels_##isa, &mns_ellipsoid_kernels_##isa, &mns_smooth_kernels_##isa, &mns_noise_kernels_##isa,                       \
            &mns_blur_kernels_##isa, &mns_foam_kernels_##isa, &mns_scene_kernels_##isa, &mns_shade_kernels_##isa,                          \
            &mns_anisotropy_kernels_##isa                                                                                                  \
    }

static const struct kernels scalar = KERNELS(scalar);
#ifdef MNS_HAVE_SSE2
static const struct kernels sse2 = KERNELS(sse2);
#endif
#ifdef MNS_HAVE_AVX2
static const struct kernels avx2 = KERNELS(avx2);
#endif
#ifdef MNS_HAVE_AVX512
static const struct kernels avx512 = KERNELS(avx512);
#endif
#ifdef MNS_HAVE_NEON
static const struct kernels neon = KERNELS(neon);
#endif

const struct kernels *mns_kernels_get(enum mns_isa isa)
{
    switch (isa) {
    case MNS_ISA_SCALAR: return &scalar;
#ifdef MNS_HAVE_SSE2
    case MNS_ISA_SSE2: return __builtin_cpu_supports("sse2") ? &sse2 : NULL;
#endif
#ifdef MNS_HAVE_AVX2
    case MNS_ISA_AVX2: return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") ? &avx2 : NULL;
#endif
#ifdef MNS_HAVE_AVX512
    case MNS_ISA_AVX512:
        return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512dq") &&
                       __builtin_cpu_supports("avx512vl")
                   ? &avx512
                   : NULL;
#endif
#ifdef MNS_HAVE_NEON
    case MNS_ISA_NEON: return &neon; /* part of the base architecture where it is built */
#endif
    default: return NULL;
    }
}

enum mns_isa mns_isa_best(void)
{
    static const enum mns_isa order[] = {MNS_ISA_AVX512, MNS_ISA_AVX2, MNS_ISA_SSE2, MNS_ISA_NEON};
    for (size_t i = 0; i < sizeof(order) / sizeof(order[0]); i++) {
        if (mns_kernels_get(order[i])) {
            return order[i];
        }
    }
    return MNS_ISA_SCALAR;
}

const char *mns_isa_name(enum mns_isa isa)
{
    static const char *const names[] = {"auto", "scalar", "sse2", "avx2", "avx512", "neon"};
    return (size_t)isa < sizeof(names) / sizeof(names[0]) ? names[isa] : NULL;
}

int mns_isa_available(enum mns_isa isa) { return isa == MNS_ISA_AUTO || mns_kernels_get(isa) != NULL; }
