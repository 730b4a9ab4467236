/* Time since periapsis from anomalies. */
#ifndef PL_ORBIT_ANOMALY_H
#define PL_ORBIT_ANOMALY_H

#include "orbit/elements.h"

/* Both functions set `since_periapsis_s` of elements whose periapsis and eccentricity are set. On
 * an ellipse whole revolutions are removed, so that the time is within half a period of periapsis.
 * Errors: PL_E_RANGE as for pl_orbit_from_elements, and for an angle that is not finite. */

/* Sets the true anomaly, radians. Keeps full precision near e = 1. Fails with PL_E_RANGE at or
 * beyond the asymptote of an open conic. */
pl_status pl_elements_set_true_anomaly(pl_elements *elements, double gm_m3_s2, double anomaly_rad);

/* Sets the mean anomaly, radians: sqrt(gm |1 - e|^3/q^3) t. Fails with PL_E_RANGE at e = 1, where
 * the mean anomaly is always 0. */
pl_status pl_elements_set_mean_anomaly(pl_elements *elements, double gm_m3_s2, double anomaly_rad);

#endif
