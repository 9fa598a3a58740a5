/* lines.c: passes along rows and columns. */
#include "cpu/smooth/lines.h"

#include "cpu/cpu.h"
#include "cpu/smooth/window.h"

struct pass {
    const struct depth_plane *fluid;
    line_function *function;
    void *context;
    float *scratch; /* of all workers */
    size_t scratch_size;
    int axis, strips;
    atomic_int next;
};

/* Floats that a worker needs. */
static size_t scratch_size(const struct depth_plane *plane, int arrays)
{
    int across = plane->blocks_x * BLOCK_WIDTH, down = plane->blocks_y * BLOCK_HEIGHT;
    return (size_t)arrays * LINES * (size_t)(across > down ? across : down);
}

bool mns_lines_reserve(struct backend *cpu, int arrays)
{
    size_t size = scratch_size(&cpu->depth[0], arrays) * (size_t)cpu->host.threads;
    cpu->line_scratch = mns_memory_reserve(cpu->host.memory, cpu->line_scratch, &cpu->line_scratch_capacity, size, sizeof(float));
    return cpu->line_scratch != NULL;
}

static int lesser_of(int a, int b) { return a < b ? a : b; }

/* Whether the tile that begins at pixel (x, y) has fluid. */
static bool has_fluid(const struct depth_plane *plane, int x, int y)
{
    int right = lesser_of((x + LINES) / BLOCK_WIDTH, plane->blocks_x), bottom = lesser_of((y + LINES) / BLOCK_HEIGHT, plane->blocks_y);
    for (int by = y / BLOCK_HEIGHT; by < bottom; by++) {
        for (int bx = x / BLOCK_WIDTH; bx < right; bx++) {
            if (plane->ranges[by * plane->blocks_x + bx].min < DEPTH_LIMIT) {
                return true;
            }
        }
    }
    return false;
}

static void run_strip(const struct pass *pass, int strip, float *scratch)
{
    const struct depth_plane *fluid = pass->fluid;
    int width = fluid->blocks_x * BLOCK_WIDTH, height = fluid->blocks_y * BLOCK_HEIGHT;
    bool rows = pass->axis == AXIS_X;
    int length = rows ? width : height, first = strip * LINES, begin = 0;
    for (int at = 0;; at += LINES) {
        if (at < length && has_fluid(fluid, rows ? at : first, rows ? first : at)) {
            continue;
        }
        if (begin < at) {
            struct line_run run = {.axis = pass->axis,
                                   .first = first,
                                   .across = lesser_of((rows ? height : width) - first, LINES),
                                   .begin = begin,
                                   .end = lesser_of(at, length),
                                   .opens = begin == 0,
                                   .ends = at >= length};
            pass->function(pass->context, &run, scratch);
        }
        if (at >= length) {
            return;
        }
        begin = at + LINES;
    }
}

static void work(void *context, int worker)
{
    struct pass *pass = context;
    float *scratch = pass->scratch + (size_t)worker * pass->scratch_size;
    for (int strip; (strip = atomic_fetch_add(&pass->next, 1)) < pass->strips;) {
        run_strip(pass, strip, scratch);
    }
}

void mns_lines_pass(struct backend *cpu, const struct depth_plane *fluid, int axis, int arrays, line_function *function, void *context)
{
    int across = axis == AXIS_X ? fluid->blocks_y * BLOCK_HEIGHT : fluid->blocks_x * BLOCK_WIDTH;
    struct pass pass = {.fluid = fluid,
                        .function = function,
                        .context = context,
                        .scratch = cpu->line_scratch,
                        .scratch_size = scratch_size(fluid, arrays),
                        .axis = axis,
                        .strips = (across + LINES - 1) / LINES};
    atomic_init(&pass.next, 0);
    cpu_run(cpu, work, &pass, cpu->host.threads);
}
