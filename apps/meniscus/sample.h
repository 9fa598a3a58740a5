/* sample.h: procedural particle sets: shapes that place particles of any spacing, and where the particles go. */
#ifndef MENISCUS_SAMPLE_H
#define MENISCUS_SAMPLE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Takes particles. While counting it only counts; then it keeps exactly as many as are wanted, passing over some of those that lie inside
 * the fluid, where none is missed. */
struct sample_sink {
    bool counting;
    size_t inside, outside; /* counted so far: inside the fluid, and near its surface */
    size_t surplus, of;     /* when not counting: how many of the first `of` inside (or of all, if there are too few) are passed over */
    bool thin_all;          /* all are candidates, not only those inside */
    size_t seen, kept;
    float *position; /* [kept][3] */
    float *velocity; /* [kept][3] */
    float *density;  /* [kept] */
};

/* A particle. depth: metres below the surface, for its density. inside: may be passed over. */
void sample_put(struct sample_sink *sink, const double position[3], const double velocity[3], double density, bool inside);

/* Counts particles that need not be placed one by one. */
void sample_count(struct sample_sink *sink, size_t inside, size_t outside);

struct sample_shape {
    const char *name;
    const char *help;
    double volume;                                           /* m^3, about: where the search for the spacing starts */
    void (*place)(struct sample_sink *sink, double spacing); /* every particle, in an order that depends on spacing alone */
};

extern const struct sample_shape sample_shapes[]; /* ends with a shape without a name */

const struct sample_shape *sample_find(const char *name); /* NULL: there is none */

/* Exactly `count` particles of a shape, which sample_free gives back whatever came of it. Returns a status; a failure begins with `name`. */
int sample_fill(struct sample_sink *sink, const struct sample_shape *shape, size_t count, const char *name);
void sample_free(struct sample_sink *sink);

/* ---- for the shapes ---- */

/* A number in [0, 1) that depends on its arguments alone. */
double sample_hash(uint64_t a, uint64_t b, uint64_t c);

/* A ball of concentric shells. */
void sample_ball(struct sample_sink *sink, double spacing, const double center[3], double radius, const double velocity[3], uint64_t seed);

/* A body of water on the ground y = 0, over [low[0], high[0]] x [low[1], high[1]] in x and z, with its surface at height(x, z). */
struct sample_pool {
    double low[2], high[2];
    double (*height)(double x, double z);
    void (*velocity)(double x, double y, double z, double out[3]); /* m/s */
};
void sample_pool(struct sample_sink *sink, double spacing, const struct sample_pool *pool);

void sample_place_crown(struct sample_sink *sink, double spacing);

#endif
