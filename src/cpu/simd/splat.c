/* splat.c: the kernels of stages bin and splat over simd.h. Formulas and contracts: cpu/splat.h; their definition: cpu/scalar/splat.c. */
#include "cpu/simd/sphere.h"

/* Lanes past the sphere's last column fail s^2 > 0: the form is negative everywhere outside the outline. They may be past the tile's
 * last column, in the room that TILE_STRIDE leaves. */
static void draw_depth(const struct table *t, int i, float *nearest)
{
    for (int x = t->x0[i]; x <= t->x1[i]; x += VLEN) {
        struct columns c = columns_at(t, i, x);
        vf along = vf_fma(vf_set1(t->vx[i]), vf_set1((float)x + 0.5f - t->x[i]) + vf_iota(), vf_set1(t->v0[i])), vy = vf_set1(t->vy[i]);
        vf dy = vf_set1((float)t->y0[i] + 0.5f - t->y[i]), one = vf_set1(1);
        float *row = nearest + t->y0[i] * TILE_STRIDE + x;
        for (int y = t->y0[i]; y <= t->y1[i]; y++, row += TILE_STRIDE, dy += one) {
            vf s2 = vf_fma(vf_fma(c.k[2], dy, c.k[1]), dy, c.k[0]);
            vf near_root = vf_fnma(s2, vf_rsqrt_quick(s2), vf_fma(vy, dy, along));
            vf_storeu(row, vf_mask_min(vf_loadu(row), vf_gt(s2, vf_zero()), near_root));
        }
    }
}

static size_t depth(const struct splat_view *view, struct splat_tile *tile, size_t chunk, float limit)
{
    struct table table;
    struct places touched = {.x0 = vf_set1(TILE_SIZE), .x1 = vf_set1(-1), .y0 = vf_set1(TILE_SIZE), .y1 = vf_set1(-1)};
    size_t drawn = 0;
    bool any = false;
    for (size_t first = chunk * CHUNK_SIZE; first < (chunk + 1) * CHUNK_SIZE; first += VLEN) {
        struct spheres s = project(view, &tile->pixels, first);
        vf nearest = s.z - s.radius - vf_set1(view->slack);
        vm shows = vm_and(present(view, first), vf_lt(nearest, vf_set1(limit)));
        if (!vm_any(shows)) {
            continue;
        }
        struct outlines o = outline(view, &tile->pixels, &s, vf_set1(1));
        struct places p = places_of(&tile->pixels, &o);
        shows = vm_and(vm_and(shows, p.some), vf_lt(nearest, hidden_from(tile, &p)));
        unsigned lanes = vm_bits(shows);
        if (lanes == 0) {
            continue;
        }
        any = true;
        tabulate(view, &tile->pixels, &s, &p, &table);
        drawn += (size_t)__builtin_popcount(vm_bits(vm_and(shows, is_home(view, tile, &s))));
        touched.x0 = vf_mask_min(touched.x0, shows, p.x0);
        touched.y0 = vf_mask_min(touched.y0, shows, p.y0);
        touched.x1 = vf_mask_max(touched.x1, shows, p.x1);
        touched.y1 = vf_mask_max(touched.y1, shows, p.y1);
        for (; lanes != 0; lanes &= lanes - 1) {
            draw_depth(&table, __builtin_ctz(lanes), tile->nearest);
        }
    }
    if (any) {
        update_farthest(tile, (int)vf_reduce_min(touched.x0), (int)vf_reduce_max(touched.x1), (int)vf_reduce_min(touched.y0),
                        (int)vf_reduce_max(touched.y1));
    }
    return drawn;
}

/* Chords and smooth forms of the lanes that are not small. */
static void add_places(const struct splat_view *view, struct splat_tile *tile, const struct spheres *s, size_t first, vm large, vf size,
                       vf weight)
{
    struct table table;
    vm smooth = view->scale > 1 ? vf_lt(size, vf_set1(CHORD_RADIUS)) : vf_lt(size, vf_zero());
    vf spread = smooth_spread(size);
    vf wider = vf_select(smooth, spread * vf_rsqrt(spread), vf_set1(1));
    struct outlines o = outline(view, &tile->texels, s, wider);
    struct places p = places_of(&tile->texels, &o);
    vm seen = vm_and(large, p.some);
    if (vm_any(seen)) {
        tabulate(view, &tile->texels, s, &p, &table);
        vf_store(table.amount, weight);
        smooth_table(&table, smooth, vf_rcp(spread));
        draw_sums(view, tile, &table, first, vm_bits(seen), vm_bits(smooth));
    }
}

SIMD void add_deposits(const struct splat_view *view, struct splat_tile *tile, const struct spheres *s, size_t first, vm small, vf weight)
{
    vf amount = deposit_amount(view, &tile->texels, s, weight);
    add_amounts(view, tile, s, first, small, amount);
}

static uint64_t thickness(const struct splat_view *view, struct splat_tile *tile, size_t chunk, float end)
{
    uint64_t left_out = 0;
    vf per_metre = vf_set1(0.5f * (tile->texels.fx + tile->texels.fy)), deposit_below = vf_set1(view->scale > 1 ? DEPOSIT_RADIUS : 0);
    for (size_t i = 0; i < CHUNK_SIZE; i += VLEN) {
        size_t first = chunk * CHUNK_SIZE + i;
        struct spheres s = project(view, &tile->texels, first);
        vf size = per_metre * s.radius;
        if (!view->orthographic) {
            size = per_metre * s.rho;
        }
        vf weight = weight_of(view, first, s.radius);
        vm real = present(view, first), before = vf_le(s.z + s.radius, vf_set1(end)), small = vf_lt(size, deposit_below);
        left_out |= (uint64_t)vm_bits(vm_and(real, vm_not(before))) << i;
        real = vm_and(real, before);
        if (vm_any(small)) {
            add_deposits(view, tile, &s, first, vm_and(real, small), weight);
        }
        if (!vm_all(small)) {
            add_places(view, tile, &s, first, vm_and(real, vm_not(small)), size, weight);
        }
    }
    return left_out;
}

/* One row of pixels, from place x on; ranges: of the strips of the block row so far. Returns how many hold fluid. */
SIMD size_t resolve_row(const struct splat_view *view, const struct splat_tile *tile, int y, float *out, vf *least, vf *most)
{
    size_t covered = 0;
    const float *row = tile->nearest + y * TILE_STRIDE;
    const int columns = tile->pixels.columns;
    struct ray_row ray = ray_row_at(view, &tile->pixels, y);
    for (int x = 0, strip = 0; x < columns; x += VLEN, strip++) {
        vf nearest = vf_load(row + x);
        vm inside = vm_first(columns - x), fluid = vm_and(inside, vf_lt(nearest, vf_set1(DEPTH_LIMIT)));
        vf z = nearest * vf_rcp(ray_length2(&ray, x));
        z = vf_select(fluid, z, vf_keep(inside, vf_set1(DEPTH_EMPTY)));
        vf_stream(out + x, z);
        least[strip] = vf_mask_min(least[strip], inside, z);
        most[strip] = vf_max(most[strip], z);
        covered += (size_t)__builtin_popcount(vm_bits(fluid));
    }
    return covered;
}

static size_t resolve_depth(const struct splat_view *view, const struct splat_tile *tile, struct depth_plane *out)
{
    size_t covered = 0;
    for (int by = 0; by < tile->pixels.rows; by += BLOCK_HEIGHT) {
        vf least[TILE_SIZE / VLEN], most[TILE_SIZE / VLEN];
        for (int strip = 0; strip < TILE_SIZE / VLEN; strip++) {
            least[strip] = vf_set1(DEPTH_EMPTY);
            most[strip] = vf_zero();
        }
        int last = by + BLOCK_HEIGHT < tile->pixels.rows ? by + BLOCK_HEIGHT : tile->pixels.rows;
        for (int y = by; y < last; y++) {
            covered += resolve_row(view, tile, y, out->plane.data + (tile->y + y) * out->plane.stride + tile->x, least, most);
        }
        struct depth_range *range = out->ranges + (tile->y + by) / BLOCK_HEIGHT * out->blocks_x + tile->x / BLOCK_WIDTH;
        for (int bx = 0, strip = 0; bx < tile->pixels.columns; bx += BLOCK_WIDTH, range++) {
            vf block_least = least[strip], block_most = most[strip];
            for (int last_strip = strip++ + BLOCK_WIDTH / VLEN; strip < last_strip; strip++) {
                block_least = vf_min(block_least, least[strip]);
                block_most = vf_max(block_most, most[strip]);
            }
            *range = (struct depth_range){.min = vf_reduce_min(block_least), .max = vf_reduce_max(block_most)};
        }
    }
    vf_stream_end();
    return covered;
}

/* The four cells about texel x of a row, summed. */
static float cell_sum(const float *above, int x)
{
    const float *a = above + 4 * x, *b = a + CELL_STRIDE;
    return (b[4] + b[1]) + (a[6] + a[3]);
}

static void resolve_sum(const struct splat_view *view, const struct splat_tile *tile, int sum, struct plane *out)
{
    for (int y = 0; y < tile->texels.rows; y++) {
        float *row = out->data + (tile->y / view->scale + y) * out->stride + tile->x / view->scale;
        const float *sums = tile->sums[sum] + y * TILE_STRIDE;
        struct ray_row ray = ray_row_at(view, &tile->texels, y);
        for (int x = 0; x < tile->texels.columns; x += VLEN) {
            float values[VLEN] __attribute__((aligned(64)));
            int lanes = tile->texels.columns - x < VLEN ? tile->texels.columns - x : VLEN;
            vf value = vf_load(sums + x);
            if (tile->deposited) {
                vf_store(values, value);
                for (int i = 0; i < lanes; i++) {
                    values[i] += cell_sum(tile->cells[sum] + y * CELL_STRIDE, x + i);
                }
                value = vf_load(values);
            }
            value = vf_set1(2) * value * vf_rsqrt(ray_length2(&ray, x));
            if (lanes == VLEN) {
                vf_storeu(row + x, value);
                continue;
            }
            vf_store(values, value);
            for (int i = 0; i < lanes; i++) {
                row[x + i] = values[i];
            }
        }
    }
}

/* Boxes of VLEN chunks in image space, grown by the slack, and the largest radii. */
struct boxes {
    vf center[3], extent[3], radius, wide; /* wide: radius, and what its thickness takes up */
};

SIMD struct boxes boxes_of(const struct splat_view *view, size_t first)
{
    const struct particle_store *p = view->particles;
    struct boxes out;
    for (int k = 0; k < 3; k++) {
        out.center[k] = vf_set1(view->translation[k]);
        out.extent[k] = vf_set1(view->slack);
        for (int axis = 0; axis < 3; axis++) {
            vf low = vf_loadu(p->box_min[axis] + first), high = vf_loadu(p->box_max[axis] + first);
            float r = 0.5f * view->rotation[3 * k + axis];
            out.center[k] = vf_fma(vf_set1(r), low + high, out.center[k]);
            out.extent[k] = vf_fma(vf_set1(fabsf(r)), high - low, out.extent[k]);
        }
    }
    out.radius = vf_set1(view->radius);
    if (view->radius_scale > 0) {
        out.radius = vf_set1(view->radius_scale) * vf_loadu(view->box_radii + first);
    }
    if (view->box_stretch) {
        out.radius = out.radius * vf_loadu(view->box_stretch + first);
    }
    out.wide = vf_set1(1 + view->sum_stretch) * out.radius;
    return out;
}

/* Lower and upper end in grid units along one axis of everything in boxes between depths nearest and farthest (as their reciprocals), and
 * half of the widest outline. */
SIMD void box_extent(const struct boxes *box, int axis, vf per_near, vf per_far, float focal, vf *low, vf *high, vf *half)
{
    vf left = box->center[axis] - box->extent[axis], right = box->center[axis] + box->extent[axis];
    vf slope_min = vf_min(left * per_near, left * per_far), slope_max = vf_max(right * per_near, right * per_far);
    vf rho = box->radius * per_near, rest = vf_fnma(rho, rho, vf_set1(1)), scale = vf_set1(focal) / rest;
    vf steep = vf_max(vf_abs(slope_min), vf_abs(slope_max));
    *low = scale * (slope_min - rho * vf_sqrt(vf_fma(slope_min, slope_min, rest)));
    *high = scale * (slope_max + rho * vf_sqrt(vf_fma(slope_max, slope_max, rest)));
    *half = scale * rho * vf_sqrt(vf_fma(steep, steep, rest));
}

/* Whether the boxes are wholly beyond the plane nx x + nz z = 0 of the frustum. */
SIMD vm beyond(const struct boxes *box, int axis, float nx, float nz)
{
    vf inside = vf_set1(nx) * box->center[axis] + vf_set1(nz) * box->center[2] + vf_set1(fabsf(nx)) * (box->extent[axis] + box->wide) +
                vf_set1(fabsf(nz)) * (box->extent[2] + box->wide);
    return vf_lt(inside, vf_zero());
}

SIMD void bounds_at(const struct splat_view *view, size_t first, size_t at, struct splat_bounds *out)
{
    struct boxes box = boxes_of(view, first + at);
    vf nearest = box.center[2] - box.extent[2], farthest = box.center[2] + box.extent[2];
    float reach = view->scale > 1 ? SUM_REACH * (float)view->scale : 0, w = (float)view->width, h = (float)view->height;
    vf x_min, x_max, y_min, y_max, sprite;
    if (view->orthographic) {
        vf rx = vf_set1(view->fx) * box.radius, ry = vf_set1(view->fy) * box.radius;
        x_min = vf_set1(view->fx) * (box.center[0] - box.extent[0]) - rx;
        x_max = vf_set1(view->fx) * (box.center[0] + box.extent[0]) + rx;
        y_min = vf_set1(view->fy) * (box.center[1] - box.extent[1]) - ry;
        y_max = vf_set1(view->fy) * (box.center[1] + box.extent[1]) + ry;
        sprite = vf_max(rx, ry);
    } else {
        vf per_near = vf_set1(1) / nearest, per_far = vf_set1(1) / farthest, half_x, half_y;
        box_extent(&box, 0, per_near, per_far, view->fx, &x_min, &x_max, &half_x);
        box_extent(&box, 1, per_near, per_far, view->fy, &y_min, &y_max, &half_y);
        sprite = vf_max(half_x, half_y);
    }
    vf stretch = vf_set1(view->sum_stretch) * sprite;
    x_min = x_min + vf_set1(view->cx - reach) - stretch;
    x_max = x_max + vf_set1(view->cx + reach) + stretch;
    y_min = y_min + vf_set1(view->cy - reach) - stretch;
    y_max = y_max + vf_set1(view->cy + reach) + stretch;
    vm fits = vm_and(vf_ge(nearest, vf_set1(CLOSE_RADII) * box.radius), vf_gt(nearest, vf_zero()));
    if (!view->orthographic && !vm_all(fits)) {
        /* Close to the eye: all of the picture, unless beyond one side of the frustum, widened by reach. */
        vm gone = vm_or(vm_or(beyond(&box, 0, view->fx, view->cx + reach), beyond(&box, 0, -view->fx, w - view->cx + reach)),
                        vm_or(beyond(&box, 1, view->fy, view->cy + reach), beyond(&box, 1, -view->fy, h - view->cy + reach)));
        x_min = vf_select(fits, x_min, vf_zero());
        x_max = vf_select(fits, x_max, vf_select(gone, vf_set1(-1), vf_set1(w)));
        y_min = vf_select(fits, y_min, vf_zero());
        y_max = vf_select(fits, y_max, vf_set1(h));
        sprite = vf_select(fits, sprite, vf_set1(DEPTH_EMPTY));
    }
    vf near_depth = nearest - box.radius, far_depth = farthest + box.radius;
    vm apart = vm_or(vf_lt(far_depth, vf_set1(view->near_plane)), vf_gt(near_depth, vf_set1(view->far_plane)));
    vf_storeu(out->x_min + at, x_min);
    vf_storeu(out->x_max + at, vf_select(apart, x_min - vf_set1(1), x_max));
    vf_storeu(out->y_min + at, y_min);
    vf_storeu(out->y_max + at, y_max);
    vf_storeu(out->near_depth + at, near_depth);
    vf_storeu(out->far_depth + at, far_depth);
    vf_storeu(out->sprite + at, sprite);
}

static void bounds(const struct splat_view *view, size_t first, struct splat_bounds *out)
{
    for (size_t at = 0; at < BOUNDS_BATCH; at += VLEN) {
        bounds_at(view, first, at, out);
    }
}

const struct splat_kernels SIMD_NAME(mns_splat_kernels) = {
    .bounds = bounds, .depth = depth, .thickness = thickness, .resolve_depth = resolve_depth, .resolve_sum = resolve_sum};
