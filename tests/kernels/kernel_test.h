/* kernel_test.h: what the kernel tests share: numbers and the instruction sets there are. */
#ifndef MNS_TESTS_KERNEL_TEST_H
#define MNS_TESTS_KERNEL_TEST_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "cpu/kernels.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static uint32_t random_state = 1;

static inline float uniform(float low, float high)
{
    random_state = random_state * 1664525u + 1013904223u;
    return low + (high - low) * (float)(random_state >> 8) / 16777216.0f;
}

/* The instruction sets other than plain C that this machine runs; NULL: no more. */
static inline const struct kernels *vector_kernels(int *index)
{
    static const enum mns_isa isas[] = {MNS_ISA_SSE2, MNS_ISA_AVX2, MNS_ISA_AVX512, MNS_ISA_NEON};
    while (*index < (int)(sizeof(isas) / sizeof(isas[0]))) {
        const struct kernels *kernels = mns_kernels_get(isas[(*index)++]);
        if (kernels) {
            return kernels;
        }
    }
    return NULL;
}

/* Every value of a within tolerance of b. */
static inline void assert_near(const float *a, const float *b, int count, float tolerance)
{
    for (int i = 0; i < count; i++) {
        if (!(fabsf(a[i] - b[i]) <= tolerance)) {
            fail_msg("value %d is %.9g, plain C has %.9g; they may differ by %g", i, (double)a[i], (double)b[i], (double)tolerance);
        }
    }
}

#endif
