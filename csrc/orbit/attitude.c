/* Spin and LVLH attitudes. */
#include "orbit/attitude.h"

/* Below this sine of the angle between r and v their plane is noise. */
#define PLANE_LIMIT 1e-11
/* Cosine to the reference axis above which it is as good as parallel to the vertical. */
#define POLE_LIMIT 0.999

pl_quat pl_attitude_spin(pl_quat q, pl_vec3 axis, double rate_rad_s, double t_s) {
  const double angle = rate_rad_s * t_s;
  const double rest = fma(rate_rad_s, t_s, -angle); /* what rounding took off the product */
  const pl_quat turned = pl_quat_mul(q, pl_quat_axis_angle(axis, angle));
  return pl_quat_unit(pl_quat_mul(turned, pl_quat_axis_angle(axis, rest)));
}

static pl_vec3 orbit_normal(const pl_state *state, double r) {
  const pl_vec3 h = pl_vec3_cross(state->r_m, state->v_m_s);
  if (pl_vec3_norm(h) > PLANE_LIMIT * r * pl_vec3_norm(state->v_m_s))
    return h;
  const pl_vec3 up = pl_vec3_scale(state->r_m, 1.0 / r);
  pl_vec3 reference = {0.0, 0.0, 1.0};
  if (fabs(up.z) > POLE_LIMIT)
    reference = (pl_vec3){1.0, 0.0, 0.0};
  return pl_vec3_madd(reference, -pl_vec3_dot(reference, up), up);
}

pl_status pl_attitude_lvlh(const pl_state *state, pl_quat *out) {
  const double r = pl_vec3_norm(state->r_m);
  if (!(r > 0.0))
    return pl_fail(PL_E_RANGE, "lvlh: the object is at its parent's centre, which has no vertical");
  const pl_vec3 z = pl_vec3_scale(state->r_m, -1.0 / r);
  const pl_vec3 y = pl_vec3_scale(pl_vec3_unit(orbit_normal(state, r)), -1.0);
  const pl_vec3 x = pl_vec3_cross(y, z);
  const pl_mat3 to_frame = {{{x.x, y.x, z.x}, {x.y, y.y, z.y}, {x.z, y.z, z.z}}};
  *out = pl_quat_from_mat3(to_frame);
  return PL_OK;
}
