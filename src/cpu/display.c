/* display.c: the display modes that show a quantity. */
#include "cpu/display.h"

#include <math.h>

/* A splat's own curvature, 1 / R, is drawn as this many times the full colour. */
static const float CURVATURE_GAIN = 3;

/* Grey of the farthest depth: still apart from the empty black. */
static const float FAR_GREY = 0.12f;

bool mns_display_is_diagram(int display)
{
    return display == MNS_DISPLAY_NORMAL || display == MNS_DISPLAY_DEPTH || display == MNS_DISPLAY_THICKNESS ||
           display == MNS_DISPLAY_CURVATURE;
}

struct display_range mns_display_measure(const struct backend *cpu, const struct frame *frame)
{
    struct display_range range = {INFINITY, -INFINITY};
    int scale = cpu->blurred.scale;
    bool depths = frame->params.display == MNS_DISPLAY_DEPTH;
    if (!depths && frame->params.display != MNS_DISPLAY_THICKNESS) {
        return range;
    }
    const struct plane *depth = &cpu->smoothed->plane, *thickness = &cpu->blurred.thickness;
    for (int y = 0; y < depth->height; y++) {
        for (int x = 0; x < depth->width; x++) {
            float z = depth->data[y * depth->stride + x];
            bool shows = z > 0 && z < DEPTH_LIMIT && (!cpu->scene.cuts_fluid || z < cpu->scene.depth.data[y * cpu->scene.depth.stride + x]);
            if (shows) {
                float value = depths ? z : thickness->data[y / scale * thickness->stride + x / scale];
                range.low = fminf(range.low, value);
                range.high = fmaxf(range.high, value);
            }
        }
    }
    return range;
}

/* A lamp beside the eye, in image space, unit; and the light that a surface gets which it does not reach: enough to tell the colour. */
static const float LAMP[3] = {-0.30f, -0.43f, -0.8515f};
static const float LIGHT_LEAST = 0.5f;

void mns_display_color(const struct shade_optics *optics, bool has_color, struct shade_row *row)
{
    const float *scene = optics->scene + 4 * (row->y * optics->scene_stride + row->x);
    for (int i = 0; i < row->count; i++) {
        bool fluid = row->nz[i] != 0;
        float towards = row->nx[i] * LAMP[0] + row->ny[i] * LAMP[1] + row->nz[i] * LAMP[2];
        float light = LIGHT_LEAST + (1 - LIGHT_LEAST) * fminf(fmaxf(towards, 0), 1);
        for (int c = 0; c < 3; c++) {
            float own = has_color ? fminf(fmaxf(row->color[c][i], 0), 1) : optics->opaque[c];
            row->out[c][i] = fluid ? own * light : scene[4 * i + c];
        }
        row->out[3][i] = fluid ? 1 : scene[4 * i + 3];
    }
}

static void show_curvature(float per_radius, float out[3])
{
    float shown = CURVATURE_GAIN * per_radius;
    out[0] = shown < 0 ? fminf(-shown, 1) : 0;
    out[1] = shown > 0 ? fminf(shown, 1) : 0;
    out[2] = 0;
}

void mns_display_row(const struct frame *frame, const struct display_range *range, struct shade_row *row, const float *curvature)
{
    float extent = range->high - range->low;
    for (int i = 0; i < row->count; i++) {
        float out[3] = {0, 0, 0};
        bool fluid = row->nz[i] != 0;
        switch (fluid ? frame->params.display : -1) {
        case -1: break;
        case MNS_DISPLAY_NORMAL: /* view space is (x, -y, -z) of image space */
            out[0] = 0.5f + 0.5f * row->nx[i];
            out[1] = 0.5f - 0.5f * row->ny[i];
            out[2] = 0.5f - 0.5f * row->nz[i];
            break;
        case MNS_DISPLAY_DEPTH:
            out[0] = extent > 0 ? 1 - (1 - FAR_GREY) * (row->depth[i] - range->low) / extent : 1;
            out[1] = out[2] = out[0];
            break;
        case MNS_DISPLAY_THICKNESS:
            out[0] = range->high > 0 ? row->thickness[i] / range->high : 0;
            out[1] = out[2] = out[0];
            break;
        default: show_curvature(curvature[i] * frame->splat_radius, out); break;
        }
        for (int c = 0; c < 3; c++) {
            row->out[c][i] = out[c];
        }
        row->out[3][i] = fluid || frame->params.background != MNS_BACKGROUND_TRANSPARENT;
    }
}
