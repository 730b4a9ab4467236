/* Orientation of a body's pole and prime meridian at a date. */
#ifndef PL_ORBIT_ORIENTATION_H
#define PL_ORBIT_ORIENTATION_H

#include "base/status.h"
#include "math/rotation.h"
#include "orbit/celestial.h"

#define PL_J2000_JD 2451545.0

/* Pole in ICRF and prime meridian, radians; W in [-pi, pi] up to its small terms. */
typedef struct pl_pole {
  double ra_rad, dec_rad, w_rad;
} pl_pole;

/* The pole at JD(TDB) = tdb_day + tdb_fraction, with any split; smaller parts give a more precise
 * phase. */
pl_pole pl_celestial_pole(const pl_celestial *body, double tdb_day, double tdb_fraction);

/* Rotation from body-fixed axes (x to longitude 0, z to the north pole) to ICRF. */
pl_quat pl_celestial_orientation(const pl_celestial *body, double tdb_day, double tdb_fraction);

/* Rotation from the equator of date to ICRF: z to the pole, x along the ascending node of the
 * equator on the ICRF equator. */
pl_quat pl_celestial_equator(const pl_celestial *body, double tdb_day, double tdb_fraction);

#endif
