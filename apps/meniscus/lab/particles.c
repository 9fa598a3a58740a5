/* particles.c: the particles of a scene: lattices that follow the surfaces, moved a little at random. */
#include "scene.h"

#include "vector.h"

#include <stdint.h>
#include <stdlib.h>

/* Layers below which no ray gets. Flat ones are shifted by half against each other; shells have no such order. */
enum { LAYERS = 4, SHELLS = 8 };

/* Most that a particle is moved, spacings: along the surface and across it. An SPH fluid's surface is about as uneven. */
static const double JITTER_ALONG = 0.15, JITTER_ACROSS = 0.1;

static const double TURN = 22.5;                 /* degrees: scene.h */
static const double NEARER = 0.8, FARTHER = 1.2; /* fluid reaches beyond what is measured by so much */
static const double MARGIN = 4;                  /* spacings of fluid beyond the picture's edges */

static void put(struct lab_cloud *cloud, const double position[3])
{
    if (cloud->count == cloud->capacity) {
        size_t capacity = cloud->capacity ? 2 * cloud->capacity : 4096;
        float(*grown)[3] = realloc(cloud->position, capacity * sizeof(*grown));
        if (!grown) {
            cloud->failed = true;
            return;
        }
        cloud->position = grown;
        cloud->capacity = capacity;
    }
    for (int k = 0; k < 3; k++) {
        cloud->position[cloud->count][k] = (float)position[k];
    }
    cloud->count++;
}

void lab_cloud_free(struct lab_cloud *cloud)
{
    free(cloud->position);
    *cloud = (struct lab_cloud){0};
}

/* Uniform in [-1, 1), by the number of a particle's layer and its place there alone. */
static double noise(int64_t i, int64_t j, int64_t layer, uint64_t which)
{
    uint64_t x = (uint64_t)i * 0x9e3779b97f4a7c15u ^ (uint64_t)j * 0xbf58476d1ce4e5b9u ^ (uint64_t)(4 * layer) * 0x94d049bb133111ebu;
    x += which * 0xd6e8feb86659fd93u;
    x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9u; /* the finisher of SplitMix64 */
    x = (x ^ x >> 27) * 0x94d049bb133111ebu;
    return (double)((x ^ x >> 31) >> 11) * 0x1p-52 - 1;
}

static bool is_seen(const struct lab_scene *scene, const struct lab_view *view, const double position[3])
{
    double depth = -position[2];
    return depth > NEARER * scene->depths[0] && depth < FARTHER * scene->depths[1] &&
           fabs(position[0]) < depth * 0.5 * view->width / view->focal + MARGIN &&
           fabs(position[1]) < depth * 0.5 * view->height / view->focal + MARGIN;
}

/* Place (i, j) of a layer of a plane, a block or waves. */
static void put_flat(struct lab_cloud *cloud, const struct lab_scene *scene, const struct lab_view *view, const struct lab_body *body,
                     int i, int j, int layer)
{
    double c = cos(radians(TURN)), s = sin(radians(TURN)), half = layer % 2 ? 0.5 : 0;
    double a = i + half + JITTER_ALONG * noise(i, j, layer, 1), b = j + half + JITTER_ALONG * noise(i, j, layer, 2);
    double u = c * a - s * b, v = s * a + c * b, wave[3] = {0};
    if (body->shape == LAB_BLOCK && u > 0) {
        return;
    }
    if (body->shape == LAB_WAVES) {
        lab_waves(u, v, wave);
    }
    double position[3];
    add_scaled(position, body->origin, u, body->u);
    add_scaled(position, position, v, body->v);
    add_scaled(position, position, wave[0] - layer + JITTER_ACROSS * noise(i, j, layer, 3), body->w);
    if (is_seen(scene, view, position)) {
        put(cloud, position);
    }
}

static void place_flat(struct lab_cloud *cloud, const struct lab_scene *scene, const struct lab_view *view, const struct lab_body *body)
{
    double depth = FARTHER * scene->depths[1];
    int reach = (int)(depth * (1 + 0.5 * hypot(view->width, view->height) / view->focal) + 2 * MARGIN);
    for (int layer = 0; layer < LAYERS; layer++) {
        for (int j = -reach; j <= reach; j++) {
            for (int i = -reach; i <= reach; i++) {
                put_flat(cloud, scene, view, body, i, j, layer);
            }
        }
    }
}

/* Shells, on each of which the particles follow a Fibonacci spiral: as many on equal areas. */
static void place_sphere(struct lab_cloud *cloud, const struct lab_body *body)
{
    static const double golden = 2.39996322972865332; /* radians: pi (3 - sqrt 5) */
    for (int layer = 0; layer < SHELLS && layer < body->radius; layer++) {
        double radius = body->radius - layer;
        int count = (int)(4 * LAB_PI * radius * radius + 0.5);
        for (int i = 0; i < count; i++) {
            double high = 1 - 2 * (i + 0.5) / count, across = sqrt(1 - high * high), turn = golden * i + layer;
            double away = radius + JITTER_ACROSS * noise(i, 0, layer, 3);
            double place[3] = {across * cos(turn), across * sin(turn), high}, position[3];
            for (int k = 0; k < 3; k++) {
                place[k] += JITTER_ALONG / radius * noise(i, 0, layer, 4 + (uint64_t)k);
            }
            normalise(place);
            /* The spiral's poles lie in the picture's plane, one of them aside. */
            add_scaled(position, body->origin, away * place[2], body->u);
            add_scaled(position, position, away * place[0], body->v);
            add_scaled(position, position, away * place[1], body->w);
            put(cloud, position);
        }
    }
}

void lab_scene_particles(const struct lab_scene *scene, const struct lab_view *view, struct lab_cloud *out)
{
    *out = (struct lab_cloud){0};
    for (int i = 0; i < scene->bodies; i++) {
        if (scene->body[i].shape == LAB_SPHERE) {
            place_sphere(out, &scene->body[i]);
        } else {
            place_flat(out, scene, view, &scene->body[i]);
        }
    }
}
