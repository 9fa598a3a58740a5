/* preset.h: looks by name: parameters that go together. */
#ifndef MENISCUS_PRESET_H
#define MENISCUS_PRESET_H

#include <meniscus/params.h>

struct preset_setting {
    const char *name, *value; /* as mns_params_set takes them */
};

struct preset {
    const char *name, *help;
    struct preset_setting settings[12]; /* ends with one without a name where it is not full */
};

extern const struct preset presets[]; /* ends with one without a name */

/* NULL: there is none; message says what there is, and which name is nearest. */
const struct preset *preset_find(const char *name, struct mns_message *message);

void preset_apply(const struct preset *preset, struct mns_params *params);

#endif
