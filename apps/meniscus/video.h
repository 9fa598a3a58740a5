/* video.h: pictures to a video: through ffmpeg, which is another program, or as raw YUV4MPEG2 (.y4m). */
#ifndef MENISCUS_VIDEO_H
#define MENISCUS_VIDEO_H

#include "options.h"

/* Whether the name ends as a video's does: .mp4, .mkv, .webm, .y4m. */
bool video_is(const char *path);

struct encoder; /* opaque; one of ffmpeg's */

/* Looks before the first picture is drawn whether such a video can be made: the options fit, and ffmpeg is there with its encoder (NULL: none
 * is needed). path: "-" for YUV4MPEG2 on standard output. Returns a status; on failure it was told why. */
int video_check(const char *path, const struct options *options, const struct encoder **encoder);

struct video; /* opaque; used by one thread at a time. Nothing below tells anything: message says why it failed */

/* What video_check has looked at. path is kept. NULL: failed. */
struct video *video_open(const char *path, const struct encoder *encoder, const struct options *options, struct mns_message *message);

/* Adds a picture: 3 channels U8 of the options' size. */
bool video_add(struct video *video, const struct mns_image *image, struct mns_message *message);

/* Ends the video and frees it. It comes to stand at its path where it is whole; else the pictures that it has got are kept beside, as
 * "out.part.mp4", and message says so (else it is ""). On failure nothing is left behind. */
bool video_close(struct video *video, bool whole, struct mns_message *message);

#endif
