/* option_sequence.h: options of sequences and videos. Each function has the shape of struct option_row's apply. */
#ifndef MENISCUS_OPTION_SEQUENCE_H
#define MENISCUS_OPTION_SEQUENCE_H

#include "options.h"

bool option_set_frames(struct options *options, const char *value, struct mns_message *message);
bool option_set_resume(struct options *options, const char *value, struct mns_message *message);
bool option_set_keep_going(struct options *options, const char *value, struct mns_message *message);
bool option_set_retime(struct options *options, const char *value, struct mns_message *message);
bool option_set_shutter(struct options *options, const char *value, struct mns_message *message);
bool option_set_shutter_samples(struct options *options, const char *value, struct mns_message *message);
bool option_set_fps(struct options *options, const char *value, struct mns_message *message);
bool option_set_crf(struct options *options, const char *value, struct mns_message *message);
bool option_set_codec(struct options *options, const char *value, struct mns_message *message);

#endif
