/* Orbits from classical elements and from state vectors, and back. */
#ifndef PL_ORBIT_ELEMENTS_H
#define PL_ORBIT_ELEMENTS_H

#include "orbit/kepler.h"

/* Classical elements with periapsis instead of semi-major axis, and time since periapsis instead
 * of an anomaly, so that every conic has them. */
typedef struct pl_elements {
  double periapsis_m;
  double eccentricity;
  double inclination_rad;
  double raan_rad;          /* right ascension of the ascending node */
  double arg_periapsis_rad; /* from the node to periapsis */
  double since_periapsis_s; /* at t = 0 */
} pl_elements;

/* PL_E_RANGE when an element is not finite, or periapsis or gm is not positive, or e < 0. */
pl_status pl_orbit_from_elements(const pl_elements *elements, double gm_m3_s2, pl_orbit *out);

/* The orbit through `state` at t = 0. Continuous in the state, circular, equatorial and parabolic
 * orbits included. Radial motion (|r x v| < 1e-11 |r| |v|, rest too) gives the conic of no width:
 * periapsis 0, e = 1, from one passage of the centre to the next. PL_E_RANGE for non-finite input
 * and at the centre. */
pl_status pl_orbit_from_state(const pl_state *state, double gm_m3_s2, pl_orbit *out);

/* Elements of an orbit. Angles are in (-pi, pi] (inclination [0, pi]). At inclination exactly 0 or
 * pi the node is put at 0, at e exactly 0 periapsis is put at the node; near those the angles are
 * ill-conditioned one by one but together give the orbit back to rounding. */
pl_elements pl_orbit_elements(const pl_orbit *orbit);

#endif
