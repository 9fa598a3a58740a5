/* sprite.h: one sphere as a tile sees it, in plain C. */
#ifndef MNS_CPU_SPRITE_H
#define MNS_CPU_SPRITE_H

#include "cpu/splat.h"

#include <math.h>

/* Volume of a sphere of radius 1. */
#define SPHERE_VOLUME 4.18879020f

/* Units of the grid it was projected to. */
struct sprite {
    float q[3];                       /* centre in image space, metres */
    float x, y;                       /* projected centre */
    float a, b, rho, length2;         /* a, b, rho, L of splat.h; orthographic: 0, 0, 0, 1 */
    float radius, weight;             /* metres; of its chord */
    float x_min, x_max, y_min, y_max; /* exact bounds of its outline */
};

static inline float sprite_radius(const struct splat_view *view, size_t particle)
{
    return view->radius_scale > 0 ? view->radius_scale * view->radii[particle] : view->radius;
}

static inline float sprite_weight(const struct splat_view *view, size_t particle, float radius)
{
    float weight = view->per_mass ? view->weight * view->particles->mass[particle] : view->weight;
    if (view->per_cube) {
        float own = view->factors ? radius / view->factors[particle] : radius;
        weight /= own * own * own;
    }
    return fminf(weight, WEIGHT_MAX);
}

static inline void sprite_center(const struct splat_view *view, size_t particle, float q[3])
{
    const struct particle_store *p = view->particles;
    for (int k = 0; k < 3; k++) {
        const float *row = &view->rotation[3 * k];
        q[k] = row[0] * p->x[particle] + row[1] * p->y[particle] + row[2] * p->z[particle] + view->translation[k];
    }
}

/* Lower and upper end of the outline along one axis: where planes through the eye touch the sphere. slope: c_x / c_z. */
static inline void sprite_extent(float slope, float rho, float *low, float *high)
{
    float rest = 1 - rho * rho, reach = rho * sqrtf(slope * slope + rest);
    *low = (slope - reach) / rest;
    *high = (slope + reach) / rest;
}

/* The sphere must be at least CLOSE_RADII radii away (orthographic: anywhere). */
static inline struct sprite sprite_project(const struct splat_view *view, const struct splat_grid *grid, size_t particle)
{
    struct sprite s = {.radius = sprite_radius(view, particle), .length2 = 1};
    s.weight = sprite_weight(view, particle, s.radius);
    sprite_center(view, particle, s.q);
    float left = s.q[0] - s.radius, right = s.q[0] + s.radius, top = s.q[1] - s.radius, bottom = s.q[1] + s.radius;
    float x = s.q[0], y = s.q[1];
    if (!view->orthographic) {
        x = s.a = s.q[0] / s.q[2];
        y = s.b = s.q[1] / s.q[2];
        s.rho = s.radius / s.q[2];
        s.length2 = s.a * s.a + s.b * s.b + 1;
        sprite_extent(s.a, s.rho, &left, &right);
        sprite_extent(s.b, s.rho, &top, &bottom);
    }
    s.x = grid->fx * x + grid->cx;
    s.y = grid->fy * y + grid->cy;
    s.x_min = grid->fx * left + grid->cx;
    s.x_max = grid->fx * right + grid->cx;
    s.y_min = grid->fy * top + grid->cy;
    s.y_max = grid->fy * bottom + grid->cy;
    return s;
}

/* Radius in grid units at the centre's depth: R_t of splat.h. */
static inline float sprite_size(const struct splat_view *view, const struct splat_grid *grid, const struct sprite *s)
{
    float radius = 0.5f * (grid->fx + grid->fy) * s->radius;
    return view->orthographic ? radius : radius / s->q[2];
}

enum sprite_form { SPRITE_CHORD, SPRITE_SMOOTH, SPRITE_DEPOSIT };

static inline enum sprite_form sprite_form_of(const struct splat_view *view, float size)
{
    return view->scale == 1 || size >= CHORD_RADIUS ? SPRITE_CHORD : size >= DEPOSIT_RADIUS ? SPRITE_SMOOTH : SPRITE_DEPOSIT;
}

/* q of the smooth form. */
static inline float sprite_falloff(float size) { return 1 / (1.6f + 2 / (3 * size * size)); }

/* The bounds of the smooth form in place of the sphere's. */
static inline void sprite_widen(struct sprite *s, float falloff)
{
    float wider = 1 / sqrtf(falloff);
    s->x_min = s->x + (s->x_min - s->x) * wider;
    s->x_max = s->x + (s->x_max - s->x) * wider;
    s->y_min = s->y + (s->y_min - s->y) * wider;
    s->y_max = s->y + (s->y_max - s->y) * wider;
}

/* s^2 and v.c as polynomials in the distance from the projected centre, in grid units (splat.h). */
struct sprite_poly {
    float k0, kx, ky, kxx, kyy, kxy, v0, vx, vy;
};

static inline struct sprite_poly sprite_poly_of(const struct splat_view *view, const struct splat_grid *grid, const struct sprite *s)
{
    float px = 1 / grid->fx, py = 1 / grid->fy, r2 = s->radius * s->radius;
    if (view->orthographic) {
        return (struct sprite_poly){.k0 = r2, .kxx = -px * px, .kyy = -py * py, .v0 = s->q[2]};
    }
    float z = s->q[2], zx = z * px, zy = z * py, q = s->rho * s->rho - 1;
    return (struct sprite_poly){.k0 = r2 * s->length2,
                                .kx = 2 * r2 * s->a * px,
                                .ky = 2 * r2 * s->b * py,
                                .kxx = (q - s->b * s->b) * zx * zx,
                                .kyy = (q - s->a * s->a) * zy * zy,
                                .kxy = 2 * s->a * s->b * zx * zy,
                                .v0 = z * s->length2,
                                .vx = zx * s->a,
                                .vy = zy * s->b};
}

/* s^2 at a place, and v.c in *along. */
static inline float sprite_evaluate(const struct sprite_poly *f, float dx, float dy, float *along)
{
    *along = f->v0 + f->vx * dx + f->vy * dy;
    return f->k0 + (f->kx + f->kxx * dx) * dx + (f->ky + f->kxy * dx + f->kyy * dy) * dy;
}

/* Sum of weight * s over all places of the grid that the sphere covers: its volume over the solid angle of one,
 * V / (c_z^2 / (|v| fx fy)), times |v| / 2 since tiles hold half chords times |v|. */
static inline float sprite_amount(const struct splat_view *view, const struct splat_grid *grid, const struct sprite *s)
{
    float across = view->orthographic ? s->radius : s->rho; /* R^3 itself may leave the range of float */
    return 0.5f * SPHERE_VOLUME * s->weight * s->radius * s->length2 * (across * grid->fx) * (across * grid->fy);
}

/* Places (i + 0.5) from *first to *last, inclusive, that lie between low and high and in [0, count). *first > *last: none. */
static inline void sprite_span(float low, float high, int count, int *first, int *last)
{
    *first = (int)ceilf(fminf(fmaxf(low - 0.5f, 0), (float)count));
    *last = (int)floorf(fmaxf(fminf(high - 0.5f, (float)(count - 1)), -1));
}

/* Whether a bilinear deposit at x from the grid's corner reaches one of its count places. */
static inline bool sprite_reaches(float x, int count) { return x > -0.5f && x < (float)count + 0.5f; }

/* Whether a centre (pixels from the tile's corner), moved into the picture, is in the tile: each sphere is counted in one tile. */
static inline bool sprite_is_home(const struct splat_view *view, const struct splat_tile *tile, float x, float y)
{
    x = fminf(fmaxf(x + (float)tile->x, 0), (float)view->width - 0.5f) - (float)tile->x;
    y = fminf(fmaxf(y + (float)tile->y, 0), (float)view->height - 0.5f) - (float)tile->y;
    return x >= 0 && x < TILE_SIZE && y >= 0 && y < TILE_SIZE;
}

static inline size_t sprite_chunk_end(const struct splat_view *view, size_t chunk)
{
    size_t end = (chunk + 1) * CHUNK_SIZE;
    return end < view->particles->count ? end : view->particles->count;
}

#endif
