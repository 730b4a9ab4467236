/* Angles between directions: faster than atan2 of the C library, with errors below the precision of
 * float32. */
#ifndef PL_MATH_ANGLE_H
#define PL_MATH_ANGLE_H

#include "math/vec.h"

/* Arctangent of x in 0..1, within 2e-8 rad (Abramowitz and Stegun 1964, 4.4.49). */
static inline double pl_arctan_unit(double x) {
  static const double c[8] = {-0.3333314528, 0.1999355085, -0.1420889944, 0.1065626393,
                              -0.0752896400, 0.0429096138, -0.0161657367, 0.0028662257};
  const double s = x * x, s2 = s * s, s4 = s2 * s2;
  const double low = (c[0] + c[1] * s) + (c[2] + c[3] * s) * s2;
  const double high = (c[4] + c[5] * s) + (c[6] + c[7] * s) * s2;
  return x + x * s * (low + high * s4);
}

/* Angle between two vectors of any length, rad in 0..pi, within 4e-8; 0 if one of them is zero.
 * Uses sine and cosine, because the cosine alone is imprecise near 0 and pi. */
static inline double pl_vec3_angle(pl_vec3 a, pl_vec3 b) {
  const double sine = pl_vec3_norm(pl_vec3_cross(a, b)), cosine = pl_vec3_dot(a, b);
  const double along = fabs(cosine);
  const double large = sine > along ? sine : along, small = sine > along ? along : sine;
  if (!(large > 0.0))
    return 0.0;
  const double octant = pl_arctan_unit(small / large);
  const double quadrant = sine > along ? 0.5 * PL_PI - octant : octant;
  return cosine < 0.0 ? PL_PI - quadrant : quadrant;
}

/* atan2(y, x), rad in -pi..pi, within 4e-8; 0 if both are zero, or one is NaN. */
static inline double pl_arctan2(double y, double x) {
  const double up = fabs(y), along = fabs(x);
  const double large = up > along ? up : along, small = up > along ? along : up;
  if (!(large > 0.0))
    return 0.0;
  const double octant = pl_arctan_unit(small / large);
  const double quadrant = up > along ? 0.5 * PL_PI - octant : octant;
  return copysign(x < 0.0 ? PL_PI - quadrant : quadrant, y);
}

#endif
