/* preset.c: looks by name. A new one is a row of the table. */
#include "preset.h"

#include "names.h"
#include "option_values.h"

#include <stdio.h>
#include <string.h>

enum { SETTINGS = sizeof(((struct preset *)0)->settings) / sizeof(struct preset_setting) };

/* Coefficients are in 1/L, so that a look is the same for a cup and for a lake. */
const struct preset presets[] = {
    {"water", "clear water: the defaults", {{NULL, NULL}}},
    {"murky",
     "a river after rain: one sees a little way into it",
     {{"absorption_relative", "8,9.5,14"}, {"fluid_color", "0.06,0.05,0.02"}}},
    {"ice-blue", "glacier water: hardly any red comes through", {{"absorption_relative", "5,1.2,0.5"}, {"fluid_color", "0.02,0.17,0.36"}}},
    {"milk",
     "white and opaque, with a dull shine",
     {{"display", "opaque"},
      {"opaque_color", "0.62,0.6,0.55"},
      {"absorption_relative", "60,66,80"}, /* for its shadow */
      {"refraction_index", "1.35"},
      {"specular", "0.3"},
      {"shininess", "200"}}},
    {"oil",
     "golden and clear, with a strong shine",
     {{"absorption_relative", "0.3,1.2,7"}, {"fluid_color", "0.12,0.06,0.002"}, {"refraction_index", "1.47"}}},
    {"lava",
     "glows by itself",
     {{"absorption_relative", "300,300,300"},
      {"fluid_color", "0.62,0.07,0.006"},
      {"refraction_index", "1.6"},
      {"specular", "0.2"},
      {"shininess", "80"}}},
    {"calm",
     "a bath, a lake without wind: foam where the water breaks, and soon gone",
     {{"foam", "layered"}, {"foam_weber_low", "1"}, {"foam_weber_high", "2.5"}, {"foam_persistence", "0.5"}, {"noise_calm", "0.1"}}},
    {"river",
     "fast water between stones: foam in streaks that drift away",
     {{"foam", "layered"}, {"foam_weber_low", "0.3"}, {"foam_weber_high", "1"}, {"foam_persistence", "1.5"}, {"noise_calm", "0.5"}}},
    {"surf",
     "breaking waves: white crests, and foam that stays on the water behind them",
     {{"foam", "layered"},
      {"foam_weber_low", "0.35"},
      {"foam_weber_high", "1"},
      {"foam_air", "0.06"},
      {"foam_persistence", "2"},
      {"spray_high", "0.55"}}},
    {"waterfall",
     "falling water: white all through, with much spray",
     {{"foam", "layered"},
      {"foam_weber_low", "0.45"},
      {"foam_weber_high", "1.2"},
      {"foam_air", "0.03"},
      {"foam_persistence", "1.2"},
      {"spray_low", "0.35"},
      {"spray_high", "0.6"}}},
    {NULL, NULL, {{NULL, NULL}}},
};

const struct preset *preset_find(const char *name, struct mns_message *message)
{
    const struct preset *nearest = &presets[0];
    char list[256] = "";
    for (const struct preset *preset = presets; preset->name; preset++) {
        if (!strcmp(preset->name, name)) {
            return preset;
        }
        option_append_name(list, sizeof(list), preset->name);
        nearest = names_distance(name, preset->name) < names_distance(name, nearest->name) ? preset : nearest;
    }
    snprintf(message->text, sizeof(message->text), "there is no preset '%s'; did you mean '%s'? There are %s", name, nearest->name, list);
    return NULL;
}

void preset_apply(const struct preset *preset, struct mns_params *params)
{
    for (int i = 0; i < SETTINGS && preset->settings[i].name; i++) {
        mns_params_set(params, preset->settings[i].name, preset->settings[i].value, NULL); /* a test sees to their being right */
    }
}
