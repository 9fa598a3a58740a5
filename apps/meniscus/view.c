/* view.c: the camera of a frame, from the options and from where the fluid is. */
#include "view.h"

#include "program.h"

#include <math.h>
#include <string.h>

static const double DEGREE = 3.14159265358979323846 / 180;

/* Where a framed camera stands, and the point of its line of sight that is nearest to the box's centre. */
static void line_of_sight(const struct mns_camera *camera, const double center[3], double eye[3], double target[3])
{
    const double *v = camera->view;
    double distance = 0;
    for (int i = 0; i < 3; i++) { /* view = [R t], eye = -R^T t; the third row of R points backwards */
        eye[i] = -(v[4 * i] * v[12] + v[4 * i + 1] * v[13] + v[4 * i + 2] * v[14]);
        distance += (eye[i] - center[i]) * v[4 * i + 2];
    }
    for (int i = 0; i < 3; i++) {
        target[i] = eye[i] - distance * v[4 * i + 2];
    }
}

/* Turns a point about the line through pivot along an axis of the world. */
static void turn(double point[3], const double pivot[3], int axis, double angle)
{
    int a = (axis + 1) % 3, b = (axis + 2) % 3;
    double c = cos(angle), s = sin(angle), x = point[a] - pivot[a], y = point[b] - pivot[b];
    point[a] = pivot[a] + c * x - s * y;
    point[b] = pivot[b] + s * x + c * y;
}

/* Near and far around all particles: no nearer than a thousandth of the distance, since depth is float32. */
static void depth_range(const struct survey *survey, const double eye[3], double *near_plane, double *far_plane)
{
    double distance = 0, half_diagonal = 0;
    for (int i = 0; i < 3; i++) {
        double away = eye[i] - 0.5 * (survey->bounds_min[i] + survey->bounds_max[i]);
        double half = 0.5 * (survey->bounds_max[i] - survey->bounds_min[i]) + 2 * survey->radius;
        distance += away * away;
        half_diagonal += half * half;
    }
    distance = sqrt(distance);
    half_diagonal = half_diagonal > 0 ? sqrt(half_diagonal) : 1;
    *near_plane = fmax(distance - 2 * half_diagonal, 1e-3 * fmax(distance, half_diagonal));
    *far_plane = 1e3 * (distance + half_diagonal);
}

static int fail_view(void)
{
    return program_usage("the camera cannot be set so: --eye and --target must differ, and all its numbers must be finite");
}

/* Cubic through keys a and b, with the slopes that their neighbours give (Catmull and Rom 1974, at uneven steps). t: 0 to 1. */
static double between(const double value[4], const double frame[4], double t)
{
    double step = frame[2] - frame[1], rise = value[2] - value[1];
    double slope_a = frame[2] > frame[0] ? step * (value[2] - value[0]) / (frame[2] - frame[0]) : rise;
    double slope_b = frame[3] > frame[1] ? step * (value[3] - value[1]) / (frame[3] - frame[1]) : rise;
    return value[1] + t * (slope_a + t * (3 * rise - 2 * slope_a - slope_b + t * (slope_a + slope_b - 2 * rise)));
}

/* The camera of the keys at a frame: the first before them, the last behind them. */
static struct camera_options camera_at(const struct camera_key *keys, size_t count, double number)
{
    size_t after = 0;
    while (after < count && keys[after].frame <= number) {
        after++;
    }
    if (after == 0 || after == count) {
        return keys[after ? count - 1 : 0].camera;
    }
    const struct camera_key *around[4] = {&keys[after > 1 ? after - 2 : 0], &keys[after - 1], &keys[after],
                                          &keys[after + 1 < count ? after + 1 : after]};
    struct camera_options out = around[1]->camera;
    double t = (number - around[1]->frame) / (around[2]->frame - around[1]->frame), frames[4];
    for (int k = 0; k < 4; k++) {
        frames[k] = around[k]->frame;
    }
#define BETWEEN(field)                                                                                                                     \
    between((double[]){around[0]->camera.field, around[1]->camera.field, around[2]->camera.field, around[3]->camera.field}, frames, t)
    for (int i = 0; i < 3; i++) {
        out.eye[i] = BETWEEN(eye[i]);
        out.target[i] = BETWEEN(target[i]);
        out.up[i] = BETWEEN(up[i]);
    }
    out.fov = fmin(fmax(BETWEEN(fov), 0.01), 179);
    out.orthographic = out.orthographic > 0 ? fmax(BETWEEN(orthographic), 1e-3 * out.orthographic) : 0;
#undef BETWEEN
    return out;
}

int view_camera(struct mns_camera *camera, const struct options *options, const struct survey *survey, double index, double number)
{
    struct camera_options chosen =
        options->key_count ? camera_at(options->keys, options->key_count, options->keys_by_index ? index : number) : options->camera;
    chosen.orbit = options->camera.orbit;
    const struct camera_options *wanted = &chosen;
    int up_axis = options->params.up_axis;
    double eye[3], target[3], center[3], up[3] = {0}, near_plane, far_plane;
    mns_camera_init(camera, options->width, options->height);
    if (mns_camera_frame(camera, survey->inner_min, survey->inner_max, survey->radius, up_axis,
                         wanted->orthographic > 0 ? 0 : wanted->fov) != MNS_OK) {
        return fail_view();
    }
    for (int i = 0; i < 3; i++) {
        center[i] = 0.5 * (survey->inner_min[i] + survey->inner_max[i]);
    }
    line_of_sight(camera, center, eye, target);
    up[up_axis] = 1;
    for (int i = 0; i < 3; i++) {
        double away = eye[i] - target[i];
        target[i] = wanted->has_target ? wanted->target[i] : wanted->has_eye ? center[i] : target[i];
        eye[i] = wanted->has_eye ? wanted->eye[i] : target[i] + away;
        up[i] = wanted->has_up ? wanted->up[i] : up[i];
    }
    const double *pivot = wanted->has_target ? wanted->target : center;
    double angle = fmod(wanted->orbit * index, 360) * DEGREE;
    turn(eye, pivot, up_axis, angle);
    turn(target, pivot, up_axis, angle);
    depth_range(survey, eye, &near_plane, &far_plane);
    near_plane = wanted->near_plane > 0 ? wanted->near_plane : near_plane;
    far_plane = wanted->far_plane > 0 ? wanted->far_plane : fmax(far_plane, 10 * near_plane);
    mns_result result = mns_camera_look_at(camera, eye, target, up);
    if (result == MNS_OK) {
        result = wanted->orthographic > 0 ? mns_camera_orthographic(camera, wanted->orthographic, near_plane, far_plane)
                                          : mns_camera_perspective(camera, wanted->fov, near_plane, far_plane);
    }
    return result == MNS_OK ? STATUS_DONE : fail_view();
}
