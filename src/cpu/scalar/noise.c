/* noise.c: the kernel of stage noise in plain C: its definition. */
#include "cpu/noise.h"

#include "cpu/sprite.h"

/* One particle's splat in the units of the tile. */
struct splat {
    struct sprite ball;
    float gx, gy, per_reach; /* gx and gy of noise.h in a pixel; 1 / B */
    struct noise_octave octaves[NOISE_OCTAVES_MAX];
    int octave_count;
};

/* false: nothing of it is seen. */
static bool project(const struct noise_view *noise, const struct splat_grid *grid, size_t particle, struct splat *s)
{
    const struct splat_view *view = noise->view;
    const struct particle_store *store = view->particles;
    float q[3], reach = sprite_radius(view, particle), amplitude = store->noise ? store->noise[particle] : 1;
    sprite_center(view, particle, q);
    if (!view->orthographic) {
        amplitude *= noise_ramp(q[2], NOISE_CLOSE_END * reach, NOISE_CLOSE_BEGIN * reach);
    }
    if (!(amplitude > 0)) {
        return false;
    }
    s->ball = sprite_project(view, grid, particle);
    s->per_reach = 1 / reach;
    float per_z = view->orthographic ? 1 : 1 / q[2], across = grid->fx * per_z, down = grid->fy * per_z, cell = noise->cell * reach;
    s->gx = s->per_reach / across;
    s->gy = s->per_reach / down;
    s->octave_count =
        noise_octaves_of(noise, store->seed[particle], amplitude, fminf(across, down) * cell, 1 / (across * cell), s->octaves);
    return s->octave_count > 0;
}

/* Perlin's quintic, from 1 to 0. */
static float blend(float t) { return 1 - t * t * t * (t * (6 * t - 15) + 10); }

/* One octave of the noise at a place in the lattice. */
static float perlin(const struct noise_view *noise, float x, float y)
{
    float left = floorf(x), top = floorf(y), u = x - left, v = y - top, wu = blend(u), wv = blend(v), sum = 0;
    int column = (int)left & (NOISE_LATTICE - 1), row = (int)top & (NOISE_LATTICE - 1);
    for (int j = 0; j < 2; j++) {
        for (int i = 0; i < 2; i++) {
            int at = ((row + j) & (NOISE_LATTICE - 1)) * NOISE_LATTICE_STRIDE + column + i;
            float plane = noise->lattice[0][at] * (u - (float)i) + noise->lattice[1][at] * (v - (float)j);
            sum += (i ? 1 - wu : wu) * (j ? 1 - wv : wv) * plane;
        }
    }
    return sum;
}

static void add(const struct noise_view *noise, struct noise_tile *tile, const struct splat *s)
{
    const struct sprite *ball = &s->ball;
    int x0, x1, y0, y1;
    float aspect = tile->pixels.fx / tile->pixels.fy;
    sprite_span(ball->x_min, ball->x_max, tile->pixels.columns, &x0, &x1);
    sprite_span(ball->y_min, ball->y_max, tile->pixels.rows, &y0, &y1);
    for (int y = y0; y <= y1; y++) {
        for (int x = x0; x <= x1; x++) {
            float dx = (float)x + 0.5f - ball->x, dy = (float)y + 0.5f - ball->y, gx = dx * s->gx, gy = dy * s->gy;
            float e = (tile->depth[y * tile->stride + x] - ball->q[2]) * s->per_reach;
            float px = gx + e * (ball->a + ball->rho * gx), py = gy + e * (ball->b + ball->rho * gy), w = 1 - px * px - py * py - e * e;
            if (!(w > 0)) {
                continue;
            }
            float sum = 0;
            for (int i = 0; i < s->octave_count; i++) {
                const struct noise_octave *octave = &s->octaves[i];
                sum += octave->weight * perlin(noise, octave->x + dx * octave->per_pixel, octave->y + dy * octave->per_pixel * aspect);
            }
            tile->sums[y * TILE_STRIDE + x] += w * w * w * sum;
        }
    }
}

/* Whether there is surface where the splat may be, of its centre moved into the tile. */
static bool reaches(const struct noise_tile *tile, const struct splat *s)
{
    int x = (int)fminf(fmaxf(s->ball.x, 0), TILE_SIZE - 1) >> NOISE_BLOCK_SHIFT,
        y = (int)fminf(fmaxf(s->ball.y, 0), TILE_SIZE - 1) >> NOISE_BLOCK_SHIFT;
    return (tile->around.near[x][y] - s->ball.q[2]) * s->per_reach < 1 && (s->ball.q[2] - tile->around.far[x][y]) * s->per_reach < 1;
}

static void splat(const struct noise_view *noise, struct noise_tile *tile, size_t chunk)
{
    for (size_t i = chunk * CHUNK_SIZE; i < sprite_chunk_end(noise->view, chunk); i++) {
        struct splat s;
        if (project(noise, &tile->pixels, i, &s) && reaches(tile, &s)) {
            add(noise, tile, &s);
        }
    }
}

const struct noise_kernels mns_noise_kernels_scalar = {.splat = splat};
