/* schema.c: docs/look.schema.json: what a look file may hold, made from the table of parameters (JSON Schema, draft 2020-12). */
#include "json_file.h"
#include "look.h"

#include <meniscus/params.h>

#include <stdio.h>
#include <string.h>

static void add_default(cJSON *property, const struct mns_param *row)
{
    struct mns_params defaults;
    char text[96];
    mns_params_init(&defaults);
    mns_params_get(&defaults, row->name, text, sizeof(text));
    look_add_value(property, "default", row, text);
}

static cJSON *number_of(const struct mns_param *row)
{
    cJSON *number = cJSON_CreateObject();
    cJSON_AddStringToObject(number, "type", row->type == MNS_PARAM_INT ? "integer" : "number");
    json_add_number(number, "minimum", row->minimum);
    json_add_number(number, "maximum", row->maximum);
    return number;
}

static cJSON *array_of(const struct mns_param *row)
{
    cJSON *array = cJSON_CreateObject();
    cJSON_AddStringToObject(array, "type", "array");
    cJSON_AddItemToObject(array, "items", number_of(row));
    json_add_number(array, "minItems", row->components);
    json_add_number(array, "maxItems", row->components);
    return array;
}

static cJSON *pattern_of(const char *pattern)
{
    cJSON *text = cJSON_CreateObject();
    cJSON_AddStringToObject(text, "type", "string");
    cJSON_AddStringToObject(text, "pattern", pattern);
    return text;
}

static cJSON *constant_of(const char *word)
{
    cJSON *constant = cJSON_CreateObject();
    cJSON_AddStringToObject(constant, "const", word);
    return constant;
}

static void add_choices(cJSON *property, const struct mns_param *row)
{
    cJSON *choices = cJSON_AddArrayToObject(property, "enum");
    for (int i = 0; row->choices[i]; i++) {
        if (*row->choices[i]) {
            cJSON_AddItemToArray(choices, cJSON_CreateString(row->choices[i]));
        }
    }
}

/* A number, three, a colour RRGGBB, or auto, as the row allows. */
static void add_numbers(cJSON *property, const struct mns_param *row)
{
    cJSON *any = cJSON_AddArrayToObject(property, "anyOf");
    cJSON_AddItemToArray(any, row->components == 3 ? array_of(row) : number_of(row));
    if (row->components == 3) {
        cJSON_AddItemToArray(any, pattern_of("^#?[0-9a-fA-F]{6}$"));
    }
    if (row->has_auto) {
        cJSON_AddItemToArray(any, constant_of("auto"));
    }
}

static void add_property(cJSON *properties, const struct mns_param *row)
{
    char description[512];
    const char *open = *row->unit ? " (" : "", *close = *row->unit ? ")" : "";
    cJSON *property = cJSON_AddObjectToObject(properties, row->name);
    snprintf(description, sizeof(description), "%s: %s%s%s%s", row->group, row->help, open, row->unit, close);
    cJSON_AddStringToObject(property, "description", description);
    if (row->type == MNS_PARAM_BOOL) {
        cJSON_AddStringToObject(property, "type", "boolean");
    } else if (row->type == MNS_PARAM_ENUM) {
        add_choices(property, row);
    } else {
        add_numbers(property, row);
    }
    add_default(property, row);
}

int look_write_schema(const char *path)
{
    cJSON *schema = cJSON_CreateObject();
    cJSON_AddStringToObject(schema, "$schema", "https://json-schema.org/draft/2020-12/schema");
    cJSON_AddStringToObject(schema, "title", "Meniscus look");
    cJSON_AddStringToObject(
        schema, "description",
        "Parameters of a picture that differ from the defaults: meniscus render --look FILE.json. Lengths in r are multiples "
        "of the splat radius, lengths in L of the fluid's own size. Written by meniscus --help-look-schema.");
    cJSON_AddStringToObject(schema, "type", "object");
    cJSON_AddBoolToObject(schema, "additionalProperties", 0);
    cJSON *properties = cJSON_AddObjectToObject(schema, "properties");
    cJSON *link = cJSON_AddObjectToObject(properties, "$schema");
    cJSON_AddStringToObject(link, "type", "string");
    cJSON_AddStringToObject(link, "description", "where this schema is, for editors");
    for (size_t i = 0; i < mns_param_count(); i++) {
        add_property(properties, mns_param_info(i));
    }
    return json_write(path, schema);
}
