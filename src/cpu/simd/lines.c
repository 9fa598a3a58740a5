/* lines.c: rows become lines side by side over simd.h, tile by tile. */
#include "cpu/smooth/lines.h"

#include "cpu/simd.h"

/* A tile of VLEN x VLEN pixels, of which the first rows are written. */
SIMD void transpose_tile(const float *in, ptrdiff_t in_stride, float *out, ptrdiff_t out_stride, int rows)
{
    vf tile[VLEN];
    for (int i = 0; i < VLEN; i++) {
        tile[i] = vf_load(in + i * in_stride);
    }
    vf_transpose(tile);
    for (int i = 0; i < rows; i++) {
        vf_store(out + i * out_stride, tile[i]);
    }
}

static void gather(const float *rows, ptrdiff_t stride, int count, float *lines)
{
    for (int line = 0; line < LINES; line += VLEN) {
        for (int i = 0; i < count; i += VLEN) {
            transpose_tile(rows + line * stride + i, stride, lines + (ptrdiff_t)i * LINES + line, LINES, VLEN);
        }
    }
}

static void scatter(const float *lines, int count, int across, float *rows, ptrdiff_t stride)
{
    for (int line = 0; line < across; line += VLEN) {
        const float *in = lines + line;
        float *out = rows + line * stride;
        for (int i = 0; i < count; i += VLEN, in += (ptrdiff_t)VLEN * LINES, out += VLEN) {
            if (across - line >= VLEN) {
                transpose_tile(in, LINES, out, stride, VLEN);
            } else {
                transpose_tile(in, LINES, out, stride, across - line);
            }
        }
    }
}

const struct line_kernels SIMD_NAME(mns_line_kernels) = {.gather = gather, .scatter = scatter};
