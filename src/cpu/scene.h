/* scene.h: the kernels of stage scene. */
#ifndef MNS_CPU_SCENE_H
#define MNS_CPU_SCENE_H

struct scene_kernels {
    int none;
};

extern const struct scene_kernels mns_scene_kernels_scalar, mns_scene_kernels_sse2, mns_scene_kernels_avx2, mns_scene_kernels_avx512,
    mns_scene_kernels_neon;

#endif
