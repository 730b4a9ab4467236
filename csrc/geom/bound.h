/* Convex shapes that bound what has no surface: where a line is inside. One row and one file a
 * kind. */
#ifndef PL_GEOM_BOUND_H
#define PL_GEOM_BOUND_H

#include <stdbool.h>
#include <stddef.h>

#include "math/vec.h"

/* Shapes are in axes of their own, metres. What the three numbers of a size mean is the kind's. */
typedef struct pl_bound {
  const char *name, *doc;
  unsigned flat; /* bit k: number k of the size may be 0 */
  /* Ends of the part of the line origin + t direction within the shape, t[0] < t[1]; false if there
   * is none. The origin lies near the shape. */
  bool (*span)(const double size[3], pl_vec3 origin, pl_vec3 direction, double t[2]);
  /* Largest product of a point of the shape with a direction. */
  double (*support)(const double size[3], pl_vec3 direction);
} pl_bound;

/* A sphere that holds the shape: its box's. */
typedef struct pl_bound_ball {
  pl_vec3 center;
  double radius_m;
} pl_bound_ball;
pl_bound_ball pl_bound_sphere(const pl_bound *bound, const double size[3]);
/* As the kind's own, for unit directions, from any origin: what is left of a coordinate of 1e9 m
 * in double is 1e-7 m. `ball`: the shape's. */
bool pl_bound_span(const pl_bound *bound, const double size[3], const pl_bound_ball *ball,
                   pl_vec3 origin, pl_vec3 direction, double t[2]);

/* The part of [t[0], t[1]] where (t - root[0]) (t - root[1]) has the sign that a quadratic
 * a t^2 + 2 b t + c <= 0 asks for; false if it is empty. For the kinds: the set is one interval. */
bool pl_bound_below(double a, double b, double c, double t[2]);

/* The table. */
extern const pl_bound *const pl_bounds[];
extern const size_t pl_bound_count;
/* Row by name, or NULL. */
const pl_bound *pl_bound_find(const char *name);

extern const pl_bound pl_bound_box, pl_bound_ellipsoid, pl_bound_cone;

#endif
