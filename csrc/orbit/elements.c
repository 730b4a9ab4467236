/* Conversions between elements, states and orbits. */
#include "orbit/elements.h"

/* Below this ratio of |r x v| to |r| |v| the plane of motion is lost to rounding. */
#define RADIAL_LIMIT 1e-11

static pl_status check(double value, double above, const char *name) {
  if (!isfinite(value) || !(value > above))
    return pl_fail(PL_E_RANGE, "%s is %g, but must be finite and greater than %g", name, value,
                   above);
  return PL_OK;
}

static pl_status check_finite(double value, const char *name) {
  if (!isfinite(value))
    return pl_fail(PL_E_RANGE, "%s is %g, but must be finite", name, value);
  return PL_OK;
}

pl_status pl_orbit_from_elements(const pl_elements *el, double gm_m3_s2, pl_orbit *out) {
  PL_TRY(check(gm_m3_s2, 0.0, "gm"));
  PL_TRY(check(el->periapsis_m, 0.0, "periapsis_m"));
  PL_TRY(check_finite(el->eccentricity, "eccentricity"));
  if (el->eccentricity < 0.0)
    return pl_fail(PL_E_RANGE, "eccentricity is %g, but must not be negative", el->eccentricity);
  PL_TRY(check_finite(el->inclination_rad, "inclination_rad"));
  PL_TRY(check_finite(el->raan_rad, "raan_rad"));
  PL_TRY(check_finite(el->arg_periapsis_rad, "arg_periapsis_rad"));
  PL_TRY(check_finite(el->since_periapsis_s, "since_periapsis_s"));
  const double cn = cos(el->raan_rad), sn = sin(el->raan_rad);
  const double cw = cos(el->arg_periapsis_rad), sw = sin(el->arg_periapsis_rad);
  const double ci = cos(el->inclination_rad), si = sin(el->inclination_rad);
  *out = (pl_orbit){
      .gm_m3_s2 = gm_m3_s2,
      .periapsis_m = el->periapsis_m,
      .eccentricity = el->eccentricity,
      .alpha_m2_s2 = gm_m3_s2 * ((1.0 - el->eccentricity) / el->periapsis_m),
      .since_periapsis_s = el->since_periapsis_s,
      .p_axis = {cn * cw - sn * sw * ci, sn * cw + cn * sw * ci, sw * si},
      .q_axis = {-cn * sw - sn * cw * ci, -sn * sw + cn * cw * ci, cw * si},
  };
  return PL_OK;
}

/* |a|^2 as an unevaluated sum of two doubles. The rounding errors of products and sums are
 * recovered exactly (Dekker 1971; Ogita, Rump, Oishi 2005, Dot2). */
static void square_norm(pl_vec3 a, double *high, double *low) {
  const double v[3] = {a.x, a.y, a.z};
  double sum = 0.0, error = 0.0;
  for (int i = 0; i < 3; i++) {
    const double product = v[i] * v[i];
    const double next = sum + product;
    const double part = next - sum;
    error += fma(v[i], v[i], -product) + ((sum - (next - part)) + (product - part));
    sum = next;
  }
  *high = sum;
  *low = error;
}

/* 2 gm/|r| - v.v, almost correctly rounded. An error in this value grows with the number of
 * revolutions, and the plain difference loses digits near the periapsis of eccentric orbits. */
static double vis_viva_alpha(const pl_state *state, double gm) {
  double r2, r2_low, v2, v2_low;
  square_norm(state->r_m, &r2, &r2_low);
  square_norm(state->v_m_s, &v2, &v2_low);
  const double r = sqrt(r2);
  const double r_low = (r2_low - fma(r, r, -r2)) / (2.0 * r);
  const double u = 2.0 * gm / r;
  const double u_low = -(fma(u, r, -2.0 * gm) + u * r_low) / r;
  const double alpha = u - v2;
  const double part = alpha - u;
  const double alpha_low = (u - (alpha - part)) + (-v2 - part);
  return alpha + (alpha_low + (u_low - v2_low));
}

/* Universal anomaly and eccentricity of the state. Both are computed from the pair (e cos E, e sin
 * E), so that they are consistent for any small e. On open conics e follows from 1 - e^2 = p
 * alpha/gm, since the pair cancels far from periapsis. */
static double anomaly_of_state(double r, double sigma, double p, pl_orbit *orbit) {
  const double gm = orbit->gm_m3_s2, alpha = orbit->alpha_m2_s2;
  const double root = sqrt(fabs(alpha));
  if (alpha > 0.0) {
    const double ec = 1.0 - alpha * r / gm, es = sigma * root / gm;
    orbit->eccentricity = hypot(ec, es);
    return orbit->eccentricity > 0.0 ? atan2(es, ec) / root : 0.0;
  }
  orbit->eccentricity = sqrt(1.0 - p * alpha / gm);
  return root > 0.0 ? asinh(sigma * root / (gm * orbit->eccentricity)) / root : sigma / gm;
}

/* Degenerate conic of radial motion: periapsis 0, e = 1, along the line to the centre. */
static void radial_motion(const pl_state *state, double r, double sigma, pl_orbit *out) {
  const double s = anomaly_of_state(r, sigma, 0.0, out);
  out->periapsis_m = 0.0;
  out->eccentricity = 1.0;
  out->since_periapsis_s = pl_orbit_time_at(out, s);
  out->p_axis = pl_vec3_scale(state->r_m, -1.0 / r);
  const pl_vec3 p = out->p_axis; /* q: any axis perpendicular to p */
  const double x = fabs(p.x), y = fabs(p.y), z = fabs(p.z);
  const pl_vec3 other = {x <= y && x <= z, y < x && y <= z, z < x && z < y};
  out->q_axis = pl_vec3_unit(pl_vec3_cross(other, p));
}

pl_status pl_orbit_from_state(const pl_state *state, double gm_m3_s2, pl_orbit *out) {
  PL_TRY(check(gm_m3_s2, 0.0, "gm"));
  const double r = pl_vec3_norm(state->r_m), v = pl_vec3_norm(state->v_m_s);
  PL_TRY(check(r, 0.0, "distance from the centre"));
  PL_TRY(check_finite(v, "speed"));
  const pl_vec3 h = pl_vec3_cross(state->r_m, state->v_m_s);
  const double h_norm = pl_vec3_norm(h);
  *out = (pl_orbit){.gm_m3_s2 = gm_m3_s2, .alpha_m2_s2 = vis_viva_alpha(state, gm_m3_s2)};
  const double sigma = pl_vec3_dot(state->r_m, state->v_m_s);
  if (!(h_norm > RADIAL_LIMIT * r * v)) {
    radial_motion(state, r, sigma, out);
    return PL_OK;
  }
  const double p = h_norm * h_norm / gm_m3_s2;
  const double s = anomaly_of_state(r, sigma, p, out);
  out->periapsis_m = p / (1.0 + out->eccentricity);
  out->since_periapsis_s = pl_orbit_time_at(out, s);
  /* The axes are chosen such that the solver's position coincides with the state. The ill-defined
   * periapsis of a circular orbit then cancels. */
  const pl_perifocal at = pl_orbit_perifocal_at(out, s);
  const double scale = 1.0 / hypot(at.x_m, at.y_m);
  const double c = at.x_m * scale, d = at.y_m * scale;
  const pl_vec3 radial = pl_vec3_scale(state->r_m, 1.0 / r);
  const pl_vec3 along = pl_vec3_unit(pl_vec3_cross(h, radial));
  out->p_axis = pl_vec3_madd(pl_vec3_scale(radial, c), -d, along);
  out->q_axis = pl_vec3_madd(pl_vec3_scale(radial, d), c, along);
  return PL_OK;
}

pl_elements pl_orbit_elements(const pl_orbit *orbit) {
  const pl_vec3 w = pl_vec3_cross(orbit->p_axis, orbit->q_axis);
  const double sin_i = hypot(w.x, w.y);
  const double raan = sin_i > 0.0 ? atan2(w.x, -w.y) : 0.0;
  const pl_vec3 node = {cos(raan), sin(raan), 0.0};
  const pl_vec3 side = pl_vec3_cross(w, node);
  pl_elements el = {
      .periapsis_m = orbit->periapsis_m,
      .eccentricity = orbit->eccentricity,
      .inclination_rad = atan2(sin_i, w.z),
      .raan_rad = raan,
      .arg_periapsis_rad =
          atan2(pl_vec3_dot(orbit->p_axis, side), pl_vec3_dot(orbit->p_axis, node)),
      .since_periapsis_s = orbit->since_periapsis_s,
  };
  if (orbit->eccentricity == 0.0) { /* any point is periapsis: use the node */
    el.since_periapsis_s += el.arg_periapsis_rad / (2.0 * PL_PI) * pl_orbit_period_s(orbit);
    el.arg_periapsis_rad = 0.0;
  }
  return el;
}
