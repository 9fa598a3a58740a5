/* inputs.c: files, directories, patterns and .pvd collections (POSIX). */
#include "inputs.h"

#include "program.h"

#include <meniscus/io.h>

#include <dirent.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* What a directory is searched for. A .pvd names files that are there anyway. */
static const char *const extensions[] = {".bgeo", ".bgeo.gz", ".vtk", ".vtu", ".vtp", ".pvtu",
                                         ".pvtp", ".ply",     ".npy", ".npz", ".csv", ".xyz"};

static int out_of_memory(const char *name) { return program_fail("%s: out of memory", name); }

/* Takes path over. */
static int add_path(struct inputs *inputs, char *path, const char *name)
{
    if (path && inputs->count == inputs->capacity) {
        size_t capacity = inputs->capacity ? 2 * inputs->capacity : 64;
        struct input *grown = realloc(inputs->list, capacity * sizeof(*grown));
        if (!grown) {
            free(path);
            return out_of_memory(name);
        }
        inputs->list = grown;
        inputs->capacity = capacity;
    }
    if (!path) {
        return out_of_memory(name);
    }
    inputs->list[inputs->count++] = (struct input){.path = path, .time = NAN};
    return STATUS_DONE;
}

static char *copy(const char *text)
{
    char *out = malloc(strlen(text) + 1);
    return out ? strcpy(out, text) : NULL;
}

/* folder/name, or name alone for the folder "". */
static char *join(const char *folder, const char *name)
{
    size_t length = strlen(folder), size = length + strlen(name) + 2;
    char *path = malloc(size);
    if (path) {
        snprintf(path, size, "%s%s%s", folder, length && folder[length - 1] != '/' ? "/" : "", name);
    }
    return path;
}

static bool ends_in(const char *name, const char *extension)
{
    size_t length = strlen(name), n = strlen(extension);
    return length > n && !strcmp(name + length - n, extension);
}

static bool is_particle_file(const char *name)
{
    for (size_t i = 0; name[0] != '.' && i < sizeof(extensions) / sizeof(extensions[0]); i++) {
        if (ends_in(name, extensions[i])) {
            return true;
        }
    }
    return false;
}

static const char *base_of(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

/* The last run of digits before the extension; NULL: there is none. */
static const char *number_in(const char *path, size_t *digits)
{
    const char *base = base_of(path), *end = base + strlen(base);
    for (size_t i = 0; i < sizeof(extensions) / sizeof(extensions[0]); i++) {
        if (ends_in(base, extensions[i])) {
            end = base + strlen(base) - strlen(extensions[i]);
        }
    }
    while (end > base && (end[-1] < '0' || end[-1] > '9')) {
        end--;
    }
    const char *start = end;
    while (start > base && start[-1] >= '0' && start[-1] <= '9') {
        start--;
    }
    *digits = (size_t)(end - start);
    return end > start ? start : NULL;
}

/* ---- directories ---- */

/* Orders names by series: names that are alike but for the number are equal, and two without a number are equal when they are the same. */
static int compare_series(const char *a, const char *b)
{
    size_t digits_a = 0, digits_b = 0;
    const char *at_a = number_in(a, &digits_a), *at_b = number_in(b, &digits_b);
    a = base_of(a);
    b = base_of(b);
    at_a = at_a ? at_a : a + strlen(a);
    at_b = at_b ? at_b : b + strlen(b);
    size_t before_a = (size_t)(at_a - a), before_b = (size_t)(at_b - b);
    int order = strncmp(a, b, before_a < before_b ? before_a : before_b);
    if (order || before_a != before_b) {
        return order ? order : before_a < before_b ? -1 : 1;
    }
    return strcmp(at_a + digits_a, at_b + digits_b);
}

static int compare_inputs_by_series(const void *a, const void *b)
{
    const char *path_a = ((const struct input *)a)->path, *path_b = ((const struct input *)b)->path;
    int order = compare_series(path_a, path_b);
    return order ? order : natural_compare(path_a, path_b);
}

/* How many of the inputs from i on are of the series of input i; they are sorted by series. */
static size_t series_length(const struct inputs *inputs, size_t i)
{
    size_t end = i + 1;
    while (end < inputs->count && compare_series(inputs->list[i].path, inputs->list[end].path) == 0) {
        end++;
    }
    return end - i;
}

/* Refuses a directory of several series: [first, count) of the inputs, sorted by series. */
static int fail_series(const struct inputs *inputs, size_t first, const char *name)
{
    enum { TOLD = 8 };
    char list[800];
    size_t used = 0, series = 0, told = 0;
    for (size_t i = first, frames; i < inputs->count; i += frames, series++) {
        size_t digits = 0;
        frames = series_length(inputs, i);
        const char *base = base_of(inputs->list[i].path), *at = frames > 1 ? number_in(base, &digits) : NULL;
        int before = at ? (int)(at - base) : (int)strlen(base);
        int written = told == TOLD ? -1
                                   : snprintf(list + used, sizeof(list) - used, "%s%.*s%s%s (%zu)", told ? ", " : "", before, base,
                                              at ? "*" : "", at ? at + digits : "", frames);
        if (written > 0 && (size_t)written < sizeof(list) - used) {
            used += (size_t)written;
            told++;
        }
    }
    list[used] = '\0';
    return program_usage("%s: holds %zu series: %s%s; name the files of one, or a pattern such as frame_%%d.vtk", name, series, list,
                         told < series ? ", ..." : "");
}

static int compare_inputs(const void *a, const void *b)
{
    return natural_compare(((const struct input *)a)->path, ((const struct input *)b)->path);
}

static void sort(struct inputs *inputs, size_t first)
{
    if (inputs->count > first) {
        qsort(inputs->list + first, inputs->count - first, sizeof(*inputs->list), compare_inputs);
    }
}

/* Adds the files of a folder that the test picks. */
static int add_folder(struct inputs *inputs, const char *folder, const char *name, bool (*picks)(const char *entry, const void *user),
                      const void *user)
{
    DIR *directory = opendir(*folder ? folder : ".");
    if (!directory) {
        return program_fail("%s: cannot be opened: %s", name, strerror(errno));
    }
    int status = STATUS_DONE;
    for (const struct dirent *entry; status == STATUS_DONE && (entry = readdir(directory));) {
        if (picks(entry->d_name, user)) {
            status = add_path(inputs, join(folder, entry->d_name), name);
        }
    }
    closedir(directory);
    return status;
}

static bool picks_particles(const char *entry, const void *user)
{
    (void)user;
    return is_particle_file(entry);
}

static bool picks_extension(const char *entry, const void *user) { return entry[0] != '.' && ends_in(entry, user); }

static int add_pvd(struct inputs *inputs, const char *name);

/* A folder without particle files may hold the .pvd of files that lie elsewhere. */
static int add_pvd_of(struct inputs *inputs, const char *folder)
{
    struct inputs found = {0};
    int status = add_folder(&found, folder, folder, picks_extension, ".pvd");
    if (status == STATUS_DONE && found.count == 0) {
        status = program_fail("%s: holds no particle files (*.bgeo, *.vtk, *.vtu, *.npy and the like)", folder);
    } else if (status == STATUS_DONE && found.count > 1) {
        status = program_usage("%s: holds %zu .pvd files; name one", folder, found.count);
    } else if (status == STATUS_DONE) {
        status = add_pvd(inputs, found.list[0].path);
    }
    inputs_free(&found);
    return status;
}

static int add_directory(struct inputs *inputs, const char *name)
{
    size_t first = inputs->count;
    int status = add_folder(inputs, name, name, picks_particles, NULL);
    if (status != STATUS_DONE) {
        return status;
    }
    if (inputs->count == first) {
        return add_pvd_of(inputs, name);
    }
    qsort(inputs->list + first, inputs->count - first, sizeof(*inputs->list), compare_inputs_by_series);
    return series_length(inputs, first) < inputs->count - first ? fail_series(inputs, first, name) : STATUS_DONE;
}

/* ---- patterns and collections ---- */

static bool picks_pattern(const char *entry, const void *user)
{
    const char *pattern = user;
    size_t before = strcspn(pattern, "%");
    if (strncmp(entry, pattern, before) != 0) {
        return false;
    }
    /* Numbers are tried, not parsed: "%04d" means 0007 and 12345, not 7. */
    for (const char *at = entry + before; *at; at++) {
        if ((*at >= '0' && *at <= '9') || *at == '-') {
            char *name = pattern_name(pattern, strtoll(at, NULL, 10));
            bool same = name && !strcmp(name, entry);
            free(name);
            if (same) {
                return true;
            }
        }
    }
    return false;
}

static int add_pattern(struct inputs *inputs, const char *name)
{
    size_t first = inputs->count;
    const char *base = base_of(name);
    char *folder = copy(name);
    if (!folder) {
        return out_of_memory(name);
    }
    folder[base - name] = '\0';
    int status = strchr(folder, '%') ? program_usage("%s: the number must be in the file's name, not in its folder's", name)
                                     : add_folder(inputs, folder, name, picks_pattern, base);
    free(folder);
    if (status == STATUS_DONE && inputs->count == first) {
        status = program_fail("%s: no file matches this pattern", name);
    }
    sort(inputs, first);
    return status;
}

static int add_steps(struct inputs *inputs, const mns_pvd *pvd, const char *name)
{
    int status = STATUS_DONE;
    for (size_t i = 0; status == STATUS_DONE && i < mns_pvd_count(pvd); i++) {
        const struct mns_pvd_step *step = mns_pvd_get(pvd, i);
        if (i > 0 && step->time == mns_pvd_get(pvd, i - 1)->time) {
            return program_fail("%s: names several files for time %g; in a sequence each time must have one (a .pvtu, for example)", name,
                                step->time);
        }
        status = add_path(inputs, copy(step->path), name);
        if (status == STATUS_DONE) {
            inputs->list[inputs->count - 1].time = step->time;
        }
    }
    return status;
}

static int add_pvd(struct inputs *inputs, const char *name)
{
    struct mns_message message;
    mns_pvd *pvd;
    if (mns_pvd_read(&pvd, name, &message) != MNS_OK) {
        return program_fail("%s", message.text);
    }
    size_t count = mns_pvd_count(pvd), later = 1;
    while (later < count && mns_pvd_get(pvd, later)->time == mns_pvd_get(pvd, 0)->time) {
        later++;
    }
    int status = later > 1 && later == count ? add_path(inputs, copy(name), name) /* the parts of one time are read together */
                                             : add_steps(inputs, pvd, name);
    mns_pvd_destroy(&pvd);
    inputs->ordered = true;
    return status;
}

int inputs_add(struct inputs *inputs, const char *name)
{
    struct stat file;
    if (!*name) {
        return program_usage("an input's name is empty");
    }
    bool exists = strcmp(name, "-") != 0 && stat(name, &file) == 0;
    if (exists && S_ISDIR(file.st_mode)) {
        return add_directory(inputs, name);
    }
    if (!exists && pattern_is(name)) {
        return add_pattern(inputs, name);
    }
    return ends_in(name, ".pvd") ? add_pvd(inputs, name) : add_path(inputs, copy(name), name);
}

int inputs_add_all(struct inputs *inputs, const char *name)
{
    struct stat file;
    size_t first = inputs->count;
    bool folder = *name && stat(name, &file) == 0 && S_ISDIR(file.st_mode);
    int status = folder ? add_folder(inputs, name, name, picks_particles, NULL) : inputs_add(inputs, name);
    if (status == STATUS_DONE && inputs->count == first) {
        status = program_fail("%s: holds no particle files (*.bgeo, *.vtk, *.vtu, *.npy and the like)", name);
    }
    sort(inputs, first);
    for (size_t i = first; i < inputs->count; i++) {
        size_t digits;
        const char *at = number_in(inputs->list[i].path, &digits);
        inputs->list[i].number = at && digits <= 15 ? strtoll(at, NULL, 10) : -1;
    }
    return status;
}

void inputs_number(struct inputs *inputs)
{
    if (!inputs->ordered) {
        sort(inputs, 0);
    }
    bool numbered = true;
    for (size_t i = 0; i < inputs->count; i++) {
        size_t digits;
        const char *at = number_in(inputs->list[i].path, &digits);
        inputs->list[i].number = at && digits <= 15 ? strtoll(at, NULL, 10) : 0;
        numbered = numbered && at && digits <= 15;
        for (size_t k = 0; numbered && k < i; k++) {
            numbered = inputs->list[k].number != inputs->list[i].number;
        }
    }
    for (size_t i = 0; !numbered && i < inputs->count; i++) {
        inputs->list[i].number = (long long)i + 1;
    }
}

bool inputs_timed(const struct inputs *inputs)
{
    for (size_t i = 0; i < inputs->count; i++) {
        if (!isfinite(inputs->list[i].time) || (i > 0 && !(inputs->list[i].time > inputs->list[i - 1].time))) {
            return false;
        }
    }
    return inputs->count > 0;
}

void inputs_free(struct inputs *inputs)
{
    for (size_t i = 0; i < inputs->count; i++) {
        free(inputs->list[i].path);
    }
    free(inputs->list);
    *inputs = (struct inputs){0};
}
