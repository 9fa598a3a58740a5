/* meshes.h: the meshes of a scene, and the picture of them that is kept. */
#ifndef MNS_SCENE_MESHES_H
#define MNS_SCENE_MESHES_H

#include "scene/mesh.h"

#include "core/view.h"

#include <embree3/rtcore.h>

#include <stdbool.h>

enum { MESHES_MAX = 256 };

struct pool;

struct slot {
    struct mesh mesh;
    RTCGeometry geometry;
    float offset[3]; /* of the mesh's origin from the scene's */
    float middle[3]; /* of its box, in Embree's coordinates */
    bool container, used;
};

/* What a pixel shows, for the smoothing of the sky's light: how much of the sky it sees is known from few rays. */
struct guide {
    int kind; /* of all its samples; enum kind of cast.c */
    float t, normal[3];
    float sky; /* part of the sky that is seen */
};

/* What a picture depends on. */
struct picture_key {
    struct mns_camera camera;
    struct mns_light light;
    unsigned generation;
};

struct mns_meshes {
    struct mns_meshes_params params;
    struct pool *pool; /* NULL: the caller's threads */
    RTCDevice device;
    RTCScene all, casters; /* every mesh; those that throw shadows */
    struct slot slots[MESHES_MAX];
    int slot_count;
    double origin[3]; /* of Embree's coordinates, world space */
    double bounds_min[3], bounds_max[3];
    unsigned generation; /* grows with each mesh that is read */
    bool committed;

    struct picture_key key;
    bool has_picture;
    struct mns_object_pixel *pixels; /* [pixel_capacity] */
    struct guide *guides;            /* the same; while a picture is drawn */
    size_t pixel_capacity;
    int *spans; /* [span_capacity] */
    size_t span_capacity;
    struct mns_objects objects;
    size_t draws;
    double draw_ms;
};

/* Draws into meshes->pixels and spans, which are large enough. view: of the camera, about meshes->origin. */
void mns_meshes_cast(struct mns_meshes *meshes, const struct view *view, const struct mns_light *light);

#endif
