/* meniscus/colormap.h: numbers of particles to colours, for struct mns_particles' color. */
#ifndef MENISCUS_COLORMAP_H
#define MENISCUS_COLORMAP_H

#include <meniscus/common.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { MNS_COLORMAP_SIZE = 1024 };

/* A map as a table; plain values: copy freely. */
struct mns_colormap {
    float linear[MNS_COLORMAP_SIZE][3]; /* linear RGB at 0 to 1, evenly spaced */
};

/* Names of the maps there are: "viridis", "plasma", "turbo", "coolwarm". index out of range: NULL. */
MNS_API const char *mns_colormap_name(size_t index);

/* By name. On failure message (may be NULL) says what there is, and which name is nearest. */
MNS_API mns_result mns_colormap_find(struct mns_colormap *out, const char *name, struct mns_message *message);

/* From colours in between which it is interpolated. srgb: [count][3], 0 to 1, evenly spaced; count: at least 2. */
MNS_API mns_result mns_colormap_make(struct mns_colormap *out, const float *srgb, size_t count, struct mns_message *message);

/* Colours of values from low (or below) to high (or above); NaN is grey. low > high turns the map round; where they are equal all get the middle.
 * out: [count][3] linear RGB. */
MNS_API void mns_colormap_apply(const struct mns_colormap *map, const double *values, size_t count, double low, double high, float *out);

#ifdef __cplusplus
}
#endif

#endif
