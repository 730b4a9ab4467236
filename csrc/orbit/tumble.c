/* Torque-free rotation by Jacobi's elliptic functions.
 *
 * Rates: Landau and Lifshitz, Mechanics, 37. With the angular momentum L along z, and the Euler
 * angles phi (about it), theta and psi (about the axis d; z-x-z), theta and psi follow from the
 * rates, and
 *   dphi/dt = L (I_a w_a^2 + I_b w_b^2)/(I_a^2 w_a^2 + I_b^2 w_b^2)
 *           = (L/I_d) (1 + ((I_d - I_a)/I_a)/(1 + c sn^2 u)),
 *   c = I_d (I_b - I_a)/(I_a (I_d - I_b)),
 * which varies between L/I_a at sn = 0 and L/I_b at sn^2 = 1. One of these limits times t is split
 * off. The remainder is an elliptic integral of the third kind (by Abramowitz and Stegun 17.7.15 if
 * c > 1). This avoids cancellation, also in differences of squares, which are computed from
 * differences of the moments: near-symmetric bodies and rotations near the separatrix are as
 * accurate as others. */
#include "orbit/tumble.h"

#include "math/elliptic.h"
#include "orbit/attitude.h"

/* The moments of a thin plate add up exactly, but rounded decimals of them may not. */
#define TRIANGLE_SLACK 1e-9
/* A rotation whose deviation from a principal axis is below this limit is treated as steady. Even
 * about the intermediate axis, where the error grows by a factor e per radian, it takes 50
 * revolutions to become visible, and its square underflows. */
#define NO_TORQUE 1e-140

static double component(pl_vec3 v, int axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }

/* The part of the precession that is not linear in t, from the elliptic functions at u, |u| <= K;
 * odd in u. */
static double swing(const pl_tumble *t, pl_elliptic f) {
  const double x = f.cn * f.cn, y = f.dn * f.dn, s = f.sn, c = t->c;
  if (!t->steep) /* integral of sn^2/(1 + c sn^2) */
    return s * s * s * pl_elliptic_rj(x, y, 1.0, 1.0 + c * s * s) / 3.0;
  /* integral of 1/(1 + c sn^2) - 1/(1 + c) */
  if (!(t->m1 > 0.0))
    return sqrt(c) / (1.0 + c) * atan(sqrt(c) * s);
  /* Integrated from u = K, where the integrand is small. With v = K - u the integrand is (c m1/(1 +
   * c)^2) sn^2 v/(cn^2 v + m1/(1 + c) sn^2 v). */
  const double sv = f.cn / f.dn, dv2 = t->m1 / y, cv2 = dv2 * s * s, rest = t->m1 / (1.0 + c);
  const double rj = pl_elliptic_rj(cv2, dv2, 1.0, cv2 + rest * sv * sv);
  return copysign(0.5 * t->half - c * rest / (1.0 + c) * sv * sv * sv * rj / 3.0, s);
}

/* The integral from 0 to 2 K. */
static double swing_half(const pl_tumble *t) {
  if (!(t->m1 > 0.0))
    return 0.0; /* not used */
  if (!t->steep)
    return 2.0 * swing(t, (pl_elliptic){1.0, 0.0, sqrt(t->m1)});
  const double rest = t->m1 / (1.0 + t->c), k = t->c * rest / (1.0 + t->c);
  return 2.0 * k * pl_elliptic_rj(0.0, t->m1, 1.0, rest) / 3.0;
}

/* The elliptic functions at u, and the integral up to u minus that up to `start`. */
static pl_elliptic phase_at(const pl_tumble *t, double t_s, double *integral) {
  const double product = t->rate_s * t_s, rest = fma(t->rate_s, t_s, -product);
  if (!isfinite(t->quarter)) {
    const double u = t->start + product;
    const pl_elliptic f = pl_elliptic_functions(u, t->m, t->m1);
    *integral = swing(t, f) - t->whole;
    return f;
  }
  const double half = 2.0 * t->quarter;
  const double part = remainder(product, half);
  const double sum = part + (rest + t->start), u = remainder(sum, half);
  const double turns = rint((product - part) / half) + rint((sum - u) / half);
  pl_elliptic f = pl_elliptic_functions(u, t->m, t->m1);
  *integral = turns * t->half + (swing(t, f) - t->whole);
  if (fmod(turns, 2.0) != 0.0) {
    f.sn = -f.sn;
    f.cn = -f.cn;
  }
  return f;
}

/* Rotation from body axes to axes whose z is along the angular momentum and whose x is along the
 * line of nodes. */
static pl_quat to_momentum(const pl_tumble *t, const double w[3]) {
  static const pl_quat relabel[3] = {
      {0.5, -0.5, -0.5, -0.5}, {0.5, 0.5, 0.5, 0.5}, {1.0, 0.0, 0.0, 0.0}};
  const int e = (t->d + 1) % 3, f = (t->d + 2) % 3; /* e, f, d is right-handed */
  const double x = t->inertia[e] * w[e], y = t->inertia[f] * w[f], z = t->inertia[t->d] * w[t->d];
  const double theta = atan2(hypot(x, y), z), psi = atan2(x, y);
  const pl_quat tilt = pl_quat_axis_angle(pl_vec3_make(1.0, 0.0, 0.0), theta);
  const pl_quat spin = pl_quat_axis_angle(pl_vec3_make(0.0, 0.0, 1.0), psi);
  return pl_quat_mul(pl_quat_mul(tilt, spin), relabel[t->d]);
}

pl_quat pl_tumble_at(const pl_tumble *t, double t_s, pl_vec3 *omega_rad_s) {
  if (t->rate_s == 0.0) {
    if (omega_rad_s)
      *omega_rad_s = t->spin_rad_s;
    const double rate = pl_vec3_norm(t->spin_rad_s);
    return pl_attitude_spin(t->start_q, pl_vec3_unit(t->spin_rad_s), rate, t_s);
  }
  double integral;
  const pl_elliptic f = phase_at(t, t_s, &integral);
  double w[3];
  w[t->a] = t->amplitude[t->a] * f.cn;
  w[t->b] = t->amplitude[t->b] * f.sn;
  w[t->d] = t->amplitude[t->d] * f.dn;
  if (omega_rad_s)
    *omega_rad_s = pl_vec3_scale((pl_vec3){w[0], w[1], w[2]}, t->scale_rad_s);
  const pl_vec3 z = {0.0, 0.0, 1.0};
  const pl_quat precessed = pl_attitude_spin(t->start_q, z, t->turn_s, t_s);
  const pl_quat swung = pl_quat_mul(precessed, pl_quat_axis_angle(z, t->weight * integral));
  return pl_quat_unit(pl_quat_mul(swung, to_momentum(t, w)));
}

/* Computes elliptic amplitudes, parameter and rate from the axes and the scaled rates at t = 0. */
static void solve(pl_tumble *t, const double w[3]) {
  const int a = t->a, b = t->b, d = t->d;
  const double ia = t->inertia[a], ib = t->inertia[b], id = t->inertia[d];
  const double da = id - ia, db = id - ib, ba = ib - ia; /* these have the same sign */
  const double wa2 = w[a] * w[a], wb2 = w[b] * w[b], wd2 = w[d] * w[d];
  const double over_a = ib * ba * wb2 + id * da * wd2;  /* L^2 - 2 E I_a */
  const double over_b = -ia * ba * wa2 + id * db * wd2; /* L^2 - 2 E I_b */
  const double under_d = ia * da * wa2 + ib * db * wb2; /* 2 E I_d - L^2 */
  const double momentum = sqrt(ia * ia * wa2 + ib * ib * wb2 + id * id * wd2);
  t->m = fmin(1.0, fmax(0.0, ba * under_d / (db * over_a)));
  t->m1 = fmin(1.0, fmax(0.0, da * over_b / (db * over_a)));
  t->quarter = pl_elliptic_k(t->m1);
  t->amplitude[a] = sqrt(wa2 + ib * db / (ia * da) * wb2);
  t->amplitude[b] = sqrt(wb2 + ia * da / (ib * db) * wa2);
  t->amplitude[d] = copysign(sqrt(wd2 + ib * ba / (id * da) * wb2), w[d]);
  if (!isfinite(t->quarter)) /* cn is positive there, so the amplitude carries the sign */
    t->amplitude[a] = copysign(t->amplitude[a], w[a]);
  const double next = t->inertia[(b + 1) % 3] - t->inertia[(b + 2) % 3];
  const double rate = sqrt(db * over_a / (ia * ib * id));
  t->rate_s = copysign(rate, next * t->amplitude[d] * t->amplitude[a]);
  double sn = w[b] / t->amplitude[b], cn = w[a] / t->amplitude[a];
  const double length = hypot(sn, cn);
  sn /= length;
  cn /= length;
  const pl_elliptic f = {sn, fabs(cn), sqrt(t->m1 + t->m * cn * cn)};
  t->start = sn * pl_elliptic_rf(cn * cn, f.dn * f.dn, 1.0);
  t->c = id * ba / (ia * db);
  t->steep = t->c > 1.0 || !(t->m1 > 0.0);
  t->turn_s = momentum / (t->steep ? ib : ia);
  t->weight = momentum / id * (da / ia) * (t->steep ? 1.0 : -t->c) / t->rate_s;
  t->half = swing_half(t);
  t->whole = swing(t, f);
  if (cn < 0.0) {
    t->start = copysign(2.0 * t->quarter, sn) - t->start;
    t->whole = copysign(t->half, sn) - t->whole;
  }
}

static pl_status check(pl_vec3 inertia, pl_vec3 omega, pl_quat start) {
  const double x = inertia.x, y = inertia.y, z = inertia.z, sum = x + y + z;
  if (!isfinite(sum) || !(x > 0.0 && y > 0.0 && z > 0.0))
    return pl_fail(PL_E_RANGE, "inertia is (%g, %g, %g), but must be finite and positive", x, y, z);
  if (2.0 * fmax(x, fmax(y, z)) > sum * (1.0 + TRIANGLE_SLACK))
    return pl_fail(PL_E_RANGE,
                   "inertia is (%g, %g, %g): no body has a moment larger than the sum "
                   "of the other two",
                   x, y, z);
  if (!pl_vec3_finite(omega))
    return pl_fail(PL_E_RANGE, "omega_rad_s is not finite");
  return pl_attitude_check(start, "start");
}

/* Sorts the axes from the smallest moment to the largest. */
static void sort_axes(const double inertia[3], int order[3]) {
  for (int i = 0; i < 3; i++)
    order[i] = i;
  for (int i = 1; i < 3; i++)
    for (int j = i; j > 0 && inertia[order[j]] < inertia[order[j - 1]]; j--) {
      const int swap = order[j];
      order[j] = order[j - 1];
      order[j - 1] = swap;
    }
}

/* A power of two close to x. Division by it is exact, so that a body on the separatrix stays on it.
 */
static double power_of_two(double x) {
  int exponent;
  frexp(x, &exponent);
  return x > 0.0 ? ldexp(1.0, exponent) : 1.0;
}

pl_status pl_tumble_init(pl_vec3 inertia, pl_vec3 omega_rad_s, pl_quat start, pl_tumble *out) {
  PL_TRY(check(inertia, omega_rad_s, start));
  const double most = power_of_two(fmax(inertia.x, fmax(inertia.y, inertia.z)));
  const double speed = power_of_two(pl_vec3_norm(omega_rad_s));
  *out =
      (pl_tumble){.spin_rad_s = omega_rad_s, .scale_rad_s = speed, .start_q = pl_quat_unit(start)};
  double w[3];
  for (int i = 0; i < 3; i++) {
    out->inertia[i] = component(inertia, i) / most;
    w[i] = component(omega_rad_s, i) / speed;
  }
  const double *in = out->inertia;
  const double torque = fabs((in[1] - in[2]) * w[1] * w[2]) + fabs((in[2] - in[0]) * w[2] * w[0]) +
                        fabs((in[0] - in[1]) * w[0] * w[1]);
  if (!(torque > NO_TORQUE))
    return PL_OK;
  int order[3];
  sort_axes(in, order);
  out->b = order[1];
  const double low = in[order[0]], mid = in[order[1]], high = in[order[2]];
  const double over = high * (high - mid) * w[order[2]] * w[order[2]] -
                      low * (mid - low) * w[order[0]] * w[order[0]]; /* L^2 - 2 E I_b */
  out->d = over >= 0.0 ? order[2] : order[0];
  out->a = over >= 0.0 ? order[0] : order[2];
  solve(out, w);
  out->rate_s *= speed;
  out->turn_s *= speed;
  out->start_q = pl_quat_mul(out->start_q, pl_quat_conjugate(to_momentum(out, w)));
  return PL_OK;
}
