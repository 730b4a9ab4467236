/* Lights of the night below a texel of their map: towns in clusters, and gaps. */
#ifndef PL_SHADE_TOWNS_H
#define PL_SHADE_TOWNS_H

#include "math/vec.h"

/* No place is more than so many times as bright as its map. */
#define PL_TOWNS_PEAK 60.0f

/* Factor on the light of a map at a point of a body, body axes, m: of cells of `size_m` and two
 * octaves of a third each, about as large as their towns, seen over a footprint `width_m` across.
 * The mean over places is 1 at any width; where the footprint hides the towns, so is the factor.
 * `share`: of white that the map has there, 0..1: dim country has few towns, but no dimmer ones. */
float pl_towns_factor(pl_vec3 point, double size_m, float width_m, float share);

#endif
