/* meniscus/environment.h: a picture of everything far away: background, reflections and the sky's light. */
#ifndef MENISCUS_ENVIRONMENT_H
#define MENISCUS_ENVIRONMENT_H

#include <meniscus/common.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct mns_environment mns_environment; /* opaque; never changed once made, so that threads and renderers may share it */

/* Copies an equirectangular picture of 3 or 4 channels (the fourth is not read), linear float32 or U8/U16 sRGB, up to 2^26 pixels. Row 0 is straight up, the
 * middle column is what a viewer faces who looks at the scene from its front, its right is to his right. What is not finite counts as 0. Memory comes from the C library.
 * On success the caller owns *out; on failure *out is NULL and message (may be NULL) says why. */
MNS_API mns_result mns_environment_create(mns_environment **out, const struct mns_image *image, struct mns_message *message);
MNS_API void mns_environment_destroy(mns_environment **environment); /* sets *environment to NULL; NULL is fine */

#ifdef __cplusplus
}
#endif

#endif
