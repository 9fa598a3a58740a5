/* look.c: look files: a JSON object of parameters by name, numbers, words, true and false, or arrays of three numbers. */
#include "look.h"

#include "json_file.h"
#include "program.h"

#include <stdio.h>
#include <string.h>

/* The value as mns_params_set reads it; false: of no such kind. */
static bool value_text(const cJSON *value, char *text, size_t size)
{
    int length = -1;
    if (cJSON_IsString(value)) {
        length = snprintf(text, size, "%s", value->valuestring);
    } else if (cJSON_IsBool(value)) {
        length = snprintf(text, size, "%s", cJSON_IsTrue(value) ? "on" : "off");
    } else if (cJSON_IsNumber(value)) {
        length = snprintf(text, size, "%.17g", value->valuedouble);
    } else if (cJSON_IsArray(value) && cJSON_GetArraySize(value) == 3) {
        const cJSON *a = value->child, *b = a->next, *c = b->next;
        if (cJSON_IsNumber(a) && cJSON_IsNumber(b) && cJSON_IsNumber(c)) {
            length = snprintf(text, size, "%.17g,%.17g,%.17g", a->valuedouble, b->valuedouble, c->valuedouble);
        }
    }
    return length >= 0 && (size_t)length < size;
}

int look_read(const char *path, struct mns_params *params)
{
    cJSON *look = json_read(path);
    int status = look ? STATUS_DONE : STATUS_FAILED;
    const cJSON *value;
    cJSON_ArrayForEach(value, look)
    {
        if (!strcmp(value->string, "$schema")) { /* for editors */
            continue;
        }
        char text[96];
        struct mns_message message;
        if (!value_text(value, text, sizeof(text))) {
            status = program_fail("%s: \"%s\" must be a number, a word, true, false or an array of three numbers", path, value->string);
        } else if (mns_params_set(params, value->string, text, &message) != MNS_OK) {
            status = program_fail("%s: %s", path, message.text);
        }
        if (status != STATUS_DONE) {
            break;
        }
    }
    cJSON_Delete(look);
    return status;
}

void look_add_value(cJSON *look, const char *name, const struct mns_param *row, const char *text)
{
    if (row->type == MNS_PARAM_BOOL) {
        cJSON_AddBoolToObject(look, name, !strcmp(text, "on"));
    } else if (row->type == MNS_PARAM_ENUM || !strcmp(text, "auto")) {
        cJSON_AddStringToObject(look, name, text);
    } else if (row->components == 3) {
        char array[104];
        snprintf(array, sizeof(array), "[%s]", text);
        cJSON_AddRawToObject(look, name, array);
    } else {
        cJSON_AddRawToObject(look, name, text);
    }
}

static cJSON *differences(const struct mns_params *params)
{
    cJSON *look = cJSON_CreateObject();
    struct mns_params defaults;
    mns_params_init(&defaults);
    for (size_t i = 0; look && i < mns_param_count(); i++) {
        const struct mns_param *row = mns_param_info(i);
        char text[96], usual[96];
        mns_params_get(params, row->name, text, sizeof(text));
        mns_params_get(&defaults, row->name, usual, sizeof(usual));
        if (strcmp(text, usual) != 0) {
            look_add_value(look, row->name, row, text);
        }
    }
    return look;
}

int look_write(const char *path, const struct mns_params *params) { return json_write(path, differences(params)); }

char *look_text(const struct mns_params *params)
{
    cJSON *look = differences(params);
    char *text = look ? cJSON_PrintUnformatted(look) : NULL;
    cJSON_Delete(look);
    return text;
}
