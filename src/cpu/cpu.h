/* cpu.h: the state of the CPU backend: what the stages hand to one another. */
#ifndef MNS_CPU_CPU_H
#define MNS_CPU_CPU_H

#include "core/backend.h"
#include "core/message.h"
#include "cpu/kernels.h"
#include "cpu/particles.h"
#include "cpu/plane.h"

#include <stdatomic.h>

/* Thickness and colour sums at 1 / scale of the picture's size: texel (x, y) covers pixels [x * scale, (x + 1) * scale). */
struct thickness_image {
    struct plane thickness; /* metres along the ray */
    struct plane color[3];  /* sum of thickness * colour; empty unless the particles have colours */
    int scale;              /* 1, 2 or 4 */
    bool has_color;
};

/* What stands behind the fluid. */
struct scene_image {
    float *color;          /* [height][stride][4] linear RGB; the fourth is 1 where something opaque or sky is, 0 where transparent */
    ptrdiff_t stride;      /* pixels */
    struct plane depth;    /* metres; DEPTH_EMPTY where there is nothing opaque. border 0 */
    bool has_depth;        /* false: depth is empty everywhere and not filled */
    bool cuts_fluid;       /* whether depth may lie before some fluid: the thickness must be clipped at it */
    size_t capacity;       /* pixels of color */
    struct shadow *shadow; /* the fluid's shadow on the floor (shadow.h), kept while set, sun and floor stand still */
};

struct backend {
    struct backend_host host;
    const struct kernels *kernels;
    enum mns_isa isa;

    struct particle_store stores[STORE_KINDS]; /* prepare */
    unsigned generation;                       /* grows with each prepare: keys what is kept per particle set */
    struct tiles *tiles;                       /* bin: [STORE_KINDS] */
    struct tiles_scratch *scratch;             /* one tile of each thread, for the stages that draw tiles in turn */
    struct depth_plane depth_raw;              /* splat */
    struct depth_plane depth[2];               /* smooth: its two buffers */
    struct plane depth_normal[3]; /* smooth: plane-fit's normals, with the depth's border and stride; empty until they are needed */
    float *block_values;          /* smooth: three values for each block of a depth plane */
    size_t block_values_capacity;
    struct depth_plane depth_texels; /* smooth at part of the size: depth_raw in texels (smooth/resample.h); empty until they are needed */
    struct plane tangents[3];        /* ... the smoothed texels' flat depth and its slopes along x and y */
    struct depth_plane depth_pixels; /* ... and the result */
    float *line_scratch;             /* smooth: lines that are being solved, for each thread */
    size_t line_scratch_capacity;
    struct plane noise;                 /* noise: N of [LGS09] eq. 11; not made unless the parameter foam is noise */
    float *noise_lattice;               /* noise: gradients (noise.h), from the first such frame on */
    struct depth_plane *smoothed;       /* smooth: where the result is (depth_raw when the filter is none) */
    struct thickness_image raw;         /* splat */
    struct thickness_image blurred;     /* blur */
    struct plane blur_half, blur_decay; /* blur: between its two passes, and how fast the Gaussian of each texel falls */
    struct foam *foam;                  /* foam: NULL until there is some */
    struct spray *spray;                /* spray: likewise */
    struct scene_image scene;           /* scene */
    unsigned char *picture;             /* shade: the picture before its silhouettes are blended */
    size_t picture_capacity;
    struct backend_stats stats;
};

/* One function per stage (backend.h); each in the file of its name. */
mns_result mns_cpu_scene(struct backend *cpu, const struct frame *frame);
mns_result mns_cpu_bin(struct backend *cpu, const struct frame *frame);
mns_result mns_cpu_splat(struct backend *cpu, const struct frame *frame);
mns_result mns_cpu_smooth(struct backend *cpu, const struct frame *frame);
mns_result mns_cpu_noise(struct backend *cpu, const struct frame *frame);
mns_result mns_cpu_blur(struct backend *cpu, const struct frame *frame);
mns_result mns_cpu_foam(struct backend *cpu, const struct frame *frame);
mns_result mns_cpu_spray(struct backend *cpu, const struct frame *frame);
mns_result mns_cpu_shade(struct backend *cpu, const struct frame *frame);
mns_result mns_cpu_passes(struct backend *cpu, const struct frame *frame);

/* Chunks of a store per tile, its radii `larger` times as large, in cpu->tiles[kind]. */
mns_result mns_cpu_bin_store(struct backend *cpu, const struct frame *frame, enum store_kind kind, float larger);
mns_result mns_cpu_bin_view(struct backend *cpu, struct tiles *tiles); /* of the store and with the radii that tiles->view says */

/* Blurs another plane of the thickness's texels, with a border, as the thickness was: after stage blur. out has a border of 1, the edge repeated. */
void mns_cpu_blur_plane(struct backend *cpu, const struct frame *frame, const struct plane *in, struct plane *out);

/* What a stage holds beyond the planes above, given back when the backend goes. */
void mns_bin_destroy(struct backend *cpu);
void mns_scene_destroy(struct backend *cpu); /* the scene image and the shadow */
void mns_noise_destroy(struct backend *cpu);
void mns_blur_destroy(struct backend *cpu);
void mns_foam_destroy(struct backend *cpu);
void mns_spray_destroy(struct backend *cpu);

/* Runs job(context, i) for i in [0, jobs) with the host's threads. */
static inline void cpu_run(struct backend *cpu, void (*job)(void *context, int index), void *context, int jobs)
{
    cpu->host.parallel.run(cpu->host.parallel.user, job, context, jobs);
}

/* Out of memory, said once for all stages. */
static inline mns_result cpu_out_of_memory(struct backend *cpu)
{
    return mns_fail(cpu->host.message, MNS_ERR_OUT_OF_MEMORY, "out of memory");
}

#endif
