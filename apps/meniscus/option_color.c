/* option_color.c: options of colours. */
#include "option_color.h"

#include "option_values.h"

#include <math.h>
#include <stdlib.h>

bool option_set_color_by(struct options *options, const char *value, struct mns_message *message)
{
    options->color.by = value;
    return *value || option_refuse(message, "the name is empty");
}

bool option_set_colormap(struct options *options, const char *value, struct mns_message *message)
{
    options->color.map = value;
    return *value || option_refuse(message, "the name is empty");
}

/* A number at the beginning of *at, which is moved behind it. */
static bool take_number(const char **at, double *out)
{
    char *end;
    *out = strtod(*at, &end);
    bool good = end != *at && isfinite(*out);
    *at = end;
    return good;
}

bool option_set_range(struct options *options, const char *value, struct mns_message *message)
{
    struct color_options *color = &options->color;
    const char *at = value;
    color->has_low = *at != ':';
    bool good = !color->has_low || take_number(&at, &color->low);
    good = good && *at++ == ':';
    color->has_high = good && *at;
    good = good && (!color->has_high || take_number(&at, &color->high));
    return (good && !*at) ||
           option_refuse(message, "'%s' must be A:B, two numbers of which either may be left out, such as 0:5 or 0:", value);
}

bool option_set_legend(struct options *options, const char *value, struct mns_message *message)
{
    (void)value;
    (void)message;
    return options->color.legend = true;
}

bool option_set_units(struct options *options, const char *value, struct mns_message *message)
{
    (void)message;
    options->color.units = value;
    return true;
}
