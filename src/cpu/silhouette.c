/* silhouette.c: antialiased silhouettes. */
#include "cpu/silhouette.h"

#include "cpu/cpu.h"
#include "cpu/pixels.h"

#include <math.h>
#include <string.h>

/* A job: this many rows. */
enum { JOB_ROWS = BLOCK_HEIGHT };

struct blend_run {
    struct backend *cpu;
    const struct silhouette *s;
    struct srgb_decoder decoder;
    const unsigned char *before; /* the picture as it was, packed */
    size_t row_bytes, pixel_bytes;
};

/* DEPTH_EMPTY where no fluid shows, 0 outside the picture. */
static float depth_at(const struct silhouette *s, int x, int y)
{
    const struct plane *depth = &s->depth->plane;
    if (x < 0 || y < 0 || x >= depth->width || y >= depth->height) {
        return 0;
    }
    float z = depth->data[y * depth->stride + x];
    if (!(z > 0 && z < DEPTH_LIMIT)) {
        return DEPTH_EMPTY;
    }
    return s->scene_depth && !(z < s->scene_depth->data[y * s->scene_depth->stride + x]) ? DEPTH_EMPTY : z;
}

static bool are_apart(const struct silhouette *s, float a, float b)
{
    float nearer = fminf(a, b), farther = fmaxf(a, b);
    return nearer > 0 && nearer < DEPTH_LIMIT && farther - nearer > fmaxf(s->edge, s->slope * (s->orthographic ? 1 : nearer));
}

/* A pixel and the edge beside it. Along the axis that crosses the edge, `side` is +1 or -1 towards the neighbour. */
struct crossing {
    const struct silhouette *s;
    int x, y, axis, side;
    float between; /* a depth between the two surfaces */
    bool is_near;  /* whether the pixel is on the nearer one */
};

/* Whether the pixel `across` towards the neighbour, in the row or column `along` away, is on the pixel's own surface. -1: outside the picture. */
static int is_own(const struct crossing *c, int across, int along)
{
    int dx = c->axis == 0 ? across * c->side : along, dy = c->axis == 0 ? along : across * c->side;
    float z = depth_at(c->s, c->x + dx, c->y + dy);
    return z <= 0 ? -1 : (z < c->between) == c->is_near;
}

/* From where the edge passed the row before, where it passes this one: the last pixel of the own surface, at most two away. */
static bool follow(const struct crossing *c, int along, int *at)
{
    for (int step = 0; step <= 2; step++) {
        for (int sign = -1; sign <= 1; sign += 2) {
            int across = *at + sign * step;
            if (is_own(c, across, along) == 1 && is_own(c, across + 1, along) == 0) {
                *at = across;
                return true;
            }
        }
    }
    return false;
}

/* Where the edge is: own surface as far as offset + slope * t from the pixel's centre, t along the edge, in pixels. */
struct course {
    float offset, slope;
};

/* Least squares: a parabola where there are crossings enough on both sides, else a line. sums[k]: of t^k; moments[k]: of t^k times the crossing. */
static struct course fit(const double sums[5], const double moments[3], bool curved)
{
    double n = sums[0], a = sums[1], b = sums[2], d = sums[3], e = sums[4];
    if (!curved) {
        double determinant = n * b - a * a, slope = determinant > 0 ? (n * moments[1] - a * moments[0]) / determinant : 0;
        return (struct course){(float)((moments[0] - slope * a) / n), (float)slope};
    }
    double m00 = b * e - d * d, m01 = b * d - a * e, m02 = a * d - b * b, determinant = n * m00 + a * m01 + b * m02;
    double m11 = n * e - b * b, m12 = a * b - n * d;
    return (struct course){(float)((m00 * moments[0] + m01 * moments[1] + m02 * moments[2]) / determinant),
                           (float)((m01 * moments[0] + m11 * moments[1] + m12 * moments[2]) / determinant)};
}

/* false: the edge could not be followed to both sides. */
static bool find_course(const struct crossing *c, struct course *out)
{
    double sums[5] = {1}, moments[3] = {0.5};
    int found[2] = {0, 0};
    for (int end = 0; end < 2; end++) {
        int at = 0, direction = 0;
        for (int k = 1; k <= SILHOUETTE_REACH; k++, found[end]++) {
            int t = end ? k : -k, before = at;
            if (!follow(c, t, &at) || (at - before) * direction < 0) { /* the end of the edge, or a corner */
                break;
            }
            direction = at != before ? at - before : direction;
            double power = 1;
            for (int i = 0; i < 5; i++, power *= t) {
                sums[i] += power;
                moments[i < 3 ? i : 0] += i < 3 ? power * (at + 0.5) : 0;
            }
        }
    }
    if (found[0] == 0 || found[1] == 0) {
        return false;
    }
    *out = fit(sums, moments, found[0] > 1 && found[1] > 1);
    return true;
}

/* Part of the pixel on its own surface: the mean over lines across the edge. */
static float cover(struct course course)
{
    enum { CUTS = 4 };
    float sum = 0;
    for (int i = 0; i < CUTS; i++) {
        float t = ((float)i + 0.5f) / CUTS - 0.5f;
        sum += fminf(fmaxf(course.offset + course.slope * t + 0.5f, 0), 1);
    }
    return sum / CUTS;
}

/* The pixel's linear colour as it was, premultiplied. */
static void read_pixel(const struct blend_run *run, int x, int y, float out[4])
{
    const unsigned char *at = run->before + (size_t)y * run->row_bytes + (size_t)x * run->pixel_bytes;
    int channels = run->s->image->channels;
    out[3] = 1;
    for (int c = 0; c < channels; c++) {
        if (run->s->image->pixel == MNS_PIXEL_F32) {
            memcpy(&out[c], at + 4 * c, 4);
        } else if (run->s->image->pixel == MNS_PIXEL_U8) {
            out[c] = c < 3 ? run->decoder.linear[at[c]] : (float)at[c] / 255;
        } else {
            uint16_t code;
            memcpy(&code, at + 2 * c, 2);
            float place = (float)code * ((float)SRGB_STEPS / 65535);
            int low = (int)fminf(place, SRGB_STEPS - 1);
            float left = run->decoder.linear[low];
            out[c] = c < 3 ? left + (place - (float)low) * (run->decoder.linear[low + 1] - left) : (float)code / 65535;
        }
    }
    for (int c = 0; c < 3; c++) {
        out[c] *= out[3];
    }
}

/* Blends what pixel (x, y) was with its neighbour into planes[.][i]; false: no edge, nothing changes. */
static bool blend_pixel(const struct blend_run *run, int x, int y, int i, float planes[4][SHADE_SPAN])
{
    const struct silhouette *s = run->s;
    float z = depth_at(s, x, y), least = 1, best = INFINITY;
    int neighbour[2] = {0, 0};
    for (int axis = 0; axis < 2; axis++) {
        int dx = axis == 0, dy = axis == 1;
        float ahead = depth_at(s, x + dx, y + dy), back = depth_at(s, x - dx, y - dy);
        bool apart = are_apart(s, z, ahead);
        if (apart == are_apart(s, z, back)) {
            continue;
        }
        float other = apart ? ahead : back, farther = fmaxf(z, other);
        struct crossing crossing = {.s = s, .x = x, .y = y, .axis = axis, .side = apart ? 1 : -1, .is_near = z < other};
        crossing.between = farther < DEPTH_LIMIT ? 0.5f * (z + other) : DEPTH_LIMIT;
        struct course course;
        if (find_course(&crossing, &course) && fabsf(course.slope) < best) { /* the axis that crosses the edge more squarely */
            best = fabsf(course.slope);
            least = cover(course);
            neighbour[0] = dx * crossing.side;
            neighbour[1] = dy * crossing.side;
        }
    }
    if (!(least < 1)) {
        return false;
    }
    float own[4], other[4];
    read_pixel(run, x, y, own);
    read_pixel(run, x + neighbour[0], y + neighbour[1], other);
    float alpha = other[3] + least * (own[3] - other[3]);
    for (int c = 0; c < 3; c++) {
        float mixed = other[c] + least * (own[c] - other[c]);
        planes[c][i] = alpha > 0 ? mixed / alpha : 0;
    }
    planes[3][i] = alpha;
    return true;
}

/* Whether some pixel of a block may be apart from a neighbour. */
static bool has_edge(const struct silhouette *s, int bx, int by)
{
    const struct depth_plane *depth = s->depth;
    float nearest = DEPTH_EMPTY, farthest = 0;
    for (int i = -2; i <= 2; i++) {
        int x = bx + i % 2, y = by + i / 2; /* itself and the four beside it */
        if (x >= 0 && y >= 0 && x < depth->blocks_x && y < depth->blocks_y) {
            nearest = fminf(nearest, depth->ranges[y * depth->blocks_x + x].min);
            farthest = fmaxf(farthest, depth->ranges[y * depth->blocks_x + x].max);
        }
    }
    return nearest < DEPTH_LIMIT && (s->scene_depth || are_apart(s, nearest, farthest));
}

/* are_apart without a branch. */
static int apart_at(float a, float b, float edge, float slope)
{
    float nearer = a < b ? a : b, farther = a < b ? b : a, steep = slope * nearer;
    return (nearer > 0) & (nearer < DEPTH_LIMIT) & (farther - nearer > (steep > edge ? steep : edge));
}

/* Which of BLOCK_WIDTH pixels from (x, y) on are apart from some neighbour. Returns whether any is. */
static int find_edges(const struct silhouette *s, int x, int y, int out[BLOCK_WIDTH])
{
    float rows[3][BLOCK_WIDTH + 2], slope = s->orthographic ? 0 : s->slope, edge = s->orthographic ? fmaxf(s->edge, s->slope) : s->edge;
    for (int r = 0; r < 3; r++) {
        const float *depth = s->depth->plane.data + (y + r - 1) * s->depth->plane.stride + x - 1;
        for (int i = 0; i < BLOCK_WIDTH + 2; i++) {
            rows[r][i] = depth[i];
        }
        for (int i = 0; s->scene_depth && i < BLOCK_WIDTH + 2; i++) {
            rows[r][i] = depth_at(s, x - 1 + i, y + r - 1);
        }
    }
    int any = 0;
    for (int i = 0; i < BLOCK_WIDTH; i++) {
        float z = rows[1][i + 1];
        out[i] = apart_at(z, rows[1][i], edge, slope) | apart_at(z, rows[1][i + 2], edge, slope) |
                 apart_at(z, rows[0][i + 1], edge, slope) | apart_at(z, rows[2][i + 1], edge, slope);
        any |= out[i];
    }
    return any;
}

/* Up to BLOCK_WIDTH pixels of row y from x on. */
static void blend_span(const struct blend_run *run, int x, int y, int count)
{
    const struct mns_image *image = run->s->image;
    float planes[4][SHADE_SPAN];
    int where[BLOCK_WIDTH], is_edge[BLOCK_WIDTH], found = 0;
    unsigned char codes[BLOCK_WIDTH * 4 * sizeof(float)];
    if (!find_edges(run->s, x, y, is_edge)) {
        return;
    }
    for (int i = 0; i < count; i++) {
        where[found] = x + i;
        found += is_edge[i] && blend_pixel(run, x + i, y, found, planes);
    }
    if (found == 0) {
        return;
    }
    run->cpu->kernels->shade->encode(planes, found, 1, PIXEL_COLOR, image->pixel, image->channels, codes);
    for (int i = 0; i < found; i++) {
        memcpy(mns_pixels_at(image, where[i], y), codes + (size_t)i * run->pixel_bytes, run->pixel_bytes);
    }
}

static void blend_rows(void *context, int by)
{
    const struct blend_run *run = context;
    const struct depth_plane *depth = run->s->depth;
    for (int bx = 0; bx < depth->blocks_x; bx++) {
        if (!has_edge(run->s, bx, by)) {
            continue;
        }
        int x = bx * BLOCK_WIDTH, columns = depth->plane.width - x < BLOCK_WIDTH ? depth->plane.width - x : BLOCK_WIDTH;
        for (int y = by * BLOCK_HEIGHT; y < (by + 1) * BLOCK_HEIGHT && y < depth->plane.height; y++) {
            blend_span(run, x, y, columns);
        }
    }
}

static void copy_rows(void *context, int job)
{
    struct blend_run *run = context;
    for (int y = job * JOB_ROWS; y < (job + 1) * JOB_ROWS && y < run->s->image->height; y++) {
        memcpy(run->cpu->picture + (size_t)y * run->row_bytes, mns_pixels_row(run->s->image, y), run->row_bytes);
    }
}

bool mns_silhouette_blend(struct backend *cpu, const struct silhouette *silhouette)
{
    static const size_t sizes[] = {[MNS_PIXEL_F32] = 4, [MNS_PIXEL_U8] = 1, [MNS_PIXEL_U16] = 2};
    const struct mns_image *image = silhouette->image;
    struct blend_run run = {.cpu = cpu, .s = silhouette, .pixel_bytes = sizes[image->pixel] * (size_t)image->channels};
    run.row_bytes = run.pixel_bytes * (size_t)image->width;
    cpu->picture = mns_memory_reserve(cpu->host.memory, cpu->picture, &cpu->picture_capacity, run.row_bytes * (size_t)image->height, 1);
    if (!cpu->picture) {
        return false;
    }
    run.before = cpu->picture;
    mns_srgb_decoder_init(&run.decoder, image->pixel);
    cpu_run(cpu, copy_rows, &run, silhouette->depth->blocks_y);
    cpu_run(cpu, blend_rows, &run, silhouette->depth->blocks_y);
    return true;
}
