/* progress.c: a bar with rate and time left on standard error. */
#include "progress.h"

#include "program.h"

#include <stdio.h>

enum { CELLS = 24 };

static bool on_screen; /* of the one standard error there is */

void progress_begin(struct progress *progress, size_t total, bool quiet)
{
    *progress = (struct progress){.total = total, .start = program_seconds()};
    progress->shown = !quiet && total > 1 && program_error_is_terminal();
}

void progress_stage(const struct progress *progress, const char *stage, const char *what)
{
    if (!progress->shown) {
        return;
    }
    double seconds = program_seconds() - progress->start;
    double rate = seconds > 0 ? (double)(progress->done - progress->skipped) / seconds : 0;
    size_t left = rate > 0 ? (size_t)((double)(progress->total - progress->done) / rate + 0.5) : 0;
    int filled = (int)(CELLS * progress->done / progress->total);
    /* Without wrapping: a second row would stay behind when the bar is taken away. */
    fprintf(stderr, "\r\x1b[K\x1b[?7l[%.*s%.*s] %zu/%zu  %.1f/s  %zu:%02zu left  %s%s%s\x1b[?7h", filled, "########################",
            CELLS - filled, "........................", progress->done, progress->total, rate, left / 60, left % 60, stage,
            *stage ? " " : "", what);
    fflush(stderr);
    on_screen = true;
}

void progress_step(struct progress *progress, const char *what)
{
    progress->done++;
    progress_stage(progress, "", what);
}

void progress_skip(struct progress *progress, size_t count)
{
    progress->done += count;
    progress->skipped += count;
}

void progress_clear(void)
{
    if (on_screen) {
        fputs("\r\x1b[K", stderr);
        on_screen = false;
    }
}
