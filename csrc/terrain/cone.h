/* Cones about directions. */
#ifndef PL_TERRAIN_CONE_H
#define PL_TERRAIN_CONE_H

#include <stddef.h>

#include "math/vec.h"

typedef struct pl_cone {
  pl_vec3 axis; /* unit */
  double angle_rad;
} pl_cone;

/* Returns a cone that contains at least one unit direction. */
static inline pl_cone pl_cone_of(const pl_vec3 *directions, size_t count) {
  pl_vec3 sum = {0.0, 0.0, 0.0};
  for (size_t k = 0; k < count; k++)
    sum = pl_vec3_add(sum, directions[k]);
  pl_cone out = {.axis = pl_vec3_norm(sum) > 0.0 ? pl_vec3_unit(sum) : directions[0]};
  double chord2 = 0.0;
  for (size_t k = 0; k < count; k++) {
    const pl_vec3 to = pl_vec3_sub(directions[k], out.axis);
    chord2 = fmax(chord2, pl_vec3_dot(to, to));
  }
  out.angle_rad = 2.0 * asin(fmin(0.5 * sqrt(chord2), 1.0));
  return out;
}

#endif
