/* ellipsoid.h: one ellipsoid as a tile sees it, in plain C, and the kernels that draw particles with a shape.
 *
 * The particle is { c + R A u, |u| = 1 }, A in image space. With adj its adjugate, Q = adj^2 and det its determinant, a point t v lies on it where
 * (t v - c)' Q (t v - c) = det^2 R^2. Written about the projected centre as in splat.h, v = v0 + d with v0 = c / c_z and d = (dx/fx, dy/fy, 0):
 *   t = c_z - (F + det s) / E   for the near root, chord = 2 |v| det s / E,
 *   E = v' Q v,   F = c_z v' Q d,
 *   s^2 = R^2 E - c_z^2 [gyy dx^2/fx^2 - 2 gxy dx dy/(fx fy) + gxx dy^2/fy^2],
 *   gxx = B_xx - 2 a B_xz + a^2 B_zz,   gyy = B_yy - 2 b B_yz + b^2 B_zz,   gxy = B_xy - b B_xz - a B_yz + a b B_zz,   B = A^2,
 * whose terms are all of the order of what they make: nothing cancels. Tiles hold t |v|^2 and sums of weight * det s |v|^2 / E, which for
 * A = 1 are those of splat.h. Orthographic rays are v = (0, 0, 1) from (u, w, 0): v0 = v, c_z before d becomes 1, and E and F lose
 * what they have of the second order in d.
 *
 * The outline ends along x where planes through the eye touch: at fx delta from the projected centre, rho = R / c_z,
 *   delta = rho [-rho (B_xz - a B_zz) -+ sqrt(gxx - rho^2 (B_xx B_zz - B_xz^2))] / (1 - rho^2 B_zz).
 *
 * Thickness. The weight is V / (4/3 pi R^3 det). On texels larger than pixels, by the outline's semi-axes in texels at the centre's depth:
 *   the shorter >= CHORD_RADIUS   its chord along the ray through the texel's centre;
 *   the longer < DEPOSIT_RADIUS   its volume, bilinearly over the four nearest texels;
 *   else                          2 q (weight * det s |v|^2 / E at its centre) max(0, 1 - p' K^-1 p)^2, p from its centre in texels,
 *                                 K = 8/5 G + 2/3, G the outline's p' G^-1 p = 1, q^2 = det G / det K: the same volume, and the second moments
 *                                 of ellipsoid (G / 5) and texel (1 / 12) together, as splat.h has it for spheres. */
#ifndef MNS_CPU_ELLIPSOID_H
#define MNS_CPU_ELLIPSOID_H

#include "cpu/sprite.h"

/* How much of the outline's half-extent the smooth form reaches beyond it, with SUM_REACH: sqrt(8/5 G + 2/3) < 1.265 sqrt(G) + 0.817. */
#define SMOOTH_STRETCH 0.265f

/* As struct splat_kernels, of sets with shapes, with the same tolerances where R is the longest semi-axis and none is more than 16 times another:
 * the estimates of root and quotient are good to 7e-5 each. Ellipsoids are no nearer than CLOSE_RADII times their longest semi-axis. */
struct ellipsoid_kernels {
    size_t (*depth)(const struct splat_view *view, struct splat_tile *tile, size_t chunk, float limit);
    uint64_t (*thickness)(const struct splat_view *view, struct splat_tile *tile, size_t chunk, float end);
};

extern const struct ellipsoid_kernels mns_ellipsoid_kernels_scalar, mns_ellipsoid_kernels_sse2, mns_ellipsoid_kernels_avx2,
    mns_ellipsoid_kernels_avx512, mns_ellipsoid_kernels_neon;

/* Symmetric matrices: xx, yy, zz, xy, xz, yz. */
struct ellipsoid {
    struct sprite sprite;  /* of the sphere with radius R; bounds and weight are the ellipsoid's, rho 0 where orthographic */
    float b[6], q[6], det; /* B, Q and the determinant of A */
    float reach;           /* half of its extent in depth, metres */
    float gxx, gyy, gxy;   /* of splat.h's outline; G = (rho fx)^2 gxx ..., orthographic with R for rho */
};

static inline float ellipsoid_dot(const float a[3], const float b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* A in image space, and its square. */
static inline void ellipsoid_turn(const struct splat_view *view, size_t particle, float a[6], float b[6])
{
    static const int rows[6] = {0, 1, 2, 0, 0, 1}, columns[6] = {0, 1, 2, 1, 2, 2};
    float *const *s = view->particles->shape;
    float half[3][3]; /* A times each row of the rotation */
    for (int k = 0; k < 3; k++) {
        const float *r = &view->rotation[3 * k];
        half[k][0] = s[0][particle] * r[0] + s[3][particle] * r[1] + s[4][particle] * r[2];
        half[k][1] = s[3][particle] * r[0] + s[1][particle] * r[1] + s[5][particle] * r[2];
        half[k][2] = s[4][particle] * r[0] + s[5][particle] * r[1] + s[2][particle] * r[2];
    }
    for (int k = 0; k < 6; k++) {
        a[k] = ellipsoid_dot(&view->rotation[3 * rows[k]], half[columns[k]]);
        b[k] = ellipsoid_dot(half[rows[k]], half[columns[k]]);
    }
}

/* Q and det from A. */
static inline void ellipsoid_invert(const float a[6], struct ellipsoid *out)
{
    float xx = a[1] * a[2] - a[5] * a[5], yy = a[0] * a[2] - a[4] * a[4], zz = a[0] * a[1] - a[3] * a[3];
    float xy = a[4] * a[5] - a[3] * a[2], xz = a[3] * a[5] - a[4] * a[1], yz = a[3] * a[4] - a[0] * a[5];
    out->det = a[0] * xx + a[3] * xy + a[4] * xz;
    out->q[0] = xx * xx + xy * xy + xz * xz;
    out->q[1] = xy * xy + yy * yy + yz * yz;
    out->q[2] = xz * xz + yz * yz + zz * zz;
    out->q[3] = xx * xy + xy * yy + xz * yz;
    out->q[4] = xx * xz + xy * yz + xz * zz;
    out->q[5] = xy * xz + yy * yz + yz * zz;
}

static inline float ellipsoid_weight(const struct splat_view *view, size_t particle, float radius, float det)
{
    float weight = sprite_weight(view, particle, radius);
    return view->per_shape ? fminf(weight / det, WEIGHT_MAX) : weight;
}

/* Ends of the outline along one axis, in units of d. diagonal, mixed: B_xx, B_xz or B_yy, B_yz. */
static inline void ellipsoid_extent(const struct ellipsoid *e, float slope, float g, float diagonal, float mixed, float *low, float *high)
{
    float rho = e->sprite.rho, square = rho * rho, per_rest = 1 / (1 - square * e->b[2]);
    float middle = rho * (mixed - slope * e->b[2]), root = sqrtf(fmaxf(g - square * (diagonal * e->b[2] - mixed * mixed), 0));
    *low = rho * (-middle - root) * per_rest;
    *high = rho * (-middle + root) * per_rest;
}

/* The eye must be farther from its centre along the view axis than it reaches (orthographic: anywhere). */
static inline struct ellipsoid ellipsoid_project(const struct splat_view *view, const struct splat_grid *grid, size_t particle)
{
    struct ellipsoid e;
    struct sprite *s = &e.sprite;
    *s = (struct sprite){.radius = sprite_radius(view, particle), .length2 = 1};
    sprite_center(view, particle, s->q);
    float a[6];
    ellipsoid_turn(view, particle, a, e.b);
    ellipsoid_invert(a, &e);
    s->weight = ellipsoid_weight(view, particle, s->radius, e.det);
    e.reach = s->radius * sqrtf(e.b[2]);
    float x = s->q[0], y = s->q[1];
    if (!view->orthographic) {
        x = s->a = s->q[0] / s->q[2];
        y = s->b = s->q[1] / s->q[2];
        s->rho = s->radius / s->q[2];
        s->length2 = s->a * s->a + s->b * s->b + 1;
    }
    e.gxx = e.b[0] - 2 * s->a * e.b[4] + s->a * s->a * e.b[2];
    e.gyy = e.b[1] - 2 * s->b * e.b[5] + s->b * s->b * e.b[2];
    e.gxy = e.b[3] - s->b * e.b[4] - s->a * e.b[5] + s->a * s->b * e.b[2];
    float right = s->radius * sqrtf(e.gxx), bottom = s->radius * sqrtf(e.gyy), left = -right, top = -bottom;
    if (!view->orthographic) {
        ellipsoid_extent(&e, s->a, e.gxx, e.b[0], e.b[4], &left, &right);
        ellipsoid_extent(&e, s->b, e.gyy, e.b[1], e.b[5], &top, &bottom);
    }
    s->x = grid->fx * x + grid->cx;
    s->y = grid->fy * y + grid->cy;
    s->x_min = s->x + grid->fx * left;
    s->x_max = s->x + grid->fx * right;
    s->y_min = s->y + grid->fy * top;
    s->y_max = s->y + grid->fy * bottom;
    return e;
}

/* Quadratic in the distance from the projected centre, in grid units. */
struct quadratic {
    float k0, kx, ky, kxx, kyy, kxy;
};

static inline float quadratic_at(const struct quadratic *k, float dx, float dy)
{
    return k->k0 + (k->kx + k->kxx * dx) * dx + (k->ky + k->kxy * dx + k->kyy * dy) * dy;
}

struct ellipsoid_poly {
    struct quadratic s2, e, f, v2; /* s^2, E, F and |v|^2 */
    float depth, det;
};

static inline struct ellipsoid_poly ellipsoid_poly_of(const struct splat_view *view, const struct splat_grid *grid,
                                                      const struct ellipsoid *e)
{
    const struct sprite *s = &e->sprite;
    const float *q = e->q;
    float px = 1 / grid->fx, py = 1 / grid->fy, r2 = s->radius * s->radius;
    float x = q[0] * s->a + q[3] * s->b + q[4], y = q[3] * s->a + q[1] * s->b + q[5], z = q[4] * s->a + q[5] * s->b + q[2]; /* Q v0 */
    float e0 = x * s->a + y * s->b + z, along = view->orthographic ? 1 : s->q[2];
    float gxx = along * along * e->gyy * px * px, gyy = along * along * e->gxx * py * py, gxy = -2 * along * along * e->gxy * px * py;
    struct ellipsoid_poly p = {.depth = s->q[2], .det = e->det, .e = {.k0 = e0}, .v2 = {.k0 = s->length2}};
    p.f = (struct quadratic){.kx = along * x * px, .ky = along * y * py};
    if (!view->orthographic) {
        p.e = (struct quadratic){e0, 2 * x * px, 2 * y * py, q[0] * px * px, q[1] * py * py, 2 * q[3] * px * py};
        p.f.kxx = along * p.e.kxx;
        p.f.kyy = along * p.e.kyy;
        p.f.kxy = along * p.e.kxy;
        p.v2 = (struct quadratic){s->length2, 2 * s->a * px, 2 * s->b * py, px * px, py * py, 0};
    }
    p.s2 = (struct quadratic){r2 * e0, r2 * p.e.kx, r2 * p.e.ky, r2 * p.e.kxx - gxx, r2 * p.e.kyy - gyy, r2 * p.e.kxy - gxy};
    return p;
}

/* The smooth form: amount * max(0, fall)^2. */
struct ellipsoid_smooth {
    struct quadratic fall;
    float amount;     /* of the particle's weight */
    float wide, high; /* half-extents, texels */
};

/* The outline's G in grid units, and the form that it takes. */
static inline enum sprite_form ellipsoid_form_of(const struct splat_view *view, const struct splat_grid *grid, const struct ellipsoid *e,
                                                 float g[3])
{
    float across = view->orthographic ? e->sprite.radius : e->sprite.rho, fx = across * grid->fx, fy = across * grid->fy;
    g[0] = fx * fx * e->gxx;
    g[1] = fy * fy * e->gyy;
    g[2] = fx * fy * e->gxy;
    float middle = 0.5f * (g[0] + g[1]), half = 0.5f * (g[0] - g[1]), spread = sqrtf(half * half + g[2] * g[2]);
    if (view->scale == 1 || middle - spread >= CHORD_RADIUS * CHORD_RADIUS) {
        return SPRITE_CHORD;
    }
    return middle + spread < DEPOSIT_RADIUS * DEPOSIT_RADIUS ? SPRITE_DEPOSIT : SPRITE_SMOOTH;
}

static inline struct ellipsoid_smooth ellipsoid_smooth_of(const struct ellipsoid *e, const struct ellipsoid_poly *p, const float g[3])
{
    float xx = 1.6f * g[0] + 2.0f / 3.0f, yy = 1.6f * g[1] + 2.0f / 3.0f, xy = 1.6f * g[2], per_det = 1 / (xx * yy - xy * xy);
    float center = e->det * e->sprite.radius * e->sprite.length2 / sqrtf(p->e.k0); /* det s |v|^2 / E */
    float q = sqrtf(fmaxf(g[0] * g[1] - g[2] * g[2], 0) * per_det);
    return (struct ellipsoid_smooth){.fall = {.k0 = 1, .kxx = -yy * per_det, .kyy = -xx * per_det, .kxy = 2 * xy * per_det},
                                     .amount = 2 * q * center,
                                     .wide = sqrtf(xx),
                                     .high = sqrtf(yy)};
}

/* The bounds of the smooth form in place of the outline's. */
static inline void ellipsoid_widen(struct sprite *s, const struct ellipsoid_smooth *smooth)
{
    s->x_min = s->x - smooth->wide;
    s->x_max = s->x + smooth->wide;
    s->y_min = s->y - smooth->high;
    s->y_max = s->y + smooth->high;
}

/* Sum over all places of what tiles hold, as sprite_amount. */
static inline float ellipsoid_amount(const struct splat_view *view, const struct splat_grid *grid, const struct ellipsoid *e)
{
    return e->det * sprite_amount(view, grid, &e->sprite);
}

#endif
