/* The table of bodies: gravity, size, albedo, parent and the IAU rotation model. */
#ifndef PL_ORBIT_CELESTIAL_H
#define PL_ORBIT_CELESTIAL_H

#include <stddef.h>

#include "base/status.h"

/* One periodic term of the rotation model. Its argument is phase + rate T + quadratic T^2, where T
 * is in Julian centuries of TDB since J2000. Right ascension and W use its sine, declination its
 * cosine. Degrees. */
typedef struct pl_rotation_term {
  double phase_deg, rate_deg_century, quadratic_deg_century2;
  double ra_deg, dec_deg, w_deg;
} pl_rotation_term;

/* North pole (ra, dec) in ICRF and prime meridian W, as defined by the IAU working group. */
typedef struct pl_rotation_model {
  double ra_deg[2];  /* constant, per century */
  double dec_deg[2]; /* constant, per century */
  double w_deg[3];   /* constant, per day, per day^2 */
  const pl_rotation_term *terms;
  size_t term_count;
} pl_rotation_model;

typedef struct pl_celestial {
  const char *name;   /* lower case */
  const char *parent; /* name of the body it orbits; NULL for the sun */
  double gm_m3_s2;
  double radii_m[3];       /* semi-axes of the ellipsoid: a to longitude 0, b, c to the pole */
  double geometric_albedo; /* V band; 0 for the sun, which emits light */
  double bond_albedo;
  pl_rotation_model rotation;
} pl_celestial;

/* All bodies, in a fixed order; static. */
const pl_celestial *pl_celestial_table(size_t *count);

/* Returns NULL if there is no such body. */
const pl_celestial *pl_celestial_find(const char *name);

/* The same, but fails with PL_E_ARGUMENT and a message that lists the valid names. */
pl_status pl_celestial_require(const char *name, const pl_celestial **out);

#endif
