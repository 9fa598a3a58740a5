/* noise.c: the kernel of stage noise over simd.h. Formulas and contract: cpu/noise.h; its definition: cpu/scalar/noise.c. */
#include "cpu/noise.h"

#include "cpu/simd/sphere.h"

/* VLEN splats, as struct splat of the definition. */
struct splats {
    float x[VLEN], y[VLEN], z[VLEN], a[VLEN], b[VLEN], rho[VLEN], gx[VLEN], gy[VLEN], per_reach[VLEN], amplitude[VLEN], cell[VLEN],
        per_pixel[VLEN];
    int32_t x0[VLEN], x1[VLEN], y0[VLEN], y1[VLEN], column[VLEN]; /* column: of blocks, of the centre moved into the tile */
} __attribute__((aligned(64)));

/* What an octave's rows need of the lattice: at row y from the splat's first the two rows, and what the planes' x and y parts weigh there. */
struct lattice_rows {
    int32_t above[TILE_SIZE + VLEN], below[TILE_SIZE + VLEN]; /* floats from the lattice's corner */
    float across[2][TILE_SIZE + VLEN], down[2][TILE_SIZE + VLEN];
};

/* The same of VLEN columns: which lanes of a vector of the lattice stand left of them, and the weights on both sides. */
struct lattice_columns {
    vi left, right;
    vf across[2], down[2];
    int first; /* column of the vector's first lane */
};

SIMD vf ramp(vf at, vf low, vf per)
{
    vf t = vf_clamp((at - low) * per, vf_zero(), vf_set1(1));
    return t * t * vf_fnma(vf_set1(2), t, vf_set1(3));
}

/* Whether there is surface where splats may be, and the columns of blocks of their centres, moved into the tile. */
SIMD vm reaches(const struct noise_tile *tile, const struct spheres *s, int32_t columns[VLEN])
{
    vf last = vf_set1(TILE_SIZE - 1);
    vi column = vi_shr(vf_truncate(vf_clamp(s->x, vf_zero(), last)), NOISE_BLOCK_SHIFT);
    vi row = vi_shr(vf_truncate(vf_clamp(s->y, vf_zero(), last)), NOISE_BLOCK_SHIFT);
    vi place = vi_add(vi_mul(column, vi_set1(NOISE_BLOCK_STRIDE)), row);
    vi_store(columns, column);
    vf nearest = vf_gather(&tile->around.near[0][0], place), farthest = vf_gather(&tile->around.far[0][0], place);
    return vm_and(vf_lt(nearest - s->z, s->radius), vf_lt(s->z - farthest, s->radius));
}

/* Which of the lanes may show, and their table. */
SIMD unsigned tabulate_splats(const struct noise_view *noise, const struct noise_tile *tile, size_t first, struct splats *t)
{
    const struct splat_view *view = noise->view;
    const struct splat_grid *grid = &tile->pixels;
    struct spheres s = project(view, grid, first);
    vm seen = vm_and(present(view, first), reaches(tile, &s, t->column));
    if (!vm_any(seen)) {
        return 0;
    }
    vf amplitude = vf_set1(1), per_reach = vf_rcp(s.radius), across = vf_set1(grid->fx), down = vf_set1(grid->fy);
    if (view->particles->noise) {
        amplitude = vf_load(view->particles->noise + first);
    }
    if (!view->orthographic) {
        vf per_z = vf_rcp(s.z);
        amplitude = amplitude * ramp(s.z * per_reach, vf_set1(NOISE_CLOSE_END), vf_set1(1 / (NOISE_CLOSE_BEGIN - NOISE_CLOSE_END)));
        across = across * per_z;
        down = down * per_z;
    }
    struct outlines o = outline(view, grid, &s, vf_set1(1));
    struct places p = places_of(grid, &o);
    vf cell = vf_set1(noise->cell) * s.radius;
    seen = vm_and(vm_and(seen, p.some), vf_gt(amplitude, vf_zero()));
    vf_store(t->x, s.x);
    vf_store(t->y, s.y);
    vf_store(t->z, s.z);
    vf_store(t->a, s.a);
    vf_store(t->b, s.b);
    vf_store(t->rho, s.rho);
    vf_store(t->gx, vf_rcp(across * s.radius));
    vf_store(t->gy, vf_rcp(down * s.radius));
    vf_store(t->per_reach, per_reach);
    vf_store(t->amplitude, amplitude);
    vf_store(t->cell, vf_min(across, down) * cell);
    vf_store(t->per_pixel, vf_rcp(across * cell));
    vi_store(t->x0, vf_truncate(p.x0));
    vi_store(t->x1, vf_truncate(p.x1));
    vi_store(t->y0, vf_truncate(p.y0));
    vi_store(t->y1, vf_truncate(p.y1));
    return vm_bits(seen);
}

/* Perlin's quintic, from 1 to 0. */
SIMD vf blend(vf t)
{
    vf p = vf_fma(vf_fma(vf_set1(6), t, vf_set1(-15)), t, vf_set1(10));
    return vf_fnma(t * t * t, p, vf_set1(1));
}

/* Lattice rows for `count` rows of pixels, the first at dy from the centre. */
SIMD void find_rows(const struct noise_octave *octave, float per_pixel, float dy, int count, struct lattice_rows *rows)
{
    vi mask = vi_set1(NOISE_LATTICE - 1), stride = vi_set1(NOISE_LATTICE_STRIDE);
    vf weight = vf_set1(octave->weight), one = vf_set1(1);
    for (int i = 0; i < count; i += VLEN) {
        vf v = vf_fma(vf_set1(dy + (float)i) + vf_iota(), vf_set1(per_pixel), vf_set1(octave->y)), top = vf_floor(v), f = v - top;
        vf above = weight * blend(f), below = weight - above;
        vi row = vf_truncate(top);
        vi_storeu(rows->above + i, vi_mul(vi_and(row, mask), stride));
        vi_storeu(rows->below + i, vi_mul(vi_and(vi_add(row, vi_set1(1)), mask), stride));
        vf_storeu(rows->across[0] + i, above);
        vf_storeu(rows->across[1] + i, below);
        vf_storeu(rows->down[0] + i, above * f);
        vf_storeu(rows->down[1] + i, below * (f - one));
    }
}

SIMD struct lattice_columns find_columns(const struct noise_octave *octave, vf dx)
{
    vf one = vf_set1(1), u = vf_fma(dx, vf_set1(octave->per_pixel), vf_set1(octave->x)), left = vf_floor(u), f = u - left;
    float first = vf_first(left);
    struct lattice_columns c;
    c.left = vf_truncate(left - vf_set1(first));
    c.right = vi_add(c.left, vi_set1(1));
    c.down[0] = blend(f);
    c.down[1] = one - c.down[0];
    c.across[0] = c.down[0] * f;
    c.across[1] = c.down[1] * (f - one);
    c.first = (int)first & (NOISE_LATTICE - 1);
    return c;
}

/* One octave of a row of VLEN pixels: the lattice's two rows become one, of which each pixel takes two columns. */
SIMD vf perlin(const struct noise_view *noise, const struct lattice_rows *rows, int y, const struct lattice_columns *c, vf sum)
{
    const float *above[2], *below[2];
    for (int k = 0; k < 2; k++) {
        above[k] = noise->lattice[k] + rows->above[y] + c->first;
        below[k] = noise->lattice[k] + rows->below[y] + c->first;
    }
    vf across = vf_fma(vf_set1(rows->across[0][y]), vf_loadu(above[0]), vf_set1(rows->across[1][y]) * vf_loadu(below[0]));
    vf down = vf_fma(vf_set1(rows->down[0][y]), vf_loadu(above[1]), vf_set1(rows->down[1][y]) * vf_loadu(below[1]));
    sum = vf_fma(c->across[0], vf_permute(across, c->left), sum);
    sum = vf_fma(c->down[0], vf_permute(down, c->left), sum);
    sum = vf_fma(c->across[1], vf_permute(across, c->right), sum);
    return vf_fma(c->down[1], vf_permute(down, c->right), sum);
}

/* The rows of blocks, from that of place y0 on, that may hold surface as near to the centre as the splat reaches. Within it |e| < 1, so that P - c is
 * no nearer to 0 across the view axis than (1 - rho) gy, less |b|. */
SIMD uint32_t blocks_of(const struct noise_tile *tile, const struct splats *t, int i)
{
    const float size = 1 << NOISE_BLOCK_SHIFT, half = 0.5f * size;
    int first = t->y0[i] >> NOISE_BLOCK_SHIFT, last = t->y1[i] >> NOISE_BLOCK_SHIFT, column = t->column[i];
    vf z = vf_set1(t->z[i]), per_reach = vf_set1(t->per_reach[i]), zero = vf_zero(), one = vf_set1(1);
    vf y = vf_fma(vf_iota(), vf_set1(size), vf_set1((float)first * size + half - t->y[i]));
    uint32_t found = 0;
    for (int by = first; by <= last; by += VLEN, y += vf_set1(VLEN * size)) {
        vf gy = vf_max(vf_fma(vf_abs(y) - vf_set1(half), vf_set1((1 - t->rho[i]) * t->gy[i]), vf_set1(-fabsf(t->b[i]))), zero);
        vf before = vf_loadu(tile->beside.near[column] + by) - z, behind = z - vf_loadu(tile->beside.far[column] + by);
        vf e = vf_max(vf_max(before, behind), zero) * per_reach;
        vm here = vm_and(vf_lt(vf_fma(gy, gy, e * e), one), vm_first(last - by + 1));
        found |= (uint32_t)vm_bits(here) << (by - first);
    }
    return found;
}

/* VLEN columns of a splat, from place x on, in rows y0 to y1. */
SIMD void add_rows(const struct noise_view *noise, struct noise_tile *tile, const struct splats *t, int i, int x, vf gx, int y0, int y1,
                   const struct lattice_columns *columns, const struct lattice_rows *rows, int octave_count)
{
    vf per_reach = vf_set1(t->per_reach[i]), z = vf_set1(t->z[i]), rho = vf_set1(t->rho[i]), b = vf_set1(t->b[i]), one = vf_set1(1);
    vf along_x = vf_fma(rho, gx, vf_set1(t->a[i]));
    for (int y = y0; y <= y1; y++) {
        vf e = (vf_loadu(tile->depth + y * tile->stride + x) - z) * per_reach, gy = vf_set1(((float)y + 0.5f - t->y[i]) * t->gy[i]);
        vf px = vf_fma(e, along_x, gx), py = vf_fma(e, vf_fma(rho, gy, b), gy);
        vf w = vf_fnma(e, e, vf_fnma(py, py, vf_fnma(px, px, one)));
        if (!vm_any(vf_gt(w, vf_zero()))) {
            continue;
        }
        vf sum = vf_zero();
        for (int k = 0; k < octave_count; k++) {
            sum = perlin(noise, &rows[k], y - t->y0[i], &columns[k], sum);
        }
        w = vf_max(w, vf_zero());
        float *to = tile->sums + y * TILE_STRIDE + x;
        vf_storeu(to, vf_fma(w * w * w, sum, vf_loadu(to)));
    }
}

SIMD int least(int a, int b) { return a < b ? a : b; }
SIMD int most(int a, int b) { return a > b ? a : b; }

/* A splat, strip by strip of VLEN columns. blocks: of blocks_of. */
SIMD void add_strips(const struct noise_view *noise, struct noise_tile *tile, const struct splats *t, int i,
                     const struct noise_octave *octaves, const struct lattice_rows *rows, uint32_t blocks, int octave_count)
{
    const int first = t->y0[i] >> NOISE_BLOCK_SHIFT;
    for (int x = t->x0[i]; x <= t->x1[i]; x += VLEN) {
        struct lattice_columns columns[NOISE_OCTAVES_MAX];
        vf dx = vf_set1((float)x + 0.5f - t->x[i]) + vf_iota(), gx = dx * vf_set1(t->gx[i]);
        for (int k = 0; k < octave_count; k++) {
            columns[k] = find_columns(&octaves[k], dx);
        }
        for (uint32_t left = blocks; left != 0; left &= left - 1) {
            int top = (first + __builtin_ctz(left)) << NOISE_BLOCK_SHIFT;
            add_rows(noise, tile, t, i, x, gx, most(t->y0[i], top), least(t->y1[i], top + (1 << NOISE_BLOCK_SHIFT) - 1), columns, rows,
                     octave_count);
        }
    }
}

static void add(const struct noise_view *noise, struct noise_tile *tile, struct splats *t, int i, float seed)
{
    uint32_t blocks = blocks_of(tile, t, i);
    if (blocks == 0) {
        return;
    }
    int first = t->y0[i] >> NOISE_BLOCK_SHIFT, last = first + 31 - __builtin_clz(blocks); /* rows without surface are not looked at */
    t->y0[i] = most(t->y0[i], (first + __builtin_ctz(blocks)) << NOISE_BLOCK_SHIFT);
    t->y1[i] = least(t->y1[i], (last << NOISE_BLOCK_SHIFT) + (1 << NOISE_BLOCK_SHIFT) - 1);
    blocks >>= __builtin_ctz(blocks);
    struct noise_octave octaves[NOISE_OCTAVES_MAX];
    struct lattice_rows rows[NOISE_OCTAVES_MAX];
    int count = noise_octaves_of(noise, seed, t->amplitude[i], t->cell[i], t->per_pixel[i], octaves);
    float aspect = tile->pixels.fx / tile->pixels.fy;
    for (int k = 0; k < count; k++) {
        find_rows(&octaves[k], octaves[k].per_pixel * aspect, (float)t->y0[i] + 0.5f - t->y[i], t->y1[i] - t->y0[i] + 1, &rows[k]);
    }
    switch (count) { /* the commonest with their columns in registers */
    case 0: break;
    case 1: add_strips(noise, tile, t, i, octaves, rows, blocks, 1); break;
    case 2: add_strips(noise, tile, t, i, octaves, rows, blocks, 2); break;
    default: add_strips(noise, tile, t, i, octaves, rows, blocks, count); break;
    }
}

static void splat(const struct noise_view *noise, struct noise_tile *tile, size_t chunk)
{
    struct splats table;
    for (size_t first = chunk * CHUNK_SIZE; first < (chunk + 1) * CHUNK_SIZE; first += VLEN) {
        for (unsigned lanes = tabulate_splats(noise, tile, first, &table); lanes != 0; lanes &= lanes - 1) {
            int i = __builtin_ctz(lanes);
            add(noise, tile, &table, i, noise->view->particles->seed[first + (size_t)i]);
        }
    }
}

const struct noise_kernels SIMD_NAME(mns_noise_kernels) = {.splat = splat};
