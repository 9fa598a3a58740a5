/* view.h: the camera of a frame, from the options and from where the fluid is. */
#ifndef MENISCUS_VIEW_H
#define MENISCUS_VIEW_H

#include "options.h"
#include "survey.h"

/* index: of the frame in the whole input; number: its own. Returns a status; on failure it was told why. */
int view_camera(struct mns_camera *camera, const struct options *options, const struct survey *survey, double index, double number);

/* Takes from a camera file what the command line leaves open: an object with eye, target, up [3], fov (or vfov_deg), orthographic,
 * near, far; they may stand in a member "camera", beside "viewport" {width, height}. Or it has "keys", such objects with a "frame" each,
 * or "frames", one for each frame of the input. Returns a status. */
int view_read_camera(struct options *options, const char *path);

/* An input that is a case file (.json): a camera file that also names "particles_file", beside it, and may give its "spacing" in metres.
 * Sets options as above and the radius, unless they are set. *particles: the file's path, to be freed. Returns a status. */
int view_read_case(struct options *options, const char *path, char **particles);
bool view_is_case(const char *path);

#endif
