/* options.h: the command line as a struct. One table of options feeds parsing, help and docs/options.md. */
#ifndef MENISCUS_OPTIONS_H
#define MENISCUS_OPTIONS_H

#include <meniscus/io.h>
#include <meniscus/meniscus.h>

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

enum command { COMMAND_RENDER = 1, COMMAND_INFO = 2, COMMAND_BENCH = 4, COMMAND_SAMPLE = 8, COMMAND_LAB = 16, COMMAND_CONVERT = 32 };

struct preset;

struct setting {
    const char *fluid; /* the one it is for, up to a dot; NULL: all */
    const char *name;
    const char *value;
};

enum { FLUIDS_MAX = 16, FLUID_NAME_MAX = 32 };

struct fluid_option {
    char name[FLUID_NAME_MAX];
    const char *files;
    struct mns_params params; /* its own settings applied */
};

struct layer_file {
    enum mns_layer layer;
    const char *path; /* or a pattern; NULL: goes into the .exr OUTPUT */
};

struct mesh_file {
    const char *path; /* or a pattern: one mesh per frame */
    bool container;
};

struct camera_options {
    bool has_eye, has_target, has_up, has_fov;
    double eye[3], target[3], up[3]; /* metres; where given */
    double fov;                      /* degrees */
    double orthographic;             /* metres from bottom to top; 0: a perspective */
    double near_plane, far_plane;    /* metres; 0: from the particles */
    double orbit;                    /* degrees per frame about the up axis */
};

enum codec { CODEC_AUTO, CODEC_H264, CODEC_VP9, CODEC_AV1 };

/* A camera at a frame's number; between keys it moves smoothly. */
struct camera_key {
    double frame;
    struct camera_options camera; /* with eye and target */
};

struct color_options {
    const char *by, *map, *units; /* as given; NULL: not asked for */
    bool has_low, has_high, legend;
    double low, high;
};

struct options {
    enum command command;
    bool help;
    char sun[32]; /* the azimuth of --sun, which a setting points to */

    const char **inputs; /* [input_count] as given */
    size_t input_count;
    const char *format; /* of the inputs; NULL: told from content */
    const char **roles; /* [role_count] "ROLE=NAME" */
    size_t role_count;
    const char *where;

    const char *output, *output_format;
    struct layer_file layers[MNS_LAYER_COUNT];
    size_t layer_count;
    bool exr_float; /* colours too */

    bool has_size;
    int width, height; /* pixels */
    struct camera_options camera;
    const char *camera_file;
    struct camera_key *keys; /* [key_count], by rising frame; from the camera file */
    size_t key_count;
    bool keys_by_index; /* their frames are places in the input, from 0, and not numbers */

    struct color_options color;

    struct setting *settings; /* [setting_count] in the order given; the last of a name wins */
    size_t setting_count;
    const struct preset **presets; /* [preset_count], applied before the looks */
    size_t preset_count;
    const char **looks; /* [look_count], read before the settings */
    size_t look_count;
    const char *save_look;
    struct mns_params params; /* looks and settings applied */

    /* Beside the inputs: where there are none, the first of the fluids is moved there, and params are its own. */
    struct fluid_option *fluids; /* [fluid_count] */
    size_t fluid_count;

    const char **foam_files; /* [foam_file_count] as given */
    size_t foam_file_count;

    struct mesh_file *meshes; /* [mesh_count] */
    size_t mesh_count;
    const char *environment; /* NULL: the sky */
    double mesh_scale;       /* metres per unit */
    bool has_mesh_up;
    int mesh_up; /* enum mns_axis, of the files; where given */

    bool has_first, has_last;
    long long first, last, step; /* frame numbers, inclusive */
    bool resume, keep_going;

    int retime;          /* pictures from one frame to the next */
    double shutter;      /* how long it stands open, over the time from picture to picture; 0: a moment */
    int shutter_samples; /* moments that are drawn meanwhile */

    enum codec codec; /* auto: by the container */
    double crf;       /* of the encoder; below 0: its default */
    int fps[2];       /* numerator and denominator */

    enum mns_backend backend;
    enum mns_isa isa;
    int threads; /* 0: all */

    const char *stats;
    bool json, quiet, verbose;
    long long repeat, warmup; /* frames */
    long long particles;

    unsigned long lab_filters, lab_scenes; /* a bit each, by number; 0: all */
    const char *pictures, *plot;           /* a folder, a file */
    double equal_time;                     /* ms; 0: not asked for */
    bool csv;
};

/* Parses what follows the command's name. Returns STATUS_DONE, or STATUS_USAGE or STATUS_FAILED after telling why.
 * options_free may always be called. */
int options_parse(struct options *options, enum command command, int count, char **arguments);
void options_free(struct options *options);

/* The usage, options and parameters of a command. */
void options_help(FILE *out, enum command command);

/* docs/options.md. */
void options_markdown(FILE *out);

#endif
