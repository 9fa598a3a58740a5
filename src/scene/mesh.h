/* mesh.h: one mesh file in memory. */
#ifndef MNS_SCENE_MESH_H
#define MNS_SCENE_MESH_H

#include "scene/texture.h"

#include <meniscus/scene.h>

#include <stdint.h>

struct material {
    float color[3]; /* linear; times the texture's and the vertices' */
    int texture;    /* index, or -1 */
};

/* Triangles of a file in world space, relative to an origin so that float is enough. */
struct mesh {
    double origin[3];
    float bounds_min[3], bounds_max[3]; /* relative to it */
    size_t vertex_count, triangle_count, material_count, texture_count;
    float *position;       /* [vertex_count + 1][3]; the last one is padding that Embree reads */
    float *normal;         /* [vertex_count][3], unit */
    float *uv;             /* [vertex_count][2]; NULL: no textures */
    float *color;          /* [vertex_count][3], linear; NULL: white */
    uint32_t *triangle;    /* [triangle_count][3] */
    uint32_t *material_of; /* [triangle_count] */
    struct material *materials;
    struct texture *textures;
};

/* params: all fields known. On failure *out is empty. */
mns_result mns_mesh_read(struct mesh *out, const char *path, const struct mns_mesh_params *params, struct mns_message *message);
void mns_mesh_free(struct mesh *mesh);

#endif
