/* meniscus/scene.h: what stands around the fluid: environments from files, and opaque meshes, drawn by ray casting into the renderer's own sky and on its floor.
 *
 *     mns_meshes_create -> mns_meshes_read (each file) -> mns_renderer_light -> mns_meshes_draw -> frame.objects -> mns_renderer_draw
 *
 * In meniscus::scene, a library of its own, which needs Assimp and Embree 3 when it is built: without them every call but destroy returns
 * MNS_ERR_UNSUPPORTED and says what to install. Memory comes from the C library. */
#ifndef MENISCUS_SCENE_H
#define MENISCUS_SCENE_H

#include <meniscus/renderer.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct mns_meshes mns_meshes; /* opaque; one thread at a time */

struct mns_meshes_params {
    size_t struct_size;           /* set by mns_meshes_params_init */
    int threads;                  /* 1 to 1024; 0 (default): as many as this process may use */
    struct mns_parallel parallel; /* default: threads of its own; kept until destroy */
    int occlusion;                /* 0 or 1 (default): corners and undersides see less of the sky */
    double occlusion_distance;    /* metres beyond which nothing hides the sky; 0 (default): a fifth of the meshes' diagonal */
};
MNS_API void mns_meshes_params_init_sized(struct mns_meshes_params *params, size_t size);
static inline void mns_meshes_params_init(struct mns_meshes_params *params) { mns_meshes_params_init_sized(params, sizeof(*params)); }

/* params NULL: all defaults. On success the caller owns *out; on failure *out is NULL and message (may be NULL) says why. */
MNS_API mns_result mns_meshes_create(mns_meshes **out, const struct mns_meshes_params *params, struct mns_message *message);
MNS_API void mns_meshes_destroy(mns_meshes **meshes); /* sets *meshes to NULL; NULL is fine */

struct mns_mesh_params {
    size_t struct_size; /* set by mns_mesh_params_init */
    int container;      /* 0 (default) or 1: a tank: only its far faces are drawn, as seen about its middle, and it throws no shadow */
    double scale;       /* metres per unit of the file; default 1 */
    int up_axis;        /* enum mns_axis: the file's own; default y */
    int world_up_axis;  /* enum mns_axis: what that becomes; default y */
};
MNS_API void mns_mesh_params_init_sized(struct mns_mesh_params *params, size_t size);
static inline void mns_mesh_params_init(struct mns_mesh_params *params) { mns_mesh_params_init_sized(params, sizeof(*params)); }

/* Reads a file (.obj, .ply, .stl, .gltf, .glb, told by its name) with its materials' colours and textures into place `slot`, 0 to 255, whose mesh before, if
 * any, goes. params NULL: all defaults. On failure the slot is as it was. */
MNS_API mns_result mns_meshes_read(mns_meshes *meshes, int slot, const char *path, const struct mns_mesh_params *params,
                                   struct mns_message *message);

/* Draws all meshes by the camera, in a light that mns_renderer_light told. *out is the frame's `objects`: valid until the next call but this one with equal
 * arguments, which does nothing. The same bytes for every number of threads. */
MNS_API mns_result mns_meshes_draw(mns_meshes *meshes, const struct mns_camera *camera, const struct mns_light *light,
                                   const struct mns_objects **out, struct mns_message *message);

struct mns_mesh_stats {
    size_t struct_size; /* set by mns_mesh_stats_init */
    size_t triangles;
    size_t draws;                        /* pictures drawn so far; a call that did nothing does not count */
    double draw_ms;                      /* the last mns_meshes_draw */
    double bounds_min[3], bounds_max[3]; /* of all vertices, world space; 0 without meshes */
};
MNS_API void mns_mesh_stats_init_sized(struct mns_mesh_stats *stats, size_t size);
static inline void mns_mesh_stats_init(struct mns_mesh_stats *stats) { mns_mesh_stats_init_sized(stats, sizeof(*stats)); }
MNS_API void mns_meshes_stats(const mns_meshes *meshes, struct mns_mesh_stats *out);

/* Reads an environment: an equirectangular picture (.hdr, .exr; .png and .jpg in sRGB), or, with %s in the name, the six square faces of a cube: px, nx, py, ny,
 * pz, nz, or posx, negx ..., with y up and pz behind who looks at the scene. On success the caller owns *out; on failure *out is NULL. */
MNS_API mns_result mns_environment_read(mns_environment **out, const char *path, struct mns_message *message);

#ifdef __cplusplus
}
#endif

#endif
