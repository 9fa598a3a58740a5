/* meniscus/io.h: particle files in, images and particle files out. Link target meniscus::io.
 *
 * Files are hostile until proved otherwise: every count is checked against the bytes at hand before memory is asked for. */
#ifndef MENISCUS_IO_H
#define MENISCUS_IO_H

#include <meniscus/camera.h>
#include <meniscus/colormap.h>
#include <meniscus/common.h>
#include <meniscus/particles.h>

#ifdef __cplusplus
extern "C" {
#endif

/* What a file's attribute is to us. */
enum mns_role {
    MNS_ROLE_NONE = 0,
    MNS_ROLE_POSITION = 1,
    MNS_ROLE_VELOCITY = 2,
    MNS_ROLE_DENSITY = 3,
    MNS_ROLE_RADIUS = 4,
    MNS_ROLE_MASS = 5,
    MNS_ROLE_ID = 6,
    MNS_ROLE_COLOR = 7,
    MNS_ROLE_COUNT = 8
};

MNS_API const char *mns_role_name(enum mns_role role); /* "velocity"; NULL for an unknown value */

/* One attribute as it stands in the file, in the machine's byte order. */
struct mns_attribute {
    const char *name; /* UTF-8 as in the file; positions are always called "position" */
    enum mns_type type;
    int components;     /* per particle, >= 1 */
    const void *data;   /* [count][components], packed */
    enum mns_role role; /* MNS_ROLE_NONE: nothing to us */
};

struct mns_read_params {
    size_t struct_size;       /* set by mns_read_params_init */
    const char *format;       /* a name from mns_read_format; NULL: told from content, then name */
    const char *const *roles; /* [role_count] "ROLE=NAME": overrides the table of known names; "ROLE=": drop that role */
    size_t role_count;
    const char *where;              /* expression over attributes such as "type==0 && density>200"; NULL: all particles */
    size_t max_bytes;               /* most memory for one file's contents and arrays; 0: no limit but the machine's */
    struct mns_allocator allocator; /* kept until the set is destroyed */
    struct mns_log log;             /* warnings: dropped particles, unknown arrays */
};
MNS_API void mns_read_params_init_sized(struct mns_read_params *params, size_t size);
static inline void mns_read_params_init(struct mns_read_params *params) { mns_read_params_init_sized(params, sizeof(*params)); }

/* Names of the formats this build reads: "bgeo", "vtk", ... index out of range: NULL. */
MNS_API const char *mns_read_format(size_t index);

/* What is known to exist but is not in this build, and the library it needs: "lzma (liblzma)". index out of range: NULL. */
MNS_API const char *mns_missing_feature(size_t index);

/* Particles read from a file, and all its per-particle attributes. */
typedef struct mns_particle_set mns_particle_set; /* opaque; read-only once made, so many threads may read it */

/* Reads a file; a .pvtu, .pvtp, .vtm, .vtpc or .pvd opens the files it names beside it. For a .pvd use mns_pvd_read to get at its time
 * steps; here its first one is read, with all its parts. params, message: may be NULL. On failure *out is NULL and message says file, place,
 * fault and remedy. */
MNS_API mns_result mns_particle_set_read(mns_particle_set **out, const char *path, const struct mns_read_params *params,
                                         struct mns_message *message);

/* The same from memory; name (may be NULL) stands in messages and helps to tell the format. Opens no other files. */
MNS_API mns_result mns_particle_set_read_memory(mns_particle_set **out, const void *data, size_t size, const char *name,
                                                const struct mns_read_params *params, struct mns_message *message);

MNS_API void mns_particle_set_destroy(mns_particle_set **set); /* sets *set to NULL; NULL is fine */

MNS_API const struct mns_particles *mns_particle_set_particles(const mns_particle_set *set); /* views of the set's arrays */
MNS_API const char *mns_particle_set_format(const mns_particle_set *set);                    /* "bgeo" */
MNS_API size_t mns_particle_set_file_count(const mns_particle_set *set); /* particles in the file, before `where` and dropping */
MNS_API size_t mns_particle_set_dropped(const mns_particle_set *set);    /* dropped for a position that is not finite */
MNS_API size_t mns_particle_set_attribute_count(const mns_particle_set *set);
MNS_API const struct mns_attribute *mns_particle_set_attribute(const mns_particle_set *set, size_t index); /* NULL: out of range */

/* A number for each particle from an expression over attributes, as in `where`: "density", "velocity" (its magnitude), "velocity.y", "x * x + z * z".
 * out: [count]. name (may be NULL) stands in messages. Errors: invalid argument, with the place in the expression and the set's attributes. */
MNS_API mns_result mns_particle_set_evaluate(const mns_particle_set *set, const char *name, const char *expression, double *out,
                                             struct mns_message *message);

/* The files of a ParaView collection (.pvd) in order of time; parts of one time follow each other as in the file. */
struct mns_pvd_step {
    double time;
    const char *path; /* of the file, with the .pvd's folder in front where it is relative */
};
typedef struct mns_pvd mns_pvd; /* opaque */
MNS_API mns_result mns_pvd_read(mns_pvd **out, const char *path, struct mns_message *message);
MNS_API size_t mns_pvd_count(const mns_pvd *pvd);
MNS_API const struct mns_pvd_step *mns_pvd_get(const mns_pvd *pvd, size_t index); /* NULL: out of range */
MNS_API void mns_pvd_destroy(mns_pvd **pvd);

/* A colour map from a text file: a line per colour, evenly spaced, of three numbers: 0 to 1, or 0 to 255 where one is above 1; sRGB. Blanks,
 * commas or semicolons between them; empty lines and what follows a # are skipped; a fourth number in front (a position) is not read. */
MNS_API mns_result mns_colormap_read(struct mns_colormap *out, const char *path, struct mns_message *message);

/* Writers. Each writes beside `path` and renames, so that the file appears whole or not at all.
 * PNG takes U8 or U16 with 1 to 4 channels; .npy takes float32, shape [h][w] or [h][w][channels]; .exr float32 with channels Y, YA, RGB or RGBA. */
MNS_API mns_result mns_image_write(const char *path, const struct mns_image *image, struct mns_message *message); /* by extension */
MNS_API const char *mns_image_write_format(size_t index); /* "png", "exr", "npy" as built; NULL: out of range */

/* An image of an OpenEXR file. Its channels are called NAME.X with the letters given, or X alone where the name is empty. "RGBA" is linear with
 * straight alpha and becomes premultiplied. */
struct mns_exr_layer {
    const char *name;              /* "" for the picture itself */
    const char *channels;          /* a letter per channel: "RGBA", "XYZ", "Z" */
    const struct mns_image *image; /* float32; all layers have one size */
};

/* Text that a file carries under a name ("owner"). */
struct mns_exr_note {
    const char *name, *text;
};

struct mns_exr_params {
    size_t struct_size; /* set by mns_exr_params_init */
    int half;           /* 0 (default): all float32; 1: colours (R, G, B, A) as half floats, what measures something as float32 */
    const struct mns_camera *camera;  /* NULL: none; written as worldToCamera and worldToNDC */
    const struct mns_exr_note *notes; /* [note_count] */
    size_t note_count;
};
MNS_API void mns_exr_params_init_sized(struct mns_exr_params *params, size_t size);
static inline void mns_exr_params_init(struct mns_exr_params *params) { mns_exr_params_init_sized(params, sizeof(*params)); }

/* Writes all layers to one file, in zlib blocks. params NULL: defaults. Unsupported in builds without OpenEXR. */
MNS_API mns_result mns_exr_write(const char *path, const struct mns_exr_layer *layers, size_t layer_count,
                                 const struct mns_exr_params *params, struct mns_message *message);

/* Encodes to memory, for standard output. The caller frees *data with mns_memory_free. */
MNS_API mns_result mns_image_encode(const char *format, const struct mns_image *image, void **data, size_t *size,
                                    struct mns_message *message);
MNS_API void mns_memory_free(void *data);

/* Names of the particle formats that are written, each also the extension: "npz", "ply", ... index out of range: NULL. */
MNS_API const char *mns_particles_write_format(size_t index);

/* Writes particles by the extension: .npy (positions only), .npz, .ply, .vtp or .bgeo (position, velocity, density, radius, id, mass, color as
 * there are). docs/formats.md tells what becomes of types that a format lacks. */
MNS_API mns_result mns_particles_write(const char *path, const struct mns_particles *particles, struct mns_message *message);

/* Writes a set with all its attributes under their own names and in their own types, in any of these formats; what was put together from other
 * attributes (u, v, w to a velocity) is left out. log (may be NULL): warnings of what the format cannot hold. */
MNS_API mns_result mns_particle_set_write(const char *path, const mns_particle_set *set, const struct mns_log *log,
                                          struct mns_message *message);

#ifdef __cplusplus
}
#endif

#endif
