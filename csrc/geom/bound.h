/* Convex bounding shapes of volumes: the interval of a line inside the shape. One file and one row
 * of the table per kind. */
#ifndef PL_GEOM_BOUND_H
#define PL_GEOM_BOUND_H

#include <stdbool.h>
#include <stddef.h>

#include "math/vec.h"

/* Shapes are in their own axes, metres. Each kind defines what the three numbers of its size
 * mean. */
typedef struct pl_bound {
  const char *name, *doc;
  unsigned flat; /* bit k: element k of the size may be 0 */
  /* Finds the interval t[0] < t[1] of the line origin + t direction inside the shape; false if it
   * is empty. The origin lies near the shape. */
  bool (*span)(const double size[3], pl_vec3 origin, pl_vec3 direction, double t[2]);
  /* Support function: the largest dot product of a point of the shape with a direction. */
  double (*support)(const double size[3], pl_vec3 direction);
} pl_bound;

/* Sphere that encloses the shape: the circumscribed sphere of its bounding box. */
typedef struct pl_bound_ball {
  pl_vec3 center;
  double radius_m;
} pl_bound_ball;
pl_bound_ball pl_bound_sphere(const pl_bound *bound, const double size[3]);
/* As the span of the kind, but for unit directions and from any origin: in double, a coordinate of
 * 1e9 m has a resolution of 1e-7 m. `ball` is the bounding sphere of the shape. */
bool pl_bound_span(const pl_bound *bound, const double size[3], const pl_bound_ball *ball,
                   pl_vec3 origin, pl_vec3 direction, double t[2]);

/* Clips [t[0], t[1]] to the solutions of the quadratic a t^2 + 2 b t + c <= 0; false if nothing is
 * left. For the kinds' own use: the set must be one interval. */
bool pl_bound_below(double a, double b, double c, double t[2]);

/* Table of all kinds. */
extern const pl_bound *const pl_bounds[];
extern const size_t pl_bound_count;

extern const pl_bound pl_bound_box, pl_bound_ellipsoid, pl_bound_cone;

#endif
