/* anisotropy_shapes.c: the shapes of all particles, cell by cell of the grid.
 *
 * Particles that stand together in a cell look at the same neighbours, which are gathered once, relative to the cell and in units of the reach,
 * into a block that stays in the first-level cache. */
#include "particles/anisotropy.h"

#include <math.h>

/* Parts that the cells are cut into for each thread: cells of the surface have fewer neighbours than those inside. */
enum { PARTS_PER_THREAD = 8 };

struct shapes {
    mns_anisotropy *self;
    struct anisotropy_rule rule;
    int parts;
};

/* What one thread works in. */
struct work {
    struct anisotropy_block block;
    struct anisotropy_batch batch;
    uint32_t first; /* sorted particle that is the batch's first */
    int count;      /* in the batch */
};

/* Shapes of the batch, to the caller's order. */
static void flush(const struct shapes *shapes, struct work *work)
{
    mns_anisotropy *self = shapes->self;
    const struct grid *grid = &self->grid;
    const struct anisotropy_batch *batch = &work->batch;
    self->kernels->shape(&shapes->rule, &work->batch, work->count);
    for (int i = 0; i < work->count; i++) {
        size_t sorted = (size_t)work->first + (size_t)i, particle = grid->index[sorted];
        const float *places[3] = {grid->x, grid->y, grid->z};
        for (int k = 0; k < 6; k++) {
            self->shape[6 * particle + (size_t)k] = batch->shape[k][i];
        }
        for (int k = 0; k < 3; k++) {
            double moved = (double)places[k][sorted] + self->reach * (double)batch->shift[k][i];
            anisotropy_place(self, particle, k, grid->origin[k] + moved);
        }
    }
    work->first += (uint32_t)work->count;
    work->count = 0;
}

/* Ends a block: what a vector reads past its last particle is far. */
static void close_block(struct anisotropy_block *block)
{
    for (int i = block->count; i < block->count + ANISOTROPY_PAD; i++) {
        block->x[i] = block->y[i] = block->z[i] = ANISOTROPY_FAR;
    }
}

/* Takes particles of a run, as many as fit. Returns the next of the run. */
static uint32_t gather(const struct grid *grid, uint32_t begin, uint32_t end, const float corner[3], float scale,
                       struct anisotropy_block *block)
{
    uint32_t room = (uint32_t)(ANISOTROPY_BLOCK - block->count), count = end - begin < room ? end - begin : room;
    float *x = block->x + block->count, *y = block->y + block->count, *z = block->z + block->count;
    for (uint32_t i = 0; i < count; i++) {
        x[i] = (grid->x[begin + i] - corner[0]) * scale;
        y[i] = (grid->y[begin + i] - corner[1]) * scale;
        z[i] = (grid->z[begin + i] - corner[2]) * scale;
    }
    block->count += (int)count;
    return begin + count;
}

/* Adds the neighbours of a cell's particles [begin, end) to the batch's end. */
static void add_particles(const struct shapes *shapes, struct work *work, const struct grid_run *runs, int run_count, uint32_t begin,
                          uint32_t end)
{
    const struct grid *grid = &shapes->self->grid;
    struct anisotropy_batch *batch = &work->batch;
    const float corner[3] = {grid->x[begin], grid->y[begin], grid->z[begin]}, scale = 1 / grid->support;
    int first = work->count, last = first + (int)(end - begin);
    for (int i = first; i < last; i++) {
        uint32_t sorted = begin + (uint32_t)(i - first);
        batch->x[i] = (grid->x[sorted] - corner[0]) * scale;
        batch->y[i] = (grid->y[sorted] - corner[1]) * scale;
        batch->z[i] = (grid->z[sorted] - corner[2]) * scale;
        for (int k = 0; k < ANISOTROPY_SUMS; k++) {
            batch->sum[k][i] = 0;
        }
    }
    work->block.count = 0;
    for (int run = 0; run < run_count; run++) {
        for (uint32_t at = runs[run].begin; at < runs[run].end;) {
            at = gather(grid, at, runs[run].end, corner, scale, &work->block);
            if (work->block.count == ANISOTROPY_BLOCK || (run == run_count - 1 && at == runs[run].end)) {
                close_block(&work->block);
                shapes->self->kernels->add(&work->block, batch, first, last);
                work->block.count = 0;
            }
        }
    }
    work->count = last;
}

static void part_job(void *context, int part)
{
    const struct shapes *shapes = context;
    const struct grid *grid = &shapes->self->grid;
    struct grid_run cells = mns_grid_part(grid, part, shapes->parts), runs[GRID_RUNS];
    struct work work = {.first = grid->start[cells.begin]};
    for (uint32_t cell = cells.begin; cell < cells.end; cell++) {
        uint32_t begin = grid->start[cell], end = grid->start[cell + 1];
        int run_count = begin < end ? mns_grid_neighbours(grid, cell, runs) : 0;
        while (begin < end) {
            uint32_t count = end - begin < ANISOTROPY_BATCH ? end - begin : ANISOTROPY_BATCH;
            if (work.count + (int)count > ANISOTROPY_BATCH) {
                flush(shapes, &work);
            }
            add_particles(shapes, &work, runs, run_count, begin, begin + count);
            begin += count;
        }
    }
    flush(shapes, &work);
}

void mns_anisotropy_shapes(mns_anisotropy *self, const struct mns_params *params)
{
    double reach = self->reach / (2 * self->radius);          /* spacings */
    double full = 2.0943951023931953 * reach * reach * reach; /* sum of w in a full neighbourhood: 2/3 pi reach^3 */
    double few = (double)params->anisotropy_neighbors * full;
    struct shapes shapes = {.self = self, .parts = PARTS_PER_THREAD * self->threads};
    shapes.rule = (struct anisotropy_rule){.ratio = params->anisotropy_ratio,
                                           .smoothing = params->anisotropy_smoothing,
                                           .isolated = params->anisotropy_isolated,
                                           .lonely = (float)(1 + few),
                                           .per_crowd = (float)(1 / few)};
    self->parallel.run(self->parallel.user, part_job, &shapes, shapes.parts);
}
