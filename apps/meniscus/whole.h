/* whole.h: whether a picture that is there was finished. */
#ifndef MENISCUS_WHOLE_H
#define MENISCUS_WHOLE_H

#include <meniscus/common.h>

#include <stdbool.h>

/* Whether the file at path is there, ends as its format must, and holds a picture of this shape (whose data is not read). Our own files appear whole;
 * a copy may have been cut, and a machine that lost its power leaves empty ones. */
bool whole_picture(const char *path, const struct mns_image *shape);

/* Whether there is a file at path that is not empty. */
bool whole_file(const char *path);

#endif
