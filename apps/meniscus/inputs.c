/* inputs.c: files, directories, patterns and .pvd collections (POSIX). */
#include "inputs.h"

#include "program.h"

#include <meniscus/io.h>

#include <dirent.h>
#include <errno.h>
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
    inputs->list[inputs->count++] = (struct input){.path = path};
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

/* Whether two names are frames of one series: alike but for the number. */
static bool same_series(const char *a, const char *b)
{
    size_t digits_a, digits_b;
    const char *at_a = number_in(a, &digits_a), *at_b = number_in(b, &digits_b);
    if (!at_a || !at_b) {
        return false;
    }
    a = base_of(a);
    b = base_of(b);
    size_t before = (size_t)(at_a - a);
    return before == (size_t)(at_b - b) && !strncmp(a, b, before) && !strcmp(at_a + digits_a, at_b + digits_b);
}

/* Refuses a directory of several series: [first, count) of the inputs, sorted. */
static int fail_series(const struct inputs *inputs, size_t first, const char *name, size_t series)
{
    char list[800];
    size_t used = 0, told = 0;
    for (size_t i = first; i < inputs->count && told < 8; i++) {
        bool is_new = true;
        size_t frames = 0, digits;
        for (size_t k = first; k < inputs->count; k++) {
            bool same = k == i || same_series(inputs->list[i].path, inputs->list[k].path);
            frames += same;
            is_new = is_new && !(same && k < i);
        }
        if (!is_new) {
            continue;
        }
        const char *base = base_of(inputs->list[i].path), *at = number_in(base, &digits);
        at = frames > 1 ? at : NULL;
        int before = at ? (int)(at - base) : (int)strlen(base);
        int written = snprintf(list + used, sizeof(list) - used, "%s%.*s%s%s (%zu)", told ? ", " : "", before, base, at ? "*" : "",
                               at ? at + digits : "", frames);
        if (written < 0 || (size_t)written >= sizeof(list) - used) {
            break;
        }
        used += (size_t)written;
        told++;
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
    size_t first = inputs->count, series = 0;
    int status = add_folder(inputs, name, name, picks_particles, NULL);
    if (status != STATUS_DONE) {
        return status;
    }
    if (inputs->count == first) {
        return add_pvd_of(inputs, name);
    }
    sort(inputs, first);
    for (size_t i = first; i < inputs->count; i++) { /* sorted: a series' frames stand together */
        series += i == first || !same_series(inputs->list[i - 1].path, inputs->list[i].path);
    }
    return series > 1 ? fail_series(inputs, first, name, series) : STATUS_DONE;
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

static int add_pvd(struct inputs *inputs, const char *name)
{
    struct mns_message message;
    mns_pvd *pvd;
    if (mns_pvd_read(&pvd, name, &message) != MNS_OK) {
        return program_fail("%s", message.text);
    }
    int status = mns_pvd_count(pvd) ? STATUS_DONE : program_fail("%s: names no files", name);
    for (size_t i = 0; status == STATUS_DONE && i < mns_pvd_count(pvd); i++) {
        status = add_path(inputs, copy(mns_pvd_get(pvd, i)->path), name);
    }
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

void inputs_free(struct inputs *inputs)
{
    for (size_t i = 0; i < inputs->count; i++) {
        free(inputs->list[i].path);
    }
    free(inputs->list);
    *inputs = (struct inputs){0};
}
