/* noise.h: surface noise: a pattern that each particle carries, summed on the smoothed surface; one tile's sums, and the kernel of stage noise.
 *
 * At a pixel whose surface point is P, a particle at c whose splat is a ball of radius B adds a (w / w_R)^3 n(u), where w is positive, with
 *   w = 1 - |P - c|^2 / B^2        [LGS09] eq. 10: its exponent -x^2 - y^2 - (p_z - d)^2 is -|P - c|^2 in radii; (1 - t)^3 falls as e^-t does and
 *                                  ends, so that no splat has an edge
 *   n = sum over octaves o of gain^o noise(2^o u)                                                                          [P430] eq. 14
 * w_R is w where the surface is R from the centre, as it is above the outermost particles, so that N does not depend on B there. u is the place in the splat, in cells of the coarsest octave, whose size is a multiple of B; a the particle's amplitude. noise is Perlin's: at
 * each point of a lattice of unit cells a gradient of unit length, whose planes are blended with the weights 1 - (6 t^5 - 15 t^4 + 10 t^3). [P430]
 * asks for 3-D noise, the third coordinate the particle's id: with whole ids that is another lattice for each. Here each particle and octave has
 * another window of one lattice of 64 x 64 cells that repeats, begun at a place between its points.
 *
 * With a, b and rho = B / z of the projected centre as in splat.h, z its depth, gx = dx z / (fx B) and gy likewise, d the depth at the pixel and
 * e = (d - z) / B,
 *   |P - c|^2 / B^2 = (gx + e (a + rho gx))^2 + (gy + e (b + rho gy))^2 + e^2.
 * Orthographic: gx = dx / (fx B), a = b = rho = 0.
 *
 * Nothing shimmers: an octave fades out where its cells become smaller than 4 pixels, and is gone at 2. Splats that come close to the eye fade out
 * too. */
#ifndef MNS_CPU_NOISE_H
#define MNS_CPU_NOISE_H

#include "cpu/splat.h"

enum {
    NOISE_OCTAVES_MAX = 6,
    NOISE_LATTICE = 64,                        /* cells after which the lattice repeats */
    NOISE_LATTICE_STRIDE = NOISE_LATTICE + 16, /* floats from row to row: the first columns once more, for a vector that begins at any */
    NOISE_LATTICE_FLOATS = NOISE_LATTICE * NOISE_LATTICE_STRIDE,
    NOISE_BLOCK_SHIFT = 2, /* blocks of 4 x 4 pixels tell where there is surface that a splat can reach */
    NOISE_BLOCKS = TILE_SIZE >> NOISE_BLOCK_SHIFT,
    NOISE_BLOCK_STRIDE = NOISE_BLOCKS + 16 /* room for a vector that begins at any */
};

/* Pixels of a cell between which an octave fades. The lattice points about 16 pixels in a row must be at most 16. */
#define NOISE_FADE_END   2.0f
#define NOISE_FADE_BEGIN 4.0f

/* Radii B from the eye between which a splat fades: nearer ones are larger than the picture. */
#define NOISE_CLOSE_END   CLOSE_RADII
#define NOISE_CLOSE_BEGIN 4.0f

/* Perlin's noise is largest in the middle of a cell: sqrt(1/2). Sums are divided by it. */
#define NOISE_PEAK 0.70710678f

/* The noise of one picture. */
struct noise_view {
    const struct splat_view *view; /* its spheres are the balls */
    const float *lattice[2];       /* x and y of the gradients: [NOISE_LATTICE][NOISE_LATTICE_STRIDE] */
    float per_weight;              /* 1 / w^3 where the surface is R from the centre: there the sum is that of the octaves */
    float cell;                    /* of the coarsest octave over B */
    float gain;
    int octaves;
};

/* Nearest and farthest surface about each block, [column][row]; where there is none near > far. */
struct noise_ranges {
    float near[NOISE_BLOCKS][NOISE_BLOCK_STRIDE], far[NOISE_BLOCKS][NOISE_BLOCK_STRIDE];
};

/* One tile's sums. */
struct noise_tile {
    struct splat_grid pixels;
    struct noise_ranges beside; /* in the block and those beside it that a splat with its centre in the column can touch */
    struct noise_ranges around; /* in all that a splat with its centre in the block can touch */
    const float *depth; /* the smoothed surface at the tile's corner; DEPTH_EMPTY where there is none. Readable 16 values past a row */
    ptrdiff_t stride;
    float *sums; /* [TILE_SIZE][TILE_STRIDE] */
};

struct noise_kernels {
    /* Adds the noise of the chunk's particles to the tile's sums. Tolerance: 1e-4 of the largest term, for some thirty products; and what a splat displaced by
     * 1e-4 pixels makes, 1e-4 * 2^octaves / cell. */
    void (*splat)(const struct noise_view *noise, struct noise_tile *tile, size_t chunk);
};

extern const struct noise_kernels mns_noise_kernels_scalar, mns_noise_kernels_sse2, mns_noise_kernels_avx2, mns_noise_kernels_avx512,
    mns_noise_kernels_neon;

/* One octave of one particle. */
struct noise_octave {
    float weight;    /* of Perlin's noise, with the particle's amplitude */
    float x, y;      /* of the centre in the lattice */
    float per_pixel; /* cells in a pixel along x */
};

/* 0 to 1 between low and high, without a bend at either. */
static inline float noise_ramp(float at, float low, float high)
{
    float t = (at - low) / (high - low);
    t = t > 0 ? t < 1 ? t : 1 : 0;
    return t * t * (3 - 2 * t);
}

/* Where a particle's window of an octave begins, in steps of 1/1024 cells. seed: a whole number under 2^24. */
static inline void noise_window(float seed, int octave, float *x, float *y)
{
    uint32_t h = (uint32_t)seed * 0x9e3779b1u + (uint32_t)octave * 0x85ebca6bu; /* then Murmur3's finish: neighbouring ids share no bits */
    h = (h ^ h >> 16) * 0x85ebca6bu;
    h = (h ^ h >> 13) * 0xc2b2ae35u;
    h ^= h >> 16;
    *x = (float)(h & 0xffff) * (1 / 1024.0f);
    *y = (float)(h >> 16) * (1 / 1024.0f);
}

/* The octaves that pixels can show. cell: of the coarsest, in pixels, the smaller way; per_pixel: 1 / cell along x. Returns how many. */
static inline int noise_octaves_of(const struct noise_view *noise, float seed, float amplitude, float cell, float per_pixel,
                                   struct noise_octave octaves[NOISE_OCTAVES_MAX])
{
    float weight = amplitude * noise->per_weight / NOISE_PEAK;
    for (int i = 0; i < noise->octaves; i++) {
        float seen = weight * noise_ramp(cell, NOISE_FADE_END, NOISE_FADE_BEGIN);
        if (!(seen > 0)) {
            return i;
        }
        octaves[i].weight = seen;
        octaves[i].per_pixel = per_pixel;
        noise_window(seed, i, &octaves[i].x, &octaves[i].y);
        weight *= noise->gain;
        cell *= 0.5f;
        per_pixel *= 2;
    }
    return noise->octaves;
}

#endif
