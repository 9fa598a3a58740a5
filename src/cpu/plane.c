/* plane.c: float images with a border. */
#include "cpu/plane.h"

#include <string.h>

enum { LINE = 16 }; /* floats in a cache line */

static int round_up(int value, int step) { return (value + step - 1) / step * step; }

bool mns_plane_resize(struct plane *plane, struct memory *memory, int width, int height, int border)
{
    if (plane->block && plane->width == width && plane->height == height && plane->border == border) {
        return true;
    }
    mns_plane_free(plane, memory);
    int left = round_up(border, LINE);
    int columns = left + round_up(width, BLOCK_WIDTH) + left;
    if (columns / LINE % 2 == 0) {
        columns += LINE;
    }
    int rows = border + round_up(height, BLOCK_HEIGHT) + border;
    size_t floats = (size_t)columns * (size_t)rows;
    float *block = mns_memory_get(memory, floats, sizeof(float));
    if (!block) {
        return false;
    }
    memset(block, 0, floats * sizeof(float));
    *plane = (struct plane){.data = block + (ptrdiff_t)border * columns + left,
                            .stride = columns,
                            .width = width,
                            .height = height,
                            .border = border,
                            .block = block,
                            .floats = floats};
    return true;
}

void mns_plane_free(struct plane *plane, struct memory *memory)
{
    mns_memory_put(memory, plane->block, plane->floats, sizeof(float));
    *plane = (struct plane){0};
}

bool mns_depth_plane_resize(struct depth_plane *plane, struct memory *memory, int width, int height)
{
    plane->blocks_x = round_up(width, BLOCK_WIDTH) / BLOCK_WIDTH;
    plane->blocks_y = round_up(height, BLOCK_HEIGHT) / BLOCK_HEIGHT;
    plane->ranges = mns_memory_reserve(memory, plane->ranges, &plane->capacity, (size_t)plane->blocks_x * (size_t)plane->blocks_y,
                                       sizeof(*plane->ranges));
    return plane->ranges && mns_plane_resize(&plane->plane, memory, width, height, PLANE_BORDER);
}

void mns_depth_plane_free(struct depth_plane *plane, struct memory *memory)
{
    mns_plane_free(&plane->plane, memory);
    mns_memory_put(memory, plane->ranges, plane->capacity, sizeof(*plane->ranges));
    *plane = (struct depth_plane){0};
}
