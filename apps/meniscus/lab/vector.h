/* vector.h: three doubles. */
#ifndef MENISCUS_LAB_VECTOR_H
#define MENISCUS_LAB_VECTOR_H

#include <math.h>

#define LAB_PI 3.14159265358979323846

static inline double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static inline double length(const double a[3]) { return sqrt(dot(a, a)); }

/* out = a + s b; out may be a. */
static inline void add_scaled(double out[3], const double a[3], double s, const double b[3])
{
    for (int k = 0; k < 3; k++) {
        out[k] = a[k] + s * b[k];
    }
}

static inline void normalise(double a[3])
{
    double scale = 1 / length(a);
    for (int k = 0; k < 3; k++) {
        a[k] *= scale;
    }
}

static inline double degrees(double radians) { return radians * (180 / LAB_PI); }

static inline double radians(double degrees_) { return degrees_ * (LAB_PI / 180); }

#endif
