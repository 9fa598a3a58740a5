/* program.h: what all commands share: exit statuses, messages on standard error, signals, output files. */
#ifndef MENISCUS_PROGRAM_H
#define MENISCUS_PROGRAM_H

#include <stdbool.h>
#include <stddef.h>

#ifdef __GNUC__
#define PROGRAM_PRINTF(text, first) __attribute__((format(printf, text, first)))
#else
#define PROGRAM_PRINTF(text, first)
#endif

struct options;

enum { STATUS_DONE = 0, STATUS_FAILED = 1, STATUS_USAGE = 2, STATUS_SIGNAL = 128 /* plus the signal's number */ };

/* One line "meniscus: TEXT" on standard error, below the progress bar if there is one. Returns STATUS_FAILED or STATUS_USAGE. */
int program_fail(const char *format, ...) PROGRAM_PRINTF(1, 2);
int program_usage(const char *format, ...) PROGRAM_PRINTF(1, 2);

/* The same with "warning: "; and plain news. */
void program_warn(const char *format, ...) PROGRAM_PRINTF(1, 2);
void program_say(const char *format, ...) PROGRAM_PRINTF(1, 2);

/* A closed pipe and a file that grows beyond its limit are told by the write that meets them, not by a signal. */
void program_ignore_write_signals(void);

/* Interrupting signals are noted, so that the file in hand is finished; the second one ends the program at once. */
void program_catch_interrupts(void);
int program_signal(void);  /* the signal that came; 0: none */
int program_stopped(void); /* tells of the signal and returns its status */

/* Whether standard error or standard output is a terminal. */
bool program_error_is_terminal(void);
bool program_output_is_terminal(void);

/* Keeps large blocks out of the C library's heaps, which otherwise grow with the length of a sequence: frames are read by one thread, freed by another,
 * and differ in size, which leaves holes. */
void program_steady_memory(void);

/* Largest memory the process held, in bytes; 0: unknown. */
double program_peak_memory(void);

/* Fails where that much cannot be had: a machine that promises more memory than it has ends the program without a word. */
int program_check_memory(const char *name, double bytes);
int program_check_picture(int width, int height);

double program_seconds(void); /* a clock that only goes forward */

/* Writes to standard output at once, in any thread, and tells nothing: 0 or an errno. */
int program_output(const void *data, size_t size);

/* Writes to standard output, and ends it: false after telling why. */
bool program_print(const void *data, size_t size);
bool program_flush(void);

/* Fails, with a reason, where a file of this name cannot be made: a long run should not end with that. "-" is standard output. */
int program_check_place(const char *path);

/* Writes a file beside its place and renames it. Returns STATUS_DONE or, after telling why, STATUS_FAILED. "-" is standard output. */
int program_write_file(const char *path, const char *text);

/* The commands. */
int command_render(struct options *options);
int command_info(struct options *options);
int command_convert(struct options *options);
int command_bench(struct options *options);
int command_lab_papers(struct options *options); /* meniscus lab papers */
int command_sample(struct options *options);
int command_lab(struct options *options);

#endif
