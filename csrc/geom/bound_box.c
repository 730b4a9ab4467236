/* Box around the origin with faces orthogonal to the axes. */
#include <math.h>

#include "geom/bound.h"

/* Slab method (Kay and Kajiya 1986). A line in the plane of a face is outside. */
static bool span(const double size[3], pl_vec3 origin, pl_vec3 direction, double t[2]) {
  const double o[3] = {origin.x, origin.y, origin.z},
               d[3] = {direction.x, direction.y, direction.z};
  t[0] = -INFINITY;
  t[1] = INFINITY;
  for (int k = 0; k < 3; k++) {
    const double half = 0.5 * size[k];
    if (d[k] == 0.0) {
      if (!(fabs(o[k]) < half))
        return false;
      continue;
    }
    const double a = (-half - o[k]) / d[k], b = (half - o[k]) / d[k];
    t[0] = fmax(t[0], fmin(a, b));
    t[1] = fmin(t[1], fmax(a, b));
  }
  return t[0] < t[1];
}

static double support(const double size[3], pl_vec3 d) {
  return 0.5 * (size[0] * fabs(d.x) + size[1] * fabs(d.y) + size[2] * fabs(d.z));
}

const pl_bound pl_bound_box = {
    .name = "box",
    .doc = "A box about the origin; the size is that of its sides",
    .span = span,
    .support = support,
};
