/* spray.c: stage spray: soft drops, stretched by their motion, to optical depths before and behind the surface.
 * In: the spray store, the smoothed depth, the scene's depth. Out: backend->spray, where foam is drawn at all and there is spray. */
#include "cpu/spray.h"

#include "cpu/cpu.h"
#include "cpu/sprite.h"
#include "cpu/tiles.h"

#include <math.h>
#include <string.h>

enum { DROPS_PER_JOB = 4096 };

struct spray_run {
    struct backend *cpu;
    const struct frame *frame;
    struct spray *spray;
    const struct splat_view *view; /* its spheres are the drops */
    atomic_size_t next;
};

/* Half the way of a drop while the shutter is open, in image space, metres. */
static void half_way(const struct spray_run *run, size_t particle, float out[3])
{
    const struct particle_store *store = run->view->particles;
    for (int k = 0; k < 3; k++) {
        out[k] = 0;
        for (int axis = 0; axis < 3 && store->velocity[0]; axis++) {
            out[k] += 0.5f * run->frame->params.spray_shutter * run->view->rotation[3 * k + axis] * store->velocity[axis][particle];
        }
    }
}

static struct spray_drop project_drop(const struct spray_run *run, size_t particle)
{
    const struct splat_view *view = run->view;
    float q[3], way[3], radius = sprite_radius(view, particle);
    sprite_center(view, particle, q);
    struct spray_drop drop = {.depth = q[2], .half = radius};
    bool seen = view->orthographic ? q[2] > view->near_plane : q[2] > fmaxf(CLOSE_RADII * radius, view->near_plane);
    if (!seen || q[2] > view->far_plane) {
        return drop;
    }
    half_way(run, particle, way);
    float per_z = view->orthographic ? 1 : 1 / q[2], fx = view->fx * per_z, fy = view->fy * per_z, size = 0.5f * (fx + fy) * radius;
    drop.x = fx * q[0] + view->cx;
    drop.y = fy * q[1] + view->cy;
    /* A point that moves by way is seen to move by way - (q / z) way_z. */
    drop.dx = fx * (way[0] - (view->orthographic ? 0 : q[0] * per_z * way[2]));
    drop.dy = fy * (way[1] - (view->orthographic ? 0 : q[1] * per_z * way[2]));
    drop.radius = fmaxf(size, SPRAY_LEAST);
    float length = sqrtf(drop.dx * drop.dx + drop.dy * drop.dy), most = SPRAY_STREAK_MAX * drop.radius;
    if (length > most) {
        drop.dx *= most / length;
        drop.dy *= most / length;
        length = most;
    }
    /* Integrals of (1 - s^2)^2: pi r^2 / 3 over a disc, 16/15 r a length along a way. Over pi / 3. */
    const float along = 2 * 1.0185916f; /* 16/15 / (pi / 3), of both halves */
    float share = size * size / (drop.radius * (drop.radius + along * length));
    drop.amount = run->frame->params.spray_depth * view->particles->opacity[particle] * share;
    return drop;
}

static void drops_job(void *context, int index)
{
    (void)index;
    struct spray_run *run = context;
    size_t count = run->view->particles->count;
    for (size_t begin = atomic_fetch_add(&run->next, DROPS_PER_JOB); begin < count; begin = atomic_fetch_add(&run->next, DROPS_PER_JOB)) {
        for (size_t i = begin; i < begin + DROPS_PER_JOB && i < count; i++) {
            run->spray->drops[i] = project_drop(run, i);
        }
    }
}

/* Pixels, inclusive; none: x0 > x1 or y0 > y1. */
struct box {
    int x0, x1, y0, y1;
};

static struct box box_of(const struct spray_drop *drop, int width, int height)
{
    struct box box;
    float rx = fabsf(drop->dx) + drop->radius, ry = fabsf(drop->dy) + drop->radius;
    sprite_span(drop->x - rx, drop->x + rx, width, &box.x0, &box.x1);
    sprite_span(drop->y - ry, drop->y + ry, height, &box.y0, &box.y1);
    return box;
}

/* Lists the drops of each tile in the order of the store. false: out of memory. */
static bool list_drops(struct spray_run *run)
{
    struct spray *spray = run->spray;
    size_t count = run->view->particles->count, tiles = (size_t)spray->columns * (size_t)spray->rows;
    memset(spray->begin, 0, (tiles + 1) * sizeof(*spray->begin));
    for (int pass = 0; pass < 2; pass++) { /* counts, then places */
        for (size_t i = 0; i < count; i++) {
            struct box box = box_of(&spray->drops[i], run->view->width, run->view->height);
            for (int ty = box.y0 / TILE_SIZE;
                 spray->drops[i].amount > 0 && box.x0 <= box.x1 && box.y0 <= box.y1 && ty <= box.y1 / TILE_SIZE; ty++) {
                for (int tx = box.x0 / TILE_SIZE; tx <= box.x1 / TILE_SIZE; tx++) {
                    size_t *place = &spray->begin[ty * spray->columns + tx];
                    if (pass == 1) {
                        spray->entries[*place] = (uint32_t)i;
                    }
                    ++*place;
                }
            }
        }
        size_t sum = 0;
        for (size_t tile = 0; tile < tiles && pass == 0; tile++) {
            size_t here = spray->begin[tile];
            spray->begin[tile] = sum;
            sum += here;
        }
        if (pass == 0) {
            spray->entries = mns_memory_reserve(run->cpu->host.memory, spray->entries, &spray->entry_capacity, sum > 0 ? sum : 1,
                                                sizeof(*spray->entries));
            if (!spray->entries) {
                return false;
            }
        }
    }
    memmove(spray->begin + 1, spray->begin, tiles * sizeof(*spray->begin)); /* each place has gone on to where the next tile begins */
    spray->begin[0] = 0;
    return true;
}

/* The part of a drop that lies before a depth: smoothly, since it has a size. */
static float part_before(const struct spray_drop *drop, float depth)
{
    float part = 0.5f + 0.5f * (depth - drop->depth) / drop->half;
    return part > 0 ? part < 1 ? part : 1 : 0;
}

/* Squared distance in radii from the way of the drop's centre. */
static float distance2(const struct spray_drop *drop, float per_length2, float x, float y)
{
    float along = (x * drop->dx + y * drop->dy) * per_length2;
    along = along > -1 ? along < 1 ? along : 1 : -1;
    float across = x - along * drop->dx, down = y - along * drop->dy;
    return (across * across + down * down) / (drop->radius * drop->radius);
}

static void draw_drop(struct spray_run *run, const struct spray_drop *drop, const struct box *tile)
{
    struct backend *cpu = run->cpu;
    struct spray *spray = run->spray;
    const struct plane *depth = &cpu->smoothed->plane, *scene = cpu->scene.has_depth ? &cpu->scene.depth : NULL;
    struct box box = box_of(drop, run->view->width, run->view->height);
    float length2 = drop->dx * drop->dx + drop->dy * drop->dy, per_length2 = length2 > 0 ? 1 / length2 : 0;
    int x0 = box.x0 > tile->x0 ? box.x0 : tile->x0, x1 = box.x1 < tile->x1 ? box.x1 : tile->x1;
    int y0 = box.y0 > tile->y0 ? box.y0 : tile->y0, y1 = box.y1 < tile->y1 ? box.y1 : tile->y1;
    for (int y = y0; y <= y1; y++) {
        for (int x = x0; x <= x1; x++) {
            float rest = 1 - distance2(drop, per_length2, (float)x + 0.5f - drop->x, (float)y + 0.5f - drop->y);
            if (!(rest > 0)) {
                continue;
            }
            float amount = drop->amount * rest * rest, before = part_before(drop, depth->data[y * depth->stride + x]);
            amount *= scene ? part_before(drop, scene->data[y * scene->stride + x]) : 1;
            spray->front.data[y * spray->front.stride + x] += amount * before;
            spray->behind.data[y * spray->behind.stride + x] += amount * (1 - before);
        }
    }
}

static void tiles_job(void *context, int index)
{
    (void)index;
    struct spray_run *run = context;
    struct spray *spray = run->spray;
    size_t count = (size_t)spray->columns * (size_t)spray->rows;
    for (size_t at = atomic_fetch_add(&run->next, 1); at < count; at = atomic_fetch_add(&run->next, 1)) {
        int x = (int)(at % (size_t)spray->columns) * TILE_SIZE, y = (int)(at / (size_t)spray->columns) * TILE_SIZE;
        struct box tile = {.x0 = x, .x1 = x + TILE_SIZE - 1, .y0 = y, .y1 = y + TILE_SIZE - 1};
        tile.x1 = tile.x1 < run->view->width ? tile.x1 : run->view->width - 1;
        tile.y1 = tile.y1 < run->view->height ? tile.y1 : run->view->height - 1;
        for (int row = tile.y0; row <= tile.y1; row++) {
            memset(spray->front.data + row * spray->front.stride + x, 0, sizeof(float) * (size_t)(tile.x1 - x + 1));
            memset(spray->behind.data + row * spray->behind.stride + x, 0, sizeof(float) * (size_t)(tile.x1 - x + 1));
        }
        for (size_t i = spray->begin[at]; i < spray->begin[at + 1]; i++) {
            draw_drop(run, &spray->drops[spray->entries[i]], &tile);
        }
    }
}

static bool reserve(struct backend *cpu, const struct frame *frame)
{
    struct memory *memory = cpu->host.memory;
    if (!cpu->spray) {
        cpu->spray = mns_memory_get(memory, 1, sizeof(*cpu->spray));
        if (!cpu->spray) {
            return false;
        }
        *cpu->spray = (struct spray){0};
    }
    struct spray *spray = cpu->spray;
    int width = frame->view.width, height = frame->view.height;
    spray->columns = (width + TILE_SIZE - 1) / TILE_SIZE;
    spray->rows = (height + TILE_SIZE - 1) / TILE_SIZE;
    size_t tiles = (size_t)spray->columns * (size_t)spray->rows;
    spray->drops = mns_memory_reserve(memory, spray->drops, &spray->drop_capacity, cpu->stores[STORE_SPRAY].count, sizeof(*spray->drops));
    spray->begin = mns_memory_reserve(memory, spray->begin, &spray->begin_capacity, tiles + 1, sizeof(*spray->begin));
    return spray->drops && spray->begin && mns_plane_resize(&spray->front, memory, width, height, 0) &&
           mns_plane_resize(&spray->behind, memory, width, height, 0);
}

mns_result mns_cpu_spray(struct backend *cpu, const struct frame *frame)
{
    if (cpu->spray) {
        cpu->spray->shows = false;
    }
    if (frame->params.foam == MNS_FOAM_NONE || cpu->stores[STORE_SPRAY].count == 0) {
        return MNS_OK;
    }
    mns_result result = mns_cpu_bin_store(cpu, frame, STORE_SPRAY, frame->params.spray_radius); /* for its view */
    if (result != MNS_OK || !reserve(cpu, frame)) {
        return result != MNS_OK ? result : cpu_out_of_memory(cpu);
    }
    struct spray_run run = {.cpu = cpu, .frame = frame, .spray = cpu->spray, .view = &cpu->tiles[STORE_SPRAY].view};
    cpu_run(cpu, drops_job, &run, cpu->host.threads);
    if (!list_drops(&run)) {
        return cpu_out_of_memory(cpu);
    }
    atomic_store(&run.next, 0);
    cpu_run(cpu, tiles_job, &run, cpu->host.threads);
    cpu->spray->shows = true;
    return MNS_OK;
}

void mns_spray_destroy(struct backend *cpu)
{
    struct memory *memory = cpu->host.memory;
    struct spray *spray = cpu->spray;
    if (spray) {
        mns_plane_free(&spray->front, memory);
        mns_plane_free(&spray->behind, memory);
        mns_memory_put(memory, spray->drops, spray->drop_capacity, sizeof(*spray->drops));
        mns_memory_put(memory, spray->entries, spray->entry_capacity, sizeof(*spray->entries));
        mns_memory_put(memory, spray->begin, spray->begin_capacity, sizeof(*spray->begin));
        mns_memory_put(memory, spray, 1, sizeof(*spray));
        cpu->spray = NULL;
    }
}
