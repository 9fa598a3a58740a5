/* shade.h: the kernels of stage shade. A span of a row goes through them in turn; each leaves its results in a struct shade_row, so that the
 * lookups in the scene, which no vector unit does well, stand in a loop of their own. */
#ifndef MNS_CPU_SHADE_H
#define MNS_CPU_SHADE_H

#include "cpu/pixels.h"
#include "cpu/sky.h"

#include <stdbool.h>
#include <stddef.h>

enum {
    SHADE_SPAN = 256, /* pixels of a row at a time, at most: what the kernels hand on stays in the first cache */
    SHADE_MARGIN = 16 /* pixels on each side of a row of normals, for the curvature */
};

/* What the optics of one picture depend on. Lengths in metres, directions and positions in image space (core/frame.h: struct view). */
struct shade_optics {
    struct sky sky;
    bool orthographic;
    float fx, fy, cx, cy, step_x, step_y; /* step_x = 1 / fx */
    float edge;                           /* neighbours whose depths differ by more are apart */
    bool one_sided;                       /* always take the smaller difference: creases stay sharp */

    bool schlick;
    float index;                           /* of refraction */
    float refraction;                      /* thicknesses that the refracted ray travels */
    float absorption[3];                   /* 1/metre */
    float absorption_mean;                 /* of the three: what a particle's colour takes the hue of */
    float scatter[3];                      /* radiance of deep fluid */
    float scatter_light[3];                /* radiance of deep fluid over the particles' colour */
    bool has_mirrored;                     /* what the surface reflects is in row->mirrored: not the sky of sky.h */
    float reflection, specular, shininess; /* specular: over the sun's light on a white surface */
    float opaque[3];                       /* colour of the surface where the fluid is opaque */
    float grey[3];                         /* radiance of grey foam */
    float spray[3];                        /* radiance of spray */

    float foam_front[3], foam_back[3];            /* radiance of thick and of thin front foam ([BSW10]: c_ff, c_fb) */
    float foam_extinction, foam_range_extinction; /* 1/metre, of T_f and of T_ff */
    float foam_blend;                             /* metres about the water's surface in which the one that is in front changes */

    const float *scene;       /* [height + 1][scene_stride][4] linear */
    ptrdiff_t scene_stride;   /* pixels, at least 2; what is beyond width and height is finite */
    const float *scene_depth; /* NULL: nothing stands before any fluid */
    ptrdiff_t scene_depth_stride;
    int width, height;
    bool transparent; /* nothing stands behind the fluid */
};

/* Pixels x to x + count - 1 of row y. Normals and positions in image space; kernels leave alone what stands where nz is 0. */
struct shade_row {
    int x, y, count;
    float nx[SHADE_SPAN], ny[SHADE_SPAN], nz[SHADE_SPAN]; /* unit, towards the eye; 0 where no fluid shows */
    float depth[SHADE_SPAN], thickness[SHADE_SPAN];
    float color[3][SHADE_SPAN];         /* of the particles, where they have one */
    float transmittance[3][SHADE_SPAN]; /* of the fluid's body, without its surface */
    float fresnel[SHADE_SPAN];
    float foam_depth[SHADE_SPAN], foam[SHADE_SPAN], foam_range[SHADE_SPAN],
        before[SHADE_SPAN];                       /* its depth, T_f, T_ff; T_wf of the water */
    float veil[SHADE_SPAN], thin[SHADE_SPAN];     /* parts that come through the foam, and that have its back colour */
    float grey[SHADE_SPAN];                       /* part that grey foam covers */
    float mirrored[3][SHADE_SPAN];                /* radiance that the surface reflects, where has_mirrored */
    float look_x[SHADE_SPAN], look_y[SHADE_SPAN]; /* where the scene is looked up: pixel centres at whole numbers, inside the picture */
    float behind[4 * SHADE_SPAN];                 /* what was found there: [count][4] */
    float out[4][SHADE_SPAN];                     /* linear, straight alpha; a plane per channel */
};

/* Rows of normals above, at and below a row of pixels: n[row][component], pixel 0 at index 0, one more pixel on each side. */
struct shade_normals {
    const float *n[3][3];
};

/* Neighbours are always held together where their depths differ by less than this many pixels' footprints: a plane seen at 3 degrees. */
#define SHADE_SLOPE_MAX 20.0f

/* A particle of colour c absorbs SHADE_TINT * (SHADE_TINT_LEAST + 1 - c) of the mean absorption in each channel: a white one nearly nothing, a
 * pure red one green and blue as strongly as water does red. */
#define SHADE_TINT       2.0f
#define SHADE_TINT_LEAST 0.1f

/* The highlight: full from a tenth of a right angle between surface and sun; and the eye's cosine from which on it grows no more. */
#define SHADE_SUNSET  6.0f
#define SHADE_GRAZING 0.15f

/* What the water mirrors from below the horizon is open ground, or the floor close by in the fluid's own shadow: half way from the ground's
 * radiance to what is seen through the water, where that is darker, from an eighth below the horizon on (a sine; its inverse, times the half).
 * With the ground alone every edge that turns to the floor shines, without it overhangs lose their form. */
#define SHADE_BELOW      4.0f
#define SHADE_BELOW_MOST 0.5f

/* Arrays may be read and written up to count rounded up to 16. Tolerances against plain C, relative to the largest value, come from fused
 * products and from reciprocals and roots of 3e-7. */
struct shade_kernels {
    /* Normals from depth (at pixel x of row y, rows `stride` apart, a border beyond the picture): the full derivative of the back-projected
     * position. Central differences; the smaller one-sided one where a neighbour is apart. No fluid (0 normals) where depth is not in
     * (0, DEPTH_LIMIT) or not before scene_depth (NULL: nothing there). Returns how many pixels have fluid. 2e-6 where no difference is within
     * rounding of the edge. */
    int (*normals)(const struct shade_optics *optics, const float *depth, ptrdiff_t stride, const float *scene_depth, int x, int y,
                   int count, float *nx, float *ny, float *nz);

    /* Mean curvature, 1/metre, from normals and depth: half the divergence of the unit normal. 0 where no fluid is. 1e-4 of 1 / footprint: differences of nearly equal normals. */
    void (*curvature)(const struct shade_optics *optics, const struct shade_normals *normals, const float *depth, ptrdiff_t stride, int x,
                      int y, int count, float *curvature);

    /* Fresnel reflectance, transmittance, lookup. has_color: the particles' colours tint. 4e-6; lookups 2e-4 pixels in 2000. */
    void (*optics)(const struct shade_optics *optics, bool has_color, struct shade_row *row);

    /* behind, where fluid is: the scene at the lookups, bilinear; towards the pixel itself where something that stands before the fluid would be
     * seen, for which the lookups may be moved. 2e-6 for equal lookups. */
    void (*fetch)(const struct shade_optics *optics, struct shade_row *row);

    /* out: the fluid over what is behind ([LGS09] eq. 13 and 14). 1e-4 of the largest value: the highlight is a high power. */
    void (*water)(const struct shade_optics *optics, bool has_color, struct shade_row *row);

    /* Of a row with foam: veil and thin, from foam and foam_range; before held to the thickness. thin is how much of the foam that is seen has the back
     * colour: [BSW10]'s exp(-T_ff) where there is no more than that, else of the front foam and of the rest by what each hides, or a lone sphere before a
     * cloud would be a grey disc. 4e-6 over what foam hides. */
    void (*veil)(const struct shade_optics *optics, struct shade_row *row);

    /* water, of a row with foam ([BSW10] eq. 7 to 10), which shows before and behind the water and without any: light is reflected by whichever is in
     * front. As water. */
    void (*layered)(const struct shade_optics *optics, bool has_color, struct shade_row *row);

    /* out: an opaque surface in the same light, the pixel's own scene where no fluid is. As water. */
    void (*opaque)(const struct shade_optics *optics, bool has_color, struct shade_row *row);

    /* out: grey foam over the fluid that is there ([LGS09] 3.5). As water. */
    void (*grey)(const struct shade_optics *optics, struct shade_row *row);

    /* planes: the channels of count pixels, at most SHADE_SPAN, of a picture [count][4]. */
    void (*split)(const float *rgba, int count, float planes[4][SHADE_SPAN]);

    /* count pixels of linear colour (times gain) and straight alpha as the caller wants them: sRGB and rounded to nearest in integers, NaN as 0;
     * channels 3 or 4. Integers differ by 1 at most, where the exact value is within 0.01 (8 bits) or 0.4 (16 bits) of halfway. */
    void (*encode)(float planes[4][SHADE_SPAN], int count, float gain, enum pixel_meaning meaning, enum mns_pixel pixel, int channels,
                   void *out);
};

extern const struct shade_kernels mns_shade_kernels_scalar, mns_shade_kernels_sse2, mns_shade_kernels_avx2, mns_shade_kernels_avx512,
    mns_shade_kernels_neon;

#endif
