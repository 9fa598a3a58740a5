/* meniscus/meniscus.h: pictures of fluids from particles. Includes the whole library but the file formats (meniscus/io.h). */
#ifndef MENISCUS_H
#define MENISCUS_H

#include <meniscus/anisotropy.h>
#include <meniscus/camera.h>
#include <meniscus/classify.h>
#include <meniscus/colormap.h>
#include <meniscus/common.h>
#include <meniscus/environment.h>
#include <meniscus/params.h>
#include <meniscus/particles.h>
#include <meniscus/renderer.h>

#endif
