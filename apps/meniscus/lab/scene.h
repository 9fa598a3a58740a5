/* scene.h: particle scenes whose surface is known in closed form.
 *
 * World space is view space: the eye at the origin looks down -z, y up. The unit of length is the particles' spacing, so that a particle's
 * radius is 1/2 and the splat radius R = radius_scale / 2.
 *
 * Particles stand on a lattice that follows the surface, some layers deep, every second layer shifted by half a spacing, and each is moved by
 * a little at random. The lattice is turned by 22.5 degrees against the picture: its own directions count neither as along the axes nor as
 * along the diagonals (measure.h: streaks). */
#ifndef MENISCUS_LAB_SCENE_H
#define MENISCUS_LAB_SCENE_H

#include <meniscus/meniscus.h>

#include <stdbool.h>
#include <stddef.h>

/* A pinhole whose pixels are square. */
struct lab_view {
    int width, height;
    double focal;  /* pixels */
    double cx, cy; /* where the view axis meets the picture, pixels */
};

/* 30 degrees from bottom to top: the angle under which a tilted plane is seen changes little over the picture. */
struct lab_view lab_view_make(int width, int height);

/* The same with the picture moved by so many pixels to the right and down. */
struct lab_view lab_view_shift(const struct lab_view *view, double right, double down);

/* What the renderer takes for it. */
mns_result lab_view_camera(const struct lab_view *view, struct mns_camera *out);

/* The direction through the centre of pixel (x, y), scaled so that one of it is one of depth. */
void lab_view_ray(const struct lab_view *view, int x, int y, double out[3]);

enum lab_shape {
    LAB_PLANE,  /* w <= 0 in the body's frame */
    LAB_SPHERE, /* about origin */
    LAB_BLOCK,  /* w <= 0 and u <= 0: a plane that ends at an edge */
    LAB_WAVES   /* w <= a sum of sines of u and v */
};

/* A body of fluid. */
struct lab_body {
    enum lab_shape shape;
    double origin[3];
    double u[3], v[3], w[3]; /* unit, right-handed; w points out of the fluid */
    double radius;           /* of a sphere */
};

/* What a scene can tell: measures that mean something there (measure.h). */
enum lab_tells {
    LAB_TELLS_BUMPS = 1,   /* a large smooth surface: bumpiness, streaks */
    LAB_TELLS_EDGE = 2,    /* a silhouette: its shift */
    LAB_TELLS_BESIDE = 4,  /* a surface beside the silhouette */
    LAB_TELLS_RIM = 8,     /* a sphere's rim */
    LAB_TELLS_FLICKER = 16 /* worth its time there */
};

enum { LAB_BODIES = 2 };

struct lab_scene {
    const char *name;
    const char *text;
    unsigned tells; /* enum lab_tells, or-ed */
    struct lab_body body[LAB_BODIES];
    int bodies;       /* body 0 is behind, body 1 before it */
    double distance;  /* depth of the middle */
    double depths[2]; /* what is measured lies between; fluid reaches further */
};

/* How far a body's surface is moved outwards from its particles' centres, spacings. */
struct lab_offsets {
    double body[LAB_BODIES];
};

/* Where a ray meets the fluid. */
struct lab_hit {
    int body;     /* -1: none */
    double depth; /* INFINITY: none */
    double normal[3];
    double cosine; /* -normal * ray: what a depth error shrinks to across the surface */
};

/* The scenes by index; NULL behind the last. */
const char *lab_scene_name(int index);
const char *lab_scene_text(int index);
int lab_scene_count(void);
int lab_scene_find(const char *name); /* -1: none */

enum { LAB_SPACING_PIXELS = 10 /* R is 6 pixels, as in a picture of a million particles */ };

/* Smaller pictures do not hold the drop, which stands before its plane by more than any filter's range. */
enum { LAB_WIDTH_MIN = 320, LAB_HEIGHT_MIN = 240 };

/* The scene for a view: a spacing spans LAB_SPACING_PIXELS in the middle (twice and half of that in the nearest and the farthest), whatever the
 * picture's size. */
void lab_scene_make(struct lab_scene *out, int index, const struct lab_view *view);

/* The true surface along a ray (lab_view_ray). */
struct lab_hit lab_body_hit(const struct lab_body *body, const double ray[3], double offset);
struct lab_hit lab_scene_hit(const struct lab_scene *scene, const double ray[3], const struct lab_offsets *offsets);

/* How far, in pixels, a pixel stands inside the foremost body's silhouette; negative: outside. INFINITY where the scene has none. */
double lab_scene_silhouette(const struct lab_scene *scene, const struct lab_view *view, int x, int y, const struct lab_offsets *offsets);

/* Height of the waves and its derivatives along u and v: out[3]. */
void lab_waves(double u, double v, double out[3]);

/* Particles, which the caller frees. */
struct lab_cloud {
    float (*position)[3];
    size_t count, capacity;
    bool failed; /* out of memory */
};
void lab_scene_particles(const struct lab_scene *scene, const struct lab_view *view, struct lab_cloud *out);
void lab_cloud_free(struct lab_cloud *cloud);

#endif
