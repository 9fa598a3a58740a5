/* sample_shapes.c: balls, bodies of water, and the simple sets made of them. Particles lie in layers along the surface, as they do in a
 * simulation at rest, and away from it on a lattice that is bent and shaken, so that no rows are seen. */
#include "sample.h"

#include <math.h>
#include <string.h>

static const double PI = 3.14159265358979323846;

enum { TOP_LAYERS = 4 }; /* layers that follow the surface at exactly the spacing; those below share what height is left */

/* What an SPH sum gives, kg/m^3: low in the outermost layers; 255 for a particle alone (cubic spline). */
static double density_at(size_t layer, uint64_t a, uint64_t b, uint64_t c)
{
    return (layer == 0 ? 650 : layer == 1 ? 930 : 1000) + 8 * (sample_hash(a, b, c) - 0.5);
}

void sample_ball(struct sample_sink *sink, double spacing, const double center[3], double radius, const double velocity[3], uint64_t seed)
{
    static const double golden_angle = 2.39996322972865332;
    size_t shells = (size_t)fmax(1, round(radius / spacing));
    for (size_t k = 0; k < shells; k++) {
        double unit = radius / (double)shells, inner = (double)k * unit, outer = inner + unit, middle = inner + 0.5 * unit;
        double share = 4 * PI / 3 * (outer * outer * outer - inner * inner * inner) / (spacing * spacing * spacing);
        size_t count = (size_t)round(share);
        middle *= shells == 1 ? 0.8 : 1; /* few particles: drawn together, as surface tension does */
        bool inside = k + 1 < shells;
        if (sink->counting) {
            sample_count(sink, inside ? count : 0, inside ? 0 : count);
            continue;
        }
        double phase = 2 * PI * sample_hash(seed, k, 1), tilt = PI * sample_hash(seed, k, 2), c = cos(tilt), s = sin(tilt);
        for (size_t i = 0; i < count; i++) { /* a Fibonacci spiral, turned so that the shells do not line up */
            double z = count > 1 ? 1 - (2 * (double)i + 1) / (double)count : 0, around = count > 1 ? sqrt(1 - z * z) : 0;
            double angle = phase + golden_angle * (double)i, x = around * cos(angle), y = around * sin(angle);
            double position[3] = {center[0] + middle * x, center[1] + middle * (c * y - s * z), center[2] + middle * (s * y + c * z)};
            bool alone = shells == 1 && count == 1;
            sample_put(sink, position, velocity, alone ? 255 : density_at(shells - 1 - k, seed, k, i), inside);
        }
    }
}

/* How far the lattice is bent at a place, in spacings: two shear waves whose lengths share no multiple with it. */
static double bend(double along, double across) { return 0.35 * sin(2 * PI * along / 8.3) + 0.25 * sin(2 * PI * (along + across) / 13.7); }

static double smooth_step(double x)
{
    x = fmin(fmax(x, 0), 1);
    return x * x * (3 - 2 * x);
}

/* One lattice coordinate of a pool, bent and shaken but for the layers along the walls. */
static double shaken(double low, double cell, double cells, double index, double displacement)
{
    double to_wall = fmin(index, cells - 1 - index); /* in spacings, from the layer at the wall */
    return low + cell * (index + 0.5 + displacement * smooth_step(to_wall / 4));
}

/* The column (i, k) of n layers, of which `outside` are near the surface. */
static void put_column(struct sample_sink *sink, double spacing, const struct sample_pool *pool, const double cells[2], size_t i, size_t k,
                       size_t n, size_t outside)
{
    double cell[2] = {(pool->high[0] - pool->low[0]) / cells[0], (pool->high[1] - pool->low[1]) / cells[1]};
    size_t top = n < TOP_LAYERS ? n : TOP_LAYERS;
    double deep_height = 0;
    for (size_t layer = 0; layer < n; layer++) { /* from the surface down */
        uint64_t place = (uint64_t)i << 32 | k;
        double x = (double)i, z = (double)k, l = (double)layer;
        double dx = bend(z + 2.3 * l, x) + 0.2 * (sample_hash(place, layer, 1) - 0.5);
        double dz = bend(x + 3.1 * l + 40, -z) + 0.2 * (sample_hash(place, layer, 2) - 0.5);
        double position[3] = {shaken(pool->low[0], cell[0], cells[0], x, dx), 0, shaken(pool->low[1], cell[1], cells[1], z, dz)};
        double dy = sample_hash(place, layer, 3) - 0.5, velocity[3];
        if (layer < top) {
            double height = pool->height(position[0], position[2]), step = n > top ? spacing : height / (double)n;
            position[1] = height - step * (l + 0.5 + (layer == 0 ? 0.04 : 0.15) * dy);
            deep_height = height - step * (double)top;
        } else {
            double step = deep_height / (double)(n - top);
            position[1] = deep_height - step * (l - (double)top + 0.5 + (layer + 1 == n ? 0.04 : 0.2) * dy);
        }
        pool->velocity(position[0], position[1], position[2], velocity);
        sample_put(sink, position, velocity, density_at(layer, place, layer, 4), layer >= outside);
    }
}

void sample_pool(struct sample_sink *sink, double spacing, const struct sample_pool *pool)
{
    double cells[2];
    for (int axis = 0; axis < 2; axis++) {
        cells[axis] = fmax(1, round((pool->high[axis] - pool->low[axis]) / spacing));
    }
    for (size_t i = 0; i < (size_t)cells[0]; i++) {
        for (size_t k = 0; k < (size_t)cells[1]; k++) {
            double x = pool->low[0] + (pool->high[0] - pool->low[0]) * ((double)i + 0.5) / cells[0];
            double z = pool->low[1] + (pool->high[1] - pool->low[1]) * ((double)k + 0.5) / cells[1];
            double to_wall = fmin(fmin((double)i, cells[0] - 1 - (double)i), fmin((double)k, cells[1] - 1 - (double)k));
            size_t n = (size_t)fmax(1, round(pool->height(x, z) / spacing));
            size_t outside = to_wall < TOP_LAYERS || n < TOP_LAYERS ? n : TOP_LAYERS;
            if (sink->counting) {
                sample_count(sink, n - outside, outside);
            } else {
                put_column(sink, spacing, pool, cells, i, k, n, outside);
            }
        }
    }
}

/* ---- the simple sets ---- */

static void at_rest(double x, double y, double z, double out[3])
{
    (void)x;
    (void)y;
    (void)z;
    out[0] = out[1] = out[2] = 0;
}

static double block_height(double x, double z)
{
    (void)x;
    (void)z;
    return 1;
}

static void place_block(struct sample_sink *sink, double spacing)
{
    static const struct sample_pool block = {{-0.5, -0.5}, {0.5, 0.5}, block_height, at_rest};
    sample_pool(sink, spacing, &block);
}

static void place_sphere(struct sample_sink *sink, double spacing)
{
    static const double center[3] = {0, 0.5, 0}, velocity[3] = {0, 0, 0};
    sample_ball(sink, spacing, center, 0.5, velocity, 1);
}

static double wall_height(double x, double z)
{
    (void)x;
    (void)z;
    return 1.4;
}

static void place_drop(struct sample_sink *sink, double spacing)
{
    static const struct sample_pool wall = {{-1.1, -0.55}, {1.1, -0.2}, wall_height, at_rest};
    static const double center[3] = {0.05, 0.75, 0.7}, velocity[3] = {0, 0, -2};
    sample_pool(sink, spacing, &wall);
    sample_ball(sink, spacing, center, 0.3, velocity, 1);
}

/* Deep-water waves: height amplitude, wave vector, phase. Angular frequency: sqrt(g |k|). */
static const struct {
    double amplitude, kx, kz, phase;
} waves[] = {{0.060, 4.1, 1.3, 0.3}, {0.034, 6.3, -3.9, 1.9}, {0.020, -3.2, 9.4, 4.1}, {0.011, 14.1, 6.7, 2.6}, {0.006, 9.0, -21.0, 5.2}};

enum { WAVES = sizeof(waves) / sizeof(waves[0]) };

static const double WAVES_DEPTH = 0.45, GRAVITY = 9.81;

static double waves_height(double x, double z)
{
    double height = WAVES_DEPTH;
    for (int i = 0; i < WAVES; i++) {
        height += waves[i].amplitude * cos(waves[i].kx * x + waves[i].kz * z + waves[i].phase);
    }
    return height;
}

static void waves_velocity(double x, double y, double z, double out[3])
{
    memset(out, 0, 3 * sizeof(*out));
    for (int i = 0; i < WAVES; i++) {
        double k = hypot(waves[i].kx, waves[i].kz), phase = waves[i].kx * x + waves[i].kz * z + waves[i].phase;
        double speed = waves[i].amplitude * sqrt(GRAVITY * k) * exp(k * (y - WAVES_DEPTH));
        out[0] += speed * cos(phase) * waves[i].kx / k;
        out[1] += speed * sin(phase);
        out[2] += speed * cos(phase) * waves[i].kz / k;
    }
}

static void place_waves(struct sample_sink *sink, double spacing)
{
    static const struct sample_pool pool = {{-1.6, -1.1}, {1.6, 1.1}, waves_height, waves_velocity};
    sample_pool(sink, spacing, &pool);
}

const struct sample_shape sample_shapes[] = {
    {"crown", "a crown splash in a pool: bowl, wall, jets, droplets, ripples", 1.7, sample_place_crown},
    {"drop", "a drop before a wall of water", 1.2, place_drop},
    {"waves", "a wavy pool", 3.2, place_waves},
    {"block", "a block of water, 1 m on each side, at rest", 1, place_block},
    {"sphere", "one drop of 1 m across; one particle for N = 1", 0.52, place_sphere},
    {NULL, NULL, 0, NULL},
};
