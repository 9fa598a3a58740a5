/* option_table.c: what each option does with its value. */
#include "option_table.h"

#include "lab/run.h"
#include "option_color.h"
#include "option_fluid.h"
#include "option_layer.h"
#include "option_scenery.h"
#include "option_sequence.h"
#include "option_values.h"
#include "preset.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* Notes a parameter for later, when the looks have been read, and checks it now. */
static bool add_setting(struct options *options, const char *name, const char *value, struct mns_message *message)
{
    struct mns_params scratch;
    mns_params_init(&scratch);
    if (mns_params_set(&scratch, name, value, message) != MNS_OK) {
        return false;
    }
    options->settings[options->setting_count++] = (struct setting){.name = name, .value = value};
    return true;
}

/* ---- one function per option ---- */

static bool set_help(struct options *options, const char *value, struct mns_message *message)
{
    (void)value;
    (void)message;
    return options->help = true;
}

static bool set_output(struct options *options, const char *value, struct mns_message *message)
{
    options->output = value;
    return *value || option_refuse(message, "the name is empty");
}

static bool set_output_format(struct options *options, const char *value, struct mns_message *message)
{
    options->output_format = value;
    return !strcmp(value, "png") || !strcmp(value, "rgba") || !strcmp(value, "y4m") ||
           option_refuse(message, "'%s' is none of png, rgba and y4m", value);
}

static bool set_format(struct options *options, const char *value, struct mns_message *message)
{
    options->format = value;
    char list[256] = "";
    for (size_t i = 0; mns_read_format(i); i++) {
        if (!strcmp(mns_read_format(i), value)) {
            return true;
        }
        option_append_name(list, sizeof(list), mns_read_format(i));
    }
    return option_refuse(message, "this build does not read '%s'; it reads %s", value, list);
}

static bool set_size(struct options *options, const char *value, struct mns_message *message)
{
    long long width, height;
    const char *end;
    if (!option_whole(value, 1, 32768, &width, &end) || *end != 'x' || !option_count(end + 1, 1, 32768, &height)) {
        return option_refuse(message, "'%s' is no size; it must be WxH, each 1 to 32768 pixels, such as 1920x1080", value);
    }
    options->width = (int)width;
    options->height = (int)height;
    return options->has_size = true;
}

static bool set_point(const char *value, double out[3], bool *has, struct mns_message *message)
{
    *has = true;
    return option_numbers(value, 3, out) || option_refuse(message, "'%s' is no point; it must be three numbers X,Y,Z", value);
}

static bool set_eye(struct options *options, const char *value, struct mns_message *message)
{
    return set_point(value, options->camera.eye, &options->camera.has_eye, message);
}

static bool set_target(struct options *options, const char *value, struct mns_message *message)
{
    return set_point(value, options->camera.target, &options->camera.has_target, message);
}

static bool set_up(struct options *options, const char *value, struct mns_message *message)
{
    const double *up = options->camera.up;
    return set_point(value, options->camera.up, &options->camera.has_up, message) &&
           (up[0] != 0 || up[1] != 0 || up[2] != 0 || option_refuse(message, "'%s' points nowhere", value));
}

static bool set_fov(struct options *options, const char *value, struct mns_message *message)
{
    options->camera.has_fov = true;
    return (option_numbers(value, 1, &options->camera.fov) && options->camera.fov >= 0.01 && options->camera.fov <= 179) ||
           option_refuse(message, "'%s' must be a number of degrees from 0.01 to 179", value);
}

static bool set_orthographic(struct options *options, const char *value, struct mns_message *message)
{
    double *height = &options->camera.orthographic; /* the range of other lengths: see params.c */
    return (option_numbers(value, 1, height) && *height >= 1e-12 && *height <= 1e15) ||
           option_refuse(message, "'%s' must be the height of the view, 1e-12 to 1e15 metres", value);
}

static bool set_orbit(struct options *options, const char *value, struct mns_message *message)
{
    return option_numbers(value, 1, &options->camera.orbit) || option_refuse(message, "'%s' must be a number of degrees per frame", value);
}

static bool set_camera(struct options *options, const char *value, struct mns_message *message)
{
    options->camera_file = value;
    return *value || option_refuse(message, "the name is empty");
}

static bool set_attribute(struct options *options, const char *value, struct mns_message *message)
{
    const char *equals = strchr(value, '=');
    size_t length = equals ? (size_t)(equals - value) : 0;
    char list[128] = "";
    for (int i = MNS_ROLE_NONE + 1; i < MNS_ROLE_COUNT; i++) {
        const char *name = mns_role_name((enum mns_role)i);
        if (length > 0 && strlen(name) == length && !strncmp(name, value, length)) {
            options->roles[options->role_count++] = value;
            return true;
        }
        option_append_name(list, sizeof(list), name);
    }
    return option_refuse(message, "'%s' must be ROLE=NAME, with a role of %s", value, list);
}

static bool set_where(struct options *options, const char *value, struct mns_message *message)
{
    (void)message;
    options->where = value;
    return true;
}

static bool set_sun(struct options *options, const char *value, struct mns_message *message)
{
    const char *comma = strchr(value, ',');
    char *azimuth = options->sun;
    if (!comma || (size_t)(comma - value) >= sizeof(options->sun)) {
        return option_refuse(message, "'%s' must be two numbers AZ,EL in degrees", value);
    }
    memcpy(azimuth, value, (size_t)(comma - value));
    azimuth[comma - value] = '\0';
    return add_setting(options, "sun_azimuth", azimuth, message) && add_setting(options, "sun_elevation", comma + 1, message);
}

static bool set_background(struct options *options, const char *value, struct mns_message *message)
{
    if (!strcmp(value, "sky") || !strcmp(value, "transparent")) {
        return add_setting(options, "background", value, message);
    }
    if (!add_setting(options, "background_color", value, message)) {
        return option_refuse(message, "'%s' must be sky, transparent or a colour RRGGBB", value);
    }
    return add_setting(options, "background", "color", message);
}

static bool set_parameter(struct options *options, const char *value, struct mns_message *message)
{
    const char *equals = strchr(value, '='), *dot = strchr(value, '.');
    char name[64];
    if (options->command == COMMAND_RENDER && equals && dot && dot < equals) {
        return option_set_of_fluid(options, value, message);
    }
    if (!equals || (size_t)(equals - value) >= sizeof(name)) {
        return option_refuse(message, "'%s' must be NAME=VALUE", value);
    }
    memcpy(name, value, (size_t)(equals - value));
    name[equals - value] = '\0';
    const struct mns_param *row = mns_param_find(name);
    if (!row) { /* for its message */
        return add_setting(options, name, equals + 1, message);
    }
    return add_setting(options, row->name, equals + 1, message);
}

static bool set_look(struct options *options, const char *value, struct mns_message *message)
{
    options->looks[options->look_count++] = value;
    return *value || option_refuse(message, "the name is empty");
}

static bool set_preset(struct options *options, const char *value, struct mns_message *message)
{
    const struct preset *preset = preset_find(value, message);
    options->presets[options->preset_count] = preset;
    options->preset_count += preset != NULL;
    return preset != NULL;
}

static bool set_save_look(struct options *options, const char *value, struct mns_message *message)
{
    options->save_look = value;
    return *value || option_refuse(message, "the name is empty");
}

static bool set_backend(struct options *options, const char *value, struct mns_message *message)
{
    options->backend = !strcmp(value, "cpu") ? MNS_BACKEND_CPU : MNS_BACKEND_AUTO;
    return options->backend == MNS_BACKEND_CPU || !strcmp(value, "auto") ||
           option_refuse(message, "'%s' is none of this build's backends: auto, cpu", value);
}

static bool set_threads(struct options *options, const char *value, struct mns_message *message)
{
    long long threads;
    if (!option_count(value, 1, 1024, &threads)) {
        return option_refuse(message, "'%s' must be a whole number from 1 to 1024", value);
    }
    options->threads = (int)threads;
    return true;
}

static bool set_isa(struct options *options, const char *value, struct mns_message *message)
{
    for (int i = MNS_ISA_SCALAR; mns_isa_name((enum mns_isa)i); i++) {
        if (!strcmp(mns_isa_name((enum mns_isa)i), value)) {
            options->isa = (enum mns_isa)i;
            return mns_isa_available(options->isa) || option_refuse(message, "%s is not in this build or not on this machine", value);
        }
    }
    return option_refuse(message, "'%s' is none of scalar, sse2, avx2, avx512 and neon", value);
}

static bool set_stats(struct options *options, const char *value, struct mns_message *message)
{
    options->stats = value;
    return *value || option_refuse(message, "the name is empty");
}

static bool set_json(struct options *options, const char *value, struct mns_message *message)
{
    (void)value;
    (void)message;
    return options->json = true;
}

static bool set_quiet(struct options *options, const char *value, struct mns_message *message)
{
    (void)value;
    (void)message;
    return options->quiet = true;
}

static bool set_verbose(struct options *options, const char *value, struct mns_message *message)
{
    (void)value;
    (void)message;
    return options->verbose = true;
}

static bool set_repeat(struct options *options, const char *value, struct mns_message *message)
{
    return option_count(value, 1, 1000000, &options->repeat) ||
           option_refuse(message, "'%s' must be a whole number from 1 to 1000000", value);
}

static bool set_warmup(struct options *options, const char *value, struct mns_message *message)
{
    return option_count(value, 0, 1000000, &options->warmup) ||
           option_refuse(message, "'%s' must be a whole number from 0 to 1000000", value);
}

/* 1000, 100k, 10M. */
static bool set_particles(struct options *options, const char *value, struct mns_message *message)
{
    static const long long most = 4294967231LL; /* 2^32 - 65, as in meniscus/particles.h */
    const char *end;
    bool good = option_whole(value, 1, most, &options->particles, &end);
    long long unit = good && *end == 'k' ? 1000 : good && *end == 'M' ? 1000000 : 1;
    good = good && !end[unit > 1] && options->particles <= most / unit;
    options->particles *= unit;
    return good || option_refuse(message, "'%s' must be a whole number from 1 to %lld, such as 1000, 100k or 10M", value, most);
}

/* "a,b,c" into bits by number. */
static bool set_names(const char *value, int (*find)(const char *name), const char *(*name_of)(int number), int count, unsigned long *out,
                      struct mns_message *message)
{
    for (const char *at = value;; at++) {
        char name[64], list[512] = "";
        size_t length = strcspn(at, ",");
        snprintf(name, sizeof(name), "%.*s", (int)length, at);
        int number = find(name);
        if (number < 0) {
            for (int i = 0; i < count; i++) {
                option_append_name(list, sizeof(list), name_of(i));
            }
            return option_refuse(message, "'%s' is none of %s", name, list);
        }
        *out |= 1UL << number;
        at += length;
        if (!*at) {
            return true;
        }
    }
}

static bool set_lab_filters(struct options *options, const char *value, struct mns_message *message)
{
    return set_names(value, lab_filter_find, lab_filter_name, lab_filter_count(), &options->lab_filters, message);
}

static bool set_lab_scenes(struct options *options, const char *value, struct mns_message *message)
{
    return set_names(value, lab_scene_find, lab_scene_name, lab_scene_count(), &options->lab_scenes, message);
}

static bool set_equal_time(struct options *options, const char *value, struct mns_message *message)
{
    return (option_numbers(value, 1, &options->equal_time) && options->equal_time > 0) ||
           option_refuse(message, "'%s' must be a number of milliseconds above 0", value);
}

static bool set_pictures(struct options *options, const char *value, struct mns_message *message)
{
    options->pictures = value;
    return *value || option_refuse(message, "the name is empty");
}

static bool set_plot(struct options *options, const char *value, struct mns_message *message)
{
    options->plot = value;
    return *value || option_refuse(message, "the name is empty");
}

static bool set_csv(struct options *options, const char *value, struct mns_message *message)
{
    (void)value;
    (void)message;
    return options->csv = true;
}

/* ---- the table ---- */

enum {
    DRAWS = COMMAND_RENDER | COMMAND_BENCH,
    SMOOTHS = COMMAND_RENDER | COMMAND_BENCH | COMMAND_LAB,
    READS = COMMAND_RENDER | COMMAND_BENCH | COMMAND_INFO | COMMAND_CONVERT,
    ALL = COMMAND_RENDER | COMMAND_BENCH | COMMAND_INFO | COMMAND_SAMPLE | COMMAND_LAB | COMMAND_CONVERT
};

const struct option_row option_table[] = {
    {"--output", 'o', "OUTPUT", COMMAND_RENDER, NULL, set_output,
     "a picture (.png, .npy), for several frames a pattern such as out_%04d.png, numbered as the inputs are; a video (.mp4, .mkv, .webm, "
     ".y4m); - for standard output"},
    {"--output", 'o', "FILE", COMMAND_SAMPLE, NULL, set_output,
     "the particles: .npz, .ply, .vtp or .bgeo (all attributes), .npy (positions)"},
    {"--output", 'o', "OUTPUT", COMMAND_CONVERT, NULL, set_output,
     "the particles: .npz, .ply, .vtp or .bgeo (all attributes), .npy (positions); for several files a pattern such as out_%04d.npz"},
    {"--output-format", 0, "FORMAT", COMMAND_RENDER, NULL, set_output_format, "of standard output: png, rgba (bytes, row by row) or y4m"},
    {"--output", 'o', "FILE", COMMAND_LAB, NULL, set_output, "the table (standard output)"},
    {"--particles", 0, "N", COMMAND_SAMPLE, NULL, set_particles, "how many particles: 1000, 100k, 10M"},

    {"--fluid", 0, "NAME=FILES", COMMAND_RENDER, NULL, option_set_fluid,
     "one of several fluids: a file, a folder, a pattern or a .pvd, as INPUT, which may be left out then; --set NAME.PARAMETER=VALUE is "
     "for it "
     "alone; repeatable"},
    {"--size", 0, "WxH", DRAWS, NULL, set_size, "pixels of the picture (1920x1080)"},
    {"--size", 0, "WxH", COMMAND_LAB, NULL, set_size, "pixels of the pictures; larger ones show more particles of the same size (640x480)"},
    {"--eye", 0, "X,Y,Z", DRAWS, NULL, set_eye, "where the camera stands; what is left out is framed from the particles"},
    {"--target", 0, "X,Y,Z", DRAWS, NULL, set_target, "what it looks at"},
    {"--up", 0, "X,Y,Z", DRAWS, NULL, set_up, "which way is up in the picture (the up axis)"},
    {"--fov", 0, "DEG", DRAWS, NULL, set_fov, "vertical field of view (45)"},
    {"--orthographic", 0, "HEIGHT", DRAWS, NULL, set_orthographic, "parallel projection of this height in metres"},
    {"--orbit", 0, "DEG", DRAWS, NULL, set_orbit, "turn the camera about the up axis by so many degrees per frame"},
    {"--camera", 0, "FILE.json", DRAWS, NULL, set_camera,
     "a camera (eye, target, up, fov, orthographic, near, far), \"keys\": cameras with a frame each, or \"frames\": a camera per frame; "
     "options go before it"},
    {"--up-axis", 0, "AXIS", DRAWS, "up_axis", NULL, "x, y or z: which world axis is up (y)"},

    {"--radius", 0, "R", DRAWS, "radius", NULL, "particle radius, half the rest spacing (from the file, else estimated)"},
    {"--radius-scale", 0, "S", DRAWS, "radius_scale", NULL, "splat radius over particle radius (1.2)"},
    {"--attribute", 0, "ROLE=NAME", READS, NULL, set_attribute, "which attribute is velocity, density, radius, mass, id, color"},
    {"--where", 0, "EXPR", READS, NULL, set_where, "which particles: 'type==0 && density>200'"},
    {"--format", 0, "NAME", READS, NULL, set_format, "format of the inputs, for standard input (-)"},

    {"--filter", 0, "NAME", DRAWS, "filter", NULL, "how depth is smoothed: smoothing-spline, ... (the parameter filter lists them)"},
    {"--filter", 0, "NAME,...", COMMAND_LAB, NULL, set_lab_filters, "filters to measure (all, and the papers' claims); repeatable"},
    {"--scenes", 0, "NAME,...", COMMAND_LAB, NULL, set_lab_scenes, "scenes to measure them in (all, and the papers' claims); repeatable"},
    {"--iterations", 0, "N", SMOOTHS, "iterations", NULL, "how often it smooths"},
    {"--smooth-scale", 0, "1|2|4", SMOOTHS, "smooth_scale", NULL, "pixels per texel along each axis in which it smooths"},
    {"--sigma", 0, "S", SMOOTHS, "sigma", NULL, "sigma of its kernel, in splat radii"},
    {"--delta", 0, "D", SMOOTHS, "delta", NULL, "depth range that is smoothed together, in splat radii"},
    {"--mu", 0, "M", SMOOTHS, "mu", NULL, "where what lies beyond counts, in splat radii"},

    {"--anisotropy", 0, "on|off", SMOOTHS, "anisotropy", NULL, "ellipsoids that follow the surface in place of spheres (off)"},
    {"--foam", 0, "KIND", DRAWS, "foam", NULL, "none, noise (small waves and grey foam) or layered (foam before, in and behind the water)"},
    {"--foam-particles", 0, "FILES", COMMAND_RENDER, NULL, option_set_foam_particles,
     "the simulation's own foam, spray and bubbles: files, a folder or a pattern, matched with the frames by the last number in the name; "
     "what "
     "they are is told by foam, spray or bubbles in the name, or by an attribute kind (0 foam, 1 spray, 2 bubble); repeatable"},
    {"--display", 0, "MODE", DRAWS, "display", NULL, "beauty, opaque, spheres, normal, depth, thickness, curvature, color"},
    {"--layer", 0, "NAME=FILE", COMMAND_RENDER, NULL, option_set_layer,
     "save a layer as .npy or .exr (a pattern in a sequence); repeatable"},
    {"--layers", 0, "NAME,...", COMMAND_RENDER, NULL, option_set_layers, "layers that an .exr OUTPUT holds beside the picture"},
    {"--exr-type", 0, "TYPE", COMMAND_RENDER, NULL, option_set_exr_type,
     "half (colours as half floats, what measures something as float; the default) or float"},
    {"--mesh", 0, "FILE", COMMAND_RENDER, NULL, option_set_mesh,
     "an opaque thing: .obj, .ply, .stl, .gltf, .glb; a pattern such as body_%04d.obj for one that changes; repeatable"},
    {"--container", 0, "FILE", COMMAND_RENDER, NULL, option_set_container, "the same of a tank: only its far faces are drawn; repeatable"},
    {"--mesh-scale", 0, "S", COMMAND_RENDER, NULL, option_set_mesh_scale, "metres per unit of the meshes' files (1)"},
    {"--mesh-up", 0, "AXIS", COMMAND_RENDER, NULL, option_set_mesh_up,
     "x, y or z: which axis is up in the meshes' files (as in the particles')"},
    {"--environment", 0, "FILE", COMMAND_RENDER, NULL, option_set_environment,
     "sky and reflections: an equirectangular .hdr, .exr, .png or .jpg; or six faces, cube_%s.png with px, nx, py, ny, pz, nz for %s"},
    {"--floor", 0, "on|off", DRAWS, "floor", NULL, "draw a floor (on)"},
    {"--sun", 0, "AZ,EL", DRAWS, NULL, set_sun, "where the sun stands, degrees about the up axis and above the horizon"},
    {"--tone-map", 0, "NAME", DRAWS, "tone_map", NULL, "none, filmic or reinhard: how light beyond white becomes a colour (none)"},
    {"--exposure", 0, "EV", DRAWS, "exposure", NULL, "the picture's light times 2^EV"},
    {"--background", 0, "COLOR", DRAWS, NULL, set_background, "sky, transparent, or RRGGBB"},
    {"--color-by", 0, "EXPR", COMMAND_RENDER, NULL, option_set_color_by,
     "colour the particles, in display color unless another is asked for, by an attribute: velocity (its magnitude), velocity.y, density, "
     "or any expression as in --where"},
    {"--colormap", 0, "NAME", COMMAND_RENDER, NULL, option_set_colormap,
     "viridis, plasma, turbo, coolwarm, or a text file of colours, three numbers a line (viridis)"},
    {"--range", 0, "A:B", COMMAND_RENDER, NULL, option_set_range,
     "the values at the ends of the map; either may be left out (from the first, middle and last frame, without 0.5 % on each side)"},
    {"--legend", 0, NULL, COMMAND_RENDER, NULL, option_set_legend, "draw the map with its values into the picture"},
    {"--units", 0, "TEXT", COMMAND_RENDER, NULL, option_set_units,
     "unit of the values, for the legend (m/s of velocity, kg/m^3 of density)"},
    {"--set", 0, "NAME=VALUE", SMOOTHS, NULL, set_parameter, "any parameter of the list below; repeatable"},
    {"--preset", 0, "NAME", SMOOTHS, NULL, set_preset,
     "parameters that go together, listed below; looks and options go before it; repeatable"},
    {"--look", 0, "FILE.json", SMOOTHS, NULL, set_look, "parameters from a file; options go before it; repeatable"},
    {"--save-look", 0, "FILE.json", DRAWS, NULL, set_save_look, "save the parameters that differ from the defaults"},

    {"--frames", 0, "A:B:STEP", COMMAND_RENDER | COMMAND_CONVERT, NULL, option_set_frames,
     "which frames, by the numbers in the file names, inclusive"},
    {"--resume", 0, NULL, COMMAND_RENDER, NULL, option_set_resume, "skip pictures that are there and whole"},
    {"--keep-going", 0, NULL, COMMAND_RENDER | COMMAND_CONVERT, NULL, option_set_keep_going, "skip and count frames that cannot be read"},
    {"--retime", 0, "K", COMMAND_RENDER, NULL, option_set_retime,
     "pictures per frame: those in between move the particles by id and velocity, and are numbered K * frame, K * frame + 1, ... (1)"},
    {"--shutter", 0, "F", COMMAND_RENDER, NULL, option_set_shutter,
     "motion blur: the part of the time between pictures that the shutter is open, 0 to 1; 0.5 as in films (0)"},
    {"--shutter-samples", 0, "N", COMMAND_RENDER, NULL, option_set_shutter_samples, "moments drawn while the shutter is open (8)"},
    {"--fps", 0, "N", COMMAND_RENDER, NULL, option_set_fps,
     "pictures per second of a video: 25, 23.976, 30000/1001 (30); foam takes it for the frames per second of the simulation"},
    {"--codec", 0, "NAME", COMMAND_RENDER, NULL, option_set_codec, "of a video: h264, vp9 or av1 (auto: vp9 in .webm, else h264)"},
    {"--crf", 0, "Q", COMMAND_RENDER, NULL, option_set_crf,
     "quality of a video, 0 the best; smaller files above (h264 18, vp9 and av1 28)"},

    {"--backend", 0, "NAME", DRAWS, NULL, set_backend, "auto or cpu"},
    {"--threads", 0, "N", SMOOTHS, NULL, set_threads, "threads (all the processors this process may use)"},
    {"--isa", 0, "NAME", SMOOTHS, NULL, set_isa, "scalar, sse2, avx2, avx512 or neon (the best there is)"},
    {"--repeat", 0, "N", COMMAND_BENCH, NULL, set_repeat, "frames to measure (20)"},
    {"--repeat", 0, "N", COMMAND_LAB, NULL, set_repeat, "draws of which the fastest counts (3)"},
    {"--equal-time", 0, "MS", COMMAND_LAB, NULL, set_equal_time, "what is the best that each filter does in so many milliseconds"},
    {"--plot", 0, "FILE.svg", COMMAND_LAB, NULL, set_plot, "error against time, for each filter with many settings"},
    {"--pictures", 0, "FOLDER", COMMAND_LAB, NULL, set_pictures, "a picture of each filter in each scene, and a sheet of each scene's"},
    {"--warmup", 0, "N", COMMAND_BENCH, NULL, set_warmup, "frames before that (3)"},
    {"--stats", 0, "FILE.json", COMMAND_RENDER, NULL, set_stats,
     "per frame and stage: milliseconds, particles, pixels, bytes; peak memory"},
    {"--json", 0, NULL, COMMAND_INFO | COMMAND_BENCH | COMMAND_LAB, NULL, set_json, "for programs"},
    {"--csv", 0, NULL, COMMAND_LAB, NULL, set_csv, "for spreadsheets: a line per scene and filter"},
    {"--quiet", 'q', NULL, ALL, NULL, set_quiet, "no warnings, no progress"},
    {"--verbose", 'v', NULL, COMMAND_RENDER | COMMAND_BENCH | COMMAND_CONVERT, NULL, set_verbose, "tell what is done"},
    {"--help", 'h', NULL, ALL, NULL, set_help, "this text"},
    {NULL, 0, NULL, 0, NULL, NULL, NULL},
};

bool option_apply(struct options *options, const struct option_row *row, const char *value, struct mns_message *message)
{
    return row->param ? add_setting(options, row->param, value, message) : row->apply(options, value, message);
}

const char *option_command_name(enum command command)
{
    return command == COMMAND_RENDER    ? "render"
           : command == COMMAND_INFO    ? "info"
           : command == COMMAND_CONVERT ? "convert"
           : command == COMMAND_BENCH   ? "bench"
           : command == COMMAND_SAMPLE  ? "sample"
                                        : "lab";
}
