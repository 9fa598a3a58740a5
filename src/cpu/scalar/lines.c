/* lines.c: rows become lines side by side, in plain C. */
#include "cpu/smooth/lines.h"

static void gather(const float *rows, ptrdiff_t stride, int count, float *lines)
{
    for (int l = 0; l < LINES; l++) {
        for (int i = 0; i < count; i++) {
            lines[i * LINES + l] = rows[l * stride + i];
        }
    }
}

static void scatter(const float *lines, int count, int across, float *rows, ptrdiff_t stride)
{
    for (int l = 0; l < across; l++) {
        for (int i = 0; i < count; i++) {
            rows[l * stride + i] = lines[i * LINES + l];
        }
    }
}

const struct line_kernels mns_line_kernels_scalar = {.gather = gather, .scatter = scatter};
