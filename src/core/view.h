/* view.h: the caller's camera in image space. */
#ifndef MNS_CORE_VIEW_H
#define MNS_CORE_VIEW_H

#include "core/frame.h"

/* origin: of the set's coordinates, world space. message may be NULL. */
mns_result mns_view_resolve(struct view *out, const struct mns_camera *camera, const double origin[3], struct mns_message *message);

#endif
