/* option_table.h: one row per option. */
#ifndef MENISCUS_OPTION_TABLE_H
#define MENISCUS_OPTION_TABLE_H

#include "options.h"

struct option_row {
    const char *name;                                                                       /* "--size" */
    char letter;                                                                            /* 'o' for -o; 0: none */
    const char *argument;                                                                   /* "WxH"; NULL: takes none */
    unsigned commands;                                                                      /* enum command, or-ed */
    const char *param;                                                                      /* the parameter it sets; NULL: apply does it */
    bool (*apply)(struct options *options, const char *value, struct mns_message *message); /* false: message says what would be right */
    const char *help;
};

extern const struct option_row option_table[]; /* ends with a row without a name */

/* false: message says what would be right. */
bool option_apply(struct options *options, const struct option_row *row, const char *value, struct mns_message *message);

const char *option_command_name(enum command command);

#endif
