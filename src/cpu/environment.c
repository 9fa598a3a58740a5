/* environment.c: lookups in the frame's environment: behind everything, and in the fluid's surface. */
#include "cpu/environment.h"

#include <math.h>

static const float TAU = 6.2831853f;
/* Sine below the horizon from which on mirrors show nothing but the floor's mean. */
static const float GROUND_FROM = 0.1f;
/* Radians between neighbours' reflections beyond which they are of two surfaces. */
static const float APART = 1.0f;

static float dot(const float a[3], const float b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

void mns_surroundings_resolve(struct surroundings *out, const struct frame *frame)
{
    *out = (struct surroundings){.environment = frame->params.background == MNS_BACKGROUND_SKY ? frame->environment : NULL};
    if (!out->environment) {
        return;
    }
    const struct scene_look *look = &frame->look;
    float right[3] = {0}, away[3] = {0};
    right[look->axis_up == MNS_AXIS_X ? 1 : 0] = 1; /* as the sun's azimuth has it (core/frame.c) */
    away[look->axis_up == MNS_AXIS_Z ? 1 : 2] = look->axis_up == MNS_AXIS_Z ? 1 : -1;
    sky_rotate(out->right, frame->view.rotation, right);
    sky_rotate(out->away, frame->view.rotation, away);
    sky_rotate(out->up, frame->view.rotation, look->up);
    out->turn = frame->params.environment_rotation / 360;
    out->intensity = frame->params.environment_intensity;
    out->texel = TAU / (float)out->environment->width[0];
    out->step = frame->view.orthographic ? 0 : 1 / frame->view.fx;
    out->has_ground = look->has_floor;
}

static void add_level(const struct mns_environment *e, int level, float u, float v, float weight, float out[3])
{
    int width = e->width[level], height = e->height[level];
    float x = u * (float)width - 0.5f, y = fminf(fmaxf(v * (float)height - 0.5f, 0), (float)(height - 1)), left = floorf(x),
          top = floorf(y);
    float fx = x - left, fy = y - top;
    int column = ((int)left % width + width) % width, next = column + 1 < width ? column + 1 : 0, row = (int)top;
    const float *a = e->levels[level] + 3 * ((ptrdiff_t)row * width), *b = row + 1 < height ? a + 3 * (ptrdiff_t)width : a;
    for (int c = 0; c < 3; c++) {
        float upper = a[3 * column + c] + fx * (a[3 * next + c] - a[3 * column + c]);
        float lower = b[3 * column + c] + fx * (b[3 * next + c] - b[3 * column + c]);
        out[c] += weight * (upper + fy * (lower - upper));
    }
}

/* Radiance from a direction (unit, image space), the mean over about `spread` radians. */
static void look_up(const struct surroundings *s, const float d[3], float spread, float out[3])
{
    const struct mns_environment *e = s->environment;
    float u = 0.5f + atan2f(dot(d, s->right), dot(d, s->away)) / TAU + s->turn,
          v = acosf(fminf(fmaxf(dot(d, s->up), -1), 1)) / (0.5f * TAU);
    float level = fminf(log2f(fmaxf(spread / s->texel, 1)), (float)(e->count - 1)), between = level - floorf(level);
    out[0] = out[1] = out[2] = 0;
    u -= floorf(u);
    add_level(e, (int)level, u, v, (1 - between) * s->intensity, out);
    if (between > 0) {
        add_level(e, (int)level + 1, u, v, between * s->intensity, out);
    }
}

void mns_surroundings_behind(const struct surroundings *s, const struct backdrop *b, int x, int y, int count, float *color)
{
    for (int i = 0; i < count; i++, color += 4) {
        float d[3] = {((float)(x + i) + 0.5f - b->cx) * b->step_x, ((float)y + 0.5f - b->cy) * b->step_y, 1}, left = 1 - color[3],
              behind[3];
        if (!(left > 0)) {
            continue;
        }
        d[0] = b->orthographic ? 0 : d[0];
        d[1] = b->orthographic ? 0 : d[1];
        float height = dot(d, s->up);
        for (int c = 0; c < 3 && color[3] > 0 && height < 0; c++) { /* haze over the floor is as the horizon above it */
            d[c] -= height * s->up[c];
        }
        float scale = 1 / sqrtf(dot(d, d));
        for (int c = 0; c < 3; c++) {
            d[c] *= scale;
        }
        look_up(s, d, s->step, behind);
        for (int c = 0; c < 3; c++) {
            color[c] += left * behind[c];
        }
        color[3] = 1;
    }
}

/* The direction in which the surface at pixel i of the row reflects. */
static void reflect(const struct shade_optics *o, const struct shade_row *row, int i, float out[3])
{
    float v[3] = {0, 0, 1};
    if (!o->orthographic) {
        v[0] = ((float)(row->x + i) + 0.5f - o->cx) * o->step_x;
        v[1] = ((float)row->y + 0.5f - o->cy) * o->step_y;
    }
    float scale = 1 / sqrtf(dot(v, v));
    const float n[3] = {row->nx[i], row->ny[i], row->nz[i]};
    float cosine = fmaxf(-dot(n, v) * scale, 0);
    for (int c = 0; c < 3; c++) {
        out[c] = v[c] * scale + 2 * cosine * n[c];
    }
}

void mns_surroundings_mirror(const struct surroundings *s, const struct shade_optics *o, struct shade_row *row)
{
    float before[3] = {0}, spread = s->step;
    bool has_before = false;
    for (int i = 0; i < row->count; i++) {
        float r[3], out[3];
        if (row->nz[i] == 0) {
            has_before = false;
            continue;
        }
        reflect(o, row, i, r);
        if (has_before) {
            const float change[3] = {r[0] - before[0], r[1] - before[1], r[2] - before[2]};
            float angle = sqrtf(dot(change, change));
            spread = angle < APART ? angle : spread;
        }
        float height = dot(r, s->up), ground = s->has_ground ? fminf(fmaxf(-height / GROUND_FROM, 0), 1) : 0;
        look_up(s, r, spread, out);
        for (int c = 0; c < 3; c++) {
            row->mirrored[c][i] = out[c] + ground * (o->sky.ground[c] - out[c]);
            before[c] = r[c];
        }
        has_before = true;
    }
}
