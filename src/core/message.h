/* message.h: messages of the core. */
#ifndef MNS_CORE_MESSAGE_H
#define MNS_CORE_MESSAGE_H

#include <meniscus/common.h>

/* Writes the text (message may be NULL) and returns code. */
mns_result mns_fail(struct mns_message *message, mns_result code, const char *format, ...)
#ifdef __GNUC__
    __attribute__((format(printf, 3, 4)))
#endif
    ;

#endif
