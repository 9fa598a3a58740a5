/* message.c: messages of the core. */
#include "core/message.h"

#include <stdarg.h>
#include <stdio.h>

mns_result mns_fail(struct mns_message *message, mns_result code, const char *format, ...)
{
    if (message) {
        va_list arguments;
        va_start(arguments, format);
        vsnprintf(message->text, sizeof(message->text), format, arguments);
        va_end(arguments);
    }
    return code;
}
