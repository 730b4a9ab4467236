/* Tells whether a point is inside a closed mesh, with the box tree over its triangles. */
#ifndef PL_GEOM_INSIDE_H
#define PL_GEOM_INSIDE_H

#include <stdbool.h>
#include <stddef.h>

#include "geom/cover.h"
#include "math/vec.h"

typedef struct pl_inside {
  bool inside;
  size_t triangles; /* triangles that were looked at, which tests count */
} pl_inside;

/* Returns the same as |pl_shape_winding| >= 0.5 for a closed mesh, whose shells may overlap: along
 * a ray from the point the surface is left once more than it is entered for each time that it goes
 * around the point. Only the triangles in boxes that the ray meets are looked at. The rays follow
 * the axes of the mesh. One that passes an edge, or a triangle that is within rounding of the
 * point, is given up; if all six are, the winding number decides. point: model units. */
pl_inside pl_cover_inside(const pl_cover *cover, pl_vec3 point);

#endif
