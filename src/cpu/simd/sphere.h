/* sphere.h: what the vector kernels that draw spheres share, beyond tile.h. */
#ifndef MNS_CPU_SIMD_SPHERE_H
#define MNS_CPU_SIMD_SPHERE_H

#include "cpu/simd/tile.h"

/* What |v|^2 along a row of a grid is made of: across + ((x + 0.5 - center) per_focal)^2; orthographic: 1. */
struct ray_row {
    vf across, first, per_focal; /* first: x + 0.5 - center for the lanes of place 0 */
};

SIMD struct ray_row ray_row_at(const struct splat_view *view, const struct splat_grid *grid, int y)
{
    if (view->orthographic) {
        return (struct ray_row){vf_set1(1), vf_zero(), vf_zero()};
    }
    float w = ((float)y + 0.5f - grid->cy) / grid->fy;
    return (struct ray_row){vf_set1(w * w + 1), vf_set1(0.5f - grid->cx) + vf_iota(), vf_set1(1 / grid->fx)};
}

SIMD vf ray_length2(const struct ray_row *row, int x)
{
    vf u = (row->first + vf_set1((float)x)) * row->per_focal;
    return vf_fma(u, u, row->across);
}

/* Scales the s^2 of smooth lanes to 1 - q + q s^2 / k0, whose positive part squared is the smooth form. */
SIMD void smooth_table(struct table *t, vm smooth, vf falloff)
{
    vf k0 = vf_load(t->k0), scale = vf_select(smooth, falloff / k0, vf_set1(1));
    vf_store(t->k0, vf_select(smooth, vf_set1(1), k0));
    vf_store(t->kx, vf_load(t->kx) * scale);
    vf_store(t->ky, vf_load(t->ky) * scale);
    vf_store(t->kxx, vf_load(t->kxx) * scale);
    vf_store(t->kyy, vf_load(t->kyy) * scale);
    vf_store(t->kxy, vf_load(t->kxy) * scale);
    vf_store(t->amount, vf_load(t->amount) * vf_select(smooth, vf_set1(2) * falloff * vf_sqrt(k0), vf_set1(1)));
}

/* 1 / q of the smooth form. */
SIMD vf smooth_spread(vf size) { return vf_set1(1.6f) + vf_set1(2.0f / 3.0f) * vf_rcp(size * size); }

/* sprite_amount. */
SIMD vf deposit_amount(const struct splat_view *view, const struct splat_grid *grid, const struct spheres *s, vf weight)
{
    vf across = vf_either(view->orthographic, s->radius, s->rho); /* R^3 itself may leave the range of float */
    return vf_set1(0.5f * SPHERE_VOLUME) * weight * s->radius * s->length2 * (across * vf_set1(grid->fx)) * (across * vf_set1(grid->fy));
}

/* sprite_extent on both sides of a centre at `at`, wider times as far. */
SIMD void extend(vf slope, vf at, const struct spheres *s, vf per_rest, vf focal, vf wider, vf *low, vf *high)
{
    vf square = vf_fma(slope, slope, s->rest), reach = s->rho * square * vf_rsqrt(square);
    vf scale = focal * per_rest * wider, shift = slope * s->rho * s->rho; /* the middle is slope / rest: slope rho^2 / rest further out */
    *low = vf_fma(scale, shift - reach, at);
    *high = vf_fma(scale, shift + reach, at);
}

SIMD struct outlines outline(const struct splat_view *view, const struct splat_grid *grid, const struct spheres *s, vf wider)
{
    struct outlines o;
    if (view->orthographic) {
        vf rx = vf_set1(grid->fx) * s->radius * wider, ry = vf_set1(grid->fy) * s->radius * wider;
        return (struct outlines){s->x - rx, s->x + rx, s->y - ry, s->y + ry};
    }
    vf per_rest = vf_rcp(s->rest);
    extend(s->a, s->x, s, per_rest, vf_set1(grid->fx), wider, &o.x_min, &o.x_max);
    extend(s->b, s->y, s, per_rest, vf_set1(grid->fy), wider, &o.y_min, &o.y_max);
    return o;
}

/* Fills all of the table but amount. */
SIMD void tabulate(const struct splat_view *view, const struct splat_grid *grid, const struct spheres *s, const struct places *p,
                   struct table *t)
{
    vf px = vf_set1(1 / grid->fx), py = vf_set1(1 / grid->fy), r2 = s->radius * s->radius;
    if (view->orthographic) {
        vf_store(t->k0, r2);
        vf_store(t->kxx, -px * px);
        vf_store(t->kyy, -py * py);
        vf_store(t->v0, s->z);
        vf_store(t->kx, vf_zero());
        vf_store(t->ky, vf_zero());
        vf_store(t->kxy, vf_zero());
        vf_store(t->vx, vf_zero());
        vf_store(t->vy, vf_zero());
    } else {
        vf zx = s->z * px, zy = s->z * py, two = vf_set1(2);
        vf_store(t->k0, r2 * s->length2);
        vf_store(t->kx, two * r2 * s->a * px);
        vf_store(t->ky, two * r2 * s->b * py);
        vf_store(t->kxx, -vf_fma(s->b, s->b, s->rest) * zx * zx);
        vf_store(t->kyy, -vf_fma(s->a, s->a, s->rest) * zy * zy);
        vf_store(t->kxy, two * s->a * s->b * zx * zy);
        vf_store(t->v0, s->z * s->length2);
        vf_store(t->vx, zx * s->a);
        vf_store(t->vy, zy * s->b);
    }
    vf_store(t->x, s->x);
    vf_store(t->y, s->y);
    vi_store(t->x0, vf_truncate(p->x0));
    vi_store(t->x1, vf_truncate(p->x1));
    vi_store(t->y0, vf_truncate(p->y0));
    vi_store(t->y1, vf_truncate(p->y1));
}

#endif
