/* grid.c: particles sorted by cell: first into buckets of neighbouring cells, then each bucket by itself. */
#include "particles/grid.h"

#include "core/attr.h"
#include "core/message.h"
#include "cpu/measure.h"
#include "particles/sample.h"

#include <math.h>
#include <stdbool.h>

enum { BUCKETS = 1024, SLICE_MAX = 64, SAMPLE = 4096, CANDIDATE_PARTS = 64 };

static const double LARGEST_EXTENT = 1e12; /* as of a set that is drawn */

/* Cells are this much wider than the support, so that rounding puts no neighbour two cells away. */
static const double CELL_SLACK = 1.00001;

struct entry {
    uint32_t cell, index;
};

/* Kept from fill to fill: what the arrays hold, and the room that the sorting needs. */
struct grid_work {
    size_t x_room, y_room, z_room, index_room, start_room, from_room, to_room;
    struct entry *from, *to;
    uint32_t counts[SLICE_MAX][BUCKETS];
    uint32_t bucket_start[BUCKETS + 1];
    float sample[3][SAMPLE];
    struct {
        double min[3], max[3];
        size_t finite;
    } part[SLICE_MAX]; /* of each slice */
    double candidates[CANDIDATE_PARTS];
};

struct fill {
    struct grid *grid;
    struct grid_work *work;
    const struct mns_particles *particles;
    const struct mns_parallel *parallel;
    int slices;
    int shift;                              /* bucket = cell >> shift */
    double bounds_min[3], bounds_max[3];    /* world space */
    double cell_origin[3], cells_per_metre; /* relative to the grid's origin */
};

static inline bool world_position(const struct mns_attr *position, enum mns_type type, size_t i, double p[3])
{
    for (int k = 0; k < 3; k++) {
        p[k] = mns_attr_get(position, type, 3, i, k);
    }
    return isfinite(p[0]) && isfinite(p[1]) && isfinite(p[2]);
}

static inline void bounds_loop(struct fill *fill, int slice, enum mns_type type)
{
    double min[3] = {INFINITY, INFINITY, INFINITY}, max[3] = {-INFINITY, -INFINITY, -INFINITY}, p[3];
    size_t finite = 0, end = mns_part_begin(fill->particles->count, slice + 1, fill->slices);
    for (size_t i = mns_part_begin(fill->particles->count, slice, fill->slices); i < end; i++) {
        if (!world_position(&fill->particles->position, type, i, p)) {
            continue;
        }
        finite++;
        for (int k = 0; k < 3; k++) {
            min[k] = p[k] < min[k] ? p[k] : min[k];
            max[k] = p[k] > max[k] ? p[k] : max[k];
        }
    }
    for (int k = 0; k < 3; k++) {
        fill->work->part[slice].min[k] = min[k];
        fill->work->part[slice].max[k] = max[k];
    }
    fill->work->part[slice].finite = finite;
}

static void bounds_job(void *context, int slice)
{
    struct fill *fill = context;
    if (fill->particles->position.type == MNS_F32) {
        bounds_loop(fill, slice, MNS_F32);
    } else {
        bounds_loop(fill, slice, MNS_F64);
    }
}

static void measure_bounds(struct fill *fill)
{
    struct grid *grid = fill->grid;
    fill->parallel->run(fill->parallel->user, bounds_job, fill, fill->slices);
    grid->count = 0;
    for (int k = 0; k < 3; k++) {
        fill->bounds_min[k] = INFINITY;
        fill->bounds_max[k] = -INFINITY;
        for (int slice = 0; slice < fill->slices; slice++) {
            fill->bounds_min[k] = fmin(fill->bounds_min[k], fill->work->part[slice].min[k]);
            fill->bounds_max[k] = fmax(fill->bounds_max[k], fill->work->part[slice].max[k]);
        }
        grid->origin[k] = 0.5 * fill->bounds_min[k] + 0.5 * fill->bounds_max[k];
    }
    for (int slice = 0; slice < fill->slices; slice++) {
        grid->count += fill->work->part[slice].finite;
    }
}

static mns_result check(const struct fill *fill, struct mns_message *message)
{
    for (int k = 0; k < 3 && fill->grid->count > 0; k++) {
        if (!(fill->bounds_max[k] - fill->bounds_min[k] < LARGEST_EXTENT)) {
            return mns_fail(message, MNS_ERR_INVALID_ARGUMENT,
                            "the particles span %g m along %c; at most %g can be searched for neighbours",
                            fill->bounds_max[k] - fill->bounds_min[k], "xyz"[k], LARGEST_EXTENT);
        }
    }
    return MNS_OK;
}

static inline bool position_of(const struct fill *fill, enum mns_type type, size_t i, float out[3])
{
    double p[3];
    bool finite = world_position(&fill->particles->position, type, i, p);
    for (int k = 0; k < 3; k++) {
        out[k] = (float)(p[k] - fill->grid->origin[k]);
    }
    return finite;
}

/* ---- the size of the torus ---- */

/* Widths of the box that holds all but the strays: 0.5 % on either side of each axis. */
static void inner_extent(const struct fill *fill, double extent[3])
{
    const struct mns_particles *in = fill->particles;
    size_t step = in->count / SAMPLE + 1, taken = 0;
    for (size_t run = 0; run * step < in->count && taken < SAMPLE; run++) {
        size_t i = mns_sample_index(run, step);
        float p[3];
        if (i < in->count && position_of(fill, in->position.type, i, p)) {
            for (int k = 0; k < 3; k++) {
                fill->work->sample[k][taken] = p[k];
            }
            taken++;
        }
    }
    for (int k = 0; k < 3 && taken > 0; k++) {
        float low = mns_select(fill->work->sample[k], taken, taken / 200);
        extent[k] = (double)(mns_select(fill->work->sample[k], taken, taken - 1 - taken / 200) - low);
    }
}

/* The box in cells, with an empty cell on either side so that nothing comes round; too large for the memory, the box without strays; at last
 * its longest sides cut. */
static void choose_size(struct fill *fill)
{
    const double room = (double)GRID_CELLS_PER_PARTICLE * (double)fill->grid->count + GRID_CELLS_LEAST;
    const double most = room < 2147483648.0 ? room : 2147483648.0; /* cells are numbered in 32 bits */
    double extent[3], size[3];
    for (int k = 0; k < 3; k++) {
        extent[k] = fill->bounds_max[k] - fill->bounds_min[k];
    }
    for (int attempt = 0; attempt < 2; attempt++) {
        for (int k = 0; k < 3; k++) {
            size[k] = floor(extent[k] * fill->cells_per_metre) + 3;
        }
        if (attempt == 0 && size[0] * size[1] * size[2] > most) {
            inner_extent(fill, extent);
        }
    }
    for (;;) {
        int longest = size[1] > size[0] ? 1 : 0;
        longest = size[2] > size[longest] ? 2 : longest;
        double others = size[(longest + 1) % 3] * size[(longest + 2) % 3];
        if (others * size[longest] <= most) {
            break;
        }
        int second = size[(longest + 1) % 3] > size[(longest + 2) % 3] ? (longest + 1) % 3 : (longest + 2) % 3;
        double fits = floor(most / others); /* no shorter than the second, or the two by turns would reach nothing */
        size[longest] = fits >= size[second] ? fits : size[longest] > size[second] ? size[second] : floor(0.5 * size[longest]);
        size[longest] = size[longest] < 3 ? 3 : size[longest];
    }
    for (int k = 0; k < 3; k++) {
        fill->grid->size[k] = (uint32_t)size[k];
        fill->cell_origin[k] = fill->bounds_min[k] - fill->grid->origin[k] - 1 / fill->cells_per_metre;
    }
    fill->grid->cells = fill->grid->size[0] * fill->grid->size[1] * fill->grid->size[2];
    for (fill->shift = 0; (fill->grid->cells - 1) >> fill->shift >= BUCKETS; fill->shift++) {
    }
}

static inline uint32_t cell_of(const struct fill *fill, const float p[3])
{
    uint32_t cell = 0;
    for (int k = 2; k >= 0; k--) {
        double size = (double)fill->grid->size[k], c = floor(((double)p[k] - fill->cell_origin[k]) * fill->cells_per_metre);
        c -= size * floor(c / size);
        c = c > 0 ? c < size - 1 ? c : size - 1 : 0; /* far from the origin the subtraction rounds */
        cell = cell * fill->grid->size[k] + (uint32_t)c;
    }
    return cell;
}

/* ---- sorting ---- */

static inline void entries_loop(struct fill *fill, int slice, enum mns_type type)
{
    struct entry *out = fill->work->from;
    uint32_t *counts = fill->work->counts[slice];
    memset(counts, 0, sizeof(fill->work->counts[slice]));
    for (int before = 0; before < slice; before++) {
        out += fill->work->part[before].finite;
    }
    size_t end = mns_part_begin(fill->particles->count, slice + 1, fill->slices);
    for (size_t i = mns_part_begin(fill->particles->count, slice, fill->slices); i < end; i++) {
        float p[3];
        if (position_of(fill, type, i, p)) {
            *out = (struct entry){.cell = cell_of(fill, p), .index = (uint32_t)i};
            counts[out++->cell >> fill->shift]++;
        }
    }
}

/* The finite particles of a slice, behind those of the slices before, counted by bucket. */
static void entries_job(void *context, int slice)
{
    struct fill *fill = context;
    if (fill->particles->position.type == MNS_F32) {
        entries_loop(fill, slice, MNS_F32);
    } else {
        entries_loop(fill, slice, MNS_F64);
    }
}

static void scatter_job(void *context, int slice)
{
    struct fill *fill = context;
    const struct entry *from = fill->work->from;
    uint32_t *places = fill->work->counts[slice];
    for (int before = 0; before < slice; before++) {
        from += fill->work->part[before].finite;
    }
    for (size_t i = 0; i < fill->work->part[slice].finite; i++) {
        fill->work->to[places[from[i].cell >> fill->shift]++] = from[i];
    }
}

/* Where each slice puts its particles of each bucket. */
static void place_buckets(struct fill *fill)
{
    struct grid_work *work = fill->work;
    uint32_t place = 0;
    for (int bucket = 0; bucket < BUCKETS; bucket++) {
        work->bucket_start[bucket] = place;
        for (int slice = 0; slice < fill->slices; slice++) {
            uint32_t count = work->counts[slice][bucket];
            work->counts[slice][bucket] = place;
            place += count;
        }
    }
    work->bucket_start[BUCKETS] = place;
}

/* Sorts a bucket by cell, and copies its particles to their places. */
static void bucket_job(void *context, int bucket)
{
    struct fill *fill = context;
    struct grid *grid = fill->grid;
    const struct entry *entries = fill->work->to;
    uint64_t first = (uint64_t)bucket << fill->shift, last = (uint64_t)(bucket + 1) << fill->shift;
    uint64_t end = last < grid->cells ? last : grid->cells;
    uint32_t begin = fill->work->bucket_start[bucket], stop = fill->work->bucket_start[bucket + 1], place = begin;
    for (uint64_t cell = first; cell < end; cell++) {
        grid->start[cell] = 0;
    }
    for (uint32_t i = begin; i < stop; i++) {
        grid->start[entries[i].cell]++;
    }
    for (uint64_t cell = first; cell < end; cell++) {
        place += grid->start[cell];
        grid->start[cell] = place; /* the end, for now */
    }
    for (uint32_t i = stop; i-- > begin;) {
        uint32_t at = --grid->start[entries[i].cell];
        float p[3];
        position_of(fill, fill->particles->position.type, entries[i].index, p);
        grid->index[at] = entries[i].index;
        grid->x[at] = p[0];
        grid->y[at] = p[1];
        grid->z[at] = p[2];
    }
}

/* ---- neighbours ---- */

int mns_grid_neighbours(const struct grid *grid, uint32_t cell, struct grid_run runs[GRID_RUNS])
{
    const uint32_t nx = grid->size[0], ny = grid->size[1], nz = grid->size[2];
    const uint32_t x = cell % nx, y = cell / nx % ny, z = cell / nx / ny;
    int count = 0;
    for (uint32_t dz = 0; dz < 3; dz++) {
        uint32_t plane = (z + nz - 1 + dz) % nz * ny;
        for (uint32_t dy = 0; dy < 3; dy++) {
            const uint32_t *row = grid->start + (plane + (y + ny - 1 + dy) % ny) * nx;
            uint32_t low = x > 0 ? x - 1 : 0, high = x + 1 < nx ? x + 2 : nx;
            runs[count] = (struct grid_run){row[low], row[high]};
            count += row[low] < row[high];
            if (x == 0 || x + 1 == nx) { /* the cell round the end of the row */
                uint32_t round = x == 0 ? nx - 1 : 0;
                runs[count] = (struct grid_run){row[round], row[round + 1]};
                count += row[round] < row[round + 1];
            }
        }
    }
    return count;
}

/* The first cell that begins at or after sorted particle i. */
static uint32_t cell_from(const struct grid *grid, size_t i)
{
    uint32_t low = 0, high = grid->cells;
    while (low < high) {
        uint32_t middle = low + (high - low) / 2;
        if (grid->start[middle] < i) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return low;
}

struct grid_run mns_grid_part(const struct grid *grid, int part, int parts)
{
    struct grid_run run = {cell_from(grid, mns_part_begin(grid->count, part, parts)), grid->cells};
    if (part + 1 < parts) {
        run.end = cell_from(grid, mns_part_begin(grid->count, part + 1, parts));
    }
    return run;
}

static void candidates_job(void *context, int part)
{
    const struct fill *fill = context;
    const struct grid *grid = fill->grid;
    struct grid_run cells = mns_grid_part(grid, part, CANDIDATE_PARTS);
    double sum = 0;
    for (uint32_t cell = cells.begin; cell < cells.end; cell++) {
        uint32_t inside = grid->start[cell + 1] - grid->start[cell];
        struct grid_run runs[GRID_RUNS];
        int count = inside ? mns_grid_neighbours(grid, cell, runs) : 0;
        for (int run = 0; run < count; run++) {
            sum += (double)inside * (runs[run].end - runs[run].begin);
        }
    }
    fill->work->candidates[part] = sum;
}

static void count_candidates(struct fill *fill)
{
    fill->parallel->run(fill->parallel->user, candidates_job, fill, CANDIDATE_PARTS);
    double sum = 0;
    for (int part = 0; part < CANDIDATE_PARTS; part++) {
        sum += fill->work->candidates[part];
    }
    fill->grid->candidates = sum / (double)fill->grid->count;
}

/* ---- all of it ---- */

static bool reserve(struct fill *fill, struct memory *memory)
{
    struct grid *grid = fill->grid;
    struct grid_work *work = fill->work;
    size_t count = grid->count, padded = count + GRID_PAD;
    grid->x = mns_memory_reserve(memory, grid->x, &work->x_room, padded, sizeof(*grid->x));
    grid->y = mns_memory_reserve(memory, grid->y, &work->y_room, padded, sizeof(*grid->y));
    grid->z = mns_memory_reserve(memory, grid->z, &work->z_room, padded, sizeof(*grid->z));
    grid->index = mns_memory_reserve(memory, grid->index, &work->index_room, count, sizeof(*grid->index));
    grid->start = mns_memory_reserve(memory, grid->start, &work->start_room, (size_t)grid->cells + 1, sizeof(*grid->start));
    work->from = mns_memory_reserve(memory, work->from, &work->from_room, count, sizeof(*work->from));
    work->to = mns_memory_reserve(memory, work->to, &work->to_room, count, sizeof(*work->to));
    return grid->x && grid->y && grid->z && grid->index && grid->start && work->from && work->to;
}

static void sort(struct fill *fill)
{
    struct grid *grid = fill->grid;
    const struct mns_parallel *parallel = fill->parallel;
    parallel->run(parallel->user, entries_job, fill, fill->slices);
    place_buckets(fill);
    parallel->run(parallel->user, scatter_job, fill, fill->slices);
    parallel->run(parallel->user, bucket_job, fill, BUCKETS);
    grid->start[grid->cells] = (uint32_t)grid->count;
    for (size_t i = grid->count; i < grid->count + GRID_PAD; i++) {
        grid->x[i] = grid->y[i] = grid->z[i] = INFINITY;
    }
}

static mns_result begin(struct grid *grid, struct memory *memory, const struct mns_particles *particles, struct mns_message *message)
{
    grid->count = 0;
    grid->cells = 0;
    if (particles->count > UINT32_MAX - 64) {
        return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "%zu particles; at most %lu can be searched for neighbours", particles->count,
                        (unsigned long)UINT32_MAX - 64);
    }
    if (particles->count > 0 && !particles->position.data) {
        return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "particles without positions");
    }
    if (particles->position.type != MNS_F32 && particles->position.type != MNS_F64) {
        return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "positions are %s; they must be float32 or float64",
                        mns_type_name(particles->position.type));
    }
    if (!grid->work) {
        grid->work = mns_memory_get(memory, 1, sizeof(*grid->work));
        if (!grid->work) {
            return mns_fail(message, MNS_ERR_OUT_OF_MEMORY, "out of memory");
        }
        memset(grid->work, 0, sizeof(*grid->work));
    }
    return MNS_OK;
}

mns_result mns_grid_fill(struct grid *grid, struct memory *memory, const struct mns_parallel *parallel, int slices,
                         const struct mns_particles *particles, double support, struct mns_message *message)
{
    mns_result result = begin(grid, memory, particles, message);
    if (result != MNS_OK) {
        return result;
    }
    struct fill fill = {.grid = grid, .work = grid->work, .particles = particles, .parallel = parallel};
    fill.slices = slices < 1 ? 1 : slices < SLICE_MAX ? slices : SLICE_MAX;
    fill.cells_per_metre = 1 / (support * CELL_SLACK);
    grid->support = (float)support;
    grid->candidates = 0;
    measure_bounds(&fill);
    result = check(&fill, message);
    if (result != MNS_OK || grid->count == 0) {
        grid->count = 0;
        return result;
    }
    choose_size(&fill);
    if (!reserve(&fill, memory)) {
        mns_grid_free(grid, memory);
        return mns_fail(message, MNS_ERR_OUT_OF_MEMORY, "out of memory for %zu particles", particles->count);
    }
    sort(&fill);
    count_candidates(&fill);
    return MNS_OK;
}

void mns_grid_free(struct grid *grid, struct memory *memory)
{
    struct grid_work *work = grid->work;
    if (work) {
        mns_memory_put(memory, grid->x, work->x_room, sizeof(*grid->x));
        mns_memory_put(memory, grid->y, work->y_room, sizeof(*grid->y));
        mns_memory_put(memory, grid->z, work->z_room, sizeof(*grid->z));
        mns_memory_put(memory, grid->index, work->index_room, sizeof(*grid->index));
        mns_memory_put(memory, grid->start, work->start_room, sizeof(*grid->start));
        mns_memory_put(memory, work->from, work->from_room, sizeof(*work->from));
        mns_memory_put(memory, work->to, work->to_room, sizeof(*work->to));
        mns_memory_put(memory, work, 1, sizeof(*work));
    }
    *grid = (struct grid){0};
}
