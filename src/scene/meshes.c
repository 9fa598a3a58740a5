/* meshes.c: the meshes of a scene: read into Embree's scenes, drawn when anything has changed. */
#include "scene/meshes.h"

#include "core/message.h"
#include "util/clock.h"
#include "util/pool.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { THREADS_MAX = 1024 };

void mns_meshes_params_init_sized(struct mns_meshes_params *params, size_t size)
{
    struct mns_meshes_params defaults;
    memset(&defaults, 0, sizeof(defaults));
    defaults.occlusion = 1;
    memset(params, 0, size);
    memcpy(params, &defaults, size < sizeof(defaults) ? size : sizeof(defaults));
    params->struct_size = size;
}

void mns_mesh_params_init_sized(struct mns_mesh_params *params, size_t size)
{
    struct mns_mesh_params defaults;
    memset(&defaults, 0, sizeof(defaults));
    defaults.scale = 1;
    defaults.up_axis = defaults.world_up_axis = MNS_AXIS_Y;
    memset(params, 0, size);
    memcpy(params, &defaults, size < sizeof(defaults) ? size : sizeof(defaults));
    params->struct_size = size;
}

void mns_mesh_stats_init_sized(struct mns_mesh_stats *stats, size_t size)
{
    memset(stats, 0, size);
    stats->struct_size = size;
}

static mns_result refuse_size(struct mns_message *message, const char *name, size_t size)
{
    return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "%s.struct_size is %zu; call its init function first", name, size);
}

static void run_in_pool(void *user, void (*job)(void *context, int index), void *context, int count)
{
    mns_pool_run(user, job, context, count);
}

static mns_result resolve(struct mns_meshes *meshes, const struct mns_meshes_params *params, struct mns_message *message)
{
    struct mns_meshes_params *own = &meshes->params;
    mns_meshes_params_init(own);
    if (params && params->struct_size < sizeof(params->struct_size)) {
        return refuse_size(message, "params", params->struct_size);
    }
    if (params) {
        memcpy(own, params, params->struct_size < sizeof(*own) ? params->struct_size : sizeof(*own));
    }
    if (own->threads < 0 || own->threads > THREADS_MAX) {
        return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "threads is %d; it must be 1 to %d, or 0 for as many as there are processors",
                        own->threads, THREADS_MAX);
    }
    if (!(own->occlusion_distance >= 0 && own->occlusion_distance <= 1e15)) {
        return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "occlusion_distance is %g; it must be 0 to 1e15 metres",
                        own->occlusion_distance);
    }
    own->threads = own->threads ? own->threads : mns_processor_count();
    if (!own->parallel.run) {
        meshes->pool = mns_pool_create(own->threads, NULL);
        if (!meshes->pool) {
            return mns_fail(message, MNS_ERR_OUT_OF_MEMORY, "%d threads cannot be started", own->threads);
        }
        own->parallel = (struct mns_parallel){.run = run_in_pool, .user = meshes->pool};
    }
    return MNS_OK;
}

mns_result mns_meshes_create(mns_meshes **out, const struct mns_meshes_params *params, struct mns_message *message)
{
    *out = NULL;
    struct mns_meshes *meshes = calloc(1, sizeof(*meshes));
    if (!meshes) {
        return mns_fail(message, MNS_ERR_OUT_OF_MEMORY, "out of memory");
    }
    mns_result result = resolve(meshes, params, message);
    if (result == MNS_OK) {
        /* Embree's own threads would build trees that differ from run to run. */
        meshes->device = rtcNewDevice("threads=1,user_threads=0");
        meshes->all = meshes->device ? rtcNewScene(meshes->device) : NULL;
        meshes->casters = meshes->device ? rtcNewScene(meshes->device) : NULL;
        if (!meshes->all || !meshes->casters) {
            result = mns_fail(message, MNS_ERR_DEVICE, "Embree cannot be started (error %d)", (int)rtcGetDeviceError(meshes->device));
        }
    }
    if (result != MNS_OK) {
        mns_meshes_destroy(&meshes);
        return result;
    }
    rtcSetSceneFlags(meshes->all, RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION);
    rtcSetSceneFlags(meshes->casters, RTC_SCENE_FLAG_ROBUST);
    *out = meshes;
    return MNS_OK;
}

/* ---- slots ---- */

/* Near faces of a container let rays through. Its outside is told by its middle, since the faces of a tank turn either way. */
static void pass_near_faces(const struct RTCFilterFunctionNArguments *hit)
{
    const struct slot *slot = hit->geometryUserPtr;
    const struct RTCRay *ray = (const struct RTCRay *)(const void *)hit->ray;
    const struct RTCHit *at = (const struct RTCHit *)(const void *)hit->hit;
    float along = ray->dir_x * at->Ng_x + ray->dir_y * at->Ng_y + ray->dir_z * at->Ng_z;
    float away = (ray->org_x + ray->tfar * ray->dir_x - slot->middle[0]) * at->Ng_x +
                 (ray->org_y + ray->tfar * ray->dir_y - slot->middle[1]) * at->Ng_y +
                 (ray->org_z + ray->tfar * ray->dir_z - slot->middle[2]) * at->Ng_z;
    if (along * away < 0) {
        hit->valid[0] = 0;
    }
}

static void empty_slot(struct mns_meshes *meshes, int index)
{
    struct slot *slot = &meshes->slots[index];
    if (!slot->used) {
        return;
    }
    if (slot->geometry) {
        rtcDetachGeometry(meshes->all, (unsigned)index);
        if (!slot->container) {
            rtcDetachGeometry(meshes->casters, (unsigned)index);
        }
        rtcReleaseGeometry(slot->geometry);
    }
    mns_mesh_free(&slot->mesh);
    *slot = (struct slot){.used = false};
}

/* Hands the slot's triangles to Embree, about the scene's origin. */
static mns_result attach(struct mns_meshes *meshes, int index, struct mns_message *message)
{
    struct slot *slot = &meshes->slots[index];
    struct mesh *mesh = &slot->mesh;
    for (int c = 0; c < 3; c++) {
        slot->offset[c] = (float)(mesh->origin[c] - meshes->origin[c]);
        slot->middle[c] = slot->offset[c]; /* a mesh's origin is its middle */
    }
    slot->geometry = rtcNewGeometry(meshes->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    float *position = slot->geometry ? rtcSetNewGeometryBuffer(slot->geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                               3 * sizeof(float), mesh->vertex_count)
                                     : NULL;
    if (!position) {
        return mns_fail(message, MNS_ERR_OUT_OF_MEMORY, "out of memory for %zu triangles", mesh->triangle_count);
    }
    for (size_t i = 0; i < 3 * mesh->vertex_count; i++) {
        position[i] = mesh->position[i] + slot->offset[i % 3];
    }
    rtcSetSharedGeometryBuffer(slot->geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh->triangle, 0, 3 * sizeof(uint32_t),
                               mesh->triangle_count);
    if (slot->container) {
        rtcSetGeometryUserData(slot->geometry, slot);
        rtcSetGeometryIntersectFilterFunction(slot->geometry, pass_near_faces);
    }
    rtcCommitGeometry(slot->geometry);
    rtcAttachGeometryByID(meshes->all, slot->geometry, (unsigned)index);
    if (!slot->container) {
        rtcAttachGeometryByID(meshes->casters, slot->geometry, (unsigned)index);
    }
    return rtcGetDeviceError(meshes->device) == RTC_ERROR_NONE
               ? MNS_OK
               : mns_fail(message, MNS_ERR_OUT_OF_MEMORY, "out of memory for %zu triangles", mesh->triangle_count);
}

static mns_result check_mesh_params(struct mns_mesh_params *out, const struct mns_mesh_params *in, struct mns_message *message)
{
    mns_mesh_params_init(out);
    if (in && in->struct_size < sizeof(in->struct_size)) {
        return refuse_size(message, "params", in->struct_size);
    }
    if (in) {
        memcpy(out, in, in->struct_size < sizeof(*out) ? in->struct_size : sizeof(*out));
    }
    if (!(out->scale > 0 && out->scale <= 1e12)) {
        return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "the mesh's scale is %g; it must be above 0, at most 1e12", out->scale);
    }
    if (out->up_axis < 0 || out->up_axis > 2 || out->world_up_axis < 0 || out->world_up_axis > 2) {
        return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "an up axis must be 0, 1 or 2 for x, y or z");
    }
    return MNS_OK;
}

/* The box of all meshes in the world. */
static void find_bounds(struct mns_meshes *meshes)
{
    bool any = false;
    for (int i = 0; i < meshes->slot_count; i++) {
        const struct mesh *mesh = &meshes->slots[i].mesh;
        for (int c = 0; c < 3 && meshes->slots[i].used; c++) {
            double low = mesh->origin[c] + (double)mesh->bounds_min[c], high = mesh->origin[c] + (double)mesh->bounds_max[c];
            meshes->bounds_min[c] = any ? fmin(meshes->bounds_min[c], low) : low;
            meshes->bounds_max[c] = any ? fmax(meshes->bounds_max[c], high) : high;
        }
        any = any || meshes->slots[i].used;
    }
}

mns_result mns_meshes_read(mns_meshes *meshes, int slot, const char *path, const struct mns_mesh_params *params,
                           struct mns_message *message)
{
    struct mns_mesh_params known;
    mns_result result = check_mesh_params(&known, params, message);
    if (result == MNS_OK && (slot < 0 || slot >= MESHES_MAX)) {
        result = mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "slot is %d; it must be 0 to %d", slot, MESHES_MAX - 1);
    }
    struct mesh mesh;
    result = result == MNS_OK ? mns_mesh_read(&mesh, path, &known, message) : result;
    if (result != MNS_OK) {
        return result;
    }
    bool first = meshes->slot_count == 0;
    empty_slot(meshes, slot);
    meshes->slots[slot] = (struct slot){.mesh = mesh, .container = known.container != 0, .used = true};
    meshes->slot_count = slot >= meshes->slot_count ? slot + 1 : meshes->slot_count;
    if (first) {
        memcpy(meshes->origin, mesh.origin, sizeof(meshes->origin));
    }
    find_bounds(meshes);
    result = attach(meshes, slot, message);
    if (result != MNS_OK) {
        empty_slot(meshes, slot);
    }
    meshes->generation++;
    meshes->committed = false;
    return result;
}

/* ---- the picture ---- */

static mns_result reserve(struct mns_meshes *meshes, int width, int height, struct mns_message *message)
{
    size_t pixels = (size_t)width * (size_t)height, rows = 2 * (size_t)height;
    if (meshes->pixel_capacity < pixels) {
        free(meshes->pixels);
        free(meshes->guides);
        meshes->pixels = malloc(pixels * sizeof(*meshes->pixels));
        meshes->guides = malloc(pixels * sizeof(*meshes->guides));
        meshes->pixel_capacity = meshes->pixels && meshes->guides ? pixels : 0;
    }
    if (meshes->span_capacity < rows) {
        free(meshes->spans);
        meshes->spans = malloc(rows * sizeof(*meshes->spans));
        meshes->span_capacity = meshes->spans ? rows : 0;
    }
    return meshes->pixel_capacity >= pixels && meshes->span_capacity >= rows
               ? MNS_OK
               : mns_fail(message, MNS_ERR_OUT_OF_MEMORY, "out of memory for a picture of the meshes");
}

static mns_result commit(struct mns_meshes *meshes, struct mns_message *message)
{
    if (!meshes->committed) {
        rtcCommitScene(meshes->all);
        rtcCommitScene(meshes->casters);
        if (rtcGetDeviceError(meshes->device) != RTC_ERROR_NONE) {
            return mns_fail(message, MNS_ERR_OUT_OF_MEMORY, "out of memory for the meshes' tree");
        }
        meshes->committed = true;
    }
    return MNS_OK;
}

/* A copy whose bytes can be compared. */
static struct picture_key key_of(const struct mns_meshes *meshes, const struct mns_camera *camera, const struct mns_light *light)
{
    struct picture_key key;
    memset(&key, 0, sizeof(key));
    memcpy(&key.camera, camera, camera->struct_size < sizeof(*camera) ? camera->struct_size : sizeof(*camera));
    memcpy(&key.light, light, light->struct_size < sizeof(*light) ? light->struct_size : sizeof(*light));
    key.generation = meshes->generation;
    return key;
}

mns_result mns_meshes_draw(mns_meshes *meshes, const struct mns_camera *camera, const struct mns_light *light,
                           const struct mns_objects **out, struct mns_message *message)
{
    double start = mns_clock_ms();
    *out = NULL;
    if (camera->struct_size < sizeof(camera->struct_size)) {
        return refuse_size(message, "camera", camera->struct_size);
    }
    if (light->struct_size < sizeof(light->struct_size)) {
        return refuse_size(message, "light", light->struct_size);
    }
    struct picture_key key = key_of(meshes, camera, light);
    if (!meshes->has_picture || memcmp(&key, &meshes->key, sizeof(key)) != 0) {
        struct view view;
        meshes->has_picture = false;
        mns_result result = mns_view_resolve(&view, &key.camera, meshes->origin, message);
        result = result == MNS_OK ? reserve(meshes, view.width, view.height, message) : result;
        result = result == MNS_OK ? commit(meshes, message) : result;
        if (result != MNS_OK) {
            return result;
        }
        mns_meshes_cast(meshes, &view, &key.light);
        meshes->objects =
            (struct mns_objects){.pixels = meshes->pixels, .width = view.width, .height = view.height, .spans = meshes->spans};
        meshes->key = key;
        meshes->has_picture = true;
        meshes->draws++;
    }
    meshes->draw_ms = mns_clock_ms() - start;
    *out = &meshes->objects;
    return MNS_OK;
}

void mns_meshes_stats(const mns_meshes *meshes, struct mns_mesh_stats *out)
{
    struct mns_mesh_stats stats;
    mns_mesh_stats_init(&stats);
    for (int i = 0; i < meshes->slot_count; i++) {
        stats.triangles += meshes->slots[i].mesh.triangle_count;
    }
    stats.draws = meshes->draws;
    stats.draw_ms = meshes->draw_ms;
    memcpy(stats.bounds_min, meshes->bounds_min, sizeof(stats.bounds_min));
    memcpy(stats.bounds_max, meshes->bounds_max, sizeof(stats.bounds_max));
    stats.struct_size = out->struct_size;
    memcpy(out, &stats, out->struct_size < sizeof(stats) ? out->struct_size : sizeof(stats));
}

void mns_meshes_destroy(mns_meshes **meshes)
{
    struct mns_meshes *m = *meshes;
    *meshes = NULL;
    if (!m) {
        return;
    }
    for (int i = 0; i < m->slot_count; i++) {
        empty_slot(m, i);
    }
    if (m->all) {
        rtcReleaseScene(m->all);
    }
    if (m->casters) {
        rtcReleaseScene(m->casters);
    }
    if (m->device) {
        rtcReleaseDevice(m->device);
    }
    mns_pool_destroy(m->pool);
    free(m->pixels);
    free(m->guides);
    free(m->spans);
    free(m);
}
