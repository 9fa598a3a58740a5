/* mesh.c: mesh files, read by Assimp into plain arrays. */
#include "scene/mesh.h"

#include "core/message.h"

#include <assimp/cimport.h>
#include <assimp/config.h>
#include <assimp/material.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Degrees between faces up to which a mesh without normals is rounded. */
static const float CREASE = 40;
/* Reflectance of a mesh that names no colour: the floor's. */
static const float PLAIN = 0.45f;
/* Vertices and triangles of one mesh at most: Embree's indices have 32 bits. */
static const size_t COUNT_MAX = 1u << 31;

static const char *const extensions[] = {"obj", "ply", "stl", "gltf", "glb", NULL};

/* One reading: where it is, and into what. */
struct reading {
    struct mesh *mesh;
    const char *path;
    const struct mns_mesh_params *params;
    const struct aiScene *scene;
    struct mns_message *message;
};

static bool same_word(const char *a, const char *b)
{
    while (*a && tolower((unsigned char)*a) == *b) {
        a++;
        b++;
    }
    return !*a && !*b;
}

static mns_result check_file(const char *path, struct mns_message *message)
{
    const char *dot = strrchr(path, '.');
    bool known = false;
    for (int i = 0; dot && extensions[i]; i++) {
        known = known || same_word(dot + 1, extensions[i]);
    }
    if (!known) {
        return mns_fail(message, MNS_ERR_UNSUPPORTED, "%s: is no mesh by its name; .obj, .ply, .stl, .gltf and .glb can be read", path);
    }
    errno = 0;
    FILE *file = fopen(path, "rb");
    char byte;
    bool empty = file && fread(&byte, 1, 1, file) == 0;
    int error = errno;
    if (file) {
        fclose(file);
    }
    if (!file || (empty && error)) {
        return mns_fail(message, MNS_ERR_IO, "%s: cannot be read: %s", path, strerror(error));
    }
    return empty ? mns_fail(message, MNS_ERR_BAD_DATA, "%s: is empty", path) : MNS_OK;
}

static mns_result out_of_memory(const struct reading *reading)
{
    return mns_fail(reading->message, MNS_ERR_OUT_OF_MEMORY, "%s: out of memory", reading->path);
}

/* Which way right and front are where an axis is up: what faces the viewer in one world does so in the other. */
struct heading {
    int right, front;
    double right_sign, front_sign;
};

static const struct heading headings[3] = {[MNS_AXIS_X] = {1, 2, -1, 1}, [MNS_AXIS_Y] = {0, 2, 1, 1}, [MNS_AXIS_Z] = {0, 1, 1, -1}};

/* The file's point in the world: its up axis turned to the world's, and scaled. */
static void to_world(const struct mns_mesh_params *params, const double in[3], double scale, double out[3])
{
    const struct heading *from = &headings[params->up_axis], *to = &headings[params->world_up_axis];
    out[to->right] = scale * in[from->right] * from->right_sign * to->right_sign;
    out[to->front] = scale * in[from->front] * from->front_sign * to->front_sign;
    out[params->world_up_axis] = scale * in[params->up_axis];
}

static mns_result count(const struct reading *reading)
{
    struct mesh *mesh = reading->mesh;
    const struct aiScene *scene = reading->scene;
    for (unsigned i = 0; i < scene->mNumMeshes; i++) {
        const struct aiMesh *part = scene->mMeshes[i];
        if (part->mPrimitiveTypes & aiPrimitiveType_TRIANGLE) {
            mesh->vertex_count += part->mNumVertices;
            mesh->triangle_count += part->mNumFaces;
        }
    }
    mesh->material_count = scene->mNumMaterials;
    if (mesh->triangle_count == 0) {
        return mns_fail(reading->message, MNS_ERR_BAD_DATA, "%s: holds no faces", reading->path);
    }
    if (mesh->vertex_count >= COUNT_MAX || mesh->triangle_count >= COUNT_MAX) {
        return mns_fail(reading->message, MNS_ERR_BAD_DATA, "%s: has %zu vertices and %zu triangles; fewer than %zu are read",
                        reading->path, mesh->vertex_count, mesh->triangle_count, COUNT_MAX);
    }
    return MNS_OK;
}

/* The box of all vertices, in the world; refuses what is not finite. */
static mns_result find_bounds(const struct reading *reading)
{
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (unsigned i = 0; i < reading->scene->mNumMeshes; i++) {
        const struct aiMesh *part = reading->scene->mMeshes[i];
        for (unsigned v = 0; v < part->mNumVertices; v++) {
            const struct aiVector3D *p = &part->mVertices[v];
            const double in[3] = {(double)p->x, (double)p->y, (double)p->z};
            double at[3];
            to_world(reading->params, in, reading->params->scale, at);
            for (int c = 0; c < 3; c++) {
                if (!(fabs(at[c]) <= 1e15)) {
                    return mns_fail(reading->message, MNS_ERR_BAD_DATA, "%s: vertex %u of mesh %u is at (%g, %g, %g); it must be finite",
                                    reading->path, v, i, in[0], in[1], in[2]);
                }
                low[c] = fmin(low[c], at[c]);
                high[c] = fmax(high[c], at[c]);
            }
        }
    }
    struct mesh *mesh = reading->mesh;
    for (int c = 0; c < 3; c++) {
        mesh->origin[c] = 0.5 * (low[c] + high[c]);
        mesh->bounds_min[c] = (float)(low[c] - mesh->origin[c]);
        mesh->bounds_max[c] = (float)(high[c] - mesh->origin[c]);
    }
    return MNS_OK;
}

static mns_result allocate(const struct reading *reading)
{
    struct mesh *mesh = reading->mesh;
    bool has_uv = false, has_color = false;
    for (unsigned i = 0; i < reading->scene->mNumMeshes; i++) {
        has_uv = has_uv || reading->scene->mMeshes[i]->mTextureCoords[0];
        has_color = has_color || reading->scene->mMeshes[i]->mColors[0];
    }
    size_t n = mesh->vertex_count;
    mesh->position = calloc(n + 2, 3 * sizeof(float));
    mesh->normal = calloc(n, 3 * sizeof(float));
    mesh->uv = has_uv ? calloc(n, 2 * sizeof(float)) : NULL;
    mesh->color = has_color ? calloc(n, 3 * sizeof(float)) : NULL;
    mesh->triangle = calloc(mesh->triangle_count + 1, 3 * sizeof(uint32_t));
    mesh->material_of = calloc(mesh->triangle_count, sizeof(uint32_t));
    mesh->materials = calloc(mesh->material_count + 1, sizeof(*mesh->materials));
    mesh->textures = calloc(mesh->material_count + 1, sizeof(*mesh->textures));
    bool done = mesh->position && mesh->normal && (!has_uv || mesh->uv) && (!has_color || mesh->color) && mesh->triangle &&
                mesh->material_of && mesh->materials && mesh->textures;
    return done ? MNS_OK : out_of_memory(reading);
}

static float finite_or(float value, float otherwise) { return isfinite(value) ? value : otherwise; }

static void copy_vertex(const struct reading *reading, const struct aiMesh *part, unsigned v, size_t to)
{
    struct mesh *mesh = reading->mesh;
    const double in[3] = {(double)part->mVertices[v].x, (double)part->mVertices[v].y, (double)part->mVertices[v].z};
    double at[3], n[3] = {0, 0, 0}, normal[3];
    to_world(reading->params, in, reading->params->scale, at);
    if (part->mNormals) {
        n[0] = (double)part->mNormals[v].x;
        n[1] = (double)part->mNormals[v].y;
        n[2] = (double)part->mNormals[v].z;
    }
    to_world(reading->params, n, 1, normal);
    double length = sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
    for (int c = 0; c < 3; c++) {
        mesh->position[3 * to + (size_t)c] = (float)(at[c] - mesh->origin[c]);
        mesh->normal[3 * to + (size_t)c] = length > 0 && isfinite(length) ? (float)(normal[c] / length) : 0;
    }
    if (mesh->uv && part->mTextureCoords[0]) {
        mesh->uv[2 * to] = finite_or(part->mTextureCoords[0][v].x, 0);
        mesh->uv[2 * to + 1] = finite_or(part->mTextureCoords[0][v].y, 0);
    }
    if (mesh->color) {
        const struct aiColor4D *color = part->mColors[0] ? &part->mColors[0][v] : NULL;
        const float rgb[3] = {color ? color->r : 1, color ? color->g : 1, color ? color->b : 1};
        for (size_t c = 0; c < 3; c++) {
            mesh->color[3 * to + c] = fminf(fmaxf(finite_or(rgb[c], 1), 0), 1);
        }
    }
}

static mns_result copy(const struct reading *reading)
{
    struct mesh *mesh = reading->mesh;
    size_t first = 0, triangle = 0;
    for (unsigned i = 0; i < reading->scene->mNumMeshes; i++) {
        const struct aiMesh *part = reading->scene->mMeshes[i];
        if (!(part->mPrimitiveTypes & aiPrimitiveType_TRIANGLE)) {
            continue;
        }
        for (unsigned v = 0; v < part->mNumVertices; v++) {
            copy_vertex(reading, part, v, first + v);
        }
        for (unsigned f = 0; f < part->mNumFaces; f++, triangle++) {
            const struct aiFace *face = &part->mFaces[f];
            mesh->material_of[triangle] = part->mMaterialIndex < mesh->material_count ? part->mMaterialIndex : 0;
            for (unsigned k = 0; k < 3; k++) {
                if (face->mNumIndices != 3 || face->mIndices[k] >= part->mNumVertices) {
                    return mns_fail(reading->message, MNS_ERR_BAD_DATA, "%s: face %u of mesh %u names a vertex that is not there",
                                    reading->path, f, i);
                }
                mesh->triangle[3 * triangle + k] = (uint32_t)(first + face->mIndices[k]);
            }
        }
        first += part->mNumVertices;
    }
    return MNS_OK;
}

/* The texture's file beside the mesh; NULL: out of memory. */
static char *beside(const char *path, const char *name)
{
    const char *slash = strrchr(path, '/');
    size_t folder = slash && name[0] != '/' ? (size_t)(slash - path) + 1 : 0;
    char *out = malloc(folder + strlen(name) + 1);
    if (out) {
        memcpy(out, path, folder);
        strcpy(out + folder, name);
        for (char *at = out + folder; *at; at++) {
            *at = *at == '\\' ? '/' : *at;
        }
    }
    return out;
}

/* A texture inside the mesh's file: "*3" by its number, else by its name. NULL: it lies beside. */
static const struct aiTexture *embedded(const struct aiScene *scene, const char *name)
{
    if (name[0] == '*') {
        unsigned long number = strtoul(name + 1, NULL, 10);
        return number < scene->mNumTextures ? scene->mTextures[number] : NULL;
    }
    for (unsigned i = 0; i < scene->mNumTextures; i++) {
        if (!strcmp(scene->mTextures[i]->mFilename.data, name)) {
            return scene->mTextures[i];
        }
    }
    return NULL;
}

static mns_result read_texture(const struct reading *reading, const char *name, struct texture *out)
{
    const struct aiTexture *inside = embedded(reading->scene, name);
    if (inside && inside->mHeight == 0) {
        return mns_texture_read(out, name, inside->pcData, inside->mWidth, reading->path, reading->message);
    }
    if (inside) {
        size_t pixels = (size_t)inside->mWidth * inside->mHeight;
        unsigned char *copied = inside->mWidth <= 16384 && inside->mHeight <= 16384 ? malloc(4 * pixels) : NULL;
        for (size_t i = 0; copied && i < pixels; i++) {
            const struct aiTexel *texel = &inside->pcData[i];
            const unsigned char rgba[4] = {texel->r, texel->g, texel->b, texel->a};
            memcpy(copied + 4 * i, rgba, 4);
        }
        return copied ? mns_texture_take(out, copied, (int)inside->mWidth, (int)inside->mHeight, reading->path, reading->message)
                      : out_of_memory(reading);
    }
    char *path = beside(reading->path, name);
    mns_result result = path ? mns_texture_read(out, path, NULL, 0, reading->path, reading->message) : out_of_memory(reading);
    free(path);
    return result;
}

/* What Assimp gives a mesh that names no material. */
static bool is_default(const struct aiMaterial *material)
{
    struct aiString name;
    bool named = aiGetMaterialString(material, AI_MATKEY_NAME, &name) == aiReturn_SUCCESS && name.length > 0;
    return !named || !strcmp(name.data, AI_DEFAULT_MATERIAL_NAME);
}

static mns_result read_materials(const struct reading *reading)
{
    struct mesh *mesh = reading->mesh;
    for (size_t i = 0; i < mesh->material_count; i++) {
        const struct aiMaterial *from = reading->scene->mMaterials[i];
        struct material *to = &mesh->materials[i];
        struct aiColor4D color = {0, 0, 0, 1};
        struct aiString name;
        bool has_color = !is_default(from) && aiGetMaterialColor(from, AI_MATKEY_COLOR_DIFFUSE, &color) == aiReturn_SUCCESS;
        bool has_texture =
            mesh->uv &&
            (aiGetMaterialTexture(from, aiTextureType_DIFFUSE, 0, &name, NULL, NULL, NULL, NULL, NULL, NULL) == aiReturn_SUCCESS ||
             aiGetMaterialTexture(from, aiTextureType_BASE_COLOR, 0, &name, NULL, NULL, NULL, NULL, NULL, NULL) == aiReturn_SUCCESS);
        const float rgb[3] = {color.r, color.g, color.b}, plain = mesh->color || has_texture ? 1 : PLAIN;
        for (int c = 0; c < 3; c++) {
            to->color[c] = has_color ? fminf(fmaxf(finite_or(rgb[c], plain), 0), 1) : plain;
        }
        to->texture = -1;
        if (has_texture) {
            mns_result result = read_texture(reading, name.data, &mesh->textures[mesh->texture_count]);
            if (result != MNS_OK) {
                return result;
            }
            to->texture = (int)mesh->texture_count++;
        }
    }
    return MNS_OK;
}

static mns_result convert(const struct reading *reading)
{
    mns_result result = count(reading);
    result = result == MNS_OK ? find_bounds(reading) : result;
    result = result == MNS_OK ? allocate(reading) : result;
    result = result == MNS_OK ? copy(reading) : result;
    return result == MNS_OK ? read_materials(reading) : result;
}

mns_result mns_mesh_read(struct mesh *out, const char *path, const struct mns_mesh_params *params, struct mns_message *message)
{
    *out = (struct mesh){.triangle_count = 0};
    mns_result result = check_file(path, message);
    if (result != MNS_OK) {
        return result;
    }
    struct aiPropertyStore *properties = aiCreatePropertyStore();
    if (!properties) {
        return mns_fail(message, MNS_ERR_OUT_OF_MEMORY, "%s: out of memory", path);
    }
    aiSetImportPropertyFloat(properties, AI_CONFIG_PP_GSN_MAX_SMOOTHING_ANGLE, CREASE);
    const struct aiScene *scene = aiImportFileExWithProperties(
        path, aiProcess_Triangulate | aiProcess_GenSmoothNormals | aiProcess_SortByPType | aiProcess_PreTransformVertices, NULL,
        properties);
    aiReleasePropertyStore(properties);
    if (!scene) {
        char text[256];
        snprintf(text, sizeof(text), "%s", aiGetErrorString());
        text[strcspn(text, "\r\n")] = '\0';
        if (strstr(text, "No output meshes")) { /* of a file with vertices alone */
            return mns_fail(message, MNS_ERR_BAD_DATA, "%s: holds no faces", path);
        }
        return mns_fail(message, MNS_ERR_BAD_DATA, "%s: cannot be read: %s", path, text);
    }
    const struct reading reading = {out, path, params, scene, message};
    result = convert(&reading);
    aiReleaseImport(scene);
    if (result != MNS_OK) {
        mns_mesh_free(out);
    }
    return result;
}

void mns_mesh_free(struct mesh *mesh)
{
    for (size_t i = 0; i < mesh->texture_count; i++) {
        mns_texture_free(&mesh->textures[i]);
    }
    free(mesh->position);
    free(mesh->normal);
    free(mesh->uv);
    free(mesh->color);
    free(mesh->triangle);
    free(mesh->material_of);
    free(mesh->materials);
    free(mesh->textures);
    *mesh = (struct mesh){.triangle_count = 0};
}
