/* Ellipsoid around the origin. */
#include <math.h>

#include "geom/bound.h"

static bool span(const double size[3], pl_vec3 origin, pl_vec3 direction, double t[2]) {
  const pl_vec3 o = {origin.x / size[0], origin.y / size[1], origin.z / size[2]};
  const pl_vec3 d = {direction.x / size[0], direction.y / size[1], direction.z / size[2]};
  t[0] = -INFINITY;
  t[1] = INFINITY;
  return pl_bound_below(pl_vec3_dot(d, d), pl_vec3_dot(o, d), pl_vec3_dot(o, o) - 1.0, t);
}

static double support(const double size[3], pl_vec3 d) {
  return pl_vec3_norm((pl_vec3){size[0] * d.x, size[1] * d.y, size[2] * d.z});
}

const pl_bound pl_bound_ellipsoid = {
    .name = "ellipsoid",
    .doc = "An ellipsoid about the origin; the size is that of its semi-axes",
    .span = span,
    .support = support,
};
