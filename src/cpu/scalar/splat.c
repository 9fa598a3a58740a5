/* splat.c: the kernels of stages bin and splat in plain C: their definition. */
#include "cpu/scalar/tile.h"

/* Bounds of one chunk's box, grown by the largest radius. */
static void chunk_bounds(const struct splat_view *view, size_t chunk, int at, struct splat_bounds *out)
{
    const struct particle_store *p = view->particles;
    float radius = view->radius_scale > 0 ? view->radius_scale * view->box_radii[chunk] : view->radius;
    radius *= view->box_stretch ? view->box_stretch[chunk] : 1;
    float center[3], extent[3];
    for (int k = 0; k < 3; k++) {
        center[k] = view->translation[k];
        extent[k] = 0;
        for (int axis = 0; axis < 3; axis++) {
            float r = view->rotation[3 * k + axis], low = p->box_min[axis][chunk], high = p->box_max[axis][chunk];
            center[k] += r * 0.5f * (low + high);
            extent[k] += fabsf(r) * 0.5f * (high - low);
        }
    }
    /* Corners of the box around the box, in image space: simple, and hardly larger where chunks are small. */
    float nearest = center[2] - extent[2] - view->slack, farthest = center[2] + extent[2] + view->slack;
    float left = center[0] - extent[0] - view->slack, right = center[0] + extent[0] + view->slack;
    float top = center[1] - extent[1] - view->slack, bottom = center[1] + extent[1] + view->slack;
    float reach = view->scale > 1 ? SUM_REACH * (float)view->scale : 0;
    float x_min = 0, x_max = (float)view->width, y_min = 0, y_max = (float)view->height, sprite = DEPTH_EMPTY;
    if (view->orthographic) {
        float rx = view->fx * radius, ry = view->fy * radius;
        sprite = fmaxf(rx, ry);
        reach += view->sum_stretch * sprite;
        x_min = view->fx * left + view->cx - rx - reach;
        x_max = view->fx * right + view->cx + rx + reach;
        y_min = view->fy * top + view->cy - ry - reach;
        y_max = view->fy * bottom + view->cy + ry + reach;
    } else if (nearest >= CLOSE_RADII * radius && nearest > 0) {
        float rho = radius / nearest, low_x, high_x, low_y, high_y, unused;
        float a_min = fminf(left / nearest, left / farthest), a_max = fmaxf(right / nearest, right / farthest);
        float b_min = fminf(top / nearest, top / farthest), b_max = fmaxf(bottom / nearest, bottom / farthest);
        sprite_extent(a_min, rho, &low_x, &unused);
        sprite_extent(a_max, rho, &unused, &high_x);
        sprite_extent(b_min, rho, &low_y, &unused);
        sprite_extent(b_max, rho, &unused, &high_y);
        /* Half of the outline's extent grows with |slope|. */
        float rest = 1 - rho * rho, a = fmaxf(fabsf(a_min), fabsf(a_max)), b = fmaxf(fabsf(b_min), fabsf(b_max));
        sprite = rho / rest * fmaxf(view->fx * sqrtf(a * a + rest), view->fy * sqrtf(b * b + rest));
        reach += view->sum_stretch * sprite;
        x_min = view->fx * low_x + view->cx - reach;
        x_max = view->fx * high_x + view->cx + reach;
        y_min = view->fy * low_y + view->cy - reach;
        y_max = view->fy * high_y + view->cy + reach;
    } else {
        /* Close to the eye: all of the picture, unless wholly beyond one side plane of the frustum (widened by reach). */
        float w = (float)view->width, h = (float)view->height, wide = (1 + view->sum_stretch) * radius;
        float planes[4][3] = {{view->fx, 0, view->cx + reach},
                              {-view->fx, 0, w - view->cx + reach},
                              {0, view->fy, view->cy + reach},
                              {0, -view->fy, h - view->cy + reach}};
        for (int i = 0; i < 4; i++) {
            const float *n = planes[i];
            float inside = n[0] * center[0] + n[1] * center[1] + n[2] * center[2] + fabsf(n[0]) * extent[0] + fabsf(n[1]) * extent[1] +
                           fabsf(n[2]) * extent[2] + (wide + view->slack) * (fabsf(n[0]) + fabsf(n[1]) + fabsf(n[2]));
            x_max = inside < 0 ? -1 : x_max;
        }
    }
    bool apart = farthest + radius < view->near_plane || nearest - radius > view->far_plane;
    out->x_min[at] = x_min;
    out->x_max[at] = apart ? x_min - 1 : x_max;
    out->y_min[at] = y_min;
    out->y_max[at] = y_max;
    out->near_depth[at] = nearest - radius;
    out->far_depth[at] = farthest + radius;
    out->sprite[at] = sprite;
}

static void bounds(const struct splat_view *view, size_t first, struct splat_bounds *out)
{
    size_t count = view->particles->chunk_count - first;
    for (size_t i = 0; i < BOUNDS_BATCH && i < count; i++) {
        chunk_bounds(view, first + i, (int)i, out);
    }
}

static void draw_depth(const struct splat_view *view, struct splat_tile *tile, const struct sprite *s, const struct span *span)
{
    struct sprite_poly poly = sprite_poly_of(view, &tile->pixels, s);
    for (int y = span->y0; y <= span->y1; y++) {
        float *row = tile->nearest + y * TILE_STRIDE;
        for (int x = span->x0; x <= span->x1; x++) {
            float along, s2 = sprite_evaluate(&poly, (float)x + 0.5f - s->x, (float)y + 0.5f - s->y, &along);
            if (s2 > 0) {
                row[x] = fminf(row[x], along - sqrtf(s2));
            }
        }
    }
}

static size_t depth(const struct splat_view *view, struct splat_tile *tile, size_t chunk, float limit)
{
    struct span touched = {.x0 = TILE_SIZE, .x1 = -1, .y0 = TILE_SIZE, .y1 = -1};
    size_t drawn = 0;
    for (size_t i = chunk * CHUNK_SIZE; i < sprite_chunk_end(view, chunk); i++) {
        struct sprite s = sprite_project(view, &tile->pixels, i);
        float nearest = s.q[2] - s.radius - view->slack;
        struct span span;
        if (nearest >= limit || !span_of(&tile->pixels, &s, &span) || nearest >= hidden_from(tile, &span)) {
            continue;
        }
        draw_depth(view, tile, &s, &span);
        drawn += sprite_is_home(view, tile, s.x, s.y);
        touched = span_both(&touched, &span);
    }
    update_farthest(tile, &touched);
    return drawn;
}

/* Chords, or with a falloff the smooth form. */
static void add_places(const struct splat_view *view, struct splat_tile *tile, struct sprite *s, size_t particle, float falloff)
{
    struct sprite_poly poly = sprite_poly_of(view, &tile->texels, s);
    float per_center = falloff / poly.k0, amount = s->weight;
    if (falloff > 0) {
        amount *= 2 * falloff * sqrtf(poly.k0);
        sprite_widen(s, falloff);
    }
    struct span span;
    if (!span_of(&tile->texels, s, &span)) {
        return;
    }
    float amounts[SUM_COUNT];
    int count = amounts_of(view, particle, amount, amounts);
    for (int y = span.y0; y <= span.y1; y++) {
        for (int x = span.x0; x <= span.x1; x++) {
            float along, s2 = sprite_evaluate(&poly, (float)x + 0.5f - s->x, (float)y + 0.5f - s->y, &along);
            float smooth = fmaxf(1 - falloff + per_center * s2, 0);
            float value = falloff > 0 ? smooth * smooth : sqrtf(fmaxf(s2, 0));
            for (int k = 0; k < count; k++) {
                tile->sums[k][y * TILE_STRIDE + x] += amounts[k] * value;
            }
        }
    }
}

static uint64_t thickness(const struct splat_view *view, struct splat_tile *tile, size_t chunk, float end)
{
    uint64_t left_out = 0;
    for (size_t i = chunk * CHUNK_SIZE; i < sprite_chunk_end(view, chunk); i++) {
        struct sprite s = sprite_project(view, &tile->texels, i);
        if (s.q[2] + s.radius > end) {
            left_out |= (uint64_t)1 << i % CHUNK_SIZE;
            continue;
        }
        float size = sprite_size(view, &tile->texels, &s);
        enum sprite_form form = sprite_form_of(view, size);
        if (form == SPRITE_DEPOSIT) {
            add_deposit(view, tile, &s, i, sprite_amount(view, &tile->texels, &s));
        } else {
            add_places(view, tile, &s, i, form == SPRITE_SMOOTH ? sprite_falloff(size) : 0);
        }
    }
    return left_out;
}

static size_t resolve_depth(const struct splat_view *view, const struct splat_tile *tile, struct depth_plane *out)
{
    size_t covered = 0;
    for (int by = 0; by < tile->pixels.rows; by += BLOCK_HEIGHT) {
        for (int bx = 0; bx < tile->pixels.columns; bx += BLOCK_WIDTH) {
            struct depth_range range = {.min = DEPTH_EMPTY, .max = 0};
            for (int y = by; y < least(by + BLOCK_HEIGHT, tile->pixels.rows); y++) {
                float *row = out->plane.data + (tile->y + y) * out->plane.stride + tile->x;
                for (int x = bx; x < least(bx + BLOCK_WIDTH, tile->pixels.columns); x++) {
                    float nearest = tile->nearest[y * TILE_STRIDE + x];
                    bool fluid = nearest < DEPTH_LIMIT;
                    row[x] = fluid ? nearest / ray_length2(view, &tile->pixels, x, y) : DEPTH_EMPTY;
                    range.min = fminf(range.min, row[x]);
                    range.max = fmaxf(range.max, row[x]);
                    covered += fluid;
                }
            }
            out->ranges[(tile->y + by) / BLOCK_HEIGHT * out->blocks_x + (tile->x + bx) / BLOCK_WIDTH] = range;
        }
    }
    return covered;
}

static void resolve_sum(const struct splat_view *view, const struct splat_tile *tile, int sum, struct plane *out)
{
    for (int y = 0; y < tile->texels.rows; y++) {
        float *row = out->data + (tile->y / view->scale + y) * out->stride + tile->x / view->scale;
        const float *sums = tile->sums[sum] + y * TILE_STRIDE;
        for (int x = 0; x < tile->texels.columns; x++) {
            float value = sums[x];
            if (tile->deposited) {
                const float *above = tile->cells[sum] + y * CELL_STRIDE + 4 * x, *below = above + CELL_STRIDE;
                value += (below[4] + below[1]) + (above[6] + above[3]);
            }
            row[x] = 2 * value / sqrtf(ray_length2(view, &tile->texels, x, y));
        }
    }
}

const struct splat_kernels mns_splat_kernels_scalar = {
    .bounds = bounds, .depth = depth, .thickness = thickness, .resolve_depth = resolve_depth, .resolve_sum = resolve_sum};
