/* tile.h: what the plain C kernels that draw into a tile share. */
#ifndef MNS_CPU_SCALAR_TILE_H
#define MNS_CPU_SCALAR_TILE_H

#include "cpu/sprite.h"

static inline int least(int a, int b) { return a < b ? a : b; }

struct span {
    int x0, x1, y0, y1; /* inclusive */
};

static inline bool span_of(const struct splat_grid *grid, const struct sprite *s, struct span *out)
{
    sprite_span(s->x_min, s->x_max, grid->columns, &out->x0, &out->x1);
    sprite_span(s->y_min, s->y_max, grid->rows, &out->y0, &out->y1);
    return out->x0 <= out->x1 && out->y0 <= out->y1;
}

static inline struct span span_both(const struct span *a, const struct span *b)
{
    return (struct span){.x0 = least(a->x0, b->x0), .x1 = -least(-a->x1, -b->x1), .y0 = least(a->y0, b->y0), .y1 = -least(-a->y1, -b->y1)};
}

/* What is at this depth or beyond is hidden everywhere in the span. */
static inline float hidden_from(const struct splat_tile *tile, const struct span *span)
{
    int columns = TILE_SIZE >> tile->shift_x;
    float farthest = 0;
    for (int by = span->y0 >> tile->shift_y; by <= span->y1 >> tile->shift_y; by++) {
        for (int bx = span->x0 >> tile->shift_x; bx <= span->x1 >> tile->shift_x; bx++) {
            farthest = fmaxf(farthest, tile->farthest[by * columns + bx]);
        }
    }
    return farthest;
}

static inline void update_farthest(struct splat_tile *tile, const struct span *span)
{
    int columns = TILE_SIZE >> tile->shift_x, width = 1 << tile->shift_x, height = 1 << tile->shift_y;
    for (int by = span->y0 >> tile->shift_y; by <= span->y1 >> tile->shift_y; by++) {
        for (int bx = span->x0 >> tile->shift_x; bx <= span->x1 >> tile->shift_x; bx++) {
            float most = 0;
            for (int y = by * height; y < (by + 1) * height; y++) {
                for (int x = bx * width; x < (bx + 1) * width; x++) {
                    most = fmaxf(most, tile->nearest[y * TILE_STRIDE + x]);
                }
            }
            int block = by * columns + bx;
            tile->farthest[block] = most > DEPTH_LIMIT ? DEPTH_EMPTY : most * tile->per_nearest[block];
        }
    }
}

/* |v|^2 of the ray through place (x, y) of the grid. */
static inline float ray_length2(const struct splat_view *view, const struct splat_grid *grid, int x, int y)
{
    float u = ((float)x + 0.5f - grid->cx) / grid->fx, w = ((float)y + 0.5f - grid->cy) / grid->fy;
    return view->orthographic ? 1 : u * u + w * w + 1;
}

/* weight, and weight * colour. */
static inline int amounts_of(const struct splat_view *view, size_t particle, float amount, float out[SUM_COUNT])
{
    out[0] = amount;
    for (int c = 0; c < 3 && view->has_color; c++) {
        out[1 + c] = amount * view->particles->color[c][particle];
    }
    return view->has_color ? SUM_COUNT : 1;
}

/* Bilinearly over the four nearest texels. */
static inline void add_deposit(const struct splat_view *view, struct splat_tile *tile, const struct sprite *s, size_t particle,
                               float amount)
{
    if (!sprite_reaches(s->x, tile->texels.columns) || !sprite_reaches(s->y, tile->texels.rows)) {
        return;
    }
    float amounts[SUM_COUNT];
    int count = amounts_of(view, particle, amount, amounts);
    float x = floorf(s->x + 0.5f), y = floorf(s->y + 0.5f), fx = s->x + 0.5f - x, fy = s->y + 0.5f - y;
    for (int k = 0; k < count; k++) {
        float *cell = tile->cells[k] + (int)y * CELL_STRIDE + 4 * (int)x;
        float low = amounts[k] * (1 - fy), high = amounts[k] * fy;
        cell[0] += low * (1 - fx);
        cell[1] += low * fx;
        cell[2] += high * (1 - fx);
        cell[3] += high * fx;
    }
    tile->deposited = true;
}

#endif
