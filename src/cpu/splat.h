/* splat.h: exact spheres drawn tile by tile: the view, one tile's buffers, and the kernels of stages bin and splat.
 *
 * A pixel's ray is v = (u, w, 1), so a point t v has depth t. It meets the sphere |x - c| = R where
 *   t |v|^2 = v.c -+ s,   s^2 = |v|^2 R^2 - |v x c|^2.
 * Written about the projected centre (dx, dy: pixels from it; rho = R / c_z; a = c_x / c_z, b = c_y / c_z, L = a^2 + b^2 + 1)
 *   s^2 = R^2 L + 2 R^2 (a dx/fx + b dy/fy) + c_z^2 [(rho^2 - 1 - b^2) dx^2/fx^2 + (rho^2 - 1 - a^2) dy^2/fy^2 + 2 a b dx dy/(fx fy)]
 *   v.c = c_z (L + a dx/fx + b dy/fy)
 * which loses nothing to cancellation, wherever in the picture the sphere is. Tiles gather v.c - s, the least, and the sums of s;
 * depth = (v.c - s) / |v|^2 and chord = 2 s / |v| are made once per pixel. Orthographic rays are v = (0, 0, 1) from (u, w, 0):
 *   s^2 = R^2 - dx^2/fx^2 - dy^2/fy^2, v.c = c_z.
 *
 * Thickness. Each particle adds weight * chord, weight = V / (4/3 pi R^3) (1 with thickness_mode chord, [LGS09] eq. 9), to texels of
 * 1, 2 or 4 pixels. At one pixel per texel that is the exact chord at each pixel's centre. Larger texels would alias: a sphere of 1.5
 * texels' radius sampled at their centres is off by 12 % of its volume, a smaller one slips between them. There each sphere gives,
 * by its own radius R_t in texels at its own depth, so that nothing jumps as the view moves,
 *   R_t >= CHORD_RADIUS    its chord along the ray through the texel's centre;
 *   R_t >= DEPOSIT_RADIUS  2 q (weight * s at its centre) max(0, 1 - q d^2)^2, d the distance from its centre relative to its outline, 1 / q =
 *                          8/5 + 2/(3 R_t^2): the same volume and, as it falls off smoothly, the same sum wherever the centres lie,
 *                          and the second moment of the sphere (R^2/5) and a texel (1/12) together;
 *   else                   its whole volume, bilinearly over the four nearest texels, whose second moment is alike at that size.
 * After the default blur one smooth form alone is within 2 % (RMS) of its chords and a deposit within 5 %; inside a fluid both are far
 * closer (bin.c). */
#ifndef MNS_CPU_SPLAT_H
#define MNS_CPU_SPLAT_H

#include "cpu/particles.h"
#include "cpu/plane.h"

#include <stdint.h>

struct thickness_image; /* cpu.h */

enum {
    TILE_SIZE = 128,              /* pixels: one tile's depths stay in the second-level cache, its texels in the first */
    TILE_STRIDE = TILE_SIZE + 16, /* floats from row to row: room for a vector past the end, and an odd number of cache lines */
    BLOCK_SHIFT_X = 4,            /* blocks of the hierarchical depth are at least 16 x 8 pixels */
    BLOCK_SHIFT_Y = 3,
    TILE_BLOCKS = (TILE_SIZE >> BLOCK_SHIFT_X) * (TILE_SIZE >> BLOCK_SHIFT_Y),
    CELL_STRIDE = 4 * (TILE_SIZE / 2 + 1), /* floats from row to row of deposit cells; deposits need texels of 2 or 4 pixels */
    SUM_COUNT = 4,                         /* thickness, and thickness * colour in three channels */
    BOUNDS_BATCH = 16                      /* chunks whose bounds are found together */
};

/* Most that a chord may be weighted: a particle a trillion times as dense as the fluid is a slip of the pen, and its thickness stays finite. */
#define WEIGHT_MAX 1e12f

#define CHORD_RADIUS   4.0f
#define DEPOSIT_RADIUS 1.25f
/* Texels that any of the three reaches beyond the sphere's outline: most for the smooth form, just under CHORD_RADIUS. */
#define SUM_REACH 1.13f

/* The camera and the particles' sizes for one frame. */
struct splat_view {
    const struct particle_store *particles;
    bool orthographic;
    float rotation[9], translation[3]; /* as struct view */
    float fx, fy, cx, cy;
    int width, height;
    float near_plane, far_plane;
    float radius;                   /* R, metres, where radius_scale is 0 */
    float radius_scale;             /* R_i = radius_scale * radii[i]; box_radii: the largest in each chunk */
    const float *radii, *box_radii; /* of the store: its radii in metres, or its factors */
    float weight;                   /* of every particle; times mass_i with per_mass, over R_i^3 with per_cube */
    const float *factors;           /* with per_cube: what R_i has in it beyond the particle's own radius, or NULL */
    bool per_mass, per_cube;
    bool per_shape;           /* weight over det A of an ellipsoid (ellipsoid.h) */
    const float *box_stretch; /* with shapes: the longest semi-axis in each chunk, over R; else NULL */
    float sum_stretch;        /* thickness may reach farther out than outlines by this times the largest half-extent, and SUM_REACH */
    bool has_color;
    int scale;   /* pixels per texel */
    float slack; /* metres: more than depths can be off by rounding. Culling leaves this much room, so that it changes no pixel */
};

/* What rays go through: a tile's pixels or its texels. Centre of (i, j) at (i + 0.5, j + 0.5) from the tile's corner. */
struct splat_grid {
    float fx, fy, cx, cy; /* of the view, in these units, from the tile's corner */
    int columns, rows;    /* that lie in the picture */
};

/* One tile's buffers. Kernels of one tile run in one thread; which chunks they get, and in which order, decides the bytes. */
struct splat_tile {
    int x, y; /* the picture's pixel in its corner */
    struct splat_grid pixels, texels;

    float *nearest;       /* [TILE_SIZE][TILE_STRIDE] least v.c - s; DEPTH_EMPTY where nothing is, 0 outside the picture */
    int shift_x, shift_y; /* blocks of the hierarchical depth are 1 << shift; sprites are no larger, or the shift is that of the tile */
    float farthest[TILE_BLOCKS];    /* what is no nearer than this cannot show in the block, metres */
    float per_nearest[TILE_BLOCKS]; /* 1 / the least |v|^2 in the block */

    float *sums[SUM_COUNT]; /* [texel rows][TILE_STRIDE] sums of weight * s */
    float
        *cells[SUM_COUNT]; /* [texel rows + 1][CELL_STRIDE]: four corner weights for each place between texel centres, from (-0.5, -0.5) */
    bool deposited;        /* whether cells hold anything; else they are 0 */
};

/* Where 16 chunks may show. Pixels; conservative. Culled: x_min > x_max. */
struct splat_bounds {
    float x_min[BOUNDS_BATCH], x_max[BOUNDS_BATCH], y_min[BOUNDS_BATCH], y_max[BOUNDS_BATCH];
    float near_depth[BOUNDS_BATCH], far_depth[BOUNDS_BATCH]; /* metres */
    float sprite[BOUNDS_BATCH]; /* pixels: largest half-extent of one sphere. DEPTH_EMPTY: the eye may be inside one or close to one */
};

/* The kernels see whole spheres only, no nearer than CLOSE_RADII radii: what the near or far plane or the scene cuts, and what surrounds
 * the eye, goes through splat_cut.h. */
#define CLOSE_RADII 2.0f

struct splat_kernels {
    /* Bounds of chunks [first, first + 16); what is past the last chunk is undefined. Contract: holds every sphere of the chunk and the
     * texels that it deposits in; a vector version differs by rounding, which the bounds leave room for. */
    void (*bounds)(const struct splat_view *view, size_t first, struct splat_bounds *out);

    /* Draws the chunk's spheres into tile->nearest wherever tile->farthest says that they may show, and brings farthest up to date.
     * limit: none at this depth or beyond can show anywhere in the chunk's bounds.
     * Returns how many spheres it drew whose centre (moved into the picture) is in the tile.
     * Tolerance: 3e-4 R + 6e-7 of the depth where s > 0.1 R, the centre displaced by up to 1e-4 pixels: the estimate of the square root
     * is good to 7e-5, and some five products round. At a rim s is ill-conditioned: s^2 is within 1e-4 R^2, so pixels may come or go. */
    size_t (*depth)(const struct splat_view *view, struct splat_tile *tile, size_t chunk, float limit);

    /* Adds the chunk's thickness to sums and cells: of the spheres that lie wholly before depth `end`. Returns which do not, bit i for
     * particle i of the chunk; they are left to splat_cut.h. Tolerance: of each chord as above; else 1e-4 of the sphere's largest term, and
     * 1e-3 texels in its place. */
    uint64_t (*thickness)(const struct splat_view *view, struct splat_tile *tile, size_t chunk, float end);

    /* Writes the tile's depths and their ranges. Returns how many pixels hold fluid. Tolerance: 1e-6 relative. */
    size_t (*resolve_depth)(const struct splat_view *view, const struct splat_tile *tile, struct depth_plane *out);

    /* Writes the tile's texels of one plane (thickness: sum 0). Tolerance: 1e-6 relative. */
    void (*resolve_sum)(const struct splat_view *view, const struct splat_tile *tile, int sum, struct plane *out);
};

extern const struct splat_kernels mns_splat_kernels_scalar, mns_splat_kernels_sse2, mns_splat_kernels_avx2, mns_splat_kernels_avx512,
    mns_splat_kernels_neon;

#endif
