/* frame.c: one picture to draw: the caller's words checked, and everything that is `auto` told. */
#include "core/frame.h"

#include "core/message.h"
#include "core/view.h"

#include <math.h>
#include <string.h>

static const double PI = 3.14159265358979323846;

/* From here on the spacing is a better measure of the volume than the radius is (SPEC: thickness). */
enum { SPACING_COUNT = 1000 };

/* Radius of particles of which it cannot be told, metres: mns_camera_frame shows such a set as a box of this half-size. */
static const double RADIUS_UNKNOWN = 0.5;

/* The least radius, metres, as of the parameter: powers of a smaller one leave the range of float. */
static const double RADIUS_LEAST = 1e-12;

/* The light of the default sun on a white surface that faces it, and how many floor cells go into L. */
static const float SUN_LIGHT[3] = {1.9f, 1.75f, 1.5f};
static const float CELLS_PER_SIZE = 2;

void mns_frame_init_sized(struct mns_frame *frame, size_t size)
{
    memset(frame, 0, size);
    frame->struct_size = size;
}

mns_result mns_params_resolve(struct mns_params *out, const struct mns_params *in, struct mns_message *message)
{
    mns_params_init(out);
    if (in) {
        size_t size = in->struct_size < sizeof(*out) ? in->struct_size : sizeof(*out);
        if (size < sizeof(in->struct_size)) {
            return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "params.struct_size is %zu; call mns_params_init first", in->struct_size);
        }
        memcpy(out, in, size);
        out->struct_size = sizeof(*out);
    }
    return mns_params_check(out, message);
}

static bool takes_every_pixel(enum mns_layer layer) { return layer == MNS_LAYER_BEAUTY || layer == MNS_LAYER_SCENE_COLOR; }

static mns_result check_image(const struct mns_image *image, const char *name, const struct mns_camera *camera, struct mns_message *message)
{
    static const size_t sizes[] = {4, 1, 2};
    if (!image->data) {
        return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "image %s has no data", name);
    }
    if (image->width != camera->width || image->height != camera->height) {
        return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "image %s is %d x %d pixels; the camera's is %d x %d", name, image->width,
                        image->height, camera->width, camera->height);
    }
    if ((unsigned)image->pixel > MNS_PIXEL_U16) {
        return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "image %s has the unknown pixel type %d", name, (int)image->pixel);
    }
    size_t row = (size_t)image->width * (size_t)image->channels * sizes[image->pixel];
    if (image->stride != 0 && (image->stride < row || image->stride % sizes[image->pixel] != 0)) {
        return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "image %s has a stride of %zu bytes; its rows need %zu", name, image->stride,
                        row);
    }
    return MNS_OK;
}

static mns_result check_outputs(struct frame *out, const struct mns_frame *in, struct mns_message *message)
{
    if (in->output_count > 0 && !in->outputs) {
        return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "frame.outputs is NULL and output_count %zu", in->output_count);
    }
    for (size_t i = 0; i < in->output_count; i++) {
        const struct mns_output *output = &in->outputs[i];
        const char *name = mns_layer_name(output->layer);
        if (!name) {
            return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "output %zu asks for the unknown layer %d", i, (int)output->layer);
        }
        if (out->wanted >> output->layer & 1) {
            return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "layer %s is asked for twice", name);
        }
        out->wanted |= 1u << output->layer;
        int channels = mns_layer_channels(output->layer);
        bool channels_fit = output->image.channels == channels || (output->layer == MNS_LAYER_BEAUTY && output->image.channels == 3);
        if (!channels_fit) {
            return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "image %s has %d channels; the layer has %d", name, output->image.channels,
                            channels);
        }
        if (output->image.pixel != MNS_PIXEL_F32 && !takes_every_pixel(output->layer)) {
            return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "layer %s is no colour; its image must be float32", name);
        }
        mns_result result = check_image(&output->image, name, in->camera, message);
        if (result != MNS_OK) {
            return result;
        }
    }
    out->outputs = in->outputs;
    out->output_count = in->output_count;
    return MNS_OK;
}

static mns_result check_scene(const struct mns_frame *in, struct mns_message *message)
{
    const struct mns_scene *scene = in->scene;
    if (!scene) {
        return MNS_OK;
    }
    if (scene->color.channels != 3 && scene->color.channels != 4) {
        return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "scene.color has %d channels; it must have 3 or 4", scene->color.channels);
    }
    mns_result result = check_image(&scene->color, "scene.color", in->camera, message);
    if (result == MNS_OK && scene->depth.data) {
        if (scene->depth.channels != 1 || scene->depth.pixel != MNS_PIXEL_F32) {
            return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "scene.depth must have one float32 channel");
        }
        result = check_image(&scene->depth, "scene.depth", in->camera, message);
    }
    return result;
}

static mns_result check_objects(const struct mns_frame *in, struct mns_message *message)
{
    const struct mns_objects *objects = in->objects;
    if (!objects) {
        return MNS_OK;
    }
    if (in->scene) {
        return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "frame has both a scene and objects; objects stand in the renderer's own scene");
    }
    if (in->params && in->params->background == MNS_BACKGROUND_TRANSPARENT) {
        return mns_fail(message, MNS_ERR_UNSUPPORTED,
                        "objects cannot stand before a transparent background yet; background must be sky or color");
    }
    if (!objects->pixels) {
        return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "objects.pixels is NULL");
    }
    if (objects->width != in->camera->width || objects->height != in->camera->height) {
        return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "objects are %d x %d pixels; the camera's picture is %d x %d", objects->width,
                        objects->height, in->camera->width, in->camera->height);
    }
    for (int y = 0; objects->spans && y < objects->height; y++) {
        int begin = objects->spans[2 * y], end = objects->spans[2 * y + 1];
        if (begin < 0 || end > objects->width) {
            return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "objects.spans has %d to %d in row %d; it must be within 0 to %d", begin,
                            end, y, objects->width);
        }
    }
    return MNS_OK;
}

static int default_iterations(int filter)
{
    switch (filter) {
    case MNS_FILTER_CURVATURE_FLOW: return 100;          /* [LGS09] table 1, at full resolution */
    case MNS_FILTER_ADAPTIVE_CURVATURE_FLOW: return 256; /* at most, as in the authors' program */
    case MNS_FILTER_IMPLICIT_CURVATURE_FLOW: return 4;
    case MNS_FILTER_SMOOTHING_SPLINE: return 4; /* each halves the width of the streaks beside edges */
    default: return 3;
    }
}

/* Of the middle of the particles' bounds; of the near plane where that is behind the eye. */
static float reference_depth(const struct view *view, const struct particle_facts *facts)
{
    float depth = view->translation[2];
    for (int i = 0; i < 3; i++) {
        depth += view->rotation[6 + i] * 0.5f * (facts->bounds_min[i] + facts->bounds_max[i]);
    }
    return depth > view->near_plane ? depth : view->near_plane;
}

void mns_frame_resolve_sizes(struct frame *out)
{
    const struct mns_params *params = &out->params;
    const struct particle_facts *facts = out->facts;
    bool own_radius = facts->has_radius && params->radius <= 0;
    double radius = params->radius > 0 ? (double)params->radius : facts->radius > 0 ? fmax(facts->radius, RADIUS_LEAST) : RADIUS_UNKNOWN;
    out->splat_radius = (float)(radius * (double)params->radius_scale);
    out->splat_scale = own_radius ? params->radius_scale : 0;

    double spacing = facts->count >= SPACING_COUNT && facts->spacing > 0 ? facts->spacing : 2 * radius, total;
    if (params->particle_volume > 0) {
        out->volume = params->particle_volume;
        total = (double)out->volume * (double)facts->count;
    } else if (facts->has_mass && params->rest_density > 0) {
        out->volume_per_mass = 1 / params->rest_density;
        total = facts->mass_sum / (double)params->rest_density;
        out->volume = (float)(total / (double)(facts->count > 0 ? facts->count : 1));
    } else {
        double volume = spacing * spacing * spacing;
        out->volume = (float)volume;
        total = volume * (double)facts->count;
        if (own_radius) {
            double per_cube = volume / (radius * radius * radius);
            out->volume_per_cube = (float)per_cube;
            total = per_cube * facts->radius_cubed_sum;
        }
    }
    out->fluid_size = params->fluid_size > 0 ? params->fluid_size : total > 0 ? (float)cbrt(total) : (float)(2 * radius);
    for (int c = 0; c < 3; c++) {
        bool given = params->absorption[0] >= 0;
        out->absorption[c] = given ? params->absorption[c] : params->absorption_relative[c] / out->fluid_size;
    }
}

/* Azimuth 0 is behind the eye of mns_camera_frame's straight view from the front, 90 to its right. */
static void resolve_sun(struct scene_look *look, const struct mns_params *params)
{
    double azimuth = (double)params->sun_azimuth * PI / 180, elevation = (double)params->sun_elevation * PI / 180;
    int right = look->axis_up == MNS_AXIS_X ? 1 : 0, front = look->axis_up == MNS_AXIS_Z ? 1 : 2;
    double towards = look->axis_up == MNS_AXIS_Z ? -1 : 1; /* the front of a scene with z up is -y */
    look->sun[right] = (float)(cos(elevation) * sin(azimuth));
    look->sun[front] = (float)(cos(elevation) * cos(azimuth) * towards);
    look->sun[look->axis_up] = (float)sin(elevation);
    for (int c = 0; c < 3; c++) {
        look->sun_color[c] = SUN_LIGHT[c] * params->sun_intensity;
    }
}

static void resolve_look(struct frame *out)
{
    const struct mns_params *params = &out->params;
    const struct particle_facts *facts = out->facts;
    struct scene_look *look = &out->look;
    look->axis_up = params->up_axis;
    look->axis_u = (look->axis_up + 1) % 3;
    look->axis_v = (look->axis_up + 2) % 3;
    look->up[look->axis_up] = 1;
    resolve_sun(look, params);
    look->has_floor = params->floor && params->background != MNS_BACKGROUND_TRANSPARENT && !out->scene;
    bool automatic = params->floor_height < -1e30f;
    look->floor_height = automatic ? facts->bounds_min[look->axis_up] - out->splat_radius
                                   : (float)((double)params->floor_height - facts->origin[look->axis_up]);
    look->floor_cell = params->floor_cell > 0 ? params->floor_cell : out->fluid_size / CELLS_PER_SIZE;
    const int axes[2] = {look->axis_u, look->axis_v};
    for (int i = 0; i < 2; i++) { /* whole periods of the checker dropped: the origin may be far away */
        look->floor_phase[i] = (float)fmod(facts->origin[axes[i]], 2 * (double)look->floor_cell);
    }
}

mns_result mns_frame_resolve(struct frame *out, const struct mns_frame *in, const struct particle_facts *facts, struct mns_message *message)
{
    *out = (struct frame){.facts = facts};
    if (!in->camera) {
        return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "frame.camera is NULL");
    }
    mns_result result = mns_view_resolve(&out->view, in->camera, facts->origin, message);
    if (result == MNS_OK) {
        result = mns_params_resolve(&out->params, in->params, message);
    }
    if (result == MNS_OK) {
        result = check_outputs(out, in, message);
    }
    if (result == MNS_OK) {
        result = check_scene(in, message);
    }
    if (result == MNS_OK) {
        result = check_objects(in, message);
    }
    if (result == MNS_OK) {
        out->scene = in->scene;
        out->objects = in->objects;
        out->environment = in->environment;
        if (out->params.iterations == 0) {
            out->params.iterations = default_iterations(out->params.filter);
        }
        out->depth_reference = reference_depth(&out->view, facts);
        mns_frame_resolve_sizes(out);
        resolve_look(out);
    }
    return result;
}
