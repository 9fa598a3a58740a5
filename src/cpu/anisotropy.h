/* anisotropy.h: the inner loops of src/particles/anisotropy.c: weighted sums over neighbours, and what follows from them.
 *
 * Based on: Yu and Turk 2013 ([YT13]). Lengths are in units of the reach, within which neighbours count with
 *   w = 1 - d^3 ([YT13] eq. 11).
 * In a full neighbourhood the mean of d d' under w is 0.15 of the identity, so that
 *   C = (sum of w d d' / sum of w - m m') / 0.15, m = sum of w d / sum of w ([YT13] eq. 9 and 10)
 * is 1 inside a fluid; at a flat surface it is 1, 1 and 0.31. Eigenvalues are held to at least the largest over `ratio` (eq. 15). */
#ifndef MNS_CPU_ANISOTROPY_H
#define MNS_CPU_ANISOTROPY_H

enum {
    ANISOTROPY_BLOCK = 1024, /* neighbours looked at together: three arrays stay in the first-level cache */
    ANISOTROPY_BATCH = 256,  /* particles whose shapes are made together */
    ANISOTROPY_PAD = 16,     /* floats that a vector may read behind the last */
    ANISOTROPY_SUMS = 10     /* w, w x, w y, w z, w xx, w yy, w zz, w xy, w xz, w yz */
};

/* Farther than any reach, and its square is finite. */
#define ANISOTROPY_FAR 1e9f

/* Particles that may be neighbours; those from count up to a multiple of ANISOTROPY_PAD are at ANISOTROPY_FAR. */
struct anisotropy_block {
    float x[ANISOTROPY_BLOCK + ANISOTROPY_PAD], y[ANISOTROPY_BLOCK + ANISOTROPY_PAD], z[ANISOTROPY_BLOCK + ANISOTROPY_PAD];
    int count;
} __attribute__((aligned(64)));

/* Particles, their sums about themselves, and what becomes of them. */
struct anisotropy_batch {
    float x[ANISOTROPY_BATCH], y[ANISOTROPY_BATCH], z[ANISOTROPY_BATCH];
    float sum[ANISOTROPY_SUMS][ANISOTROPY_BATCH];
    float shape[6][ANISOTROPY_BATCH]; /* A */
    float shift[3][ANISOTROPY_BATCH]; /* of the centre */
} __attribute__((aligned(64)));

struct anisotropy_rule {
    float ratio;             /* of the longest to the shortest semi-axis, at most */
    float smoothing;         /* lambda of [YT13] eq. 6 */
    float isolated;          /* semi-axes of a particle on its own */
    float lonely, per_crowd; /* sum of w up to which a particle is on its own, and 1 over how much more makes it one of a fluid */
};

struct anisotropy_kernels {
    /* Adds the block to the sums of particles first to end - 1 of the batch. Tolerance: 1e-3 of the sum of w, in all ten: the estimate of the
     * square root is good to 7e-5, and terms at the reach come and go. */
    void (*add)(const struct anisotropy_block *block, struct anisotropy_batch *batch, int first, int end);

    /* Shapes and shifts from the sums of particles 0 to count - 1. Tolerance: 1e-4 in A for the same sums. */
    void (*shape)(const struct anisotropy_rule *rule, struct anisotropy_batch *batch, int count);
};

extern const struct anisotropy_kernels mns_anisotropy_kernels_scalar, mns_anisotropy_kernels_sse2, mns_anisotropy_kernels_avx2,
    mns_anisotropy_kernels_avx512, mns_anisotropy_kernels_neon;

/* Mean of one diagonal term of d d' in a full neighbourhood: integral of d^4 (1 - d^3) over that of d^2 (1 - d^3), over 3. */
#define ANISOTROPY_FULL 0.15f

/* What eigenvalues are held to where all neighbours are in one place. */
#define ANISOTROPY_LEAST 1e-6f

/* Rotations of three planes each that leave nothing that counts off the diagonal of a symmetric 3 x 3 matrix: what is left is squared by each. */
enum { JACOBI_SWEEPS = 3 };

#endif
