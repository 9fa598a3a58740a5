/* foam.c: the kernels of stage foam in plain C: their definition. */
#include "cpu/foam.h"

#include "cpu/scalar/tile.h"

#include <string.h>

static float clamp(float a, float low, float high) { return a > low ? a < high ? a : high : low; }

static size_t ends(const struct splat_view *view, const struct splat_tile *tile, float delta, const struct plane *scene,
                   struct plane *depth, struct foam_ends *out)
{
    size_t covered = 0;
    for (int y = 0; y < tile->pixels.rows; y++) {
        float *row = depth->data + (tile->y + y) * depth->stride + tile->x;
        for (int x = 0; x < tile->pixels.columns; x++) {
            float behind = scene ? scene->data[(tile->y + y) * scene->stride + tile->x + x] : DEPTH_EMPTY;
            bool shows = row[x] < DEPTH_LIMIT && row[x] < behind;
            float square = ray_length2(view, &tile->pixels, x, y);
            int at = y * TILE_STRIDE + x;
            out->all[at] = !shows ? 0 : behind < DEPTH_LIMIT ? behind * square : DEPTH_EMPTY;
            out->front[at] = shows ? fminf((row[x] + delta) * square, out->all[at]) : 0;
            row[x] = shows ? row[x] : DEPTH_EMPTY;
            covered += shows;
        }
    }
    return covered;
}

static void limits(const struct splat_view *view, const struct splat_tile *tile, const struct plane *depth, float *out)
{
    int rows = least(TILE_SIZE, view->height - tile->y), columns = least(TILE_SIZE, view->width - tile->x), scale = view->scale;
    memset(out, 0, (size_t)(TILE_SIZE / scale + 2) * TILE_STRIDE * sizeof(float));
    for (int y = 0; y * scale < rows; y++) {
        for (int x = 0; x * scale < columns; x++) {
            float sum = 0, count = 0;
            for (int py = y * scale; py < (y + 1) * scale && py < rows; py++) {
                const float *row = depth->data + (tile->y + py) * depth->stride + tile->x;
                for (int px = x * scale; px < (x + 1) * scale && px < columns; px++) {
                    bool shows = row[px] < DEPTH_LIMIT;
                    sum += shows ? row[px] : 0;
                    count += (float)shows;
                }
            }
            out[(y + 1) * TILE_STRIDE + x + 1] = count > 0 ? sum / count : 0;
        }
    }
}

/* Gradient noise of one octave at a fixed age: on each cell corner dx gx + dy gy + dz gz, the last a constant of the slice. */
struct slice {
    float gx[9][9], gy[9][9], gz[9][9];
    int cells;
    float weight;
};

static float fade(float t) { return t * t * t * (t * (t * 6 - 15) + 10); }

static float mix(float a, float b, float t) { return a + t * (b - a); }

static void gradient(uint32_t hash, float g[3])
{
    for (int k = 0; k < 3; k++) {
        g[k] = (float)(hash >> (10 * k) & 1023) * (1 / 511.5f) - 1;
    }
}

static void make_slice(struct slice *out, float seed, int octave, float age, float size)
{
    out->cells = DETAIL_CELLS << octave;
    out->weight = DETAIL_GAIN[octave] * clamp((2 * size / (float)out->cells - DETAIL_LEAST) / DETAIL_LEAST, 0, 1);
    float z = DETAIL_LIFE * age, below = floorf(z), dz = z - below, part = fade(dz);
    for (int j = 0; j <= out->cells && out->weight > 0; j++) {
        for (int i = 0; i <= out->cells; i++) {
            float a[3], b[3];
            gradient(foam_hash((uint32_t)seed, (uint32_t)octave, (uint32_t)i, (uint32_t)j, (uint32_t)below), a);
            gradient(foam_hash((uint32_t)seed, (uint32_t)octave, (uint32_t)i, (uint32_t)j, (uint32_t)below + 1), b);
            out->gx[j][i] = mix(a[0], b[0], part);
            out->gy[j][i] = mix(a[1], b[1], part);
            out->gz[j][i] = mix(a[2] * dz, b[2] * (dz - 1), part);
        }
    }
}

/* u, v: -1 to 1 across the sphere. */
static float noise_at(const struct slice *s, float u, float v)
{
    float half = 0.5f * (float)s->cells, x = clamp((u + 1) * half, 0, (float)s->cells), y = clamp((v + 1) * half, 0, (float)s->cells);
    int i = least((int)x, s->cells - 1), j = least((int)y, s->cells - 1);
    float dx = x - (float)i, dy = y - (float)j, row[2];
    for (int k = 0; k < 2; k++) {
        float left = s->gx[j + k][i] * dx + s->gy[j + k][i] * (dy - (float)k) + s->gz[j + k][i];
        float right = s->gx[j + k][i + 1] * (dx - 1) + s->gy[j + k][i + 1] * (dy - (float)k) + s->gz[j + k][i + 1];
        row[k] = mix(left, right, fade(dx));
    }
    return mix(row[0], row[1], fade(dy));
}

static void draw(const struct splat_view *view, struct splat_tile *tile, const struct sprite *s, const struct foam_ends *ends,
                 const struct slice slices[DETAIL_OCTAVES], float amount)
{
    struct span span;
    if (!span_of(&tile->pixels, s, &span)) {
        return;
    }
    struct sprite_poly poly = sprite_poly_of(view, &tile->pixels, s);
    float across = view->orthographic ? s->radius : s->rho, per_x = 1 / (across * tile->pixels.fx), per_y = 1 / (across * tile->pixels.fy);
    for (int y = span.y0; y <= span.y1; y++) {
        for (int x = span.x0; x <= span.x1; x++) {
            float dx = (float)x + 0.5f - s->x, dy = (float)y + 0.5f - s->y, along, s2 = sprite_evaluate(&poly, dx, dy, &along), noise = 0;
            if (!(s2 > 0)) {
                continue;
            }
            for (int octave = 0; octave < DETAIL_OCTAVES; octave++) {
                noise += slices[octave].weight > 0 ? slices[octave].weight * noise_at(&slices[octave], dx * per_x, dy * per_y) : 0;
            }
            float root = sqrtf(s2), weight = 0.5f * s->weight * fmaxf(1 + amount * noise, 0);
            int at = y * TILE_STRIDE + x;
            tile->sums[0][at] += weight * fmaxf(fminf(along + root, ends->all[at]) - (along - root), 0);
            tile->sums[1][at] += weight * fmaxf(fminf(along + root, ends->front[at]) - (along - root), 0);
        }
    }
}

static void thickness(const struct splat_view *view, struct splat_tile *tile, size_t chunk, const struct foam_ends *ends, float amount)
{
    const struct particle_store *p = view->particles;
    for (size_t i = chunk * CHUNK_SIZE; i < sprite_chunk_end(view, chunk); i++) {
        struct sprite s = sprite_project(view, &tile->pixels, i);
        struct slice slices[DETAIL_OCTAVES];
        for (int octave = 0; octave < DETAIL_OCTAVES; octave++) {
            make_slice(&slices[octave], p->seed[i], octave, p->age ? p->age[i] : 0, sprite_size(view, &tile->pixels, &s));
        }
        draw(view, tile, &s, ends, slices, amount);
    }
}

/* Share of a ball's volume that is before depth. */
static float part_before(const struct sprite *s, float depth)
{
    float h = clamp((depth - s->q[2]) / s->radius, -1, 1);
    return 0.5f + 0.25f * h * (3 - h * h);
}

/* Chords, or with a falloff the smooth form. */
static void add_front(const struct splat_view *view, struct splat_tile *tile, struct sprite *s, float falloff, const float *limits)
{
    struct sprite_poly poly = sprite_poly_of(view, &tile->texels, s);
    float amount = s->weight;
    if (falloff > 0) {
        amount *= 2 * falloff * sqrtf(poly.k0);
        sprite_widen(s, falloff);
    }
    struct span span;
    if (!span_of(&tile->texels, s, &span)) {
        return;
    }
    for (int y = span.y0; y <= span.y1; y++) {
        for (int x = span.x0; x <= span.x1; x++) {
            float along, s2 = sprite_evaluate(&poly, (float)x + 0.5f - s->x, (float)y + 0.5f - s->y, &along), value;
            float limit = limits[(y + 1) * TILE_STRIDE + x + 1];
            if (falloff > 0) {
                float smooth = fmaxf(1 - falloff + falloff / poly.k0 * s2, 0);
                value = smooth * smooth * part_before(s, limit);
            } else {
                float root = sqrtf(fmaxf(s2, 0)), end = limit * ray_length2(view, &tile->texels, x, y);
                value = 0.5f * fmaxf(fminf(along + root, end) - (along - root), 0);
            }
            tile->sums[0][y * TILE_STRIDE + x] += amount * value;
        }
    }
}

static void deposit_front(const struct splat_view *view, struct splat_tile *tile, const struct sprite *s, const float *limits)
{
    if (!sprite_reaches(s->x, tile->texels.columns) || !sprite_reaches(s->y, tile->texels.rows)) {
        return;
    }
    float amount = sprite_amount(view, &tile->texels, s), x = floorf(s->x + 0.5f), y = floorf(s->y + 0.5f);
    float fx = s->x + 0.5f - x, fy = s->y + 0.5f - y, low = amount * (1 - fy), high = amount * fy;
    const float *above = limits + (int)y * TILE_STRIDE + (int)x, *below = above + TILE_STRIDE;
    float *cell = tile->cells[0] + (int)y * CELL_STRIDE + 4 * (int)x;
    cell[0] += low * (1 - fx) * part_before(s, above[0]);
    cell[1] += low * fx * part_before(s, above[1]);
    cell[2] += high * (1 - fx) * part_before(s, below[0]);
    cell[3] += high * fx * part_before(s, below[1]);
    tile->deposited = true;
}

static void front(const struct splat_view *view, struct splat_tile *tile, size_t chunk, const float *limits, float last)
{
    for (size_t i = chunk * CHUNK_SIZE; i < sprite_chunk_end(view, chunk); i++) {
        struct sprite s = sprite_project(view, &tile->texels, i);
        if (!(s.q[2] - s.radius < last)) {
            continue;
        }
        float size = sprite_size(view, &tile->texels, &s);
        enum sprite_form form = sprite_form_of(view, size);
        if (form == SPRITE_DEPOSIT) {
            deposit_front(view, tile, &s, limits);
        } else {
            add_front(view, tile, &s, form == SPRITE_SMOOTH ? sprite_falloff(size) : 0, limits);
        }
    }
}

const struct foam_kernels mns_foam_kernels_scalar = {.ends = ends, .limits = limits, .thickness = thickness, .front = front};
