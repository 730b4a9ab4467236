/* Where a body's pole and prime meridian point at a date. */
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

/* At JD(TDB) = tdb_day + tdb_fraction, any split; the finer the parts, the finer the phase. */
pl_pole pl_celestial_pole(const pl_celestial *body, double tdb_day, double tdb_fraction);

/* Body-fixed (x to longitude 0, z to the north pole) to ICRF. */
pl_quat pl_celestial_orientation(const pl_celestial *body, double tdb_day, double tdb_fraction);

/* Equator of date to ICRF: z to the pole, x along the ascending node of the equator on ICRF's. */
pl_quat pl_celestial_equator(const pl_celestial *body, double tdb_day, double tdb_fraction);

#endif
