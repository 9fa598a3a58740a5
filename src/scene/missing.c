/* missing.c: the calls of meniscus/scene.h in a build without Assimp or Embree. */
#include "core/message.h"

#include <meniscus/scene.h>

#include <string.h>

static mns_result missing(struct mns_message *message)
{
    return mns_fail(message, MNS_ERR_UNSUPPORTED,
                    "this build reads no meshes and no environments: install Assimp, Embree 3 and stb (Debian: libassimp-dev libembree-dev "
                    "libstb-dev) and build again");
}

void mns_meshes_params_init_sized(struct mns_meshes_params *params, size_t size)
{
    memset(params, 0, size);
    params->struct_size = size;
}

void mns_mesh_params_init_sized(struct mns_mesh_params *params, size_t size)
{
    memset(params, 0, size);
    params->struct_size = size;
}

void mns_mesh_stats_init_sized(struct mns_mesh_stats *stats, size_t size)
{
    memset(stats, 0, size);
    stats->struct_size = size;
}

mns_result mns_meshes_create(mns_meshes **out, const struct mns_meshes_params *params, struct mns_message *message)
{
    (void)params;
    *out = NULL;
    return missing(message);
}

void mns_meshes_destroy(mns_meshes **meshes) { *meshes = NULL; }

mns_result mns_meshes_read(mns_meshes *meshes, int slot, const char *path, const struct mns_mesh_params *params,
                           struct mns_message *message)
{
    (void)meshes, (void)slot, (void)path, (void)params;
    return missing(message);
}

mns_result mns_meshes_draw(mns_meshes *meshes, const struct mns_camera *camera, const struct mns_light *light,
                           const struct mns_objects **out, struct mns_message *message)
{
    (void)meshes, (void)camera, (void)light;
    *out = NULL;
    return missing(message);
}

mns_result mns_environment_read(mns_environment **out, const char *path, struct mns_message *message)
{
    (void)path;
    *out = NULL;
    return missing(message);
}

void mns_meshes_stats(const mns_meshes *meshes, struct mns_mesh_stats *out) { (void)meshes, (void)out; }
