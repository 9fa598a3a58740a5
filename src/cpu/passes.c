/* passes.c: stage passes: layers for compositors: velocity, motion, id, position. Free unless one of them is asked for.
 * In: the tiles' chunks, the smoothed depth, the particles' velocities and ids. The particle of a pixel is the one that its ray meets first, found
 * in double precision tile by tile: no hurry, but what lies wholly behind all that shows in a tile is passed over. */
#include "cpu/cpu.h"
#include "cpu/ellipsoid.h"
#include "cpu/pixels.h"
#include "cpu/tiles.h"

#include <math.h>
#include <string.h>

enum { NONE = -1, TILE_PIXELS = TILE_SIZE * TILE_SIZE };

/* The nearest particle of each of a tile's pixels. */
struct owners {
    double depth[TILE_PIXELS];
    long long particle[TILE_PIXELS]; /* place in the store, or NONE */
    float farthest;                  /* depth of all that shows in the tile; below 0: nothing does */
};

struct passes {
    struct backend *cpu;
    const struct frame *frame;
    const struct mns_image *velocity, *motion, *id, *position; /* NULL: not asked for */
    atomic_size_t next;                                        /* tile */
};

/* { c + R A u } in image space: (p - c)' Q (p - c) = size2. */
struct solid {
    double c[3], q[6], size2;
    int x0, y0, x1, y1; /* the tile's pixels that it may touch, inclusive */
};

static int least(int a, int b) { return a < b ? a : b; }
static int most(int a, int b) { return a > b ? a : b; }

static void apply(const double q[6], const double v[3], double out[3])
{
    out[0] = q[0] * v[0] + q[3] * v[1] + q[4] * v[2];
    out[1] = q[3] * v[0] + q[1] * v[1] + q[5] * v[2];
    out[2] = q[4] * v[0] + q[5] * v[1] + q[2] * v[2];
}

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* whole: its outline can be had from its projection; else it may touch any pixel. */
static struct solid solid_of(const struct splat_view *view, const struct splat_grid *grid, size_t particle, bool whole)
{
    struct solid s = {.q = {1, 1, 1}, .x1 = grid->columns - 1, .y1 = grid->rows - 1};
    float center[3], radius = sprite_radius(view, particle);
    double det = 1;
    sprite_center(view, particle, center);
    struct sprite outline = {0};
    if (view->particles->shape[0]) {
        struct ellipsoid e = {.det = 1};
        float a[6], b[6];
        ellipsoid_turn(view, particle, a, b);
        ellipsoid_invert(a, &e);
        det = (double)e.det;
        for (int k = 0; k < 6; k++) {
            s.q[k] = (double)e.q[k];
        }
        outline = whole ? ellipsoid_project(view, grid, particle).sprite : outline;
    } else if (whole) {
        outline = sprite_project(view, grid, particle);
    }
    for (int k = 0; k < 3; k++) {
        s.c[k] = (double)center[k];
    }
    s.size2 = det * (double)radius * det * (double)radius;
    if (whole) { /* one more pixel for what was rounded */
        s.x0 = most(0, (int)fminf(fmaxf(outline.x_min - 1, 0), TILE_SIZE));
        s.y0 = most(0, (int)fminf(fmaxf(outline.y_min - 1, 0), TILE_SIZE));
        s.x1 = least(s.x1, (int)fminf(fmaxf(outline.x_max + 1, -1), TILE_SIZE));
        s.y1 = least(s.y1, (int)fminf(fmaxf(outline.y_max + 1, -1), TILE_SIZE));
    }
    return s;
}

/* Depth at which the ray of a tile's pixel meets the solid first, at or behind the near plane; INFINITY: never. */
static double meet(const struct splat_view *view, const struct splat_grid *grid, const struct solid *s, int x, int y)
{
    double u = ((double)x + 0.5 - (double)grid->cx) / (double)grid->fx, w = ((double)y + 0.5 - (double)grid->cy) / (double)grid->fy;
    double ray[3] = {view->orthographic ? 0 : u, view->orthographic ? 0 : w, 1}, from[3] = {-s->c[0], -s->c[1], -s->c[2]}, along[3];
    if (view->orthographic) {
        from[0] += u;
        from[1] += w;
    }
    apply(s->q, ray, along);
    double a = dot(ray, along), b = dot(from, along);
    apply(s->q, from, along);
    double square = b * b - a * (dot(from, along) - s->size2);
    if (!(square >= 0) || !(a > 0)) {
        return (double)INFINITY;
    }
    double root = sqrt(square), first = (-b - root) / a, last = (-b + root) / a, near_plane = (double)view->near_plane;
    return first >= near_plane ? first : last >= near_plane ? near_plane : (double)INFINITY;
}

static void add_chunk(const struct tiles *tiles, const struct splat_tile *tile, const struct tile_entry *entry, struct owners *owners)
{
    const struct splat_view *view = &tiles->view;
    bool whole = !tile_chunk_is_cut(view, &entry->chunk);
    size_t first = (size_t)entry->id * CHUNK_SIZE, left = view->particles->count - first, count = left < CHUNK_SIZE ? left : CHUNK_SIZE;
    for (size_t i = first; i < first + count; i++) {
        const struct solid s = solid_of(view, &tile->pixels, i, whole);
        for (int y = s.y0; y <= s.y1; y++) {
            for (int x = s.x0; x <= s.x1; x++) {
                int at = y * TILE_SIZE + x;
                double depth = meet(view, &tile->pixels, &s, x, y);
                if (depth < owners->depth[at]) {
                    owners->depth[at] = depth;
                    owners->particle[at] = (long long)i;
                }
            }
        }
    }
}

/* ---- what shows ---- */

/* Depth of the surface at a pixel; 0: no fluid shows. */
static float surface_at(const struct backend *cpu, int x, int y)
{
    const struct plane *depth = &cpu->smoothed->plane, *scene = &cpu->scene.depth;
    float z = depth->data[y * depth->stride + x];
    bool hidden = cpu->scene.has_depth && cpu->scene.cuts_fluid && !(z < scene->data[y * scene->stride + x]);
    return z > 0 && z < DEPTH_LIMIT && !hidden ? z : 0;
}

static float farthest_in(const struct backend *cpu, const struct splat_tile *tile)
{
    const struct plane *raw = &cpu->depth_raw.plane;
    float farthest = -1;
    for (int y = tile->y; y < tile->y + tile->pixels.rows; y++) {
        for (int x = tile->x; x < tile->x + tile->pixels.columns; x++) {
            float z = raw->data[y * raw->stride + x];
            farthest = surface_at(cpu, x, y) > 0 && z < DEPTH_LIMIT ? fmaxf(farthest, z) : farthest;
        }
    }
    return farthest;
}

static void find_owners(const struct backend *cpu, struct tile_scratch *scratch, size_t index, struct owners *owners)
{
    const struct tiles *tiles = &cpu->tiles[STORE_WATER];
    size_t count = mns_tile_begin(tiles, index, scratch);
    for (int i = 0; i < TILE_PIXELS; i++) {
        owners->depth[i] = (double)INFINITY;
        owners->particle[i] = NONE;
    }
    owners->farthest = farthest_in(cpu, &scratch->tile);
    for (size_t i = 0; i < count && owners->farthest > 0; i++) {
        if (scratch->list[i].chunk.near_depth - tiles->view.slack <= owners->farthest) {
            add_chunk(tiles, &scratch->tile, &scratch->list[i], owners);
        }
    }
}

/* ---- values ---- */

/* Image space from world space, of a direction. */
static void turn(const struct view *view, const double in[3], double out[3])
{
    for (int k = 0; k < 3; k++) {
        const float *row = &view->rotation[3 * k];
        out[k] = (double)row[0] * in[0] + (double)row[1] * in[1] + (double)row[2] * in[2];
    }
}

/* The surface point of a pixel in image space. */
static void point_at(const struct view *view, int x, int y, double depth, double out[3])
{
    double per = view->orthographic ? 1 : depth;
    out[0] = ((double)x + 0.5 - (double)view->cx) / (double)view->fx * per;
    out[1] = ((double)y + 0.5 - (double)view->cy) / (double)view->fy * per;
    out[2] = depth;
}

/* How far a point moves in the picture, in pixels, right and down. What would pass the eye moves to where it is a hundredth as far away. */
static void motion_of(const struct view *view, const double point[3], const double move[3], float out[2])
{
    double before = view->orthographic ? 1 : point[2], after = view->orthographic ? 1 : fmax(point[2] + move[2], 0.01 * point[2]);
    out[0] = (float)((double)view->fx * ((point[0] + move[0]) / after - point[0] / before));
    out[1] = (float)((double)view->fy * ((point[1] + move[1]) / after - point[1] / before));
}

static void write_particle(const struct passes *passes, int x, int y, double depth, long long particle)
{
    const struct particle_store *store = &passes->cpu->stores[STORE_WATER];
    const struct view *view = &passes->frame->view;
    double velocity[3] = {0, 0, 0}, move[3], point[3];
    float motion[2] = {0, 0}, id = NONE;
    for (int k = 0; k < 3 && particle >= 0 && store->velocity[0]; k++) {
        velocity[k] = (double)store->velocity[k][particle];
    }
    if (passes->velocity) {
        float *out = (float *)mns_pixels_at(passes->velocity, x, y);
        for (int k = 0; k < 3; k++) {
            out[k] = (float)velocity[k];
        }
    }
    if (passes->motion && particle >= 0) {
        turn(view, velocity, move);
        for (int k = 0; k < 3; k++) {
            move[k] *= (double)passes->frame->params.motion_time;
        }
        point_at(view, x, y, depth, point);
        motion_of(view, point, move, motion);
    }
    if (passes->motion) {
        memcpy(mns_pixels_at(passes->motion, x, y), motion, sizeof(motion));
    }
    if (passes->id) {
        id = particle >= 0 ? store->id[particle] : NONE;
        memcpy(mns_pixels_at(passes->id, x, y), &id, sizeof(id));
    }
}

/* World space from image space: the rotation's transpose. */
static void write_position(const struct passes *passes, int x, int y, double depth)
{
    const struct view *view = &passes->frame->view;
    float out[3] = {0, 0, 0};
    double p[3];
    point_at(view, x, y, depth, p);
    for (int k = 0; k < 3 && depth > 0; k++) {
        double sum = passes->frame->facts->origin[k];
        for (int r = 0; r < 3; r++) {
            sum += (double)view->rotation[3 * r + k] * (p[r] - (double)view->translation[r]);
        }
        out[k] = (float)sum;
    }
    memcpy(mns_pixels_at(passes->position, x, y), out, sizeof(out));
}

static void write_tile(const struct passes *passes, const struct splat_tile *tile, const struct owners *owners)
{
    for (int y = 0; y < tile->pixels.rows; y++) {
        for (int x = 0; x < tile->pixels.columns; x++) {
            float depth = surface_at(passes->cpu, tile->x + x, tile->y + y);
            if (passes->position) {
                write_position(passes, tile->x + x, tile->y + y, (double)depth);
            }
            write_particle(passes, tile->x + x, tile->y + y, (double)depth, depth > 0 ? owners->particle[y * TILE_SIZE + x] : NONE);
        }
    }
}

static void passes_job(void *context, int index)
{
    struct passes *passes = context;
    struct tile_scratch *scratch = &passes->cpu->scratch->threads[index];
    const struct tiles *tiles = &passes->cpu->tiles[STORE_WATER];
    size_t count = (size_t)tiles->columns * (size_t)tiles->rows;
    bool owned = passes->velocity || passes->motion || passes->id;
    struct owners owners;
    for (size_t tile = atomic_fetch_add(&passes->next, 1); tile < count; tile = atomic_fetch_add(&passes->next, 1)) {
        if (owned) {
            find_owners(passes->cpu, scratch, tile, &owners);
        } else {
            mns_tile_begin(tiles, tile, scratch);
        }
        write_tile(passes, &scratch->tile, &owners);
    }
}

mns_result mns_cpu_passes(struct backend *cpu, const struct frame *frame)
{
    struct passes passes = {.cpu = cpu,
                            .frame = frame,
                            .velocity = mns_frame_output(frame, MNS_LAYER_VELOCITY),
                            .motion = mns_frame_output(frame, MNS_LAYER_MOTION),
                            .id = mns_frame_output(frame, MNS_LAYER_ID),
                            .position = mns_frame_output(frame, MNS_LAYER_POSITION)};
    bool owned = passes.velocity || passes.motion || passes.id;
    if (owned && !cpu->host.passes) {
        return mns_fail(
            cpu->host.message, MNS_ERR_INVALID_ARGUMENT,
            "layers velocity, motion and id need struct mns_renderer_params with passes 1, so that prepare keeps what they show");
    }
    if (owned || passes.position) {
        cpu_run(cpu, passes_job, &passes, cpu->host.threads);
    }
    return MNS_OK;
}
