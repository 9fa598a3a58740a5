/* ellipsoid.c: the kernels that draw particles with a shape, in plain C: their definition. Formulas: cpu/ellipsoid.h. */
#include "cpu/ellipsoid.h"

#include "cpu/scalar/tile.h"

static void draw_depth(const struct splat_view *view, struct splat_tile *tile, const struct ellipsoid *e, const struct span *span)
{
    struct ellipsoid_poly p = ellipsoid_poly_of(view, &tile->pixels, e);
    for (int y = span->y0; y <= span->y1; y++) {
        float *row = tile->nearest + y * TILE_STRIDE, dy = (float)y + 0.5f - e->sprite.y;
        for (int x = span->x0; x <= span->x1; x++) {
            float dx = (float)x + 0.5f - e->sprite.x, s2 = quadratic_at(&p.s2, dx, dy);
            if (s2 > 0) {
                float depth = p.depth - (quadratic_at(&p.f, dx, dy) + p.det * sqrtf(s2)) / quadratic_at(&p.e, dx, dy);
                row[x] = fminf(row[x], depth * quadratic_at(&p.v2, dx, dy));
            }
        }
    }
}

static size_t depth(const struct splat_view *view, struct splat_tile *tile, size_t chunk, float limit)
{
    struct span touched = {.x0 = TILE_SIZE, .x1 = -1, .y0 = TILE_SIZE, .y1 = -1};
    size_t drawn = 0;
    for (size_t i = chunk * CHUNK_SIZE; i < sprite_chunk_end(view, chunk); i++) {
        struct ellipsoid e = ellipsoid_project(view, &tile->pixels, i);
        float nearest = e.sprite.q[2] - e.reach - view->slack;
        struct span span;
        if (nearest >= limit || !span_of(&tile->pixels, &e.sprite, &span) || nearest >= hidden_from(tile, &span)) {
            continue;
        }
        draw_depth(view, tile, &e, &span);
        drawn += sprite_is_home(view, tile, e.sprite.x, e.sprite.y);
        touched = span_both(&touched, &span);
    }
    update_farthest(tile, &touched);
    return drawn;
}

static void add_chords(const struct splat_view *view, struct splat_tile *tile, const struct ellipsoid *e, const struct ellipsoid_poly *p,
                       size_t particle)
{
    struct span span;
    if (!span_of(&tile->texels, &e->sprite, &span)) {
        return;
    }
    float amounts[SUM_COUNT];
    int count = amounts_of(view, particle, e->sprite.weight * p->det, amounts);
    for (int y = span.y0; y <= span.y1; y++) {
        for (int x = span.x0; x <= span.x1; x++) {
            float dx = (float)x + 0.5f - e->sprite.x, dy = (float)y + 0.5f - e->sprite.y;
            float value = sqrtf(fmaxf(quadratic_at(&p->s2, dx, dy), 0)) * quadratic_at(&p->v2, dx, dy) / quadratic_at(&p->e, dx, dy);
            for (int k = 0; k < count; k++) {
                tile->sums[k][y * TILE_STRIDE + x] += amounts[k] * value;
            }
        }
    }
}

static void add_smooth(const struct splat_view *view, struct splat_tile *tile, const struct ellipsoid *e,
                       const struct ellipsoid_smooth *smooth, size_t particle)
{
    struct sprite s = e->sprite;
    struct span span;
    ellipsoid_widen(&s, smooth);
    if (!span_of(&tile->texels, &s, &span)) {
        return;
    }
    float amounts[SUM_COUNT];
    int count = amounts_of(view, particle, s.weight * smooth->amount, amounts);
    for (int y = span.y0; y <= span.y1; y++) {
        for (int x = span.x0; x <= span.x1; x++) {
            float fall = fmaxf(quadratic_at(&smooth->fall, (float)x + 0.5f - s.x, (float)y + 0.5f - s.y), 0);
            for (int k = 0; k < count; k++) {
                tile->sums[k][y * TILE_STRIDE + x] += amounts[k] * fall * fall;
            }
        }
    }
}

static uint64_t thickness(const struct splat_view *view, struct splat_tile *tile, size_t chunk, float end)
{
    uint64_t left_out = 0;
    for (size_t i = chunk * CHUNK_SIZE; i < sprite_chunk_end(view, chunk); i++) {
        struct ellipsoid e = ellipsoid_project(view, &tile->texels, i);
        if (e.sprite.q[2] + e.reach > end) {
            left_out |= (uint64_t)1 << i % CHUNK_SIZE;
            continue;
        }
        float g[3];
        enum sprite_form form = ellipsoid_form_of(view, &tile->texels, &e, g);
        if (form == SPRITE_DEPOSIT) {
            add_deposit(view, tile, &e.sprite, i, ellipsoid_amount(view, &tile->texels, &e));
            continue;
        }
        struct ellipsoid_poly p = ellipsoid_poly_of(view, &tile->texels, &e);
        if (form == SPRITE_CHORD) {
            add_chords(view, tile, &e, &p, i);
        } else {
            struct ellipsoid_smooth smooth = ellipsoid_smooth_of(&e, &p, g);
            add_smooth(view, tile, &e, &smooth, i);
        }
    }
    return left_out;
}

const struct ellipsoid_kernels mns_ellipsoid_kernels_scalar = {.depth = depth, .thickness = thickness};
