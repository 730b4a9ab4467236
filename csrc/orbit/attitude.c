/* Spin, orbit frames and pointing.
 *
 * Orbit frames: Vallado, Fundamentals of Astrodynamics and Applications, 4th ed., 3.3. Pointing
 * with a second reference: the TRIAD method (Markley and Crassidis, Fundamentals of Spacecraft
 * Attitude Determination and Control, 5.1). */
#include "orbit/attitude.h"

/* Below this sine of the angle between r and v the orbital plane is lost to rounding. */
#define PLANE_LIMIT 1e-11
/* Above this cosine of the angle between the vertical and the reference axis they count as
 * parallel. */
#define POLE_LIMIT 0.999
/* Below this sine of the angle between aim and reference the roll is lost to rounding. */
#define AIM_LIMIT 1e-6

pl_status pl_attitude_check(pl_quat q, const char *name) {
  const double n2 = q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z;
  if (!isfinite(n2) || !(n2 > 0.0))
    return pl_fail(PL_E_RANGE, "the quaternion %s must be finite and not zero", name);
  return PL_OK;
}

pl_quat pl_attitude_spin(pl_quat q, pl_vec3 axis, double rate_rad_s, double t_s) {
  const double angle = rate_rad_s * t_s;
  const double rest = fma(rate_rad_s, t_s, -angle); /* rounding error of the product */
  const pl_quat turned = pl_quat_mul(q, pl_quat_axis_angle(axis, angle));
  return pl_quat_unit(pl_quat_mul(turned, pl_quat_axis_angle(axis, rest)));
}

/* Component perpendicular to `v` of a fixed axis: z, or x near the poles. */
static pl_vec3 square_to(pl_vec3 v) {
  const pl_vec3 along = pl_vec3_unit(v);
  pl_vec3 reference = {0.0, 0.0, 1.0};
  if (fabs(along.z) > POLE_LIMIT)
    reference = (pl_vec3){1.0, 0.0, 0.0};
  return pl_vec3_madd(reference, -pl_vec3_dot(reference, along), along);
}

/* r x v, or zero if it is lost to rounding. */
static pl_vec3 momentum(const pl_state *state) {
  const pl_vec3 h = pl_vec3_cross(state->r_m, state->v_m_s);
  const double limit = PLANE_LIMIT * pl_vec3_norm(state->r_m) * pl_vec3_norm(state->v_m_s);
  return pl_vec3_norm(h) > limit ? h : pl_vec3_make(0.0, 0.0, 0.0);
}

pl_vec3 pl_attitude_normal(const pl_state *state) {
  const pl_vec3 h = momentum(state);
  return pl_vec3_norm(h) > 0.0 ? h : square_to(state->r_m);
}

/* Quaternion of the matrix with columns x = y x z, y, z. y and z are perpendicular unit vectors. */
static pl_quat from_yz(pl_vec3 y, pl_vec3 z) {
  const pl_vec3 x = pl_vec3_cross(y, z);
  return pl_quat_from_mat3((pl_mat3){{{x.x, y.x, z.x}, {x.y, y.y, z.y}, {x.z, y.z, z.z}}});
}

pl_status pl_attitude_lvlh(const pl_state *state, pl_quat *out) {
  const double r = pl_vec3_norm(state->r_m);
  if (!(r > 0.0))
    return pl_fail(PL_E_RANGE, "lvlh: the object is at its parent's centre, which has no vertical");
  const pl_vec3 z = pl_vec3_scale(state->r_m, -1.0 / r);
  *out = from_yz(pl_vec3_scale(pl_vec3_unit(pl_attitude_normal(state)), -1.0), z);
  return PL_OK;
}

pl_status pl_attitude_rsw(const pl_state *state, pl_quat *out) {
  const double r = pl_vec3_norm(state->r_m);
  if (!(r > 0.0))
    return pl_fail(PL_E_RANGE, "rsw: the object is at its parent's centre, which has no vertical");
  const pl_vec3 x = pl_vec3_scale(state->r_m, 1.0 / r);
  const pl_vec3 z = pl_vec3_unit(pl_attitude_normal(state));
  *out = from_yz(pl_vec3_cross(z, x), z);
  return PL_OK;
}

pl_status pl_attitude_velocity(const pl_state *state, pl_quat *out) {
  const double v = pl_vec3_norm(state->v_m_s);
  if (!(v > 0.0))
    return pl_fail(PL_E_RANGE, "velocity: the object does not move about its parent");
  const pl_vec3 x = pl_vec3_scale(state->v_m_s, 1.0 / v), h = momentum(state);
  const pl_vec3 normal = pl_vec3_norm(h) > 0.0 ? h : square_to(state->v_m_s);
  const pl_vec3 y = pl_vec3_scale(pl_vec3_unit(normal), -1.0);
  *out = from_yz(y, pl_vec3_cross(x, y));
  return PL_OK;
}

/* Unit vectors along `aim` and perpendicular to both `aim` and `up`. */
static pl_status triad(pl_vec3 aim, pl_vec3 up, pl_vec3 *along, pl_vec3 *side) {
  const double length = pl_vec3_norm(aim);
  if (!(length > 0.0) || !isfinite(length))
    return pl_fail(PL_E_RANGE, "it stands where it is to point at");
  const pl_vec3 u = pl_vec3_scale(aim, 1.0 / length);
  pl_vec3 cross = pl_vec3_cross(u, pl_vec3_unit(up));
  if (!(pl_vec3_norm(cross) > AIM_LIMIT)) {
    const double x = fabs(u.x), y = fabs(u.y), z = fabs(u.z);
    const pl_vec3 farthest = {x <= y && x <= z, y < x && y <= z, z < x && z < y};
    cross = pl_vec3_cross(u, farthest);
  }
  *along = u;
  *side = pl_vec3_unit(cross);
  return PL_OK;
}

pl_status pl_attitude_aim_x(pl_vec3 aim, pl_vec3 up, pl_quat *out) {
  pl_vec3 x = {0}, side = {0}; /* side = x cross up: opposite to y */
  PL_TRY(triad(aim, up, &x, &side));
  const pl_vec3 y = pl_vec3_scale(side, -1.0);
  *out = from_yz(y, pl_vec3_cross(x, y));
  return PL_OK;
}

pl_status pl_attitude_aim_z(pl_vec3 aim, pl_vec3 up, pl_quat *out) {
  pl_vec3 z = {0}, side = {0}; /* side = z cross up; x = y cross z with y opposite to up */
  PL_TRY(triad(aim, up, &z, &side));
  *out = from_yz(pl_vec3_cross(z, side), z);
  return PL_OK;
}
