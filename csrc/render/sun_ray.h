/* Shadow rays to the sun: those of paths, and those of the mask of shadows. */
#ifndef PL_RENDER_SUN_RAY_H
#define PL_RENDER_SUN_RAY_H

#include "light/sun.h"
#include "render/vertex.h"

/* The sun as seen from a vertex. `suns`: the sun as seen from the centre of each object. */
pl_sun_view pl_sun_view_of(const pl_snapshot *shot, const pl_sun_view *suns,
                           const pl_vertex *vertex);

/* The shadow ray from a vertex `toward` a point of the sun's disc. */
pl_ray pl_sun_ray(const pl_vertex *vertex, const pl_snapshot *shot, const pl_sun_view *sun,
                  pl_vec3f toward);

#endif
