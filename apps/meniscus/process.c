/* process.c: another program as a child, at one end of a pipe (POSIX). Linux-only: a wider pipe. */
#if defined(__linux__)
#define _GNU_SOURCE
#endif

#include "process.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

enum { PIPE_BYTES = 1 << 20 /* Linux's most without privileges; wakes both sides less often */ };

struct process {
    pid_t child;
    int pipe;     /* our end */
    FILE *errors; /* what it writes to standard error: a file, so that nobody need read it in time */
};

static int start_child(struct process *process, const char *const *arguments, enum process_pipe kind, int theirs)
{
    posix_spawn_file_actions_t files;
    posix_spawnattr_t attributes;
    sigset_t signals;
    if (posix_spawn_file_actions_init(&files) != 0) {
        return ENOMEM;
    }
    if (posix_spawnattr_init(&attributes) != 0) {
        posix_spawn_file_actions_destroy(&files);
        return ENOMEM;
    }
    bool fed = kind == PROCESS_FED;
    int error = posix_spawn_file_actions_addopen(&files, fed ? STDOUT_FILENO : STDIN_FILENO, "/dev/null", fed ? O_WRONLY : O_RDONLY, 0);
    error = error ? error : posix_spawn_file_actions_adddup2(&files, theirs, fed ? STDIN_FILENO : STDOUT_FILENO);
    error = error ? error : posix_spawn_file_actions_adddup2(&files, fileno(process->errors), STDERR_FILENO);
    sigemptyset(&signals);
    error = error ? error : posix_spawnattr_setsigmask(&attributes, &signals);
    error = error ? error : posix_spawnattr_setpgroup(&attributes, 0);
    error = error ? error : posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK);
    error =
        error ? error : posix_spawnp(&process->child, arguments[0], &files, &attributes, (char *const *)(const void *)arguments, environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&files);
    return error;
}

int process_start(struct process **out, const char *const *arguments, enum process_pipe kind)
{
    *out = NULL;
    struct process *process = calloc(1, sizeof(*process));
    if (!process) {
        return ENOMEM;
    }
    int ends[2], error;
    process->errors = tmpfile();
    if (!process->errors || pipe(ends) != 0) {
        error = errno;
    } else {
        int ours = ends[kind == PROCESS_FED], theirs = ends[kind != PROCESS_FED];
        fcntl(ours, F_SETFD, FD_CLOEXEC); /* the child would wait for its own end */
        fcntl(theirs, F_SETFD, FD_CLOEXEC);
        fcntl(fileno(process->errors), F_SETFD, FD_CLOEXEC);
#ifdef F_SETPIPE_SZ
        fcntl(ours, F_SETPIPE_SZ, PIPE_BYTES);
#endif
        process->pipe = ours;
        error = start_child(process, arguments, kind, theirs);
        close(theirs);
        if (error) {
            close(ours);
        }
    }
    if (error) {
        if (process->errors) {
            fclose(process->errors);
        }
        free(process);
        return error;
    }
    *out = process;
    return 0;
}

int process_write(struct process *process, const void *data, size_t size)
{
    const char *at = data;
    while (size > 0) {
        ssize_t written = write(process->pipe, at, size);
        if (written < 0 && errno != EINTR) {
            return errno;
        }
        at += written > 0 ? written : 0;
        size -= written > 0 ? (size_t)written : 0;
    }
    return 0;
}

size_t process_read(struct process *process, void *data, size_t size)
{
    size_t used = 0;
    while (used < size) {
        ssize_t got = read(process->pipe, (char *)data + used, size - used);
        if (got == 0 || (got < 0 && errno != EINTR)) {
            break;
        }
        used += got > 0 ? (size_t)got : 0;
    }
    return used;
}

/* The first line that it wrote to standard error, which later ones follow from; "": none. */
static void first_line(FILE *errors, char *out, size_t size)
{
    rewind(errors);
    size_t length = fread(out, 1, size - 1, errors);
    out[length] = '\0';
    out[strcspn(out, "\r\n")] = '\0';
}

void process_finish(struct process *process, struct process_end *end)
{
    int status = 0;
    close(process->pipe);
    pid_t waited;
    do {
        waited = waitpid(process->child, &status, 0);
    } while (waited < 0 && errno == EINTR);
    end->good = waited == process->child && WIFEXITED(status) && WEXITSTATUS(status) == 0;
    first_line(process->errors, end->why, sizeof(end->why));
    if (waited == process->child && WIFSIGNALED(status)) {
        snprintf(end->why, sizeof(end->why), "ended by signal %d (%s)", WTERMSIG(status), strsignal(WTERMSIG(status)));
    } else if (!end->why[0]) {
        snprintf(end->why, sizeof(end->why), "exit status %d", WIFEXITED(status) ? WEXITSTATUS(status) : -1);
    }
    fclose(process->errors);
    free(process);
}
