/* Conversion of anomalies to times by the universal anomaly.
 *
 * tan(E/2) = sqrt((1 - e)/(1 + e)) tan(nu/2) and s = E/sqrt(alpha) give
 *   s = 2 D sqrt(q/(gm (1 + e))) atan(x)/x,   D = tan(nu/2), x^2 = D^2 (1 - e)/(1 + e),
 * where atan(x)/x is smooth through x^2 = 0 (Battin, An Introduction to the Mathematics and Methods
 * of Astrodynamics, 4.5). The time follows from s without differences of nearly equal terms. */
#include "orbit/anomaly.h"

/* Below this value five terms of the series are exact to rounding. */
#define SERIES_LIMIT 1e-4

/* atan(sqrt y)/sqrt y, which is atanh(sqrt -y)/sqrt -y for y < 0; y > -1. */
static double atan_ratio(double y) {
  if (fabs(y) < SERIES_LIMIT)
    return 1.0 - y * (1.0 / 3.0 - y * (1.0 / 5.0 - y * (1.0 / 7.0 - y / 9.0)));
  const double x = sqrt(fabs(y));
  return (y > 0.0 ? atan(x) : atanh(x)) / x;
}

/* Checks all elements except the anomaly, and returns the orbit at periapsis. */
static pl_status at_periapsis(const pl_elements *elements, double gm, pl_orbit *out) {
  pl_elements start = *elements;
  start.since_periapsis_s = 0.0;
  return pl_orbit_from_elements(&start, gm, out);
}

pl_status pl_elements_set_true_anomaly(pl_elements *elements, double gm_m3_s2, double anomaly_rad) {
  pl_orbit orbit;
  PL_TRY(at_periapsis(elements, gm_m3_s2, &orbit));
  if (!isfinite(anomaly_rad))
    return pl_fail(PL_E_RANGE, "the true anomaly is not finite");
  const double e = elements->eccentricity, nu = remainder(anomaly_rad, 2.0 * PL_PI);
  const double d = tan(0.5 * nu), y = (1.0 - e) / (1.0 + e) * d * d;
  if (e >= 1.0 && (!(y > -1.0) || fabs(nu) >= PL_PI)) {
    const double limit = acos(-1.0 / e) * 180.0 / PL_PI;
    return pl_fail(PL_E_RANGE,
                   "a true anomaly of %.6g deg is beyond the asymptote: eccentricity %g "
                   "has those between -%.6g and %.6g deg",
                   nu * 180.0 / PL_PI, e, limit, limit);
  }
  const double scale = sqrt(elements->periapsis_m / (gm_m3_s2 * (1.0 + e)));
  elements->since_periapsis_s = pl_orbit_time_at(&orbit, 2.0 * d * scale * atan_ratio(y));
  return PL_OK;
}

pl_status pl_elements_set_mean_anomaly(pl_elements *elements, double gm_m3_s2, double anomaly_rad) {
  pl_orbit orbit;
  PL_TRY(at_periapsis(elements, gm_m3_s2, &orbit));
  if (!isfinite(anomaly_rad))
    return pl_fail(PL_E_RANGE, "the mean anomaly is not finite");
  const double e = elements->eccentricity, q = elements->periapsis_m;
  if (e == 1.0)
    return pl_fail(PL_E_RANGE, "a parabola has no mean anomaly");
  const double a = q / fabs(1.0 - e), mean = sqrt(gm_m3_s2 / a) / a;
  const double phase = e < 1.0 ? remainder(anomaly_rad, 2.0 * PL_PI) : anomaly_rad;
  elements->since_periapsis_s = phase / mean;
  if (!isfinite(elements->since_periapsis_s))
    return pl_fail(PL_E_RANGE, "a mean anomaly of %g rad is out of range", anomaly_rad);
  return PL_OK;
}
