/* process.h: another program as a child, at one end of a pipe. */
#ifndef MENISCUS_PROCESS_H
#define MENISCUS_PROCESS_H

#include <stdbool.h>
#include <stddef.h>

struct process; /* opaque */

enum process_pipe {
    PROCESS_FED, /* we write its standard input; what it prints is dropped */
    PROCESS_READ /* we read what it prints; its standard input is empty */
};

/* How a child ended. */
struct process_end {
    bool good;     /* exit status 0 */
    char why[512]; /* else: the first line it wrote to standard error, or its signal, or its status */
};

/* Starts arguments[0], found in PATH, with the arguments (ended by NULL); no shell is asked. A signal typed at the terminal does not reach
 * it: it ends when its input does. On failure *out is NULL; returns 0 or an errno (ENOENT: no such program). */
int process_start(struct process **out, const char *const *arguments, enum process_pipe kind);

int process_write(struct process *process, const void *data, size_t size); /* 0 or an errno; EPIPE: it is gone */
size_t process_read(struct process *process, void *data, size_t size);     /* fewer than size: its end */

/* Closes the pipe, waits for the child and frees process. */
void process_finish(struct process *process, struct process_end *end);

#endif
