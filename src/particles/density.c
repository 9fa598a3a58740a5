/* density.c: SPH sums over the neighbour grid, a few particles of a row at once. */
#include "particles/density.h"

#include <math.h>

enum { PARTS = 256, LANES = 8 };

struct sum {
    const struct grid *grid;
    float *out;
};

/* The cubic spline over q = distance / support, less its factor: 1 - 6 q^2 + 6 q^3 up to q = 1/2, then 2 (1 - q)^3, 0 from 1 on. */
static inline float spline(float q2)
{
    float q = sqrtf(q2 < 1 ? q2 : 1), far = 1 - q;
    float inner = 1 - 6 * q * q * far, outer = 2 * far * far * far;
    return q < 0.5f ? inner : outer;
}

/* Runs may be read past their end (GRID_PAD): what lies there is weighed 0. */
static float sum_runs(const struct grid *grid, const struct grid_run *runs, int count, uint32_t i)
{
    const float x = grid->x[i], y = grid->y[i], z = grid->z[i], scale = 1 / (grid->support * grid->support);
    float lanes[LANES] = {0};
    for (int run = 0; run < count; run++) {
        for (uint32_t j = runs[run].begin; j < runs[run].end; j += LANES) {
            const float *px = grid->x + j, *py = grid->y + j, *pz = grid->z + j;
            const int left = (int)(runs[run].end - j);
            for (int k = 0; k < LANES; k++) {
                float dx = px[k] - x, dy = py[k] - y, dz = pz[k] - z;
                float weight = spline((dx * dx + dy * dy + dz * dz) * scale);
                lanes[k] += k < left ? weight : 0;
            }
        }
    }
    float total = 0;
    for (int k = 0; k < LANES; k++) {
        total += lanes[k];
    }
    return total;
}

static void sum_job(void *context, int part)
{
    const struct sum *sum = context;
    const struct grid *grid = sum->grid;
    const struct grid_run cells = mns_grid_part(grid, part, PARTS);
    /* 8 / pi h^3 times the volume (h / 2)^3 */
    const float factor = (float)(8 / 3.14159265358979323846 / (DENSITY_SUPPORT * DENSITY_SUPPORT * DENSITY_SUPPORT / 8));
    for (uint32_t cell = cells.begin; cell < cells.end; cell++) {
        if (grid->start[cell] == grid->start[cell + 1]) {
            continue;
        }
        struct grid_run runs[GRID_RUNS];
        int count = mns_grid_neighbours(grid, cell, runs);
        for (uint32_t i = grid->start[cell]; i < grid->start[cell + 1]; i++) {
            sum->out[grid->index[i]] = factor * sum_runs(grid, runs, count, i);
        }
    }
}

void mns_density_sum(const struct grid *grid, const struct mns_parallel *parallel, float *out, size_t count)
{
    struct sum sum = {.grid = grid, .out = out};
    for (size_t i = 0; grid->count < count && i < count; i++) {
        out[i] = 0; /* those with positions are written below */
    }
    parallel->run(parallel->user, sum_job, &sum, PARTS);
}
