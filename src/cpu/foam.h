/* foam.h: stage foam: what it leaves for stage shade, and its kernels.
 *
 * Based on: Bagar, Scherzer and Wimmer 2010, section 5.2 ([BSW10]). Along a pixel's ray, all in metres and volume-true as in splat.h:
 *   foam depth   the nearest foam sphere, wherever it shows before the scene
 *   T_f          thickness of the foam
 *   T_ff         thickness of the foam that lies within delta_foam behind the foam's depth
 *   T_wf, T_wb   thickness of the water before and behind the foam's depth: shares of the water's one thickness, so that their sum is that
 *
 * T_f and T_ff are sums over pixels, each sphere's chord times its own detail
 *   n(u, v) = max(0, 1 + amount sum_o w_o a_o noise_o(u, v, DETAIL_LIFE age)),   (u, v) from -1 to 1 across the sphere's outline,
 * with gradient noise of mean 0 ([BSW10]: noise3(x, y, lifetime)) that the particle's seed chooses. Octave o has DETAIL_CELLS << o cells across; its weight
 * w_o = saturate((cell - DETAIL_LEAST) / DETAIL_LEAST) fades out what is finer than pixels, cell being one's width in them. So the pattern goes
 * where the particle goes, changes with its age, and nothing jumps as it comes nearer.
 *
 * T_wf is gathered in the water's own texels by the three forms of splat.h, each particle as far as it lies before the mean depth of the foam in
 * the texel; then blurred as the thickness is, over the texels that hold foam alone, relative to the thickness there. */
#ifndef MNS_CPU_FOAM_H
#define MNS_CPU_FOAM_H

#include "cpu/splat.h"

#define DETAIL_CELLS 2
#define DETAIL_LIFE  6.0f /* cells that the pattern goes through in a particle's life */
#define DETAIL_LEAST 3.0f /* pixels */

enum { DETAIL_OCTAVES = 3 };

/* a_o: detail falls off by the root of its size, so that fine structure stays visible in close-ups. */
static const float DETAIL_GAIN[DETAIL_OCTAVES] = {2.5f, 1.8f, 1.25f};

/* Where sums over one tile's pixels end along each ray, as v.c of splat.h (depth times |v|^2). [TILE_SIZE][TILE_STRIDE]; 0 where no foam shows. */
struct foam_ends {
    float *all;   /* the scene, or DEPTH_EMPTY */
    float *front; /* delta_foam behind the foam's depth, no farther than all */
};

/* Mean depth of the foam in a tile's texels of water, metres; 0: none. Texel (x, y) at [(y + 1) * TILE_STRIDE + x + 1]: a border of nothing all around. */
enum { LIMIT_ROWS = TILE_SIZE + 2, LIMIT_FLOATS = LIMIT_ROWS * TILE_STRIDE };

struct foam_kernels {
    /* From the tile's foam depths (of which what is not before scene becomes DEPTH_EMPTY; NULL: nothing there) to the ends. Returns how many
     * pixels hold foam. Tolerance: 1e-6 relative. */
    size_t (*ends)(const struct splat_view *view, const struct splat_tile *tile, float delta, const struct plane *scene,
                   struct plane *depth, struct foam_ends *ends);

    /* From the tile's foam depths to limits, for the texels of view->scale pixels. Tolerance: 1e-6 relative. */
    void (*limits)(const struct splat_view *view, const struct splat_tile *tile, const struct plane *depth, float *limits);

    /* Adds T_f to sums[0] and T_ff to sums[1] of the tile, of a chunk that no plane cuts, with detail `amount`. Tolerance: of each chord as depth
     * and thickness of splat.h; detail 1e-3 of amount. */
    void (*thickness)(const struct splat_view *view, struct splat_tile *tile, size_t chunk, const struct foam_ends *ends, float amount);

    /* Adds T_wf of a chunk of water to sums[0] and cells[0]. last: no limit where the chunk may be is farther. Tolerance: as thickness of splat.h. */
    void (*front)(const struct splat_view *view, struct splat_tile *tile, size_t chunk, const float *limits, float last);
};

extern const struct foam_kernels mns_foam_kernels_scalar, mns_foam_kernels_sse2, mns_foam_kernels_avx2, mns_foam_kernels_avx512,
    mns_foam_kernels_neon;

/* One thread's buffers. */
struct foam_scratch {
    struct foam_ends ends;
    float *limits; /* [LIMIT_FLOATS] */
};

struct foam {
    bool shows;                    /* whether there is any in the picture */
    unsigned char *tiles;          /* whether each tile holds any; where it does not, the planes of pixels hold nothing */
    struct depth_plane depth;      /* pixels: metres, DEPTH_EMPTY where there is none */
    struct plane thickness, front; /* pixels: T_f, T_ff */
    struct plane before;           /* texels of water: T_wf over the thickness; 0 far from foam */
    struct plane sums[2], blurred; /* texels: T_wf and the thickness where there is foam, 0 elsewhere; room */
    struct plane ends;             /* pixels: delta_foam behind the depth; only where a plane cuts foam */
    struct foam_scratch *scratch;  /* [scratch_count] */
    int scratch_count, columns;    /* columns: of tiles */
    size_t tile_capacity;
};

/* The lattice of gradients behind the detail: point (i, j, k) of an octave, of a particle with this seed: three components in (-1, 1) from the bits of a hash. */
static inline uint32_t foam_hash(uint32_t seed, uint32_t octave, uint32_t i, uint32_t j, uint32_t k)
{
    uint32_t h = seed * 0x9e3779b1u + octave * 0x85ebca6bu + i * 0xc2b2ae35u + j * 0x27d4eb2fu + k * 0x165667b1u;
    h = (h ^ h >> 15) * 0x2c1b3c6du;
    h = (h ^ h >> 12) * 0x297a2d39u;
    return h ^ h >> 15;
}

#endif
