/* Intersection of rays with ellipsoids; surface normals and coordinates. */
#include "geom/ellipsoid.h"

bool pl_ellipsoid_intersect(pl_vec3 radii_m, pl_vec3 origin, pl_vec3 direction, double t_min,
                            double *t) {
  const pl_vec3 f = {origin.x / radii_m.x, origin.y / radii_m.y, origin.z / radii_m.z};
  const pl_vec3 d = {direction.x / radii_m.x, direction.y / radii_m.y, direction.z / radii_m.z};
  return pl_unit_sphere_intersect(f, d, t_min, t);
}

bool pl_unit_sphere_intersect(pl_vec3 f, pl_vec3 d, double t_min, double *t) {
  const double a = pl_vec3_dot(d, d);
  if (!(a > 0.0))
    return false;
  const double b = -pl_vec3_dot(f, d);
  /* the point of the line nearest to the centre */
  const pl_vec3 nearest = pl_vec3_madd(f, b / a, d);
  const double discriminant = a * (1.0 - pl_vec3_dot(nearest, nearest));
  if (!(discriminant >= 0.0))
    return false;
  const double c = pl_vec3_dot(f, f) - 1.0;
  const double q = b + copysign(sqrt(discriminant), b);
  double t0 = q != 0.0 ? c / q : 0.0, t1 = q / a;
  if (t0 > t1) {
    const double swap = t0;
    t0 = t1;
    t1 = swap;
  }
  *t = t0 > t_min ? t0 : t1;
  return *t > t_min;
}

pl_vec3 pl_ellipsoid_normal(pl_vec3 radii_m, pl_vec3 point) {
  const pl_vec3 gradient = {point.x / (radii_m.x * radii_m.x), point.y / (radii_m.y * radii_m.y),
                            point.z / (radii_m.z * radii_m.z)};
  return pl_vec3_unit(gradient);
}

void pl_ellipsoid_lon_lat(pl_vec3 point, double *lon_rad, double *lat_rad) {
  *lon_rad = atan2(point.y, point.x);
  *lat_rad = atan2(point.z, sqrt(point.x * point.x + point.y * point.y));
}
