/* sample_crown.c: the crown that a drop throws up when it falls into a pool: a bowl, a wall that leans out, a thick rim that breaks into
 * jets, and droplets from them. Metres; the drop fell on (0, 0) of the x-z plane. */
#include "sample.h"

#include <math.h>
#include <string.h>

static const double PI = 3.14159265358979323846;

static const double DEPTH = 0.34; /* of the pool at rest */
static const double BOWL = 0.50;  /* radius of the bowl */
static const double BOWL_DEPTH = 0.25;
static const double WALL = 0.52;        /* radius of the wall's foot */
static const double WALL_HEIGHT = 0.45; /* without the scallops */
static const double LEAN = 0.21;        /* how far the rim stands outside the foot */

enum { JETS = 23, SHED = 3 /* droplets on a jet's line at most */, SPRAY = 520 };

static const double CLOSED = 0.82; /* spacings between the particles of a sheet or a thread one particle thick, so that it has no holes */

static const double ACROSS[2][2] = {{-1.25, -1.0}, {1.25, 1.0}};

static double ramp(double from, double to, double x)
{
    x = fmin(fmax((x - from) / (to - from), 0), 1);
    return x * x * (3 - 2 * x);
}

static double pool_height(double x, double z)
{
    double r = hypot(x, z), u = r / BOWL, bowl = u < 1 ? (1 - u * u) * (1 - u * u) : 0;
    double swell = (r - WALL) / 0.11;
    double ring = 0.020 * exp(-(r - WALL) / 0.42) * ramp(0.60, 0.78, r) * cos(2 * PI * (r - 0.62) / 0.19);
    double calm = 0.0030 * sin(7.1 * x + 3.3 * z + 0.4) + 0.0024 * sin(-4.2 * x + 8.9 * z + 2.0) + 0.0013 * sin(15.3 * x - 11.2 * z);
    return DEPTH - BOWL_DEPTH * bowl + 0.085 * exp(-swell * swell) + ring + calm * ramp(0.3, 0.9, r);
}

static void pool_velocity(double x, double y, double z, double out[3])
{
    double r = hypot(x, z), near = exp(-(r - WALL) * (r - WALL) / 0.05), outward = r > 1e-9 ? 1.1 * near / r : 0;
    out[0] = outward * x;
    out[1] = near * 0.9 * y / DEPTH;
    out[2] = outward * z;
}

/* ---- the jets: where they stand on the rim and how large they are ---- */

struct jet {
    double angle;        /* radians */
    double length;       /* metres beyond the rim */
    double radius, bulb; /* metres, at its foot and of its end */
};

static struct jet jet_at(uint64_t i)
{
    struct jet jet = {.angle = 2 * PI * ((double)i + 0.55 * (sample_hash(i, 7, 1) - 0.5)) / JETS};
    double size = sample_hash(i, 7, 2);
    jet.length = 0.04 + 0.22 * size * size;
    jet.radius = 0.020 + 0.012 * sample_hash(i, 7, 3);
    jet.bulb = jet.radius * (0.95 + 0.45 * sample_hash(i, 7, 4));
    return jet;
}

/* How much the rim is pulled up at an angle: highest at the jets, hanging between them. 0 to 1. */
static double scallop(double angle)
{
    double pull = 0;
    for (uint64_t i = 0; i < JETS; i++) {
        struct jet jet = jet_at(i);
        double away = remainder(angle - jet.angle, 2 * PI) / (0.42 * PI / JETS);
        pull = fmax(pull, (0.5 + 2.2 * jet.length) * exp(-fabs(away)));
    }
    return pull;
}

/* ---- the wall ---- */

/* A place on the wall: v metres up, before it leans out. */
static void wall_at(double angle, double v, double out[3])
{
    double u = v / WALL_HEIGHT, r = WALL + LEAN * pow(fmax(u, 0), 1.7);
    out[0] = r * cos(angle);
    out[1] = DEPTH + 0.03 + v;
    out[2] = r * sin(angle);
}

/* The direction of flight there, of unit length. */
static void wall_direction(double angle, double v, double out[3])
{
    double slope = 1.7 * LEAN / WALL_HEIGHT * pow(fmax(v / WALL_HEIGHT, 0), 0.7), length = hypot(slope, 1);
    out[0] = slope / length * cos(angle);
    out[1] = 1 / length;
    out[2] = slope / length * sin(angle);
}

static double rim_height(double angle)
{
    return WALL_HEIGHT * (0.86 + 0.05 * sin(angle + 0.7) + 0.03 * sin(2 * angle + 2.1)) + 0.10 * scallop(angle);
}

static void put_wall(struct sample_sink *sink, double spacing, const double *rims, size_t rim_count)
{
    double step = CLOSED * spacing;
    size_t rows = (size_t)round(1.35 * WALL_HEIGHT / step);
    for (size_t row = 0; row < rows; row++) {
        double v = ((double)row + 0.5) * step, u = v / WALL_HEIGHT;
        double thickness = 0.055 * exp(-2.2 * u) + 0.021, foot[3], direction[3];
        wall_at(0, v, foot);
        size_t around = (size_t)fmax(1, round(2 * PI * foot[0] / step)), layers = (size_t)fmax(1, round(thickness / spacing));
        double phase = sample_hash(row, 11, 1);
        for (size_t i = 0; i < around; i++) {
            double angle = 2 * PI * ((double)i + phase + 0.2 * (sample_hash(row, i, 12) - 0.5)) / (double)around;
            double turn = angle / (2 * PI), rim = rims[(size_t)((turn - floor(turn)) * (double)rim_count) % rim_count];
            double place[3];
            wall_at(angle, v + 0.2 * spacing * (sample_hash(row, i, 13) - 0.5), place);
            if (v > rim || place[1] < pool_height(place[0], place[2]) + 0.3 * spacing) {
                continue;
            }
            wall_direction(angle, v, direction);
            double across = hypot(direction[0], direction[2]), speed = 1.2 + 1.6 * u;
            double velocity[3] = {speed * direction[0], speed * direction[1], speed * direction[2]};
            for (size_t layer = 0; layer < layers; layer++) {
                double offset = thickness * (((double)layer + 0.5) / (double)layers - 0.5); /* outward, across the sheet */
                double position[3] = {place[0] + offset * direction[1] * cos(angle), place[1] - offset * across,
                                      place[2] + offset * direction[1] * sin(angle)};
                sample_put(sink, position, velocity, layers == 1 ? 500 : 640, false);
            }
        }
    }
}

/* A round slice of a tube: rings about a centre, in the plane across the direction. */
static void put_slice(struct sample_sink *sink, double spacing, const double center[3], const double direction[3], double radius,
                      const double velocity[3], uint64_t seed)
{
    double side[3] = {direction[1], -direction[0], 0}, length = hypot(side[0], side[1]), up[3];
    if (length < 1e-6) {
        side[0] = length = 1;
        side[1] = 0;
    }
    side[0] /= length;
    side[1] /= length;
    up[0] = direction[1] * side[2] - direction[2] * side[1];
    up[1] = direction[2] * side[0] - direction[0] * side[2];
    up[2] = direction[0] * side[1] - direction[1] * side[0];
    size_t rings = (size_t)fmax(1, round(radius / spacing));
    for (size_t k = 0; k < rings; k++) {
        double unit = radius / (double)rings, ring = ((double)k + 0.5) * unit, area = PI * unit * unit * (2 * (double)k + 1);
        size_t count = (size_t)fmax(k == 0, round(area / (spacing * spacing)));
        double phase = 2 * PI * sample_hash(seed, k, 21);
        for (size_t i = 0; i < count; i++) {
            double angle = phase + 2 * PI * (double)i / (double)count, c = count > 1 ? ring * cos(angle) : 0,
                   s = count > 1 ? ring * sin(angle) : 0;
            double position[3] = {center[0] + c * side[0] + s * up[0], center[1] + c * side[1] + s * up[1],
                                  center[2] + c * side[2] + s * up[2]};
            sample_put(sink, position, velocity, count > 1 ? 640 : 420, false);
        }
    }
}

static void put_rim(struct sample_sink *sink, double spacing)
{
    size_t steps = (size_t)round(2 * PI * (WALL + LEAN) * 1.25 / (CLOSED * spacing)); /* it winds up and down */
    for (size_t i = 0; i < steps; i++) {
        double angle = 2 * PI * (double)i / (double)steps, next = angle + 1e-3, center[3], ahead[3], along[3], velocity[3], length = 0;
        wall_at(angle, rim_height(angle), center);
        wall_at(next, rim_height(next), ahead);
        for (int k = 0; k < 3; k++) {
            along[k] = ahead[k] - center[k];
            length += along[k] * along[k];
        }
        for (int k = 0; k < 3; k++) {
            along[k] /= sqrt(length);
        }
        wall_direction(angle, rim_height(angle), velocity);
        for (int k = 0; k < 3; k++) {
            velocity[k] *= 2.6;
        }
        put_slice(sink, spacing, center, along, 0.019 + 0.004 * sin(9 * angle + 1) + 0.006 * scallop(angle), velocity, i);
    }
}

static void add_scaled(double out[3], const double a[3], const double b[3], double scale)
{
    for (int k = 0; k < 3; k++) {
        out[k] = a[k] + scale * b[k];
    }
}

static void put_jet(struct sample_sink *sink, double spacing, uint64_t i)
{
    static const double nowhere[3] = {0, 0, 0};
    struct jet jet = jet_at(i);
    double foot[3], direction[3], velocity[3], place[3];
    wall_at(jet.angle, rim_height(jet.angle), foot);
    wall_direction(jet.angle, rim_height(jet.angle), direction);
    add_scaled(velocity, nowhere, direction, 2.9);
    size_t steps = (size_t)round(jet.length / (CLOSED * spacing));
    for (size_t k = 0; k < steps; k++) { /* a neck behind the bulb */
        double u = ((double)k + 0.5) / (double)steps;
        add_scaled(place, foot, direction, u * jet.length);
        put_slice(sink, spacing, place, direction, jet.radius * (1 - 0.62 * u), velocity, 1000 * i + k);
    }
    add_scaled(place, foot, direction, jet.length + 0.6 * jet.bulb);
    sample_ball(sink, spacing, place, jet.bulb, velocity, 5000 + i);
    double away = jet.length + jet.bulb;
    for (uint64_t k = 0; k < SHED && sample_hash(i, k, 31) < 0.75; k++) { /* drops that came off before, slower and slower downwards */
        double radius = jet.bulb * (0.35 + 0.55 * sample_hash(i, k, 32));
        away += 0.045 + 0.10 * sample_hash(i, k, 33);
        add_scaled(place, foot, direction, away);
        place[0] += 0.03 * (sample_hash(i, k, 34) - 0.5);
        place[1] -= 0.25 * away * away;
        place[2] += 0.03 * (sample_hash(i, k, 35) - 0.5);
        sample_ball(sink, spacing, place, radius, velocity, 6000 + SHED * i + k);
    }
}

/* Droplets about the crown. Sizes as ligaments break: a Gamma distribution, here a sum of three exponentials. */
static void put_spray(struct sample_sink *sink, double spacing)
{
    for (uint64_t i = 0; i < SPRAY; i++) {
        double gamma = -log((1 - sample_hash(i, 41, 1)) * (1 - sample_hash(i, 41, 2)) * (1 - sample_hash(i, 41, 3)));
        double radius = fmin(0.0030 * gamma, 0.026), flight = sample_hash(i, 41, 4);
        struct jet jet = jet_at((uint64_t)(sample_hash(i, 41, 5) * JETS) % JETS);
        double angle = jet.angle + 0.16 * (sample_hash(i, 41, 6) + sample_hash(i, 41, 7) - 1);
        double r = WALL + LEAN + 0.05 + 0.46 * flight * sqrt(sample_hash(i, 41, 8)) - 0.12 * sample_hash(i, 41, 9);
        double top = DEPTH + WALL_HEIGHT + 0.06 + 0.42 * flight * (1 - 0.75 * flight); /* a parabola, seen by many */
        double y = DEPTH + 0.1 + (top - DEPTH - 0.1) * sqrt(sample_hash(i, 41, 10)) + 0.05 * sample_hash(i, 41, 11);
        double position[3] = {r * cos(angle), y, r * sin(angle)};
        double velocity[3] = {1.5 * cos(angle), 3 * (0.5 - flight), 1.5 * sin(angle)};
        bool beyond = fabs(position[0]) > ACROSS[1][0] - radius || fabs(position[2]) > ACROSS[1][1] - radius;
        if (!beyond && y - radius > pool_height(position[0], position[2]) + spacing) {
            sample_ball(sink, spacing, position, radius, velocity, 8000 + i);
        }
    }
}

void sample_place_crown(struct sample_sink *sink, double spacing)
{
    const struct sample_pool pool = {{ACROSS[0][0], ACROSS[0][1]}, {ACROSS[1][0], ACROSS[1][1]}, pool_height, pool_velocity};
    double rims[2048];
    enum { RIMS = sizeof(rims) / sizeof(rims[0]) };
    for (size_t i = 0; i < RIMS; i++) {
        rims[i] = rim_height(2 * PI * ((double)i + 0.5) / RIMS);
    }
    sample_pool(sink, spacing, &pool);
    put_wall(sink, spacing, rims, RIMS);
    put_rim(sink, spacing);
    for (uint64_t i = 0; i < JETS; i++) {
        put_jet(sink, spacing, i);
    }
    put_spray(sink, spacing);
}
