/* The universal Kepler equation from periapsis, and the resulting states.
 *
 * t = q s + gm e s^3 c3(alpha s^2), dt/ds = r > 0: monotonic, and free of cancellation for any e.
 * The initial value and the safeguarded Laguerre step follow Conway, "An improved algorithm due to
 * Laguerre for the solution of Kepler's equation", Celest. Mech. 39, 1986. */
#include "orbit/kepler.h"

#define STUMPFF_TERMS 10
#define LAGUERRE_DEGREE 5.0
#define MAX_STEPS 60
/* Convergence is cubic: if a step is this small relative to s, the next is below rounding. */
#define LAST_STEP 1e-8

static void stumpff_series(double z, double c[4]) {
  double c2 = 1.0, c3 = 1.0;
  for (int j = STUMPFF_TERMS; j >= 1; j--) {
    const double k = 2.0 * j;
    c2 = 1.0 - z * c2 / ((k + 1.0) * (k + 2.0));
    c3 = 1.0 - z * c3 / ((k + 2.0) * (k + 3.0));
  }
  c[2] = c2 / 2.0;
  c[3] = c3 / 6.0;
  c[1] = 1.0 - z * c[3];
  c[0] = 1.0 - z * c[2];
}

void pl_stumpff(double z, double c[4]) {
  if (fabs(z) <= 1.0) { /* the closed forms are 0/0 at z = 0 */
    stumpff_series(z, c);
    return;
  }
  const double w = sqrt(fabs(z));
  const double half = z > 0.0 ? sin(0.5 * w) : sinh(0.5 * w);
  c[2] = 2.0 * half * half / fabs(z);
  if (z > 0.0) {
    const double s = sin(w);
    c[0] = cos(w);
    c[1] = s / w;
    c[3] = (w - s) / (z * w);
  } else {
    const double s = sinh(w);
    c[0] = cosh(w);
    c[1] = s / w;
    c[3] = (s - w) / (-z * w);
  }
}

/* Quantities that are the same for all times. */
typedef struct conic {
  const pl_orbit *orbit;
  double gm_e;     /* gm * eccentricity */
  double root;     /* sqrt(|alpha|) */
  double period_s; /* infinite for open conics */
  double s_max;    /* universal anomaly of apoapsis; infinite for open conics */
  double v_scale;  /* sqrt(gm q (1 + e)), the angular momentum, m^2/s */
} conic;

static conic conic_make(const pl_orbit *orbit) {
  conic c = {.orbit = orbit, .period_s = INFINITY, .s_max = INFINITY};
  const double alpha = orbit->alpha_m2_s2;
  c.gm_e = orbit->gm_m3_s2 * orbit->eccentricity;
  c.root = sqrt(fabs(alpha));
  c.v_scale = sqrt(orbit->gm_m3_s2 * orbit->periapsis_m * (1.0 + orbit->eccentricity));
  if (alpha > 0.0) {
    c.period_s = 2.0 * PL_PI * (orbit->gm_m3_s2 / (alpha * c.root));
    c.s_max = PL_PI / c.root;
  }
  return c;
}

/* The real root of (gm e/6) s^3 + q s - t = 0 for t > 0, in a form without cancellation. It is
 * above the solution on open conics (c3 >= 1/6) and below it on ellipses. */
static double cubic_start(const conic *c, double t) {
  const double q = c->orbit->periapsis_m;
  if (!(c->gm_e > 0.0))
    return t / q;
  const double p = 6.0 * q / c->gm_e, qq = 6.0 * t / c->gm_e;
  const double p3 = p / 3.0;
  const double w = cbrt(0.5 * qq + sqrt(0.25 * qq * qq + p3 * p3 * p3));
  const double s = qq / (w * w + p3 + (p3 / w) * (p3 / w));
  return s > 0.0 ? s : t / q; /* fallback if e is so small that the cubes overflow */
}

static double start_value(const conic *c, double t) {
  const double s = cubic_start(c, t);
  const pl_orbit *o = c->orbit;
  if (o->alpha_m2_s2 > 0.0)
    return fmin(s, c->s_max);
  if (!(c->root * s > 1.0))
    return s;
  /* Far out on a hyperbola the cubic overshoots exponentially; use e sinh F = N + F < N + b s. */
  const double n = t / o->gm_m3_s2 * c->root * c->root * c->root;
  return fmin(s, asinh((n + c->root * s) / o->eccentricity) / c->root);
}

/* Universal anomaly at time t >= 0 from periapsis (t <= half a period on an ellipse). */
static double solve(const conic *c, double t) {
  if (!(t > 0.0))
    return 0.0;
  const pl_orbit *o = c->orbit;
  double s = start_value(c, t);
  double low = 0.0, high = o->alpha_m2_s2 > 0.0 ? c->s_max : s;
  for (int step = 0; step < MAX_STEPS; step++) {
    double k[4];
    pl_stumpff(o->alpha_m2_s2 * s * s, k);
    const double f = o->periapsis_m * s + c->gm_e * s * s * s * k[3] - t;
    const double f1 = o->periapsis_m + c->gm_e * s * s * k[2];
    const double f2 = c->gm_e * s * k[1];
    if (f < 0.0)
      low = s;
    else
      high = s;
    const double n1 = LAGUERRE_DEGREE - 1.0;
    const double root = sqrt(fabs(n1 * n1 * f1 * f1 - LAGUERRE_DEGREE * n1 * f * f2));
    double next = s - LAGUERRE_DEGREE * f / (f1 + root);
    if (!(next >= low && next <= high))
      next = 0.5 * (low + high);
    const double change = fabs(next - s);
    s = next;
    if (!(change > LAST_STEP * s))
      break;
  }
  return s;
}

static pl_perifocal place(const conic *c, double s) {
  const pl_orbit *o = c->orbit;
  double k[4];
  pl_stumpff(o->alpha_m2_s2 * s * s, k);
  pl_perifocal out = {.s = s};
  out.r_m = o->periapsis_m + c->gm_e * s * s * k[2];
  out.x_m = o->periapsis_m - o->gm_m3_s2 * s * s * k[2];
  out.y_m = c->v_scale * s * k[1];
  out.vx_m_s = -o->gm_m3_s2 * s * k[1] / out.r_m;
  out.vy_m_s = c->v_scale * k[0] / out.r_m;
  return out;
}

/* Checks that t lies within the radial motion, which lasts from one passage of the centre to the
 * next. */
static pl_status check_radial(const conic *c, double t_s, double t) {
  const double since = c->orbit->since_periapsis_s;
  if (since > 0.0 ? t > 0.0 && t < c->period_s : t < 0.0 && t > -c->period_s)
    return PL_OK;
  return pl_fail(PL_E_RANGE, "at %g s radial motion has passed the centre", t_s);
}

static pl_status place_at_time(const conic *c, double t_s, pl_perifocal *out) {
  double t = t_s + c->orbit->since_periapsis_s;
  if (!isfinite(t))
    return pl_fail(PL_E_RANGE, "time %g s on an orbit is not finite", t_s);
  if (c->orbit->periapsis_m == 0.0)
    PL_TRY(check_radial(c, t_s, t));
  if (isfinite(c->period_s)) /* exact, since remainder does not round */
    t = remainder(t, c->period_s);
  *out = place(c, copysign(solve(c, fabs(t)), t));
  return PL_OK;
}

pl_perifocal pl_orbit_perifocal_at(const pl_orbit *orbit, double s) {
  const conic c = conic_make(orbit);
  return place(&c, s);
}

double pl_orbit_time_at(const pl_orbit *orbit, double s) {
  double k[4];
  pl_stumpff(orbit->alpha_m2_s2 * s * s, k);
  return orbit->periapsis_m * s + orbit->gm_m3_s2 * orbit->eccentricity * s * s * s * k[3];
}

pl_status pl_orbit_perifocal(const pl_orbit *orbit, double t_s, pl_perifocal *out) {
  const conic c = conic_make(orbit);
  return place_at_time(&c, t_s, out);
}

pl_status pl_orbit_states(const pl_orbit *orbit, size_t count, const double *t_s, pl_state *out) {
  const conic c = conic_make(orbit);
  for (size_t i = 0; i < count; i++) {
    pl_perifocal at;
    PL_TRY(place_at_time(&c, t_s[i], &at));
    out[i].r_m = pl_vec3_madd(pl_vec3_scale(orbit->p_axis, at.x_m), at.y_m, orbit->q_axis);
    out[i].v_m_s = pl_vec3_madd(pl_vec3_scale(orbit->p_axis, at.vx_m_s), at.vy_m_s, orbit->q_axis);
  }
  return PL_OK;
}

double pl_orbit_period_s(const pl_orbit *orbit) { return conic_make(orbit).period_s; }
