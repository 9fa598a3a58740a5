/* tile.h: what the vector kernels that draw into a tile share. Included by files over simd.h; formulas and contracts: cpu/splat.h. */
#ifndef MNS_CPU_SIMD_TILE_H
#define MNS_CPU_SIMD_TILE_H

#include "cpu/sprite.h"

#include "cpu/simd.h"

/* Spheres of VLEN particles in the units of a grid, as struct sprite. */
struct spheres {
    vf x, y, z, a, b, rho, rest, length2; /* rest: 1 - rho^2 */
    vf radius;
};

/* Outlines, not yet cut to the grid. */
struct outlines {
    vf x_min, x_max, y_min, y_max;
};

/* Places of a grid, inclusive, cut to it. */
struct places {
    vf x0, x1, y0, y1;
    vm some; /* where there are any */
};

/* What the loops over one sphere's places read: struct sprite_poly and the rest of VLEN spheres. */
struct table {
    float k0[VLEN], kx[VLEN], ky[VLEN], kxx[VLEN], kyy[VLEN], kxy[VLEN], v0[VLEN], vx[VLEN], vy[VLEN], x[VLEN], y[VLEN], amount[VLEN];
    int32_t x0[VLEN], x1[VLEN], y0[VLEN], y1[VLEN];
} __attribute__((aligned(64)));

SIMD vf transform(const float row[3], vf x, vf y, vf z, float translation)
{
    return vf_fma(vf_set1(row[0]), x, vf_fma(vf_set1(row[1]), y, vf_fma(vf_set1(row[2]), z, vf_set1(translation))));
}

SIMD struct spheres project(const struct splat_view *view, const struct splat_grid *grid, size_t first)
{
    const struct particle_store *p = view->particles;
    vf px = vf_load(p->x + first), py = vf_load(p->y + first), pz = vf_load(p->z + first);
    struct spheres s;
    vf x = transform(&view->rotation[0], px, py, pz, view->translation[0]);
    vf y = transform(&view->rotation[3], px, py, pz, view->translation[1]);
    s.z = transform(&view->rotation[6], px, py, pz, view->translation[2]);
    s.radius = vf_set1(view->radius);
    if (view->radius_scale > 0) {
        s.radius = vf_set1(view->radius_scale) * vf_load(view->radii + first);
    }
    if (view->orthographic) {
        s.a = s.b = s.rho = vf_zero();
        s.rest = s.length2 = vf_set1(1);
    } else {
        vf per_depth = vf_rcp(s.z);
        s.a = x = x * per_depth;
        s.b = y = y * per_depth;
        s.rho = s.radius * per_depth;
        s.rest = vf_fnma(s.rho, s.rho, vf_set1(1));
        s.length2 = vf_fma(s.a, s.a, vf_fma(s.b, s.b, vf_set1(1)));
    }
    s.x = vf_fma(vf_set1(grid->fx), x, vf_set1(grid->cx));
    s.y = vf_fma(vf_set1(grid->fy), y, vf_set1(grid->cy));
    return s;
}

SIMD struct places places_of(const struct splat_grid *grid, const struct outlines *o)
{
    vf half = vf_set1(0.5f), right = vf_set1((float)(grid->columns - 1)), bottom = vf_set1((float)(grid->rows - 1));
    vf x0 = vf_ceil(o->x_min - half), x1 = vf_floor(o->x_max - half), y0 = vf_ceil(o->y_min - half), y1 = vf_floor(o->y_max - half);
    struct places p;
    p.some = vm_and(vm_and(vf_le(x0, x1), vf_le(y0, y1)),
                    vm_and(vm_and(vf_ge(x1, vf_zero()), vf_ge(y1, vf_zero())), vm_and(vf_le(x0, right), vf_le(y0, bottom))));
    p.x0 = vf_clamp(x0, vf_zero(), right);
    p.x1 = vf_clamp(x1, vf_zero(), right);
    p.y0 = vf_clamp(y0, vf_zero(), bottom);
    p.y1 = vf_clamp(y1, vf_zero(), bottom);
    return p;
}

/* s^2 down a column of lanes: k[0] + dy (k[1] + dy k[2]), for the columns that begin at place x. */
struct columns {
    vf k[3];
};

SIMD struct columns columns_at(const struct table *t, int i, int x)
{
    vf dx = vf_set1((float)x + 0.5f - t->x[i]) + vf_iota();
    return (struct columns){{vf_fma(vf_fma(vf_set1(t->kxx[i]), dx, vf_set1(t->kx[i])), dx, vf_set1(t->k0[i])),
                             vf_fma(vf_set1(t->kxy[i]), dx, vf_set1(t->ky[i])), vf_set1(t->kyy[i])}};
}

/* The farthest of a block. */
SIMD float most_in(const float *row, int width, int height)
{
    vf most = vf_zero();
    for (int y = 0; y < height; y++, row += TILE_STRIDE) {
        for (int x = 0; x < width; x += VLEN) {
            most = vf_max(most, vf_load(row + x));
        }
    }
    return vf_reduce_max(most);
}

static inline void update_farthest(struct splat_tile *tile, int x0, int x1, int y0, int y1)
{
    int columns = TILE_SIZE >> tile->shift_x, width = 1 << tile->shift_x, height = 1 << tile->shift_y;
    for (int by = y0 >> tile->shift_y; by <= y1 >> tile->shift_y; by++) {
        for (int bx = x0 >> tile->shift_x; bx <= x1 >> tile->shift_x; bx++) {
            float most = most_in(tile->nearest + by * height * TILE_STRIDE + bx * width, width, height);
            int block = by * columns + bx;
            tile->farthest[block] = most > DEPTH_LIMIT ? DEPTH_EMPTY : most * tile->per_nearest[block];
        }
    }
}

/* Nothing at this depth or beyond can show in the places: no sphere spans more than two blocks each way. */
SIMD vf hidden_from(const struct splat_tile *tile, const struct places *p)
{
    int shift = 7 - tile->shift_x; /* log2 of the blocks in a row */
    vi x0 = vi_shr(vf_truncate(p->x0), tile->shift_x), x1 = vi_shr(vf_truncate(p->x1), tile->shift_x);
    vi y0 = vi_shl(vi_shr(vf_truncate(p->y0), tile->shift_y), shift), y1 = vi_shl(vi_shr(vf_truncate(p->y1), tile->shift_y), shift);
    vf above = vf_max(vf_gather(tile->farthest, vi_add(y0, x0)), vf_gather(tile->farthest, vi_add(y0, x1)));
    vf below = vf_max(vf_gather(tile->farthest, vi_add(y1, x0)), vf_gather(tile->farthest, vi_add(y1, x1)));
    return vf_max(above, below);
}

/* sprite_is_home. */
SIMD vm is_home(const struct splat_view *view, const struct splat_tile *tile, const struct spheres *s)
{
    vf left = vf_set1((float)-tile->x), top = vf_set1((float)-tile->y), size = vf_set1(TILE_SIZE);
    vf x = vf_clamp(s->x, left, vf_set1((float)(view->width - tile->x) - 0.5f));
    vf y = vf_clamp(s->y, top, vf_set1((float)(view->height - tile->y) - 0.5f));
    return vm_and(vm_and(vf_ge(x, vf_zero()), vf_lt(x, size)), vm_and(vf_ge(y, vf_zero()), vf_lt(y, size)));
}

/* Lanes of particles first to first + VLEN - 1 that exist. */
SIMD vm present(const struct splat_view *view, size_t first)
{
    size_t left = first < view->particles->count ? view->particles->count - first : 0;
    return vm_first(left < VLEN ? (int)left : VLEN);
}

SIMD vf weight_of(const struct splat_view *view, size_t first, vf radius)
{
    vf weight = vf_set1(view->weight);
    if (view->per_mass) {
        weight = weight * vf_load(view->particles->mass + first);
    }
    if (view->per_cube) {
        if (view->factors) {
            radius = radius / vf_load(view->factors + first);
        }
        weight = weight / (radius * radius * radius);
    }
    return vf_min(weight, vf_set1(WEIGHT_MAX));
}

/* Adds amount * s, or the smooth form, to one plane of sums. */
SIMD void draw_sum(const struct table *t, int i, float amount, float *sums, bool smooth)
{
    for (int x = t->x0[i]; x <= t->x1[i]; x += VLEN) {
        struct columns c = columns_at(t, i, x);
        vf dy = vf_set1((float)t->y0[i] + 0.5f - t->y[i]), one = vf_set1(1), scale = vf_set1(amount);
        float *row = sums + t->y0[i] * TILE_STRIDE + x;
        for (int y = t->y0[i]; y <= t->y1[i]; y++, row += TILE_STRIDE, dy += one) {
            vf s2 = vf_max(vf_fma(vf_fma(c.k[2], dy, c.k[1]), dy, c.k[0]), vf_zero());
            vf value = s2 * s2;
            if (!smooth) {
                value = vf_keep(vf_gt(s2, vf_zero()), s2 * vf_rsqrt_quick(s2));
            }
            vf_storeu(row, vf_fma(scale, value, vf_loadu(row)));
        }
    }
}

static inline void draw_sums(const struct splat_view *view, struct splat_tile *tile, const struct table *t, size_t first, unsigned lanes,
                             unsigned smooth)
{
    for (; lanes != 0; lanes &= lanes - 1) {
        int i = __builtin_ctz(lanes);
        for (int k = 0; k < (view->has_color ? SUM_COUNT : 1); k++) {
            float amount = k == 0 ? t->amount[i] : t->amount[i] * view->particles->color[k - 1][first + (size_t)i];
            if (smooth >> i & 1) {
                draw_sum(t, i, amount, tile->sums[k], true);
            } else {
                draw_sum(t, i, amount, tile->sums[k], false);
            }
        }
    }
}

/* Four floats of a deposit cell. */
typedef float cell_t __attribute__((vector_size(16), may_alias));

/* The four corner weights of each lane's deposit. */
SIMD void corners_of(vf amount, vf fx, vf fy, vf corners[4])
{
    vf high = amount * fy, low = amount - high, low_right = low * fx, high_right = high * fx;
    corners[0] = low - low_right;
    corners[1] = low_right;
    corners[2] = high - high_right;
    corners[3] = high_right;
}

/* Adds them to one plane. */
SIMD void add_corners(float *cells, vf corners[4], const int32_t place[VLEN], unsigned lanes)
{
    vf_transpose_4(corners); /* lane i is now four floats of corners[i % 4] */
    float quads[4 * VLEN] __attribute__((aligned(64)));
    for (int k = 0; k < 4; k++) {
        vf_store(quads + k * VLEN, corners[k]);
    }
    if (lanes == (1u << VLEN) - 1) {
        for (int i = 0; i < VLEN; i++) {
            *(cell_t *)(cells + place[i]) += *(const cell_t *)(quads + i % 4 * VLEN + i / 4 * 4);
        }
        return;
    }
    for (; lanes != 0; lanes &= lanes - 1) {
        int i = __builtin_ctz(lanes);
        *(cell_t *)(cells + place[i]) += *(const cell_t *)(quads + i % 4 * VLEN + i / 4 * 4);
    }
}

SIMD void add_cells(float *cells, vf amount, vf fx, vf fy, const int32_t place[VLEN], unsigned lanes)
{
    vf corners[4];
    corners_of(amount, fx, fy, corners);
    add_corners(cells, corners, place, lanes);
}

/* Adds amount to the four cells about the centres of lanes that are in reach of the grid, and amount * colour. */
SIMD void add_amounts(const struct splat_view *view, struct splat_tile *tile, const struct spheres *s, size_t first, vm lanes_in, vf amount)
{
    const struct splat_grid *grid = &tile->texels;
    vf x = s->x + vf_set1(0.5f), y = s->y + vf_set1(0.5f);
    vm reaches = vm_and(vm_and(vf_gt(x, vf_zero()), vf_lt(x, vf_set1((float)(grid->columns + 1)))),
                        vm_and(vf_gt(y, vf_zero()), vf_lt(y, vf_set1((float)(grid->rows + 1)))));
    unsigned lanes = vm_bits(vm_and(lanes_in, reaches));
    if (lanes == 0) {
        return;
    }
    vf left = vf_floor(x), top = vf_floor(y);
    int32_t place[VLEN] __attribute__((aligned(64)));
    vi_store(place, vi_add(vi_mul(vf_truncate(top), vi_set1(CELL_STRIDE)), vi_shl(vf_truncate(left), 2)));
    add_cells(tile->cells[0], amount, x - left, y - top, place, lanes);
    for (int c = 0; c < 3 && view->has_color; c++) {
        add_cells(tile->cells[1 + c], amount * vf_load(view->particles->color[c] + first), x - left, y - top, place, lanes);
    }
    tile->deposited = true;
}

#endif
