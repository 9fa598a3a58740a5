/* splat_cut.c: spheres and ellipsoids that are not drawn whole: cut by the near or far plane or by the scene, or around the eye. */
#include "cpu/splat_cut.h"

#include "cpu/ellipsoid.h"

/* Inline, unlike fmin and fmax, which have NaN to mind. */
static inline double lesser(double a, double b) { return a < b ? a : b; }
static inline double greater(double a, double b) { return a > b ? a : b; }

struct ball {
    double q[3], radius; /* metres, image space */
    double reach;        /* half of its extent in depth, metres */
    bool has_shape;
    double b[6], inverse[6], det; /* A^2 and its inverse, xx, yy, zz, xy, xz, yz; the determinant of A */
    int x0, x1, y0, y1;           /* places of the grid that it may touch, inclusive */
};

/* p' m q. */
static double form(const double m[6], const double p[3], const double q[3])
{
    return p[0] * (m[0] * q[0] + m[3] * q[1] + m[4] * q[2]) + p[1] * (m[3] * q[0] + m[1] * q[1] + m[5] * q[2]) +
           p[2] * (m[4] * q[0] + m[5] * q[1] + m[2] * q[2]);
}

/* Returns the determinant. */
static double invert(const double m[6], double out[6])
{
    out[0] = m[1] * m[2] - m[5] * m[5];
    out[1] = m[0] * m[2] - m[4] * m[4];
    out[2] = m[0] * m[1] - m[3] * m[3];
    out[3] = m[4] * m[5] - m[3] * m[2];
    out[4] = m[3] * m[5] - m[4] * m[1];
    out[5] = m[3] * m[4] - m[0] * m[5];
    double det = m[0] * out[0] + m[3] * out[3] + m[4] * out[4];
    for (int k = 0; k < 6; k++) {
        out[k] /= det;
    }
    return det;
}

/* A^2 and its inverse in image space, from the shape in the world. */
static void turn_shape(const struct splat_view *view, size_t particle, struct ball *ball)
{
    static const int rows[6] = {0, 1, 2, 0, 0, 1}, columns[6] = {0, 1, 2, 1, 2, 2};
    const double unit[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    double a[6], inverse[6], half[3][3], back[3][3]; /* A and its inverse times each row of the rotation */
    for (int k = 0; k < 6; k++) {
        a[k] = (double)view->particles->shape[k][particle];
    }
    ball->det = invert(a, inverse);
    for (int k = 0; k < 3; k++) {
        const float *r = &view->rotation[3 * k];
        const double row[3] = {(double)r[0], (double)r[1], (double)r[2]};
        for (int axis = 0; axis < 3; axis++) {
            half[k][axis] = form(a, unit[axis], row);
            back[k][axis] = form(inverse, unit[axis], row);
        }
    }
    for (int k = 0; k < 6; k++) {
        const double *left = half[rows[k]], *right = half[columns[k]];
        ball->b[k] = left[0] * right[0] + left[1] * right[1] + left[2] * right[2];
        left = back[rows[k]];
        right = back[columns[k]];
        ball->inverse[k] = left[0] * right[0] + left[1] * right[1] + left[2] * right[2];
    }
    ball->has_shape = true;
    ball->reach = ball->radius * sqrt(ball->b[2]);
}

static struct ball ball_of(const struct splat_view *view, size_t particle)
{
    float q[3], radius = sprite_radius(view, particle);
    sprite_center(view, particle, q);
    struct ball ball = {.q = {(double)q[0], (double)q[1], (double)q[2]}, .radius = (double)radius, .reach = (double)radius};
    if (view->particles->shape[0]) {
        turn_shape(view, particle, &ball);
    }
    return ball;
}

/* How far it reaches along n, metres times |n|. */
static double extent(const struct ball *ball, double x, double y, double z)
{
    const double n[3] = {x, y, z};
    return ball->radius * sqrt(ball->has_shape ? form(ball->b, n, n) : x * x + y * y + z * z);
}

struct ray {
    double u, w, length2; /* v = (u, w, 1), orthographic: from (u, w, 0) along (0, 0, 1) */
};

static struct ray ray_at(const struct splat_view *view, const struct splat_grid *grid, int x, int y)
{
    struct ray ray = {.u = (x + 0.5 - (double)grid->cx) * (double)(1 / grid->fx),
                      .w = (y + 0.5 - (double)grid->cy) * (double)(1 / grid->fy)};
    ray.length2 = view->orthographic ? 1 : ray.u * ray.u + ray.w * ray.w + 1;
    return ray;
}

/* ellipsoid.h's formula, with A^-2 for Q and 1 for det. */
static bool meet_shape(const struct splat_view *view, const struct ray *ray, const struct ball *ball, double *enter, double *leave)
{
    const double *c = ball->q;
    double along = view->orthographic ? 1 : c[2], u = view->orthographic ? 0 : ray->u, w = view->orthographic ? 0 : ray->w;
    const double v[3] = {u, w, 1}, d[3] = {ray->u - c[0] / along, ray->w - c[1] / along, 0};
    const double n[3] = {v[1] * d[2] - v[2] * d[1], v[2] * d[0] - v[0] * d[2], v[0] * d[1] - v[1] * d[0]};
    double e = form(ball->inverse, v, v), f = along * form(ball->inverse, v, d);
    double square = ball->radius * ball->radius * e - along * along * form(ball->b, n, n) / (ball->det * ball->det);
    if (!(square > 0)) {
        return false;
    }
    *enter = c[2] - (f + sqrt(square)) / e;
    *leave = c[2] - (f - sqrt(square)) / e;
    return true;
}

/* Depths at which the ray enters and leaves. false: it misses. */
static bool meet(const struct splat_view *view, const struct ray *ray, const struct ball *ball, double *enter, double *leave)
{
    if (ball->has_shape) {
        return meet_shape(view, ray, ball, enter, leave);
    }
    const double *c = ball->q;
    double along, square;
    if (view->orthographic) {
        double x = c[0] - ray->u, y = c[1] - ray->w;
        along = c[2];
        square = ball->radius * ball->radius - x * x - y * y;
    } else {
        double x = ray->w * c[2] - c[1], y = c[0] - ray->u * c[2], z = ray->u * c[1] - ray->w * c[0]; /* v x c */
        along = ray->u * c[0] + ray->w * c[1] + c[2];
        square = ray->length2 * ball->radius * ball->radius - (x * x + y * y + z * z);
    }
    if (!(square > 0)) {
        return false;
    }
    *enter = (along - sqrt(square)) / ray->length2;
    *leave = (along + sqrt(square)) / ray->length2;
    return true;
}

/* Whether it is wholly beyond one side of the pyramid through the grid. focal, center, count: of one axis. */
static bool is_beside(const struct ball *ball, int axis, float focal, float center, int count)
{
    double f = (double)focal, low = (double)center, high = count - low, x = f * ball->q[axis], z = ball->q[2];
    double nx = axis == 0 ? f : 0, ny = axis == 1 ? f : 0;
    return x + low * z < -extent(ball, nx, ny, low) || high * z - x < -extent(ball, -nx, -ny, high);
}

/* Fills its places. false: nothing of it in the grid and between the planes. */
static bool place_ball(const struct splat_view *view, const struct splat_grid *grid, size_t particle, struct ball *ball)
{
    float near_depth = (float)(ball->q[2] - ball->reach), far_depth = (float)(ball->q[2] + ball->reach);
    ball->x0 = ball->y0 = 0;
    ball->x1 = grid->columns - 1;
    ball->y1 = grid->rows - 1;
    if (far_depth <= view->near_plane || near_depth >= view->far_plane) {
        return false;
    }
    if (!view->orthographic &&
        (is_beside(ball, 0, grid->fx, grid->cx, grid->columns) || is_beside(ball, 1, grid->fy, grid->cy, grid->rows))) {
        return false;
    }
    if (!view->orthographic && ball->q[2] < (double)CLOSE_RADII * ball->reach) {
        return true; /* its outline may be no ellipse */
    }
    struct sprite s = ball->has_shape ? ellipsoid_project(view, grid, particle).sprite : sprite_project(view, grid, particle);
    sprite_span(s.x_min, s.x_max, grid->columns, &ball->x0, &ball->x1);
    sprite_span(s.y_min, s.y_max, grid->rows, &ball->y0, &ball->y1);
    return ball->x0 <= ball->x1 && ball->y0 <= ball->y1;
}

/* Whether the centre, moved before the eye and into the picture, is in the tile. */
static bool is_home(const struct splat_view *view, const struct splat_tile *tile, const struct ball *ball)
{
    double per_metre = view->orthographic ? 1 : 1 / greater(ball->q[2], (double)view->near_plane);
    return sprite_is_home(view, tile, (float)(ball->q[0] * per_metre * (double)tile->pixels.fx + (double)tile->pixels.cx),
                          (float)(ball->q[1] * per_metre * (double)tile->pixels.fy + (double)tile->pixels.cy));
}

static void update_farthest(struct splat_tile *tile)
{
    int columns = TILE_SIZE >> tile->shift_x, rows = TILE_SIZE >> tile->shift_y;
    for (int block = 0; block < columns * rows; block++) {
        const float *corner = tile->nearest + (block / columns << tile->shift_y) * TILE_STRIDE + (block % columns << tile->shift_x);
        float most = 0;
        for (int y = 0; y < 1 << tile->shift_y; y++) {
            for (int x = 0; x < 1 << tile->shift_x; x++) {
                most = corner[y * TILE_STRIDE + x] > most ? corner[y * TILE_STRIDE + x] : most;
            }
        }
        tile->farthest[block] = most > DEPTH_LIMIT ? DEPTH_EMPTY : most * tile->per_nearest[block];
    }
}

static void draw_ball(const struct splat_view *view, struct splat_tile *tile, const struct ball *ball)
{
    double near_plane = (double)view->near_plane, far_plane = (double)view->far_plane;
    for (int y = ball->y0; y <= ball->y1; y++) {
        for (int x = ball->x0; x <= ball->x1; x++) {
            float *nearest = &tile->nearest[y * TILE_STRIDE + x];
            struct ray ray = ray_at(view, &tile->pixels, x, y);
            double enter, leave;
            if (*nearest <= (float)(near_plane * ray.length2) || !meet(view, &ray, ball, &enter, &leave)) {
                continue;
            }
            if (leave > near_plane && enter < far_plane) {
                *nearest = fminf(*nearest, (float)(greater(enter, near_plane) * ray.length2));
            }
        }
    }
}

size_t mns_cut_depth(const struct splat_view *view, struct splat_tile *tile, size_t chunk, float limit)
{
    size_t drawn = 0;
    for (size_t i = chunk * CHUNK_SIZE; i < sprite_chunk_end(view, chunk); i++) {
        struct ball ball = ball_of(view, i);
        if (!place_ball(view, &tile->pixels, i, &ball) || (float)(ball.q[2] - ball.reach) - view->slack >= limit) {
            continue;
        }
        draw_ball(view, tile, &ball);
        drawn += is_home(view, tile, &ball);
    }
    update_farthest(tile);
    return drawn;
}

/* Where thickness ends in pixel (x, y) of the picture. */
static double end_at(const struct splat_view *view, const struct plane *scene, int x, int y)
{
    return lesser((double)view->far_plane, (double)scene->data[y * scene->stride + x]);
}

/* Part of a ball that lies before depth: a cap's share of the volume. */
static double part_before(const struct ball *ball, double depth)
{
    double above = depth - ball->q[2];
    if (above >= ball->reach || above <= -ball->reach) {
        return above > 0;
    }
    double h = above / (2 * ball->reach) + 0.5;
    return h * h * (3 - 2 * h);
}

/* Mean over the pixels of texel (x, y) of the visible length between enter and leave. */
static double mean_visible(const struct splat_view *view, const struct splat_tile *tile, int x, int y, const struct plane *scene,
                           double enter, double leave)
{
    double sum = 0, from = greater(enter, (double)view->near_plane);
    if (!scene) {
        return greater(lesser(leave, (double)view->far_plane) - from, 0);
    }
    int pixels = 0, x0 = tile->x + x * view->scale, y0 = tile->y + y * view->scale;
    for (int py = y0; py < y0 + view->scale && py < view->height; py++) {
        for (int px = x0; px < x0 + view->scale && px < view->width; px++) {
            sum += greater(lesser(leave, end_at(view, scene, px, py)) - from, 0);
            pixels++;
        }
    }
    return sum / pixels;
}

/* The same of a ball that is spread over more than its outline: its visible part, whichever ray. */
static double mean_part(const struct splat_view *view, const struct splat_tile *tile, int x, int y, const struct plane *scene,
                        const struct ball *ball)
{
    double sum = 0, before = part_before(ball, (double)view->near_plane);
    if (!scene) {
        return greater(part_before(ball, (double)view->far_plane) - before, 0);
    }
    int pixels = 0, x0 = tile->x + x * view->scale, y0 = tile->y + y * view->scale;
    for (int py = y0; py < y0 + view->scale && py < view->height; py++) {
        for (int px = x0; px < x0 + view->scale && px < view->width; px++) {
            sum += greater(part_before(ball, end_at(view, scene, px, py)) - before, 0);
            pixels++;
        }
    }
    return sum / pixels;
}

static void add(const struct splat_view *view, struct splat_tile *tile, int x, int y, size_t particle, double value)
{
    tile->sums[0][y * TILE_STRIDE + x] += (float)value;
    for (int c = 0; c < 3 && view->has_color; c++) {
        tile->sums[1 + c][y * TILE_STRIDE + x] += (float)(value * (double)view->particles->color[c][particle]);
    }
}

static void add_chords(const struct splat_view *view, struct splat_tile *tile, size_t particle, double weight, struct ball *ball,
                       const struct plane *scene)
{
    if (!place_ball(view, &tile->texels, particle, ball)) {
        return;
    }
    for (int y = ball->y0; y <= ball->y1; y++) {
        for (int x = ball->x0; x <= ball->x1; x++) {
            struct ray ray = ray_at(view, &tile->texels, x, y);
            double enter, leave;
            if (meet(view, &ray, ball, &enter, &leave)) {
                add(view, tile, x, y, particle, 0.5 * weight * ray.length2 * mean_visible(view, tile, x, y, scene, enter, leave));
            }
        }
    }
}

/* amount * max(0, base + scale * form)^2. */
struct fall {
    struct quadratic form;
    float base, scale;
    double amount;
};

/* Within the sprite's bounds. */
static void add_smooth(const struct splat_view *view, struct splat_tile *tile, size_t particle, const struct sprite *s,
                       const struct fall *fall, struct ball *ball, const struct plane *scene)
{
    sprite_span(s->x_min, s->x_max, tile->texels.columns, &ball->x0, &ball->x1);
    sprite_span(s->y_min, s->y_max, tile->texels.rows, &ball->y0, &ball->y1);
    for (int y = ball->y0; y <= ball->y1; y++) {
        for (int x = ball->x0; x <= ball->x1; x++) {
            float at = quadratic_at(&fall->form, (float)x + 0.5f - s->x, (float)y + 0.5f - s->y);
            double smooth = (double)fmaxf(fall->base + fall->scale * at, 0);
            if (smooth > 0) {
                add(view, tile, x, y, particle, fall->amount * smooth * smooth * mean_part(view, tile, x, y, scene, ball));
            }
        }
    }
}

static void add_deposit(const struct splat_view *view, struct splat_tile *tile, size_t particle, const struct sprite *s, double amount,
                        const struct ball *ball, const struct plane *scene)
{
    if (!sprite_reaches(s->x, tile->texels.columns) || !sprite_reaches(s->y, tile->texels.rows)) {
        return;
    }
    float left = floorf(s->x - 0.5f), top = floorf(s->y - 0.5f);
    for (int y = (int)top; y <= (int)top + 1; y++) {
        for (int x = (int)left; x <= (int)left + 1; x++) {
            if (x >= 0 && x < tile->texels.columns && y >= 0 && y < tile->texels.rows) {
                double share = (1 - fabs((double)s->x - 0.5 - x)) * (1 - fabs((double)s->y - 0.5 - y));
                add(view, tile, x, y, particle, amount * share * mean_part(view, tile, x, y, scene, ball));
            }
        }
    }
}

struct depth_range mns_cut_range(const struct cut_scene *scene, int x0, int x1, int y0, int y1)
{
    const int columns = TILE_SIZE >> BLOCK_SHIFT_X, rows = TILE_SIZE >> BLOCK_SHIFT_Y;
    struct depth_range all = {.min = DEPTH_EMPTY, .max = 0};
    for (int by = y0 > 0 ? y0 >> BLOCK_SHIFT_Y : 0; by < rows && by <= y1 >> BLOCK_SHIFT_Y; by++) {
        for (int bx = x0 > 0 ? x0 >> BLOCK_SHIFT_X : 0; bx < columns && bx <= x1 >> BLOCK_SHIFT_X; bx++) {
            struct depth_range range = scene->ranges[by * columns + bx];
            all.min = range.min < all.min ? range.min : all.min;
            all.max = range.max > all.max ? range.max : all.max;
        }
    }
    return all;
}

/* Pixels from the tile's corner where a sphere's thickness may come to, of a bound in texels. */
static int pixel_bound(const struct splat_view *view, float bound, float reach)
{
    return (int)fminf(fmaxf((bound + reach) * (float)view->scale, -1), TILE_SIZE);
}

/* The scene that it meets: NULL where it lies wholly before. *hidden: wholly behind. */
static const struct plane *scene_met(const struct splat_view *view, const struct sprite *s, const struct ball *ball,
                                     const struct cut_scene *scene, bool *hidden)
{
    float reach = view->scale > 1 ? SUM_REACH + 1 : 1; /* and what is left of the texel */
    float wide = reach + 0.5f * view->sum_stretch * (s->x_max - s->x_min), high = reach + 0.5f * view->sum_stretch * (s->y_max - s->y_min);
    struct depth_range range = mns_cut_range(scene, pixel_bound(view, s->x_min, -wide), pixel_bound(view, s->x_max, wide),
                                             pixel_bound(view, s->y_min, -high), pixel_bound(view, s->y_max, high));
    *hidden = (float)(ball->q[2] - ball->reach) >= range.max;
    return (float)(ball->q[2] + ball->reach) > range.min ? scene->depth : NULL;
}

static void cut_ball(const struct splat_view *view, struct splat_tile *tile, size_t particle, struct ball *ball, struct sprite *s,
                     const struct plane *scene)
{
    float size = sprite_size(view, &tile->texels, s), falloff = sprite_falloff(size);
    enum sprite_form form = sprite_form_of(view, size);
    if (form == SPRITE_CHORD) {
        add_chords(view, tile, particle, (double)s->weight, ball, scene);
    } else if (form == SPRITE_SMOOTH) {
        struct sprite_poly p = sprite_poly_of(view, &tile->texels, s);
        struct fall fall = {
            {p.k0, p.kx, p.ky, p.kxx, p.kyy, p.kxy}, 1 - falloff, falloff / p.k0, (double)(s->weight * 2 * falloff * sqrtf(p.k0))};
        sprite_widen(s, falloff);
        add_smooth(view, tile, particle, s, &fall, ball, scene);
    } else {
        add_deposit(view, tile, particle, s, (double)sprite_amount(view, &tile->texels, s), ball, scene);
    }
}

static void cut_ellipsoid(const struct splat_view *view, struct splat_tile *tile, size_t particle, struct ball *ball,
                          const struct ellipsoid *e, const struct plane *scene)
{
    float g[3];
    enum sprite_form form = ellipsoid_form_of(view, &tile->texels, e, g);
    struct sprite s = e->sprite;
    if (form == SPRITE_CHORD) {
        add_chords(view, tile, particle, (double)s.weight, ball, scene);
    } else if (form == SPRITE_SMOOTH) {
        struct ellipsoid_poly p = ellipsoid_poly_of(view, &tile->texels, e);
        struct ellipsoid_smooth smooth = ellipsoid_smooth_of(e, &p, g);
        ellipsoid_widen(&s, &smooth);
        struct fall fall = {smooth.fall, 0, 1, (double)(s.weight * smooth.amount)};
        add_smooth(view, tile, particle, &s, &fall, ball, scene);
    } else {
        add_deposit(view, tile, particle, &s, (double)ellipsoid_amount(view, &tile->texels, e), ball, scene);
    }
}

static void cut_particle(const struct splat_view *view, struct splat_tile *tile, size_t particle, const struct cut_scene *scene)
{
    struct ball ball = ball_of(view, particle);
    if (!view->orthographic && ball.q[2] < (double)CLOSE_RADII * ball.reach) {
        double weight = (double)(ball.has_shape ? ellipsoid_weight(view, particle, (float)ball.radius, (float)ball.det)
                                                : sprite_weight(view, particle, (float)ball.radius));
        add_chords(view, tile, particle, weight, &ball, scene ? scene->depth : NULL);
        return;
    }
    struct ellipsoid e;
    struct sprite s;
    if (ball.has_shape) {
        e = ellipsoid_project(view, &tile->texels, particle);
        s = e.sprite;
    } else {
        s = sprite_project(view, &tile->texels, particle);
    }
    bool hidden = false;
    const struct plane *depth = scene ? scene_met(view, &s, &ball, scene, &hidden) : NULL;
    if (hidden) {
        return;
    }
    if (ball.has_shape) {
        cut_ellipsoid(view, tile, particle, &ball, &e, depth);
    } else {
        cut_ball(view, tile, particle, &ball, &s, depth);
    }
}

void mns_cut_thickness(const struct splat_view *view, struct splat_tile *tile, size_t chunk, uint64_t which, const struct cut_scene *scene)
{
    for (size_t i = chunk * CHUNK_SIZE; i < sprite_chunk_end(view, chunk); i++) {
        if (which >> i % CHUNK_SIZE & 1) {
            cut_particle(view, tile, i, scene);
        }
    }
}
