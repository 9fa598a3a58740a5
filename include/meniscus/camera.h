/* meniscus/camera.h: where the picture is taken from. */
#ifndef MENISCUS_CAMERA_H
#define MENISCUS_CAMERA_H

#include <meniscus/common.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A camera and the size of its picture. Matrices are column-major and act on column vectors.
 * Only the x, y and w rows of the projection are read, so any convention of clip depth will do; near and far stand beside it. */
struct mns_camera {
    size_t struct_size;    /* set by mns_camera_init */
    int width, height;     /* pixels, 1 to 32768 each */
    double view[16];       /* world to view: a rotation and a translation, no scale */
    double projection[16]; /* view to clip, clip y up: perspective (off-centre too) or orthographic */
    double near_plane;     /* metres along the view axis, > 0 for a perspective; fluid nearer than this, or behind the eye, is cut away
                              * per pixel */
    double far_plane;      /* metres, > near_plane, may be INFINITY; fluid farther than this is not drawn */
};

/* A width x height camera at the origin that looks down -z with a vertical field of view of 45 degrees, near 0.01, far 1e6. */
MNS_API void mns_camera_init_sized(struct mns_camera *camera, int width, int height, size_t size);
static inline void mns_camera_init(struct mns_camera *camera, int width, int height)
{
    mns_camera_init_sized(camera, width, height, sizeof(*camera));
}

/* The functions below return MNS_OK, or MNS_ERR_INVALID_ARGUMENT and leave the camera as it was. All vectors are in world space, metres.
 *
 * What a draw refuses besides: projections that are skewed or mirrored, focal lengths outside 1e-18 to 1e18 pixels (orthographic: pixels per
 * metre). */

/* Sets view. When up is parallel to the line of sight another axis is taken. eye and target must differ. */
MNS_API mns_result mns_camera_look_at(struct mns_camera *camera, const double eye[3], const double target[3], const double up[3]);

/* Sets projection from a vertical field of view in (0, 180) degrees, with square pixels. */
MNS_API mns_result mns_camera_perspective(struct mns_camera *camera, double fov_y, double near_plane, double far_plane);

/* Sets an off-centre perspective: the edges of the picture on the near plane, metres in view space. */
MNS_API mns_result mns_camera_frustum(struct mns_camera *camera, double left, double right, double bottom, double top, double near_plane,
                                      double far_plane);

/* Sets an orthographic projection that shows view_height metres from bottom to top, with square pixels.
 * near_plane may be negative, which lets in no more than 0 does: depths are positive. */
MNS_API mns_result mns_camera_orthographic(struct mns_camera *camera, double view_height, double near_plane, double far_plane);

/* Sets view and projection so that the box fills the picture, seen from in front, from the right and from above.
 * fov_y in (0, 180) degrees, or orthographic when fov_y is 0. up_axis: 0, 1 or 2 for x, y or z.
 * margin: metres to add around the box (the particles' radius). */
MNS_API mns_result mns_camera_frame(struct mns_camera *camera, const double bounds_min[3], const double bounds_max[3], double margin,
                                    int up_axis, double fov_y);

#ifdef __cplusplus
}
#endif

#endif
