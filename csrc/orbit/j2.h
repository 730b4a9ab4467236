/* The propagator `j2`: an ellipse whose node, periapsis and mean anomaly drift. */
#ifndef PL_ORBIT_J2_H
#define PL_ORBIT_J2_H

#include <stdbool.h>

#include "math/rotation.h"
#include "orbit/elements.h"
#include "orbit/propagator.h"

extern const pl_propagator_kind pl_j2_kind;

/* The second zonal harmonic (unnormalised) and the radius that it refers to. */
typedef struct pl_flattening {
  double j2;
  double radius_m; /* > 0 */
} pl_flattening;

/* Secular rates of mean elements to first order in J2. */
typedef struct pl_drift {
  double raan_rad_s, arg_periapsis_rad_s;
  double mean_anomaly_rad_s; /* including Kepler's mean motion */
} pl_drift;

/* Rates of an ellipse about a centre whose pole is z. Fails with PL_E_RANGE for e >= 1. */
pl_status pl_j2_drift(const pl_elements *elements, double gm_m3_s2, pl_flattening flattening,
                      pl_drift *out);

/* Creates the propagator from the mean elements of `orbit` at the epoch. If `osculating`, `orbit`
 * has osculating elements, of which only the semi-major axis is corrected to its mean value.
 * `frame` rotates the axes of the orbit to ICRF, `equator` those of the centre's equator. States
 * are those of the mean elements, and velocities the derivatives of the positions. Fails with
 * PL_E_RANGE for e >= 1, a radius that is not positive or values that are not finite; with
 * PL_E_MEMORY. */
pl_status pl_j2_create(const pl_orbit *orbit, pl_flattening flattening, bool osculating,
                       pl_quat frame, pl_quat equator, pl_propagator **out);

#endif
