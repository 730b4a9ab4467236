/* Time since periapsis from anomalies. */
#ifndef PL_ORBIT_ANOMALY_H
#define PL_ORBIT_ANOMALY_H

#include "orbit/elements.h"

/* Both set `since_periapsis_s` of elements whose periapsis and eccentricity are set. On an ellipse
 * whole turns are taken off: the time is within half a period of periapsis. PL_E_RANGE as for
 * pl_orbit_from_elements, and for an angle that is not finite. */

/* True anomaly, radians, without loss of digits through e = 1. PL_E_RANGE for one at or beyond the
 * asymptote of an open conic. */
pl_status pl_elements_set_true_anomaly(pl_elements *elements, double gm_m3_s2, double anomaly_rad);

/* Mean anomaly, radians: sqrt(gm |1 - e|^3/q^3) t. PL_E_RANGE at e = 1, where it is always 0. */
pl_status pl_elements_set_mean_anomaly(pl_elements *elements, double gm_m3_s2, double anomaly_rad);

#endif
