/* load.h: particles from a file or from standard input, and a renderer for them, as the options say. */
#ifndef MENISCUS_LOAD_H
#define MENISCUS_LOAD_H

#include "options.h"

/* What reading a file had to say: held back until it is known whether the file is refused, and until its turn comes. */
struct load_notes {
    size_t count; /* all of them; the first are kept */
    struct load_note {
        enum mns_log_level level;
        struct mns_message message;
    } first[8];
};

/* "-" is standard input, which can be read once. On failure *out is NULL and message says why. Tells nothing: any thread may read. */
mns_result load_particles_quietly(mns_particle_set **out, const char *path, const struct options *options, struct load_notes *notes,
                                  struct mns_message *message);

/* Tells the notes, as --quiet and --verbose let it. */
void load_tell(const struct load_notes *notes, const char *path, const struct options *options);

/* Both. A file that is refused gets its one line, the message, and no warnings. */
mns_result load_particles(mns_particle_set **out, const char *path, const struct options *options, struct mns_message *message);

/* Where the library's warnings go. */
struct mns_log program_log(const struct options *options);

/* A renderer as the options want it, and what finds the particles' shapes (NULL where they are spheres). Returns STATUS_DONE or, after telling why,
 * STATUS_FAILED. */
int program_renderer(mns_renderer **out, const struct options *options);
int program_anisotropy(mns_anisotropy **out, const struct options *options);

/* The same for what tells foam and spray. */
int program_classifier(mns_classifier **out, const struct options *options);

#endif
