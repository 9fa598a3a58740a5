/* curvature_flow.c: the filters curvature-flow [LGS09] and adaptive-curvature-flow [BSW10]: explicit steps over the picture. */
#include "cpu/smooth/filter.h"
#include "cpu/smooth/flow.h"
#include "util/prefetch.h"

#include <math.h>
#include <string.h>

/* A job goes down a patch of this size and takes several steps on the way, each two rows behind the one before, with their rows in the nearest
 * caches: a picture comes from memory once in LEVELS steps. Each step needs two pixels around what it makes, so that a patch begins with as many
 * more at each side: within a block. */
enum {
    LEVELS = 4,
    PATCH_WIDTH = 1024,
    PATCH_HEIGHT = 128,
    PATCH_BLOCKS = PATCH_WIDTH / BLOCK_WIDTH,
    MARGIN = 2 * BLOCK_WIDTH, /* a block is made, and the pixel beside it read */
    ROWS_AHEAD = 4,
    ROW = PATCH_WIDTH + 2 * MARGIN
};

_Static_assert(2 * LEVELS <= BLOCK_HEIGHT && 2 * LEVELS < BLOCK_WIDTH, "what a pass reaches lies in the blocks beside");

/* The explicit flows measure their step where the fluid's middle is: there flow_step 0.5 is the bound of the five-point scheme. Pixels that
 * are no squares are smoothed alike in the world: each axis' rate goes with its focal length squared. */
static struct flow resolve(const struct frame *frame)
{
    const struct view *view = &frame->view;
    const struct mns_params *params = &frame->params;
    float widest = fmaxf(fabsf(view->fx), fabsf(view->fy)), time = params->flow_step * (view->orthographic ? 1 : frame->depth_reference);
    struct flow flow = {.apart = params->edge_threshold * frame->splat_radius, .orthographic = view->orthographic};
    const float focal[2] = {fabsf(view->fx), fabsf(view->fy)};
    for (int axis = 0; axis < 2; axis++) {
        float part = focal[axis] / widest;
        flow.focal_square[axis] = focal[axis] * focal[axis];
        flow.slope[axis] = FLOW_SLOPE_MAX / focal[axis];
        flow.rate[axis] = 0.5f * time * part * part;
    }
    if (params->filter ==
        MNS_FILTER_ADAPTIVE_CURVATURE_FLOW) { /* [BSW10] eq. 4 with r_w = sigma^2 f / time; a step is taken while i < r_s */
        float sigma = params->flow_sigma * frame->splat_radius * widest;
        flow.count = fmaxf(sigma * sigma / time, 1e-30f);
    }
    return flow;
}

/* Steps that are left to take in and near each block of a picture, [blocks_y][blocks_x]. */
struct flow_blocks {
    const float *inside; /* in a block or one beside it: what moves */
    const float *around; /* ... or one beside those: where edges and speeds matter */
};

struct flow_pass {
    const struct flow *flow;
    const struct flow_kernels *kernels;
    struct flow_blocks blocks;
    const struct depth_plane *start, *in;
    struct depth_plane *out;
    int patches_x, step, levels; /* steps step to step + levels - 1 */
};

/* Steps that any pixel of a block takes. */
static float block_steps(const struct flow *flow, float nearest)
{
    return nearest >= DEPTH_LIMIT ? 0 : flow->count == 0 ? INFINITY : flow->orthographic ? flow->count : flow->count / nearest;
}

/* The largest of each block and those beside it. */
static void dilate(const struct depth_plane *plane, const float *in, float *out)
{
    for (int by = 0; by < plane->blocks_y; by++) {
        for (int bx = 0; bx < plane->blocks_x; bx++) {
            float largest = 0;
            for (int y = by > 0 ? by - 1 : 0; y <= by + 1 && y < plane->blocks_y; y++) {
                for (int x = bx > 0 ? bx - 1 : 0; x <= bx + 1 && x < plane->blocks_x; x++) {
                    largest = fmaxf(largest, in[y * plane->blocks_x + x]);
                }
            }
            out[by * plane->blocks_x + bx] = largest;
        }
    }
}

/* Fills three images of blocks; the first is the steps themselves. Returns the most. */
static float count_steps(const struct flow *flow, const struct depth_plane *plane, float *steps, struct flow_blocks *out)
{
    int blocks = plane->blocks_x * plane->blocks_y;
    float most = 0;
    for (int i = 0; i < blocks; i++) {
        steps[i] = block_steps(flow, plane->ranges[i].min);
        most = fmaxf(most, steps[i]);
    }
    dilate(plane, steps, steps + blocks);
    dilate(plane, steps + blocks, steps + 2 * blocks);
    *out = (struct flow_blocks){.inside = steps + blocks, .around = steps + 2 * blocks};
    return most;
}

/* Where a row of blocks has work: runs of blocks [begin, end), relative to the patch's first. */
struct runs {
    struct {
        int begin, end;
    } run[PATCH_BLOCKS + 2];
    int count;
};

static void runs_add(struct runs *runs, int block)
{
    if (runs->count > 0 && runs->run[runs->count - 1].end == block) {
        runs->run[runs->count - 1].end++;
    } else {
        runs->run[runs->count].begin = block;
        runs->run[runs->count++].end = block + 1;
    }
}

/* Where a row of blocks has work: edges, speeds and the steps between around, the last step inside. */
struct work {
    int block_row;
    struct runs around, inside;
};

/* Rows of one step, in rings: row y at [y mod 4]. The patch's first pixel is at MARGIN. */
struct level {
    _Alignas(64) float across[4][ROW], down[4][ROW], speed[4][ROW], depth[4][ROW]; /* depth: after the step */
    float flux[ROW];                                                               /* into the next row to step */
};

struct patch {
    const struct flow_pass *pass;
    int left, blocks;    /* the first block, and how many */
    struct work work[4]; /* of row y's blocks, at [y / BLOCK_HEIGHT mod 4] */
    struct level level[LEVELS];
};

/* What stood still in this pass and the one before is the same in both planes. */
static void find_work(struct patch *patch, int by)
{
    const struct flow_pass *pass = patch->pass;
    int blocks_x = pass->in->blocks_x, blocks_y = pass->in->blocks_y;
    float done = pass->step > LEVELS ? (float)(pass->step - LEVELS) : 0;
    struct work *work = &patch->work[by & 3];
    *work = (struct work){.block_row = by};
    for (int i = -1; i <= patch->blocks; i++) {
        int x = patch->left + i, y = by < 0 ? 0 : by < blocks_y ? by : blocks_y - 1; /* beyond the picture as at its edge */
        int index = y * blocks_x + (x < 0 ? 0 : x < blocks_x ? x : blocks_x - 1);
        if (pass->blocks.around[index] > done) {
            runs_add(&work->around, i);
        }
        if (i >= 0 && i < patch->blocks && pass->blocks.inside[index] > done) {
            runs_add(&work->inside, i);
        }
    }
}

static const struct work *work_at(struct patch *patch, int y)
{
    int by = (y + 2 * BLOCK_HEIGHT) / BLOCK_HEIGHT - 2; /* y is at least -2 LEVELS */
    if (patch->work[by & 3].block_row != by) {
        find_work(patch, by);
    }
    return &patch->work[by & 3];
}

static struct flow_row row_at(struct level *level, int y, int block)
{
    int x = MARGIN + block * BLOCK_WIDTH;
    return (struct flow_row){level->across[y & 3] + x, level->down[y & 3] + x, level->speed[y & 3] + x};
}

static float *plane_at(const struct patch *patch, const struct depth_plane *plane, int y, int block)
{
    return plane->plane.data + y * plane->plane.stride + (patch->left + block) * BLOCK_WIDTH;
}

/* Depth before a step. */
static const float *depth_at(struct patch *patch, int k, int y, int block)
{
    return k == 0 ? plane_at(patch, patch->pass->in, y, block) : patch->level[k - 1].depth[y & 3] + MARGIN + block * BLOCK_WIDTH;
}

/* Asks for a row of the picture that is read soon: every row is a stream of its own, too short for the processor to foresee. */
static void fetch_row(struct patch *patch, int y)
{
    const struct runs *runs = &work_at(patch, y)->around;
    for (int i = 0; i < runs->count; i++) {
        for (int block = runs->run[i].begin; block < runs->run[i].end; block++) {
            mns_prefetch(plane_at(patch, patch->pass->in, y, block));
        }
    }
}

static void make_speeds(struct patch *patch, int k, int y)
{
    const struct flow_pass *pass = patch->pass;
    const struct runs *runs = &work_at(patch, y)->around;
    for (int i = 0; i < runs->count; i++) {
        int block = runs->run[i].begin, count = (runs->run[i].end - block) * BLOCK_WIDTH;
        const struct flow_row row = row_at(&patch->level[k], y, block), above = row_at(&patch->level[k], y - 1, block);
        pass->kernels->speed(pass->flow, depth_at(patch, k, y, block), depth_at(patch, k, y + 1, block),
                             plane_at(patch, pass->start, y, block), pass->step + k, above.down, count, &row);
    }
}

/* After the speeds of the row below. */
static void step_row(struct patch *patch, int k, int y)
{
    const struct flow_pass *pass = patch->pass;
    struct level *level = &patch->level[k];
    const struct runs *runs = &work_at(patch, y)->around;
    for (int i = 0; i < runs->count; i++) {
        int block = runs->run[i].begin, count = (runs->run[i].end - block) * BLOCK_WIDTH, x = MARGIN + block * BLOCK_WIDTH;
        const struct flow_row row = row_at(level, y, block), below = row_at(level, y + 1, block);
        pass->kernels->step(pass->flow, depth_at(patch, k, y, block), &row, below.speed, count, level->flux + x, level->depth[y & 3] + x);
    }
}

/* A row after its last step goes to the picture. */
static void write_row(struct patch *patch, int y)
{
    const struct flow_pass *pass = patch->pass;
    const struct runs *runs = &work_at(patch, y)->inside;
    for (int i = 0; i < runs->count; i++) {
        int block = runs->run[i].begin, count = (runs->run[i].end - block) * BLOCK_WIDTH;
        memcpy(plane_at(patch, pass->out, y, block), depth_at(patch, pass->levels, y, block), (size_t)count * sizeof(float));
    }
}

/* Step k makes the rows of the patch and two more at each end for each step that follows, after one whose flux alone counts. */
static void run_patch(void *context, int index)
{
    const struct flow_pass *pass = context;
    int left = index % pass->patches_x * PATCH_BLOCKS, top = index / pass->patches_x * PATCH_HEIGHT, height = pass->in->plane.height;
    int bottom = top + PATCH_HEIGHT < height ? top + PATCH_HEIGHT : height, steps = pass->levels;
    struct patch patch = {.pass = pass, .left = left};
    for (int i = 0; i < 4; i++) {
        patch.work[i].block_row = -3; /* none */
    }
    patch.blocks = pass->in->blocks_x - left < PATCH_BLOCKS ? pass->in->blocks_x - left : PATCH_BLOCKS;
    for (int row = top - 2 * steps; row < bottom + 2 * steps; row++) {
        fetch_row(&patch, row + ROWS_AHEAD);
        for (int k = 0; k < steps; k++) {
            int y = row - 2 * k, rest = 2 * (steps - 1 - k); /* y: the row of speeds */
            if (y < top - rest - 2 || y > bottom + rest) {
                continue;
            }
            make_speeds(&patch, k, y);
            if (y > top - rest - 1) {
                step_row(&patch, k, y - 1);
            }
            if (k + 1 == steps && y > top) {
                write_row(&patch, y - 1);
            }
        }
    }
}

void mns_smooth_curvature_flow(struct backend *cpu, const struct frame *frame)
{
    const struct depth_plane *start = cpu->smoothed;
    struct flow flow = resolve(frame);
    struct flow_pass pass = {.flow = &flow, .kernels = cpu->kernels->smooth->flow, .start = start};
    float most = fminf(count_steps(&flow, start, cpu->block_values, &pass.blocks), (float)frame->params.iterations);
    int steps = (int)ceilf(most), patches_y = (start->plane.height + PATCH_HEIGHT - 1) / PATCH_HEIGHT;
    pass.patches_x = (start->plane.width + PATCH_WIDTH - 1) / PATCH_WIDTH;
    mns_smooth_copy_empty(cpu, start);
    for (pass.step = 0; pass.step < steps; pass.step += LEVELS) {
        pass.levels = steps - pass.step < LEVELS ? steps - pass.step : LEVELS;
        pass.in = cpu->smoothed;
        pass.out = smooth_target(cpu);
        cpu_run(cpu, run_patch, &pass, pass.patches_x * patches_y);
        cpu->smoothed = pass.out;
    }
    mns_smooth_measure(cpu);
}
