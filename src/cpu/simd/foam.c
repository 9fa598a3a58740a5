/* foam.c: the kernels of stage foam over simd.h. Formulas and contracts: cpu/foam.h; their definition: cpu/scalar/foam.c. */
#include "cpu/foam.h"

#include "cpu/simd/sphere.h"

#include <string.h>

static size_t ends(const struct splat_view *view, const struct splat_tile *tile, float delta, const struct plane *scene,
                   struct plane *depth, struct foam_ends *out)
{
    size_t covered = 0;
    vf empty = vf_set1(DEPTH_EMPTY), limit = vf_set1(DEPTH_LIMIT);
    for (int y = 0; y < tile->pixels.rows; y++) {
        float *row = depth->data + (tile->y + y) * depth->stride + tile->x;
        const float *behind = scene ? scene->data + (tile->y + y) * scene->stride + tile->x : NULL;
        struct ray_row ray = ray_row_at(view, &tile->pixels, y);
        for (int x = 0; x < tile->pixels.columns; x += VLEN) {
            vf z = vf_loadu(row + x), square = ray_length2(&ray, x), end = empty;
            vm inside = vm_first(tile->pixels.columns - x);
            if (scene) {
                end = vf_select(inside, vf_loadu(behind + x), empty);
            }
            vm shows = vm_and(vm_and(inside, vf_lt(z, limit)), vf_lt(z, end));
            vf all = vf_keep(shows, vf_select(vf_lt(end, limit), end * square, empty));
            vf_store(out->all + y * TILE_STRIDE + x, all);
            vf_store(out->front + y * TILE_STRIDE + x, vf_keep(shows, vf_min((z + vf_set1(delta)) * square, all)));
            vf_storeu(row + x, vf_select(inside, vf_select(shows, z, empty), z));
            covered += (size_t)__builtin_popcount(vm_bits(shows));
        }
    }
    return covered;
}

static void limits(const struct splat_view *view, const struct splat_tile *tile, const struct plane *depth, float *out)
{
    int rows = view->height - tile->y, columns = view->width - tile->x, scale = view->scale;
    rows = rows < TILE_SIZE ? rows : TILE_SIZE;
    columns = columns < TILE_SIZE ? columns : TILE_SIZE;
    memset(out, 0, (size_t)(TILE_SIZE / scale + 2) * TILE_STRIDE * sizeof(float));
    for (int top = 0; top < rows; top += scale) {
        float sums[TILE_SIZE] __attribute__((aligned(64))), counts[TILE_SIZE] __attribute__((aligned(64)));
        for (int x = 0; x < columns; x += VLEN) {
            vf sum = vf_zero(), count = vf_zero();
            vm inside = vm_first(columns - x);
            for (int y = top; y < top + scale && y < rows; y++) {
                vf z = vf_loadu(depth->data + (tile->y + y) * depth->stride + tile->x + x);
                vm shows = vm_and(inside, vf_lt(z, vf_set1(DEPTH_LIMIT)));
                sum = vf_mask_add(sum, shows, z);
                count = vf_mask_add(count, shows, vf_set1(1));
            }
            vf_store(sums + x, sum);
            vf_store(counts + x, count);
        }
        float *row = out + (top / scale + 1) * TILE_STRIDE + 1;
        for (int x = 0; x * scale < columns; x++) {
            float sum = 0, count = 0;
            for (int px = x * scale; px < (x + 1) * scale && px < columns; px++) {
                sum += sums[px];
                count += counts[px];
            }
            row[x] = count > 0 ? sum / count : 0;
        }
    }
}

/* ---- detail ---- */

enum { POINTS_MAX = (DETAIL_CELLS << (DETAIL_OCTAVES - 1)) + 1 };

/* One octave of VLEN particles, as struct slice of the plain C. */
struct slices {
    float gx[POINTS_MAX * POINTS_MAX][VLEN], gy[POINTS_MAX * POINTS_MAX][VLEN], gz[POINTS_MAX * POINTS_MAX][VLEN];
    float weight[VLEN];
} __attribute__((aligned(64)));

/* Values of a row of lattice points down the columns of one vector: at + dy * slope. */
struct lattice_row {
    vf at, slope;
};

SIMD vf fade(vf t) { return t * t * t * vf_fma(t, vf_fma(t, vf_set1(6), vf_set1(-15)), vf_set1(10)); }

SIMD vf mix(vf a, vf b, vf t) { return vf_fma(t, b - a, a); }

SIMD vi vi_xor(vi a, vi b) { return vi_sub(vi_or(a, b), vi_and(a, b)); }

SIMD vi hash_end(vi h)
{
    h = vi_mul(vi_xor(h, vi_shr(h, 15)), vi_set1((int)0x2c1b3c6du));
    h = vi_mul(vi_xor(h, vi_shr(h, 12)), vi_set1((int)0x297a2d39u));
    return vi_xor(h, vi_shr(h, 15));
}

SIMD vf component(vi hash, int k)
{
    return vf_fma(vi_float(vi_and(vi_shr(hash, 10 * k), vi_set1(1023))), vf_set1(1 / 511.5f), vf_set1(-1));
}

/* Returns whether any particle has detail of this octave. size: radii in pixels. */
SIMD bool make_slices(struct slices *out, int octave, vf seed, vf age, vf size)
{
    int points = (DETAIL_CELLS << octave) + 1;
    vf cell = size * vf_set1(2.0f / (float)(points - 1));
    vf weight = vf_set1(DETAIL_GAIN[octave]) * vf_clamp((cell - vf_set1(DETAIL_LEAST)) * vf_set1(1 / DETAIL_LEAST), vf_zero(), vf_set1(1));
    vf_store(out->weight, weight);
    if (!vm_any(vf_gt(weight, vf_zero()))) {
        return false;
    }
    vf z = vf_set1(DETAIL_LIFE) * age, below = vf_floor(z), dz = z - below, above = dz - vf_set1(1), part = fade(dz);
    vi base = vi_add(vi_add(vi_mul(vf_truncate(seed), vi_set1((int)0x9e3779b1u)), vi_mul(vf_truncate(below), vi_set1(0x165667b1))),
                     vi_set1((int)((uint32_t)octave * 0x85ebca6bu)));
    for (int j = 0; j < points; j++) {
        for (int i = 0; i < points; i++) {
            vi h = vi_add(base, vi_set1((int)((uint32_t)i * 0xc2b2ae35u + (uint32_t)j * 0x27d4eb2fu)));
            vi a = hash_end(h), b = hash_end(vi_add(h, vi_set1(0x165667b1)));
            int at = j * points + i;
            vf_store(out->gx[at], mix(component(a, 0), component(b, 0), part));
            vf_store(out->gy[at], mix(component(a, 1), component(b, 1), part));
            vf_store(out->gz[at], mix(component(a, 2) * dz, component(b, 2) * above, part));
        }
    }
    return true;
}

/* Rows of the lattice of particle `lane` for columns at u, -1 to 1 across the sphere; weighted. rows: [points] */
SIMD void make_rows(const struct slices *s, int octave, int lane, vf u, struct lattice_row *rows)
{
    int cells = DETAIL_CELLS << octave, points = cells + 1;
    vf x = vf_clamp((u + vf_set1(1)) * vf_set1(0.5f * (float)cells), vf_zero(), vf_set1((float)cells));
    vf i = vf_min(vf_floor(x), vf_set1((float)(cells - 1))), dx = x - i, part = fade(dx), weight = vf_set1(s->weight[lane]);
    vf left = dx * weight, right = left - weight;
    for (int j = 0; j < points; j++) {
        int at = j * points;
        vf gx[2], gy[2], gz[2];
        for (int k = 0; k < 2; k++) {
            gx[k] = vf_set1(s->gx[at + k][lane]);
            gy[k] = vf_set1(s->gy[at + k][lane]);
            gz[k] = vf_set1(s->gz[at + k][lane]);
            for (int c = 1; c < cells; c++) {
                vm here = vf_ge(i, vf_set1((float)c));
                gx[k] = vf_select(here, vf_set1(s->gx[at + c + k][lane]), gx[k]);
                gy[k] = vf_select(here, vf_set1(s->gy[at + c + k][lane]), gy[k]);
                gz[k] = vf_select(here, vf_set1(s->gz[at + c + k][lane]), gz[k]);
            }
        }
        rows[j].at = mix(vf_fma(gx[0], left, gz[0] * weight), vf_fma(gx[1], right, gz[1] * weight), part);
        rows[j].slope = mix(gy[0], gy[1], part) * weight;
    }
}

/* What VLEN rows of pixels take of the rows of the lattice above and below them: noise = at[j] w[0] + slope[j] w[1] + at[j + 1] w[2] + slope[j + 1] w[3]. */
struct row_weights {
    float w[4][VLEN];
    int32_t j[VLEN];
} __attribute__((aligned(64)));

/* v: -1 to 1 down the sphere. */
SIMD void weigh_rows(vf v, int cells, struct row_weights *out)
{
    vf y = vf_clamp((v + vf_set1(1)) * vf_set1(0.5f * (float)cells), vf_zero(), vf_set1((float)cells));
    vf j = vf_min(vf_floor(y), vf_set1((float)(cells - 1))), dy = y - j, below = fade(dy), above = vf_set1(1) - below;
    vf_store(out->w[0], above);
    vf_store(out->w[1], above * dy);
    vf_store(out->w[2], below);
    vf_store(out->w[3], below * (dy - vf_set1(1)));
    vi_store(out->j, vf_truncate(j));
}

SIMD vf noise_at(const struct lattice_row *rows, const struct row_weights *row, int k)
{
    const struct lattice_row *above = rows + row->j[k];
    vf noise = vf_fma(above[0].slope, vf_set1(row->w[1][k]), above[0].at * vf_set1(row->w[0][k]));
    return vf_fma(above[1].slope, vf_set1(row->w[3][k]), vf_fma(above[1].at, vf_set1(row->w[2][k]), noise));
}

/* ---- T_f and T_ff ---- */

struct sphere_detail {
    const struct slices *slices; /* [octaves] */
    float amount, per_x, per_y;  /* of the largest noise; (u, v) per pixel */
};

/* octaves: a constant wherever this is called. */
SIMD void draw_columns(const struct table *t, int i, int x, struct splat_tile *tile, const struct foam_ends *ends,
                       const struct sphere_detail *detail, int octaves)
{
    struct lattice_row rows[DETAIL_OCTAVES][POINTS_MAX];
    const vf dx = vf_set1((float)x + 0.5f - t->x[i]) + vf_iota(), one = vf_set1(1), amount = vf_set1(detail->amount);
    for (int octave = 0; octave < octaves; octave++) {
        make_rows(&detail->slices[octave], octave, i, dx * vf_set1(detail->per_x), rows[octave]);
    }
    const struct columns c = columns_at(t, i, x);
    const vf v0 = vf_fma(vf_set1(t->vx[i]), dx, vf_set1(t->v0[i])), vy = vf_set1(t->vy[i]), weight = vf_set1(0.5f * t->amount[i]);
    float down = (float)t->y0[i] + 0.5f - t->y[i], per_y = detail->per_y;
    const ptrdiff_t first = t->y0[i] * TILE_STRIDE + x;
    const float *end_all = ends->all + first, *end_front = ends->front + first;
    float *all = tile->sums[0] + first, *front = tile->sums[1] + first;
    struct row_weights weights[DETAIL_OCTAVES];
    for (int row = 0; row <= t->y1[i] - t->y0[i]; row++, down += 1) {
        for (int octave = 0; octave < octaves && row % VLEN == 0; octave++) {
            weigh_rows((vf_set1(down) + vf_iota()) * vf_set1(per_y), DETAIL_CELLS << octave, &weights[octave]);
        }
        vf dy = vf_set1(down), s2 = vf_max(vf_fma(vf_fma(c.k[2], dy, c.k[1]), dy, c.k[0]), vf_zero()), here = weight;
        vf root = vf_keep(vf_gt(s2, vf_zero()), s2 * vf_rsqrt_quick(s2)), along = vf_fma(vy, dy, v0);
        vf enter = along - root, leave = along + root;
        if (octaves > 0) {
            vf noise = noise_at(rows[0], &weights[0], row % VLEN);
            for (int octave = 1; octave < octaves; octave++) {
                noise = noise + noise_at(rows[octave], &weights[octave], row % VLEN);
            }
            here = weight * vf_max(vf_fma(amount, noise, one), vf_zero());
        }
        vf_storeu(all, vf_fma(here, vf_max(vf_min(leave, vf_loadu(end_all)) - enter, vf_zero()), vf_loadu(all)));
        vf_storeu(front, vf_fma(here, vf_max(vf_min(leave, vf_loadu(end_front)) - enter, vf_zero()), vf_loadu(front)));
        end_all += TILE_STRIDE;
        end_front += TILE_STRIDE;
        all += TILE_STRIDE;
        front += TILE_STRIDE;
    }
}

static void draw(const struct table *t, int i, struct splat_tile *tile, const struct foam_ends *ends, const struct sphere_detail *detail,
                 int octaves)
{
    for (int x = t->x0[i]; x <= t->x1[i]; x += VLEN) {
        switch (octaves) {
        case 0: draw_columns(t, i, x, tile, ends, detail, 0); break;
        case 1: draw_columns(t, i, x, tile, ends, detail, 1); break;
        case 2: draw_columns(t, i, x, tile, ends, detail, 2); break;
        default: draw_columns(t, i, x, tile, ends, detail, DETAIL_OCTAVES); break;
        }
    }
}

static void thickness(const struct splat_view *view, struct splat_tile *tile, size_t chunk, const struct foam_ends *ends, float amount)
{
    const struct particle_store *p = view->particles;
    struct table table;
    struct slices slices[DETAIL_OCTAVES];
    for (size_t first = chunk * CHUNK_SIZE; first < (chunk + 1) * CHUNK_SIZE; first += VLEN) {
        struct spheres s = project(view, &tile->pixels, first);
        struct outlines o = outline(view, &tile->pixels, &s, vf_set1(1));
        struct places places = places_of(&tile->pixels, &o);
        unsigned lanes = vm_bits(vm_and(present(view, first), places.some));
        if (lanes == 0) {
            continue;
        }
        tabulate(view, &tile->pixels, &s, &places, &table);
        vf_store(table.amount, weight_of(view, first, s.radius));
        vf across = vf_either(view->orthographic, s.radius, s.rho), size = across * vf_set1(0.5f * (tile->pixels.fx + tile->pixels.fy));
        float acrosses[VLEN] __attribute__((aligned(64)));
        vf_store(acrosses, across);
        int octaves = 0;
        while (octaves < DETAIL_OCTAVES && amount > 0 &&
               make_slices(&slices[octaves], octaves, vf_load(p->seed + first), p->age ? vf_load(p->age + first) : vf_zero(), size)) {
            octaves++;
        }
        for (; lanes != 0; lanes &= lanes - 1) {
            int i = __builtin_ctz(lanes), own = 0;
            while (own < octaves && slices[own].weight[i] > 0) {
                own++;
            }
            const struct sphere_detail detail = {.slices = slices,
                                                 .amount = amount,
                                                 .per_x = 1 / (acrosses[i] * tile->pixels.fx),
                                                 .per_y = 1 / (acrosses[i] * tile->pixels.fy)};
            draw(&table, i, tile, ends, &detail, own);
        }
    }
}

/* ---- T_wf ---- */

/* Share of a ball's volume that is before depth. */
SIMD vf part_before(vf z, vf per_radius, vf depth)
{
    vf h = vf_clamp((depth - z) * per_radius, vf_set1(-1), vf_set1(1));
    return vf_fma(vf_set1(0.25f) * h, vf_set1(3) - h * h, vf_set1(0.5f));
}

/* The chord before the limits, or the smooth form's share. */
SIMD void draw_front(const struct splat_view *view, struct splat_tile *tile, const struct table *t, int i, bool smooth, float z,
                     float per_radius, const float *limits)
{
    for (int x = t->x0[i]; x <= t->x1[i]; x += VLEN) {
        struct columns c = columns_at(t, i, x);
        vf along = vf_fma(vf_set1(t->vx[i]), vf_set1((float)x + 0.5f - t->x[i]) + vf_iota(), vf_set1(t->v0[i])), vy = vf_set1(t->vy[i]);
        vf dy = vf_set1((float)t->y0[i] + 0.5f - t->y[i]), one = vf_set1(1), amount = vf_set1(smooth ? t->amount[i] : 0.5f * t->amount[i]);
        for (int y = t->y0[i]; y <= t->y1[i]; y++, dy += one) {
            float *row = tile->sums[0] + y * TILE_STRIDE + x;
            vf s2 = vf_max(vf_fma(vf_fma(c.k[2], dy, c.k[1]), dy, c.k[0]), vf_zero()), value;
            vf limit = vf_loadu(limits + (y + 1) * TILE_STRIDE + x + 1);
            if (smooth) {
                value = s2 * s2 * part_before(vf_set1(z), vf_set1(per_radius), limit);
            } else {
                struct ray_row ray = ray_row_at(view, &tile->texels, y);
                vf root = vf_keep(vf_gt(s2, vf_zero()), s2 * vf_rsqrt_quick(s2)), middle = vf_fma(vy, dy, along);
                value = vf_max(vf_min(middle + root, limit * ray_length2(&ray, x)) - (middle - root), vf_zero());
            }
            vf_storeu(row, vf_fma(amount, value, vf_loadu(row)));
        }
    }
}

SIMD void add_front(const struct splat_view *view, struct splat_tile *tile, const struct spheres *s, size_t first, vm large, vf size,
                    const float *limits)
{
    struct table table;
    vm smooth = view->scale > 1 ? vf_lt(size, vf_set1(CHORD_RADIUS)) : vf_lt(size, vf_zero());
    vf spread = smooth_spread(size);
    struct outlines o = outline(view, &tile->texels, s, vf_select(smooth, spread * vf_rsqrt(spread), vf_set1(1)));
    struct places p = places_of(&tile->texels, &o);
    unsigned lanes = vm_bits(vm_and(large, p.some)), forms = vm_bits(smooth);
    if (lanes == 0) {
        return;
    }
    float z[VLEN] __attribute__((aligned(64))), per_radius[VLEN] __attribute__((aligned(64)));
    vf_store(z, s->z);
    vf_store(per_radius, vf_rcp(s->radius));
    tabulate(view, &tile->texels, s, &p, &table);
    vf_store(table.amount, weight_of(view, first, s->radius));
    smooth_table(&table, smooth, vf_rcp(spread));
    for (; lanes != 0; lanes &= lanes - 1) {
        int i = __builtin_ctz(lanes);
        if (forms >> i & 1) {
            draw_front(view, tile, &table, i, true, z[i], per_radius[i], limits);
        } else {
            draw_front(view, tile, &table, i, false, z[i], per_radius[i], limits);
        }
    }
}

SIMD void deposit_front(const struct splat_view *view, struct splat_tile *tile, const struct spheres *s, size_t first, vm small,
                        const float *limits)
{
    const struct splat_grid *grid = &tile->texels;
    vf x = s->x + vf_set1(0.5f), y = s->y + vf_set1(0.5f);
    vm reaches = vm_and(vm_and(vf_gt(x, vf_zero()), vf_lt(x, vf_set1((float)(grid->columns + 1)))),
                        vm_and(vf_gt(y, vf_zero()), vf_lt(y, vf_set1((float)(grid->rows + 1)))));
    unsigned lanes = vm_bits(vm_and(small, reaches));
    if (lanes == 0) {
        return;
    }
    vm here = vm_and(small, reaches);
    vf left = vf_keep(here, vf_floor(x)), top = vf_keep(here, vf_floor(y)), corners[4], per_radius = vf_rcp(s->radius);
    int32_t place[VLEN] __attribute__((aligned(64)));
    vi column = vf_truncate(left), row = vf_truncate(top), limit = vi_add(vi_mul(row, vi_set1(TILE_STRIDE)), column);
    vi_store(place, vi_add(vi_mul(row, vi_set1(CELL_STRIDE)), vi_shl(column, 2)));
    corners_of(deposit_amount(view, grid, s, weight_of(view, first, s->radius)), x - left, y - top, corners);
    for (int k = 0; k < 4; k++) {
        corners[k] = corners[k] * part_before(s->z, per_radius, vf_gather(limits + k / 2 * TILE_STRIDE + k % 2, limit));
    }
    add_corners(tile->cells[0], corners, place, lanes);
    tile->deposited = true;
}

static void front(const struct splat_view *view, struct splat_tile *tile, size_t chunk, const float *limits, float last)
{
    vf per_metre = vf_set1(0.5f * (tile->texels.fx + tile->texels.fy)), deposit_below = vf_set1(view->scale > 1 ? DEPOSIT_RADIUS : 0);
    for (size_t first = chunk * CHUNK_SIZE; first < (chunk + 1) * CHUNK_SIZE; first += VLEN) {
        struct spheres s = project(view, &tile->texels, first);
        vf size = per_metre * vf_either(view->orthographic, s.radius, s.rho);
        vm real = vm_and(present(view, first), vf_lt(s.z - s.radius, vf_set1(last))), small = vf_lt(size, deposit_below);
        if (!vm_any(real)) {
            continue;
        }
        deposit_front(view, tile, &s, first, vm_and(real, small), limits);
        add_front(view, tile, &s, first, vm_and(real, vm_not(small)), size, limits);
    }
}

const struct foam_kernels SIMD_NAME(mns_foam_kernels) = {.ends = ends, .limits = limits, .thickness = thickness, .front = front};
