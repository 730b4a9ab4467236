/* Cone or truncated cone along z, from the origin. */
#include <math.h>

#include "geom/bound.h"

enum { START, END, LENGTH };

/* Between the planes of the ends: x^2 + y^2 <= (r + k z)^2. There only one nappe of the double cone
 * lies. */
static bool span(const double size[3], pl_vec3 o, pl_vec3 d, double t[2]) {
  const double k = (size[END] - size[START]) / size[LENGTH], r = size[START] + k * o.z;
  t[0] = -INFINITY;
  t[1] = INFINITY;
  if (d.z == 0.0) {
    if (!(o.z > 0.0 && o.z < size[LENGTH]))
      return false;
  } else {
    const double near = -o.z / d.z, far = (size[LENGTH] - o.z) / d.z;
    t[0] = fmin(near, far);
    t[1] = fmax(near, far);
  }
  const double a = d.x * d.x + d.y * d.y - k * k * d.z * d.z;
  const double b = o.x * d.x + o.y * d.y - k * d.z * r;
  const double c = o.x * o.x + o.y * o.y - r * r;
  return pl_bound_below(a, b, c, t) && t[0] < t[1];
}

static double support(const double size[3], pl_vec3 d) {
  const double across = sqrt(d.x * d.x + d.y * d.y);
  return fmax(size[START] * across, size[END] * across + size[LENGTH] * d.z);
}

const pl_bound pl_bound_cone = {
    .name = "cone",
    .doc = "A part of a cone about z, from the origin on; the size is the radius there, the radius "
           "at the other end, and the length",
    .flat = 1u << START | 1u << END,
    .span = span,
    .support = support,
};
