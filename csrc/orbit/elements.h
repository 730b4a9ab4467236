/* Conversion between orbits, classical elements and state vectors. */
#ifndef PL_ORBIT_ELEMENTS_H
#define PL_ORBIT_ELEMENTS_H

#include "orbit/kepler.h"

/* Classical elements with the periapsis distance instead of the semi-major axis, and the time since
 * periapsis instead of an anomaly, so that they are defined for every conic. */
typedef struct pl_elements {
  double periapsis_m;
  double eccentricity;
  double inclination_rad;
  double raan_rad;          /* right ascension of the ascending node */
  double arg_periapsis_rad; /* from the node to periapsis */
  double since_periapsis_s; /* at t = 0 */
} pl_elements;

/* Fails with PL_E_RANGE if an element is not finite, periapsis or gm is not positive, or e < 0. */
pl_status pl_orbit_from_elements(const pl_elements *elements, double gm_m3_s2, pl_orbit *out);

/* The orbit through `state` at t = 0. It is a continuous function of the state, also at circular,
 * equatorial and parabolic orbits. Radial motion (|r x v| < 1e-11 |r| |v|, and rest) gives the
 * degenerate conic with periapsis 0 and e = 1, from one passage of the centre to the next. Fails
 * with PL_E_RANGE for input that is not finite, and at the centre. */
pl_status pl_orbit_from_state(const pl_state *state, double gm_m3_s2, pl_orbit *out);

/* Elements of an orbit. Angles are in (-pi, pi], the inclination in [0, pi]. At an inclination of
 * exactly 0 or pi the ascending node is set to 0, and at e of exactly 0 periapsis is set to the
 * node. Near these cases the individual angles are ill-conditioned, but together they reproduce the
 * orbit to rounding. */
pl_elements pl_orbit_elements(const pl_orbit *orbit);

#endif
