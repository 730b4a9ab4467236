/* Night lights at scales below a texel of their map: clustered towns, and gaps between them. */
#ifndef PL_SHADE_TOWNS_H
#define PL_SHADE_TOWNS_H

#include "math/vec.h"

/* Upper limit of the factor on the map. */
#define PL_TOWNS_PEAK 60.0f

/* Factor on the light of a map at a point of a body, body axes, m. The pattern has cells of
 * `size_m` and two more octaves, each with a third of the cell size of the one before; `width_m`:
 * diameter of the footprint. The spatial mean is 1 at any width; the factor fades to 1 where the
 * footprint hides the towns. `brightness`: value of the map relative to white, 0..1: dark regions
 * have fewer towns rather than dimmer ones. */
float pl_towns_factor(pl_vec3 point, double size_m, float width_m, float brightness);

#endif
