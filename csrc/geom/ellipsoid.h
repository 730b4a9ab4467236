/* Analytic ellipsoids in double precision. */
#ifndef PL_GEOM_ELLIPSOID_H
#define PL_GEOM_ELLIPSOID_H

#include <stdbool.h>

#include "math/vec.h"

/* Nearest t > t_min at which origin + t direction meets the ellipsoid of semi-axes `radii_m` at the
 * origin, all in the ellipsoid's axes; direction need not be unit. False if there is none.
 * Scaled to the unit sphere, then solved without cancellation (Haines et al. 2019), so that rays
 * from 4e11 m still meet a limb of 6e6 m. */
bool pl_ellipsoid_intersect(pl_vec3 radii_m, pl_vec3 origin, pl_vec3 direction, double t_min,
                            double *t);

/* The same for the unit sphere: what an ellipsoid is in axes scaled by its radii. t is in units of
 * `direction`, which need not be unit. */
bool pl_unit_sphere_intersect(pl_vec3 origin, pl_vec3 direction, double t_min, double *t);

/* Outward unit normal at a point of the surface. */
pl_vec3 pl_ellipsoid_normal(pl_vec3 radii_m, pl_vec3 point);

/* Longitude (east, -pi..pi) and planetocentric latitude of a point; (0, 0) at the centre. */
void pl_ellipsoid_lon_lat(pl_vec3 point, double *lon_rad, double *lat_rad);

#endif
