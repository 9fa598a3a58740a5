/* camera.c: view and projection matrices. */
#include <meniscus/camera.h>

#include <math.h>
#include <stdbool.h>
#include <string.h>

static const double PI = 3.14159265358979323846;

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static void cross(double out[3], const double a[3], const double b[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

/* false: too short, or not finite. */
static bool normalize(double v[3])
{
    double length = sqrt(dot(v, v));
    if (!(length > 0) || !isfinite(length)) {
        return false;
    }
    for (int i = 0; i < 3; i++) {
        v[i] /= length;
    }
    return true;
}

void mns_camera_init_sized(struct mns_camera *camera, int width, int height, size_t size)
{
    memset(camera, 0, size);
    camera->struct_size = size;
    camera->width = width;
    camera->height = height;
    for (int i = 0; i < 4; i++) {
        camera->view[5 * i] = 1;
    }
    mns_camera_perspective(camera, 45, 0.01, 1e6);
}

mns_result mns_camera_look_at(struct mns_camera *camera, const double eye[3], const double target[3], const double up[3])
{
    double back[3] = {eye[0] - target[0], eye[1] - target[1], eye[2] - target[2]};
    if (!normalize(back)) {
        return MNS_ERR_INVALID_ARGUMENT;
    }
    double right[3], above[3] = {up[0], up[1], up[2]};
    if (!normalize(above)) {
        return MNS_ERR_INVALID_ARGUMENT;
    }
    if (fabs(dot(above, back)) > 1 - 1e-9) { /* looking straight up or down: any axis that is not the line of sight */
        int axis = fabs(back[2]) < 0.9 ? 2 : 0;
        above[0] = above[1] = above[2] = 0;
        above[axis] = -1;
    }
    cross(right, above, back);
    normalize(right);
    cross(above, back, right);
    const double *rows[3] = {right, above, back};
    for (int row = 0; row < 3; row++) {
        for (int column = 0; column < 3; column++) {
            camera->view[4 * column + row] = rows[row][column];
        }
        camera->view[12 + row] = -dot(rows[row], eye);
        camera->view[4 * row + 3] = 0;
    }
    camera->view[15] = 1;
    return MNS_OK;
}

mns_result mns_camera_frustum(struct mns_camera *camera, double left, double right, double bottom, double top, double near_plane,
                              double far_plane)
{
    if (!(near_plane > 0) || !(far_plane > near_plane) || !(right > left) || !(top > bottom)) {
        return MNS_ERR_INVALID_ARGUMENT;
    }
    double *p = camera->projection;
    memset(p, 0, sizeof(camera->projection));
    p[0] = 2 * near_plane / (right - left);
    p[5] = 2 * near_plane / (top - bottom);
    p[8] = (right + left) / (right - left);
    p[9] = (top + bottom) / (top - bottom);
    bool ends = isfinite(far_plane);
    p[10] = ends ? -(far_plane + near_plane) / (far_plane - near_plane) : -1;
    p[11] = -1;
    p[14] = -2 * near_plane * (ends ? far_plane / (far_plane - near_plane) : 1);
    camera->near_plane = near_plane;
    camera->far_plane = far_plane;
    return MNS_OK;
}

mns_result mns_camera_perspective(struct mns_camera *camera, double fov_y, double near_plane, double far_plane)
{
    if (!(fov_y > 0) || !(fov_y < 180) || camera->width < 1 || camera->height < 1) {
        return MNS_ERR_INVALID_ARGUMENT;
    }
    double top = near_plane * tan(fov_y * PI / 360), right = top * camera->width / camera->height;
    return mns_camera_frustum(camera, -right, right, -top, top, near_plane, far_plane);
}

mns_result mns_camera_orthographic(struct mns_camera *camera, double view_height, double near_plane, double far_plane)
{
    if (!(view_height > 0) || !isfinite(view_height) || !(far_plane > near_plane) || camera->width < 1 || camera->height < 1) {
        return MNS_ERR_INVALID_ARGUMENT;
    }
    double *p = camera->projection;
    memset(p, 0, sizeof(camera->projection));
    p[0] = 2 / (view_height * camera->width / camera->height);
    p[5] = 2 / view_height;
    bool ends = isfinite(far_plane);
    p[10] = ends ? -2 / (far_plane - near_plane) : 0;
    p[14] = ends ? -(far_plane + near_plane) / (far_plane - near_plane) : -1;
    p[15] = 1;
    camera->near_plane = near_plane;
    camera->far_plane = far_plane;
    return MNS_OK;
}

/* The direction from the fluid to the eye when framing: in front, to the right, above, as a fraction of each axis. */
static void framing_direction(double out[3], int up_axis)
{
    static const double azimuth = 28, elevation = 22; /* degrees */
    double side = sin(azimuth * PI / 180) * cos(elevation * PI / 180), front = cos(azimuth * PI / 180) * cos(elevation * PI / 180);
    /* up y: front is +z, right +x. up z: front is -y, right +x. up x: front is +z, right +y. */
    out[up_axis] = sin(elevation * PI / 180);
    out[up_axis == 0 ? 1 : 0] = side;
    out[up_axis == 2 ? 1 : 2] = up_axis == 2 ? -front : front;
}

/* The box to frame, in the camera's axes: corner k at right x[k], above y[k], back z[k] from the centre. */
struct framed_box {
    double x[8], y[8], z[8];
};

/* How far the eye must stand back, and how far to the right and above the centre, so that the box fills a picture of these half-widths
 * with `room` around it. The box's sides meet the picture's sides where the eye looks at the middle of what it sees, not of the box. */
static double fit_perspective(const struct framed_box *box, double tan_x, double tan_y, double room, double pan[2])
{
    enum { ROUNDS = 8 }; /* each leaves about a tenth of the error */
    double distance = 0;
    pan[0] = pan[1] = 0;
    for (int round = 0; round < ROUNDS; round++) {
        distance = 0;
        for (int k = 0; k < 8; k++) {
            double x = fabs(box->x[k] - pan[0]) / tan_x, y = fabs(box->y[k] - pan[1]) / tan_y;
            distance = fmax(distance, box->z[k] + room * fmax(x, y));
        }
        double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
        for (int k = 0; k < 8; k++) {
            double depth = distance - box->z[k];
            const double at[2] = {(box->x[k] - pan[0]) / depth, (box->y[k] - pan[1]) / depth};
            for (int i = 0; i < 2; i++) {
                low[i] = fmin(low[i], at[i]);
                high[i] = fmax(high[i], at[i]);
            }
        }
        for (int i = 0; i < 2; i++) {
            pan[i] += 0.5 * (low[i] + high[i]) * distance;
        }
    }
    return distance;
}

/* Largest distance from the centre. On its own: in the loop that fills the box gcc 12 for ARM stops with an internal error. */
static double reach(const double at[8])
{
    double most = 0;
    for (int k = 0; k < 8; k++) {
        most = fmax(most, fabs(at[k]));
    }
    return most;
}

/* Right, above and back of the framing eye. */
static void framing_axes(double axes[3][3], int up_axis)
{
    double up[3] = {0};
    up[up_axis] = 1;
    framing_direction(axes[2], up_axis);
    normalize(axes[2]);
    cross(axes[0], up, axes[2]);
    normalize(axes[0]);
    cross(axes[1], axes[2], axes[0]);
}

mns_result mns_camera_frame(struct mns_camera *camera, const double bounds_min[3], const double bounds_max[3], double margin, int up_axis,
                            double fov_y)
{
    if (up_axis < 0 || up_axis > 2 || !(fov_y >= 0) || !(fov_y < 180) || !(margin >= 0) || camera->width < 1 || camera->height < 1) {
        return MNS_ERR_INVALID_ARGUMENT;
    }
    double center[3], half[3], diagonal = 0;
    for (int i = 0; i < 3; i++) {
        center[i] = 0.5 * (bounds_min[i] + bounds_max[i]);
        half[i] = 0.5 * (bounds_max[i] - bounds_min[i]) + margin;
        diagonal += half[i] * half[i];
    }
    diagonal = sqrt(diagonal);
    if (!isfinite(diagonal)) {
        return MNS_ERR_INVALID_ARGUMENT;
    }
    if (diagonal <= 0) {
        half[0] = half[1] = half[2] = 0.5;
        diagonal = 0.9;
    }
    double axes[3][3];
    framing_axes(axes, up_axis);
    struct framed_box box;
    for (int corner = 0; corner < 8; corner++) {
        double p[3];
        for (int i = 0; i < 3; i++) {
            p[i] = corner >> i & 1 ? half[i] : -half[i];
        }
        box.x[corner] = dot(p, axes[0]);
        box.y[corner] = dot(p, axes[1]);
        box.z[corner] = dot(p, axes[2]);
    }

    static const double room = 1.08; /* around the box */
    double aspect = (double)camera->width / camera->height, tan_y = tan(fov_y * PI / 360), pan[2] = {0, 0};
    double distance = fov_y > 0 ? fit_perspective(&box, tan_y * aspect, tan_y, room, pan) : 2 * diagonal;
    double eye[3], target[3];
    for (int i = 0; i < 3; i++) {
        target[i] = center[i] + pan[0] * axes[0][i] + pan[1] * axes[1][i];
        eye[i] = target[i] + distance * axes[2][i];
    }
    const double up[3] = {up_axis == 0, up_axis == 1, up_axis == 2};
    mns_result result = mns_camera_look_at(camera, eye, target, up);
    if (result != MNS_OK) {
        return result;
    }
    double near_plane = fmax(distance - 2 * diagonal, distance * 1e-3), far_plane = 1e3 * (distance + diagonal);
    return fov_y > 0 ? mns_camera_perspective(camera, fov_y, near_plane, far_plane)
                     : mns_camera_orthographic(camera, 2 * room * fmax(reach(box.y), reach(box.x) / aspect), near_plane, far_plane);
}
