/* view.c: the caller's camera, checked and turned into image space around the set's origin. */
#include "core/view.h"

#include "core/message.h"

#include <math.h>

enum { SIZE_MAX_PIXELS = 32768 };

/* Nearest that fluid may be, metres: what is at the eye or behind it has no place in a picture, even an orthographic one. */
static const float NEAR_LEAST = 1e-20f;

/* So that products stay finite: a camera farther from the particles than this, metres, sees as much of them from here, which is nothing; and
 * bounds of focal lengths, pixels. */
static const double DISTANCE_MAX = 1e15, FOCAL_LEAST = 1e-18, FOCAL_MAX = 1e18;

/* How far a view matrix may be from a rotation: engines keep theirs in float. */
static const double ROTATION_TOLERANCE = 1e-3;

/* Element of a column-major 4 x 4 matrix. */
static double at(const double m[16], int row, int column) { return m[4 * column + row]; }

static mns_result check_camera(const struct mns_camera *camera, struct mns_message *message)
{
    if (camera->width < 1 || camera->height < 1 || camera->width > SIZE_MAX_PIXELS || camera->height > SIZE_MAX_PIXELS) {
        return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "the picture is %d x %d pixels; it must be 1 to %d each way", camera->width,
                        camera->height, SIZE_MAX_PIXELS);
    }
    for (int i = 0; i < 16; i++) {
        if (!isfinite(camera->view[i]) || !isfinite(camera->projection[i])) {
            return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "the camera's matrices hold a number that is not finite");
        }
    }
    if (!isfinite(camera->near_plane) || !(camera->far_plane > camera->near_plane)) {
        return mns_fail(message, MNS_ERR_INVALID_ARGUMENT,
                        "the camera's near plane is at %g and its far plane at %g; far must be beyond near", camera->near_plane,
                        camera->far_plane);
    }
    return MNS_OK;
}

/* Three rows of unit length, at right angles, right-handed. */
static bool is_rotation(const double m[16])
{
    for (int i = 0; i < 3; i++) {
        for (int j = i; j < 3; j++) {
            double product = 0;
            for (int k = 0; k < 3; k++) {
                product += at(m, i, k) * at(m, j, k);
            }
            if (fabs(product - (i == j)) > ROTATION_TOLERANCE) {
                return false;
            }
        }
    }
    double determinant = 0;
    for (int k = 0; k < 3; k++) {
        determinant += at(m, 0, k) * (at(m, 1, (k + 1) % 3) * at(m, 2, (k + 2) % 3) - at(m, 1, (k + 2) % 3) * at(m, 2, (k + 1) % 3));
    }
    return determinant > 0;
}

/* Focal lengths and centre from the rows x, y, w of the projection. */
static mns_result resolve_projection(struct view *out, const struct mns_camera *camera, struct mns_message *message)
{
    const double *p = camera->projection;
    double per_depth = -at(p, 3, 2), constant = at(p, 3, 3);
    bool perspective = per_depth > 0 && constant == 0, orthographic = per_depth == 0 && constant > 0;
    bool skewed = at(p, 3, 0) != 0 || at(p, 3, 1) != 0 || at(p, 0, 1) != 0 || at(p, 1, 0) != 0;
    if (!(perspective || orthographic) || skewed) {
        return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "the projection is neither perspective nor orthographic with upright axes");
    }
    double w = perspective ? per_depth : constant;
    /* perspective: clip x = p00 x + p02 z with z = -depth; orthographic: clip x = p00 x + p03 */
    double shift_x = perspective ? -at(p, 0, 2) / w : at(p, 0, 3) / w, shift_y = perspective ? -at(p, 1, 2) / w : at(p, 1, 3) / w;
    double strays = perspective ? fabs(at(p, 0, 3)) + fabs(at(p, 1, 3)) : fabs(at(p, 0, 2)) + fabs(at(p, 1, 2));
    const double fx = 0.5 * camera->width * at(p, 0, 0) / w, fy = 0.5 * camera->height * at(p, 1, 1) / w;
    const double cx = 0.5 * camera->width * (1 + shift_x), cy = 0.5 * camera->height * (1 - shift_y);
    if (!(fx > 0) || !(fy > 0) || strays != 0) {
        return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "the projection mirrors or shears the picture");
    }
    if (!(fmin(fx, fy) >= FOCAL_LEAST) || !(fmax(fx, fy) <= FOCAL_MAX) || !(fmax(fabs(cx), fabs(cy)) <= FOCAL_MAX)) {
        return mns_fail(
            message, MNS_ERR_INVALID_ARGUMENT,
            "the projection has focal lengths of %g x %g pixels about (%g, %g); they must be from %g to %g, the centre within %g", fx, fy,
            cx, cy, FOCAL_LEAST, FOCAL_MAX, FOCAL_MAX);
    }
    out->orthographic = orthographic;
    out->fx = (float)fx;
    out->fy = (float)fy;
    out->cx = (float)cx;
    out->cy = (float)cy;
    if (perspective && !(camera->near_plane > 0)) {
        return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "the camera's near plane is at %g; a perspective needs it beyond 0",
                        camera->near_plane);
    }
    return MNS_OK;
}

mns_result mns_view_resolve(struct view *out, const struct mns_camera *camera, const double origin[3], struct mns_message *message)
{
    mns_result result = check_camera(camera, message);
    if (result != MNS_OK) {
        return result;
    }
    *out = (struct view){.width = camera->width, .height = camera->height};
    out->near_plane = fmaxf((float)fmin(camera->near_plane, 1e30), NEAR_LEAST);
    out->far_plane = (float)fmin(camera->far_plane, 1e30);
    result = resolve_projection(out, camera, message);
    if (result != MNS_OK) {
        return result;
    }
    if (!is_rotation(camera->view)) {
        return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "the view matrix is no rotation and translation: it scales, shears or mirrors");
    }
    for (int row = 0; row < 3; row++) {
        double sign = row == 0 ? 1 : -1; /* view space is (x, -y, -z) of image space */
        double translation = sign * at(camera->view, row, 3);
        for (int column = 0; column < 3; column++) {
            out->rotation[3 * row + column] = (float)(sign * at(camera->view, row, column));
            translation += sign * at(camera->view, row, column) * origin[column];
        }
        out->translation[row] = (float)fmax(fmin(translation, DISTANCE_MAX), -DISTANCE_MAX);
    }
    return MNS_OK;
}
