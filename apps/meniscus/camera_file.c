/* camera_file.c: camera files and case files, which give a view in JSON. */
#include "view.h"

#include "json_file.h"
#include "program.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Takes object[name] unless has says that the command line gave it. */
static bool take(const char *path, const cJSON *object, const char *name, int count, double *out, bool *has)
{
    double values[3];
    bool found;
    if (!json_numbers(path, object, name, count, values, &found)) {
        return false;
    }
    if (found && !*has) {
        memcpy(out, values, (size_t)count * sizeof(*out));
        *has = true;
    }
    return true;
}

static bool take_camera(struct camera_options *camera, const char *path, const cJSON *object)
{
    bool has_orthographic = camera->orthographic > 0, has_near = false, has_far = false;
    bool good = take(path, object, "eye", 3, camera->eye, &camera->has_eye) &&
                take(path, object, "target", 3, camera->target, &camera->has_target) &&
                take(path, object, "up", 3, camera->up, &camera->has_up) && take(path, object, "fov", 1, &camera->fov, &camera->has_fov) &&
                take(path, object, "vfov_deg", 1, &camera->fov, &camera->has_fov) &&
                take(path, object, "orthographic", 1, &camera->orthographic, &has_orthographic) &&
                take(path, object, "near", 1, &camera->near_plane, &has_near) && take(path, object, "far", 1, &camera->far_plane, &has_far);
    if (!good) {
        return false;
    }
    if (!(camera->fov >= 0.01 && camera->fov <= 179)) {
        program_fail("%s: \"fov\" is %g; it must be 0.01 to 179 degrees", path, camera->fov);
        return false;
    }
    if ((camera->orthographic != 0 && !(camera->orthographic >= 1e-12 && camera->orthographic <= 1e15)) ||
        (has_near && !(camera->near_plane > 0)) || (has_far && !(camera->far_plane > camera->near_plane))) {
        program_fail("%s: \"orthographic\" and \"near\" must be above 0, and \"far\" above \"near\"", path);
        return false;
    }
    return true;
}

static bool take_viewport(struct options *options, const char *path, const cJSON *viewport)
{
    double width = 0, height = 0;
    bool has_width, has_height;
    if (!json_numbers(path, viewport, "width", 1, &width, &has_width) || !json_numbers(path, viewport, "height", 1, &height, &has_height)) {
        return false;
    }
    bool good = has_width && has_height && width >= 1 && width <= 32768 && height >= 1 && height <= 32768;
    if (!good || width != floor(width) || height != floor(height)) {
        program_fail("%s: \"viewport\" must hold a whole width and height, 1 to 32768 pixels", path);
        return false;
    }
    if (!options->has_size) {
        options->width = (int)width;
        options->height = (int)height;
        options->has_size = true;
    }
    return true;
}

static bool take_view(struct options *options, const char *path, const cJSON *json)
{
    const cJSON *camera = cJSON_GetObjectItemCaseSensitive(json, "camera"), *viewport = cJSON_GetObjectItemCaseSensitive(json, "viewport");
    return take_camera(&options->camera, path, cJSON_IsObject(camera) ? camera : json) &&
           (!viewport || take_viewport(options, path, viewport));
}

/* One key: a camera on top of the command line's. name: of the array. */
static bool take_key(struct camera_key *key, const struct options *options, const char *path, const char *name, const cJSON *item)
{
    bool has_frame = options->keys_by_index;
    key->camera = options->camera;
    key->frame = (double)options->key_count;
    if (!has_frame && !json_numbers(path, item, "frame", 1, &key->frame, &has_frame)) {
        return false;
    }
    if (!take_camera(&key->camera, path, item)) {
        return false;
    }
    if (!has_frame || !key->camera.has_eye || !key->camera.has_target) {
        program_fail("%s: each of \"%s\" must have %san \"eye\" and a \"target\"", path, name,
                     options->keys_by_index ? "" : "a \"frame\", ");
        return false;
    }
    return true;
}

static bool take_keys(struct options *options, const char *path, const char *name, const cJSON *keys)
{
    int count = cJSON_IsArray(keys) ? cJSON_GetArraySize(keys) : 0;
    options->keys = count > 0 ? calloc((size_t)count, sizeof(*options->keys)) : NULL;
    if (!options->keys) {
        program_fail("%s: \"%s\" must be an array of cameras", path, name);
        return false;
    }
    const cJSON *item;
    cJSON_ArrayForEach(item, keys)
    {
        struct camera_key *key = &options->keys[options->key_count];
        if (!take_key(key, options, path, name, item)) {
            return false;
        }
        const struct camera_key *before = options->key_count ? key - 1 : NULL;
        if (before && (key->frame <= before->frame || key->camera.has_up != before->camera.has_up ||
                       (key->camera.orthographic > 0) != (before->camera.orthographic > 0))) {
            program_fail("%s: \"%s\" must have rising frames, and all or none of them \"up\" and \"orthographic\"", path, name);
            return false;
        }
        options->key_count++;
    }
    return true;
}

int view_read_camera(struct options *options, const char *path)
{
    cJSON *json = json_read(path);
    const cJSON *keys = cJSON_GetObjectItemCaseSensitive(json, "keys"), *frames = cJSON_GetObjectItemCaseSensitive(json, "frames");
    bool good = json != NULL;
    if (frames) {
        options->keys_by_index = true;
        good = take_keys(options, path, "frames", frames);
    } else if (keys) {
        good = take_keys(options, path, "keys", keys);
    } else if (json) {
        good = take_view(options, path, json);
    }
    cJSON_Delete(json);
    return good ? STATUS_DONE : STATUS_FAILED;
}

bool view_is_case(const char *path)
{
    size_t length = strlen(path);
    return length > 5 && !strcmp(path + length - 5, ".json");
}

/* The particles' file, which stands beside the case file unless its path is absolute. */
static char *particles_path(const char *path, const cJSON *json)
{
    const cJSON *file = cJSON_GetObjectItemCaseSensitive(json, "particles_file");
    if (!cJSON_IsString(file) || !*file->valuestring) {
        program_fail("%s: must name its particles in \"particles_file\"", path);
        return NULL;
    }
    const char *name = file->valuestring, *slash = strrchr(path, '/');
    size_t folder = *name == '/' || !slash ? 0 : (size_t)(slash - path) + 1, length = strlen(name);
    char *out = malloc(folder + length + 1);
    if (!out) {
        program_fail("%s: out of memory", path);
        return NULL;
    }
    memcpy(out, path, folder);
    memcpy(out + folder, name, length + 1);
    return out;
}

int view_read_case(struct options *options, const char *path, char **particles)
{
    *particles = NULL;
    cJSON *json = json_read(path);
    double spacing = 0;
    bool has_spacing = false,
         good = json && take_view(options, path, json) && json_numbers(path, json, "spacing", 1, &spacing, &has_spacing);
    if (good && has_spacing && !(spacing > 0 && spacing < 1e12)) {
        program_fail("%s: \"spacing\" is %g; it must be above 0", path, spacing);
        good = false;
    }
    *particles = good ? particles_path(path, json) : NULL;
    if (*particles && has_spacing && options->params.radius <= 0) {
        options->params.radius = (float)(0.5 * spacing);
    }
    cJSON_Delete(json);
    return *particles ? STATUS_DONE : STATUS_FAILED;
}
