/* option_scenery.c: options of what stands around the fluid. */
#include "option_scenery.h"

#include "option_values.h"

enum { MESHES_MAX = 256 }; /* as meniscus/scene.h has places */

bool option_set_foam_particles(struct options *options, const char *value, struct mns_message *message)
{
    options->foam_files[options->foam_file_count++] = value;
    return *value || option_refuse(message, "the name is empty");
}

static bool add_mesh(struct options *options, const char *value, bool container, struct mns_message *message)
{
    options->meshes[options->mesh_count++] = (struct mesh_file){.path = value, .container = container};
    if (options->mesh_count > MESHES_MAX) {
        return option_refuse(message, "%d meshes are the most that can be given", MESHES_MAX);
    }
    return *value || option_refuse(message, "the name is empty");
}

bool option_set_mesh(struct options *options, const char *value, struct mns_message *message)
{
    return add_mesh(options, value, false, message);
}

bool option_set_container(struct options *options, const char *value, struct mns_message *message)
{
    return add_mesh(options, value, true, message);
}

bool option_set_environment(struct options *options, const char *value, struct mns_message *message)
{
    options->environment = value;
    return *value || option_refuse(message, "the name is empty");
}

bool option_set_mesh_scale(struct options *options, const char *value, struct mns_message *message)
{
    double *scale = &options->mesh_scale;
    return (option_numbers(value, 1, scale) && *scale >= 1e-12 && *scale <= 1e12) ||
           option_refuse(message, "'%s' must be metres per unit of the files, 1e-12 to 1e12", value);
}

bool option_set_mesh_up(struct options *options, const char *value, struct mns_message *message)
{
    options->has_mesh_up = true;
    options->mesh_up = value[0] - 'x';
    return (value[0] >= 'x' && value[0] <= 'z' && !value[1]) || option_refuse(message, "'%s' is none of x, y and z", value);
}
