/* ellipsoid.c: the kernels that draw particles with a shape, over simd.h. Formulas and contracts: cpu/ellipsoid.h; their definition:
 * cpu/scalar/ellipsoid.c. */
#include "cpu/ellipsoid.h"

#include "cpu/simd/tile.h"

/* What A adds to VLEN spheres, as struct ellipsoid. */
struct shapes {
    vf half[3][3]; /* A times each row of the rotation */
    vf b[6], q[6], det, reach;
    vf gxx, gyy, gxy;
};

/* One coefficient for each lane. */
struct lane_quadratic {
    float k0[VLEN], kx[VLEN], ky[VLEN], kxx[VLEN], kyy[VLEN], kxy[VLEN];
} __attribute__((aligned(64)));

/* What the loops over one ellipsoid's places read: struct ellipsoid_poly and the rest of VLEN ellipsoids. */
struct ellipsoid_table {
    struct lane_quadratic s2, e, f;
    float depth[VLEN], det[VLEN], x[VLEN], y[VLEN], amount[VLEN];
    int32_t x0[VLEN], x1[VLEN], y0[VLEN], y1[VLEN];
} __attribute__((aligned(64)));

SIMD vf dot(const vf a[3], const vf b[3]) { return vf_fma(a[0], b[0], vf_fma(a[1], b[1], a[2] * b[2])); }

SIMD vf dot_row(const float row[3], const vf b[3])
{
    return vf_fma(vf_set1(row[0]), b[0], vf_fma(vf_set1(row[1]), b[1], vf_set1(row[2]) * b[2]));
}

/* A times a row of the rotation. */
SIMD void half_turn(const struct splat_view *view, size_t first, int row, vf out[3])
{
    static const int at[3][3] = {{0, 3, 4}, {3, 1, 5}, {4, 5, 2}};
    for (int k = 0; k < 3; k++) {
        vf a[3];
        for (int axis = 0; axis < 3; axis++) {
            a[axis] = vf_load(view->particles->shape[at[k][axis]] + first);
        }
        out[k] = dot_row(&view->rotation[3 * row], a);
    }
}

/* How far lanes reach in depth; the rest waits until they are known to show. */
SIMD void reach_of(const struct splat_view *view, size_t first, const struct spheres *s, struct shapes *out)
{
    half_turn(view, first, 2, out->half[2]);
    out->b[2] = dot(out->half[2], out->half[2]);
    out->reach = s->radius * vf_sqrt(out->b[2]);
}

/* Q and det from A. */
SIMD void invert(const vf a[6], struct shapes *out)
{
    vf xx = vf_fnma(a[5], a[5], a[1] * a[2]), yy = vf_fnma(a[4], a[4], a[0] * a[2]), zz = vf_fnma(a[3], a[3], a[0] * a[1]);
    vf xy = vf_fnma(a[3], a[2], a[4] * a[5]), xz = vf_fnma(a[4], a[1], a[3] * a[5]), yz = vf_fnma(a[0], a[5], a[3] * a[4]);
    const vf x[3] = {xx, xy, xz}, y[3] = {xy, yy, yz}, z[3] = {xz, yz, zz}, row[3] = {a[0], a[3], a[4]};
    out->det = dot(row, x);
    out->q[0] = dot(x, x);
    out->q[1] = dot(y, y);
    out->q[2] = dot(z, z);
    out->q[3] = dot(x, y);
    out->q[4] = dot(x, z);
    out->q[5] = dot(y, z);
}

/* All but what reach_of gave. */
SIMD void turn(const struct splat_view *view, size_t first, const struct spheres *s, struct shapes *out)
{
    half_turn(view, first, 0, out->half[0]);
    half_turn(view, first, 1, out->half[1]);
    vf(*half)[3] = out->half, *b = out->b;
    const float *x = &view->rotation[0], *y = &view->rotation[3], *z = &view->rotation[6];
    const vf a[6] = {dot_row(x, half[0]), dot_row(y, half[1]), dot_row(z, half[2]),
                     dot_row(x, half[1]), dot_row(x, half[2]), dot_row(y, half[2])};
    b[0] = dot(half[0], half[0]);
    b[1] = dot(half[1], half[1]);
    b[3] = dot(half[0], half[1]);
    b[4] = dot(half[0], half[2]);
    b[5] = dot(half[1], half[2]);
    invert(a, out);
    vf two = vf_set1(2);
    out->gxx = vf_fma(s->a, vf_fnma(two, b[4], s->a * b[2]), b[0]);
    out->gyy = vf_fma(s->b, vf_fnma(two, b[5], s->b * b[2]), b[1]);
    out->gxy = vf_fnma(s->b, b[4], vf_fma(s->a, vf_fnma(vf_set1(1), b[5], s->b * b[2]), b[3]));
}

/* ellipsoid_extent about a centre at `at`. */
SIMD void extend(vf slope, vf at, const struct spheres *s, const struct shapes *e, vf g, vf diagonal, vf mixed, vf focal, vf *low, vf *high)
{
    vf square = s->rho * s->rho, minor = vf_fnma(mixed, mixed, diagonal * e->b[2]);
    vf root = vf_sqrt(vf_max(vf_fnma(square, minor, g), vf_zero())), middle = s->rho * vf_fnma(slope, e->b[2], mixed);
    vf scale = focal * s->rho * vf_rcp(vf_fnma(square, e->b[2], vf_set1(1)));
    *low = vf_fnma(scale, middle + root, at);
    *high = vf_fma(scale, root - middle, at);
}

SIMD struct outlines outline(const struct splat_view *view, const struct splat_grid *grid, const struct spheres *s, const struct shapes *e)
{
    struct outlines o;
    if (view->orthographic) {
        vf rx = vf_set1(grid->fx) * s->radius * vf_sqrt(e->gxx), ry = vf_set1(grid->fy) * s->radius * vf_sqrt(e->gyy);
        return (struct outlines){s->x - rx, s->x + rx, s->y - ry, s->y + ry};
    }
    extend(s->a, s->x, s, e, e->gxx, e->b[0], e->b[4], vf_set1(grid->fx), &o.x_min, &o.x_max);
    extend(s->b, s->y, s, e, e->gyy, e->b[1], e->b[5], vf_set1(grid->fy), &o.y_min, &o.y_max);
    return o;
}

SIMD void store_quadratic(struct lane_quadratic *out, vf k0, vf kx, vf ky, vf kxx, vf kyy, vf kxy)
{
    vf_store(out->k0, k0);
    vf_store(out->kx, kx);
    vf_store(out->ky, ky);
    vf_store(out->kxx, kxx);
    vf_store(out->kyy, kyy);
    vf_store(out->kxy, kxy);
}

SIMD void store_places(const struct spheres *s, const struct places *p, float x[VLEN], float y[VLEN], int32_t x0[VLEN], int32_t x1[VLEN],
                       int32_t y0[VLEN], int32_t y1[VLEN])
{
    vf_store(x, s->x);
    vf_store(y, s->y);
    vi_store(x0, vf_truncate(p->x0));
    vi_store(x1, vf_truncate(p->x1));
    vi_store(y0, vf_truncate(p->y0));
    vi_store(y1, vf_truncate(p->y1));
}

/* Q v0's depth at the projected centre: E there. */
SIMD vf center_e(const struct spheres *s, const vf q[6])
{
    vf x = vf_fma(q[0], s->a, vf_fma(q[3], s->b, q[4])), y = vf_fma(q[3], s->a, vf_fma(q[1], s->b, q[5]));
    return vf_fma(x, s->a, vf_fma(y, s->b, vf_fma(q[4], s->a, vf_fma(q[5], s->b, q[2]))));
}

/* Fills all of the table but amount. */
SIMD void tabulate(const struct splat_view *view, const struct splat_grid *grid, const struct spheres *s, const struct shapes *e,
                   const struct places *p, struct ellipsoid_table *t)
{
    const vf *q = e->q;
    vf px = vf_set1(1 / grid->fx), py = vf_set1(1 / grid->fy), r2 = s->radius * s->radius, two = vf_set1(2), zero = vf_zero();
    vf x = vf_fma(q[0], s->a, vf_fma(q[3], s->b, q[4])) * px, y = vf_fma(q[3], s->a, vf_fma(q[1], s->b, q[5])) * py;
    vf e0 = center_e(s, q);
    vf_store(t->depth, s->z);
    vf_store(t->det, e->det);
    store_places(s, p, t->x, t->y, t->x0, t->x1, t->y0, t->y1);
    if (view->orthographic) {
        store_quadratic(&t->e, e0, zero, zero, zero, zero, zero);
        store_quadratic(&t->f, zero, x, y, zero, zero, zero);
        store_quadratic(&t->s2, r2 * e0, zero, zero, -e->gyy * px * px, -e->gxx * py * py, two * e->gxy * px * py);
        return;
    }
    vf zx = s->z * px, zy = s->z * py, xx = q[0] * px * px, yy = q[1] * py * py, xy = two * q[3] * px * py;
    store_quadratic(&t->e, e0, two * x, two * y, xx, yy, xy);
    store_quadratic(&t->f, zero, s->z * x, s->z * y, s->z * xx, s->z * yy, s->z * xy);
    store_quadratic(&t->s2, r2 * e0, two * r2 * x, two * r2 * y, vf_fnma(e->gyy * zx, zx, r2 * xx), vf_fnma(e->gxx * zy, zy, r2 * yy),
                    vf_fma(two * e->gxy * zx, zy, r2 * xy));
}

/* A quadratic down a column of lanes. */
SIMD struct columns quadratic_columns(const struct lane_quadratic *k, int i, vf dx)
{
    return (struct columns){{vf_fma(vf_fma(vf_set1(k->kxx[i]), dx, vf_set1(k->kx[i])), dx, vf_set1(k->k0[i])),
                             vf_fma(vf_set1(k->kxy[i]), dx, vf_set1(k->ky[i])), vf_set1(k->kyy[i])}};
}

SIMD vf column_at(const struct columns *c, vf dy) { return vf_fma(vf_fma(c->k[2], dy, c->k[1]), dy, c->k[0]); }

/* |v|^2 at columns x on: across + (y + 0.5 - center)^2 down^2. */
struct ray_columns {
    vf across;
    float center, down;
};

SIMD struct ray_columns ray_columns_at(const struct splat_view *view, const struct splat_grid *grid, int x)
{
    if (view->orthographic) {
        return (struct ray_columns){vf_set1(1), 0, 0};
    }
    vf u = (vf_set1((float)x + 0.5f - grid->cx) + vf_iota()) * vf_set1(1 / grid->fx);
    return (struct ray_columns){vf_fma(u, u, vf_set1(1)), grid->cy - 0.5f, 1 / grid->fy};
}

SIMD vf ray_length2(const struct ray_columns *ray, int y)
{
    float w = ((float)y - ray->center) * ray->down;
    return ray->across + vf_set1(w * w);
}

/* Lanes past the last column fail s^2 > 0, as for spheres. */
static void draw_depth(const struct splat_view *view, const struct splat_grid *grid, const struct ellipsoid_table *t, int i, float *nearest)
{
    const vf det = vf_set1(t->det[i]), depth = vf_set1(t->depth[i]), one = vf_set1(1);
    for (int x = t->x0[i]; x <= t->x1[i]; x += VLEN) {
        vf dx = vf_set1((float)x + 0.5f - t->x[i]) + vf_iota(), dy = vf_set1((float)t->y0[i] + 0.5f - t->y[i]);
        struct columns s = quadratic_columns(&t->s2, i, dx), e = quadratic_columns(&t->e, i, dx), f = quadratic_columns(&t->f, i, dx);
        struct ray_columns ray = ray_columns_at(view, grid, x);
        float *row = nearest + t->y0[i] * TILE_STRIDE + x;
        for (int y = t->y0[i]; y <= t->y1[i]; y++, row += TILE_STRIDE, dy += one) {
            vf s2 = column_at(&s, dy), behind = vf_fma(det, s2 * vf_rsqrt_quick(s2), column_at(&f, dy));
            vf near_root = vf_fnma(behind, vf_rcp_quick(column_at(&e, dy)), depth) * ray_length2(&ray, y);
            vf_storeu(row, vf_mask_min(vf_loadu(row), vf_gt(s2, vf_zero()), near_root));
        }
    }
}

static size_t depth(const struct splat_view *view, struct splat_tile *tile, size_t chunk, float limit)
{
    struct ellipsoid_table table;
    struct places touched = {.x0 = vf_set1(TILE_SIZE), .x1 = vf_set1(-1), .y0 = vf_set1(TILE_SIZE), .y1 = vf_set1(-1)};
    size_t drawn = 0;
    bool any = false;
    for (size_t first = chunk * CHUNK_SIZE; first < (chunk + 1) * CHUNK_SIZE; first += VLEN) {
        struct spheres s = project(view, &tile->pixels, first);
        struct shapes e;
        reach_of(view, first, &s, &e);
        vf nearest = s.z - e.reach - vf_set1(view->slack);
        vm shows = vm_and(present(view, first), vf_lt(nearest, vf_set1(limit)));
        if (!vm_any(shows)) {
            continue;
        }
        turn(view, first, &s, &e);
        struct outlines o = outline(view, &tile->pixels, &s, &e);
        struct places p = places_of(&tile->pixels, &o);
        shows = vm_and(vm_and(shows, p.some), vf_lt(nearest, hidden_from(tile, &p)));
        unsigned lanes = vm_bits(shows);
        if (lanes == 0) {
            continue;
        }
        any = true;
        tabulate(view, &tile->pixels, &s, &e, &p, &table);
        drawn += (size_t)__builtin_popcount(vm_bits(vm_and(shows, is_home(view, tile, &s))));
        touched.x0 = vf_mask_min(touched.x0, shows, p.x0);
        touched.y0 = vf_mask_min(touched.y0, shows, p.y0);
        touched.x1 = vf_mask_max(touched.x1, shows, p.x1);
        touched.y1 = vf_mask_max(touched.y1, shows, p.y1);
        for (; lanes != 0; lanes &= lanes - 1) {
            draw_depth(view, &tile->pixels, &table, __builtin_ctz(lanes), tile->nearest);
        }
    }
    if (any) {
        update_farthest(tile, (int)vf_reduce_min(touched.x0), (int)vf_reduce_max(touched.x1), (int)vf_reduce_min(touched.y0),
                        (int)vf_reduce_max(touched.y1));
    }
    return drawn;
}

/* Adds amount * s |v|^2 / E to one plane of sums. */
static void draw_chords(const struct splat_view *view, const struct splat_grid *grid, const struct ellipsoid_table *t, int i, float amount,
                        float *sums)
{
    const vf scale = vf_set1(amount), one = vf_set1(1);
    for (int x = t->x0[i]; x <= t->x1[i]; x += VLEN) {
        vf dx = vf_set1((float)x + 0.5f - t->x[i]) + vf_iota(), dy = vf_set1((float)t->y0[i] + 0.5f - t->y[i]);
        struct columns s = quadratic_columns(&t->s2, i, dx), e = quadratic_columns(&t->e, i, dx);
        struct ray_columns ray = ray_columns_at(view, grid, x);
        float *row = sums + t->y0[i] * TILE_STRIDE + x;
        for (int y = t->y0[i]; y <= t->y1[i]; y++, row += TILE_STRIDE, dy += one) {
            vf s2 = column_at(&s, dy), per_e = vf_rcp_quick(column_at(&e, dy)) * ray_length2(&ray, y);
            vf_storeu(row, vf_fma(scale, vf_keep(vf_gt(s2, vf_zero()), s2 * vf_rsqrt_quick(s2) * per_e), vf_loadu(row)));
        }
    }
}

SIMD void add_chords(const struct splat_view *view, struct splat_tile *tile, const struct spheres *s, const struct shapes *e, size_t first,
                     vm lanes_in, vf weight)
{
    struct ellipsoid_table table;
    struct outlines o = outline(view, &tile->texels, s, e);
    struct places p = places_of(&tile->texels, &o);
    unsigned lanes = vm_bits(vm_and(lanes_in, p.some));
    if (lanes == 0) {
        return;
    }
    tabulate(view, &tile->texels, s, e, &p, &table);
    vf_store(table.amount, weight * e->det);
    for (; lanes != 0; lanes &= lanes - 1) {
        int i = __builtin_ctz(lanes);
        draw_chords(view, &tile->texels, &table, i, table.amount[i], tile->sums[0]);
        for (int c = 0; c < 3 && view->has_color; c++) {
            float color = view->particles->color[c][first + (size_t)i];
            draw_chords(view, &tile->texels, &table, i, table.amount[i] * color, tile->sums[1 + c]);
        }
    }
}

/* The outline's G in texels. */
struct spread {
    vf xx, yy, xy;
};

SIMD struct spread spread_of(const struct splat_view *view, const struct splat_grid *grid, const struct spheres *s, const struct shapes *e)
{
    vf across = view->orthographic ? s->radius : s->rho, fx = across * vf_set1(grid->fx), fy = across * vf_set1(grid->fy);
    return (struct spread){fx * fx * e->gxx, fy * fy * e->gyy, fx * fy * e->gxy};
}

/* Of lanes whose form is the smooth one: drawn as spheres' tables are, with the fall in place of s^2. */
SIMD void add_smooth(const struct splat_view *view, struct splat_tile *tile, const struct spheres *s, const struct shapes *e,
                     const struct spread *g, size_t first, vm lanes, vf weight)
{
    vf more = vf_set1(1.6f), texel = vf_set1(2.0f / 3.0f);
    vf xx = vf_fma(more, g->xx, texel), yy = vf_fma(more, g->yy, texel), xy = more * g->xy;
    vf wide = vf_sqrt(xx), high = vf_sqrt(yy), per_det = vf_rcp(vf_fnma(xy, xy, xx * yy));
    struct outlines o = {s->x - wide, s->x + wide, s->y - high, s->y + high};
    struct places p = places_of(&tile->texels, &o);
    vm seen = vm_and(lanes, p.some);
    if (!vm_any(seen)) {
        return;
    }
    vf center = e->det * s->radius * s->length2 * vf_rsqrt(center_e(s, e->q));
    vf q = vf_sqrt(vf_max(vf_fnma(g->xy, g->xy, g->xx * g->yy), vf_zero()) * per_det);
    struct table table;
    vf_store(table.k0, vf_set1(1));
    vf_store(table.kx, vf_zero());
    vf_store(table.ky, vf_zero());
    vf_store(table.kxx, -yy * per_det);
    vf_store(table.kyy, -xx * per_det);
    vf_store(table.kxy, vf_set1(2) * xy * per_det);
    vf_store(table.amount, vf_set1(2) * q * center * weight);
    store_places(s, &p, table.x, table.y, table.x0, table.x1, table.y0, table.y1);
    draw_sums(view, tile, &table, first, vm_bits(seen), vm_bits(seen));
}

SIMD void add_deposits(const struct splat_view *view, struct splat_tile *tile, const struct spheres *s, const struct shapes *e,
                       size_t first, vm lanes, vf weight)
{
    const struct splat_grid *grid = &tile->texels;
    vf across = view->orthographic ? s->radius : s->rho;
    vf amount = vf_set1(0.5f * SPHERE_VOLUME) * weight * e->det * s->radius * s->length2 * (across * vf_set1(grid->fx)) *
                (across * vf_set1(grid->fy));
    add_amounts(view, tile, s, first, lanes, amount);
}

static uint64_t thickness(const struct splat_view *view, struct splat_tile *tile, size_t chunk, float end)
{
    uint64_t left_out = 0;
    for (size_t i = 0; i < CHUNK_SIZE; i += VLEN) {
        size_t first = chunk * CHUNK_SIZE + i;
        struct spheres s = project(view, &tile->texels, first);
        struct shapes e;
        reach_of(view, first, &s, &e);
        vm real = present(view, first), before = vf_le(s.z + e.reach, vf_set1(end));
        left_out |= (uint64_t)vm_bits(vm_and(real, vm_not(before))) << i;
        real = vm_and(real, before);
        if (!vm_any(real)) {
            continue;
        }
        turn(view, first, &s, &e);
        vf weight = weight_of(view, first, s.radius);
        if (view->per_shape) {
            weight = vf_min(weight / e.det, vf_set1(WEIGHT_MAX));
        }
        struct spread g = spread_of(view, &tile->texels, &s, &e);
        vf middle = vf_set1(0.5f) * (g.xx + g.yy), half = vf_set1(0.5f) * (g.xx - g.yy), off = vf_sqrt(vf_fma(half, half, g.xy * g.xy));
        float chord = view->scale > 1 ? CHORD_RADIUS * CHORD_RADIUS : -DEPTH_LIMIT,
              deposit = view->scale > 1 ? DEPOSIT_RADIUS * DEPOSIT_RADIUS : 0;
        vm chords = vm_and(real, vf_ge(middle - off, vf_set1(chord)));
        vm deposits = vm_and(vm_and(real, vm_not(chords)), vf_lt(middle + off, vf_set1(deposit)));
        vm smooth = vm_and(real, vm_not(vm_or(chords, deposits)));
        if (vm_any(deposits)) {
            add_deposits(view, tile, &s, &e, first, deposits, weight);
        }
        if (vm_any(chords)) {
            add_chords(view, tile, &s, &e, first, chords, weight);
        }
        if (vm_any(smooth)) {
            add_smooth(view, tile, &s, &e, &g, first, smooth, weight);
        }
    }
    return left_out;
}

const struct ellipsoid_kernels SIMD_NAME(mns_ellipsoid_kernels) = {.depth = depth, .thickness = thickness};
