/* Analytic ellipsoids in double precision. */
#ifndef PL_GEOM_ELLIPSOID_H
#define PL_GEOM_ELLIPSOID_H

#include <stdbool.h>

#include "math/vec.h"

/* Finds the smallest t > t_min at which origin + t direction intersects the ellipsoid of semi-axes
 * `radii_m` around the origin, all in the ellipsoid's axes; direction need not be a unit vector.
 * Returns false if there is none. The ray is scaled to the unit sphere and the quadratic is solved
 * without cancellation (Haines et al. 2019), so that rays from 4e11 m still resolve a limb of 6e6
 * m. */
bool pl_ellipsoid_intersect(pl_vec3 radii_m, pl_vec3 origin, pl_vec3 direction, double t_min,
                            double *t);

/* The same for the unit sphere, to which an ellipsoid is mapped by axes scaled by its radii. t is
 * in units of `direction`, which need not be a unit vector. */
bool pl_unit_sphere_intersect(pl_vec3 origin, pl_vec3 direction, double t_min, double *t);

/* Returns the outward unit normal at a point of the surface. */
pl_vec3 pl_ellipsoid_normal(pl_vec3 radii_m, pl_vec3 point);

/* Computes the longitude (east, -pi..pi) and planetocentric latitude of a point; (0, 0) at the
 * centre. */
void pl_ellipsoid_lon_lat(pl_vec3 point, double *lon_rad, double *lat_rad);

#endif
