/* Table of bounding shapes, and the code that they have in common. */
#include "geom/bound.h"

#include <math.h>

const pl_bound *const pl_bounds[] = {
    &pl_bound_box,
    &pl_bound_ellipsoid,
    &pl_bound_cone,
};
const size_t pl_bound_count = sizeof pl_bounds / sizeof pl_bounds[0];

pl_bound_ball pl_bound_sphere(const pl_bound *bound, const double size[3]) {
  const double x[2] = {-bound->support(size, (pl_vec3){-1.0, 0.0, 0.0}),
                       bound->support(size, (pl_vec3){1.0, 0.0, 0.0})};
  const double y[2] = {-bound->support(size, (pl_vec3){0.0, -1.0, 0.0}),
                       bound->support(size, (pl_vec3){0.0, 1.0, 0.0})};
  const double z[2] = {-bound->support(size, (pl_vec3){0.0, 0.0, -1.0}),
                       bound->support(size, (pl_vec3){0.0, 0.0, 1.0})};
  const pl_vec3 half = {0.5 * (x[1] - x[0]), 0.5 * (y[1] - y[0]), 0.5 * (z[1] - z[0])};
  const pl_vec3 center = {0.5 * (x[0] + x[1]), 0.5 * (y[0] + y[1]), 0.5 * (z[0] + z[1])};
  return (pl_bound_ball){center, pl_vec3_norm(half)};
}

/* Moves the origin to the point of the line nearest to the centre of the shape: the squares of
 * large coordinates would lose the precision of a small shape. */
bool pl_bound_span(const pl_bound *bound, const double size[3], const pl_bound_ball *ball,
                   pl_vec3 origin, pl_vec3 direction, double t[2]) {
  const double nearest = pl_vec3_dot(pl_vec3_sub(ball->center, origin), direction);
  const pl_vec3 from = pl_vec3_madd(origin, nearest, direction);
  const pl_vec3 off = pl_vec3_sub(from, ball->center);
  if (pl_vec3_dot(off, off) > ball->radius_m * ball->radius_m ||
      !bound->span(size, from, direction, t))
    return false;
  t[0] += nearest;
  t[1] += nearest;
  return t[0] < t[1];
}

static bool clip(double low, double high, double t[2]) {
  t[0] = fmax(t[0], low);
  t[1] = fmin(t[1], high);
  return t[0] < t[1];
}

/* Computes the roots without cancellation: q/a and c/q with q = -(b + sign(b) sqrt(b^2 - a c)). */
bool pl_bound_below(double a, double b, double c, double t[2]) {
  const double discriminant = b * b - a * c;
  if (discriminant <= 0.0)
    return a < 0.0 || (a == 0.0 && c <= 0.0);
  const double q = -(b + copysign(sqrt(discriminant), b));
  const double first = q / a, second = c / q;
  const double low = fmin(first, second), high = fmax(first, second);
  if (a >= 0.0)
    return clip(low, high, t);
  /* The set lies outside the roots. The other limits of the shape leave at most one side non-empty,
   * apart from rounding. */
  double before[2] = {t[0], t[1]}, after[2] = {t[0], t[1]};
  const bool is_before = clip(-INFINITY, low, before), is_after = clip(high, INFINITY, after);
  const bool first_side = is_before && (!is_after || before[1] - before[0] > after[1] - after[0]);
  t[0] = first_side ? before[0] : after[0];
  t[1] = first_side ? before[1] : after[1];
  return is_before || is_after;
}
