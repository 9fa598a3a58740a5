/* program.c: messages, signals and files of the program (POSIX). */
#include "program.h"

#include "progress.h"

#include <errno.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#ifdef __GLIBC__
#include <malloc.h>
#endif

/* One line whatever the names in it: what would move the cursor or start a line is shown as a question mark. */
static void print_line(const char *kind, const char *format, va_list arguments)
{
    char text[2048];
    vsnprintf(text, sizeof(text), format, arguments);
    for (char *at = text; *at; at++) {
        *at = (unsigned char)*at < ' ' || *at == 127 ? '?' : *at;
    }
    progress_clear();
    fprintf(stderr, "meniscus: %s%s\n", kind, text);
}

int program_fail(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    print_line("", format, arguments);
    va_end(arguments);
    return STATUS_FAILED;
}

int program_usage(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    print_line("", format, arguments);
    va_end(arguments);
    return STATUS_USAGE;
}

void program_warn(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    print_line("warning: ", format, arguments);
    va_end(arguments);
}

void program_say(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    print_line("", format, arguments);
    va_end(arguments);
}

static volatile sig_atomic_t caught; /* a signal handler can reach nothing else */

static void note(int number) { caught = number; }

static void catch_unless_ignored(int number, const struct sigaction *action)
{
    struct sigaction before;
    if (sigaction(number, NULL, &before) == 0 && before.sa_handler != SIG_IGN) { /* as nohup asks */
        sigaction(number, action, NULL);
    }
}

void program_catch_interrupts(void)
{
    struct sigaction action;
    memset(&action, 0, sizeof(action));
    sigemptyset(&action.sa_mask);
    action.sa_handler = note;
    action.sa_flags = (int)(SA_RESTART | SA_RESETHAND);
    catch_unless_ignored(SIGHUP, &action);
    catch_unless_ignored(SIGINT, &action);
    catch_unless_ignored(SIGTERM, &action);
}

void program_ignore_write_signals(void)
{
    signal(SIGPIPE, SIG_IGN);
    signal(SIGXFSZ, SIG_IGN);
}

int program_signal(void) { return (int)caught; }

int program_stopped(void)
{
    program_say("stopped by a signal");
    return STATUS_SIGNAL + program_signal();
}

bool program_error_is_terminal(void) { return isatty(STDERR_FILENO); }

bool program_output_is_terminal(void) { return isatty(STDOUT_FILENO); }

void program_steady_memory(void)
{
#ifdef __GLIBC__
    mallopt(M_MMAP_THRESHOLD, 256 << 10); /* bytes; fixed, where glibc would raise it to 32 MiB as blocks are freed */
#endif
}

double program_peak_memory(void)
{
    struct rusage usage;
    if (getrusage(RUSAGE_SELF, &usage) != 0) {
        return 0;
    }
#ifdef __APPLE__
    return (double)usage.ru_maxrss; /* bytes there, kilobytes elsewhere */
#else
    return (double)usage.ru_maxrss * 1024;
#endif
}

int program_check_memory(const char *name, double bytes)
{
    static const double gibibyte = 1 << 30;
    double machine = (double)sysconf(_SC_PHYS_PAGES) * (double)sysconf(_SC_PAGESIZE); /* negative: unknown */
    if (machine > 0 && bytes > machine) {
        return program_fail("%s: needs about %.0f GiB of memory, and this machine has %.1f", name, bytes / gibibyte, machine / gibibyte);
    }
    return STATUS_DONE;
}

int program_check_picture(int width, int height)
{
    enum { PIXEL_BYTES = 34 }; /* as measured, without layers */
    return program_check_memory("--size", PIXEL_BYTES * (double)width * (double)height);
}

double program_seconds(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

int program_output(const void *data, size_t size)
{
    errno = 0;
    return fwrite(data, 1, size, stdout) == size && fflush(stdout) == 0 ? 0 : errno ? errno : EIO;
}

static bool fail_output(int error)
{
    program_fail("standard output: cannot be written: %s", strerror(error ? error : EIO));
    return false;
}

bool program_print(const void *data, size_t size)
{
    errno = 0;
    return fwrite(data, 1, size, stdout) == size || fail_output(errno);
}

bool program_flush(void)
{
    errno = 0;
    return (fflush(stdout) == 0 && !ferror(stdout)) || fail_output(errno);
}

/* Fills the open file and closes it; 0 or an errno. */
static int fill(FILE *file, const char *text)
{
    errno = 0;
    int error = fputs(text, file) == EOF ? errno : 0;
    if (fclose(file) != 0 && !error) {
        error = errno ? errno : EIO;
    }
    return error;
}

static int fail_file(const char *path, int error) { return program_fail("%s: cannot be written: %s", path, strerror(error)); }

/* What hinders a file in the folder that ends at slash (NULL: the working folder): 0 or an errno. */
static int folder_error(const char *path, const char *slash)
{
    size_t length = slash ? (size_t)(slash - path) + 1 : 0;
    char *folder = malloc(length + 2);
    if (!folder) {
        return ENOMEM;
    }
    memcpy(folder, path, length);
    memcpy(folder + length, ".", 2);
    int error = access(folder, W_OK | X_OK) == 0 ? 0 : errno;
    free(folder);
    return error;
}

int program_check_place(const char *path)
{
    struct stat status;
    bool exists = strcmp(path, "-") != 0 && stat(path, &status) == 0;
    if (exists && S_ISDIR(status.st_mode)) {
        return program_fail("%s: cannot be written: it is a folder", path);
    }
    bool in_place = !strcmp(path, "-") || (exists && !S_ISREG(status.st_mode));
    int error = in_place ? 0 : folder_error(path, strrchr(path, '/'));
    return error ? fail_file(path, error) : STATUS_DONE;
}

int program_write_file(const char *path, const char *text)
{
    if (!strcmp(path, "-")) {
        return program_print(text, strlen(text)) && program_flush() ? STATUS_DONE : STATUS_FAILED;
    }
    struct stat status;
    if (stat(path, &status) == 0 && !S_ISREG(status.st_mode)) { /* a device or a pipe; a folder fails to open */
        FILE *file = fopen(path, "w");
        int error = file ? fill(file, text) : errno;
        return error ? fail_file(path, error) : STATUS_DONE;
    }
    size_t size = strlen(path) + 32;
    char *beside = malloc(size);
    if (!beside) {
        return program_fail("%s: out of memory", path);
    }
    snprintf(beside, size, "%s.tmp-%ld", path, (long)getpid());
    FILE *file = fopen(beside, "wx");
    int error = file ? fill(file, text) : errno;
    if (!error && rename(beside, path) != 0) {
        error = errno;
    }
    if (error && file) {
        remove(beside);
    }
    free(beside);
    return error ? fail_file(path, error) : STATUS_DONE;
}
