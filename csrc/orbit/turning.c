/* Evaluates the rotation of a central body. */
#include "orbit/turning.h"

#include "orbit/orientation.h"

#define SECONDS_PER_DAY 86400.0

pl_status pl_turning_init(const pl_force_setting *setting, const pl_force_value *values,
                          pl_turning *out) {
  const pl_force_value *body = &values[0], *q = &values[1], *rate = &values[2];
  if ((body->body != NULL) == (q->count > 0))
    return pl_fail(PL_E_ARGUMENT, "give either body or q, for how the centre turns");
  if (rate->count && !q->count)
    return pl_fail(PL_E_ARGUMENT, "rate_rad_s goes with q; a body has a rate of its own");
  *out = (pl_turning){.tdb_day = setting->tdb_day,
                      .tdb_fraction = setting->tdb_fraction,
                      .body = body->body,
                      .q = PL_QUAT_IDENTITY,
                      .rate_rad_s = rate->count ? rate->numbers[0] : 0.0};
  if (body->body)
    return PL_OK;
  const double *n = q->numbers;
  const double norm2 = n[0] * n[0] + n[1] * n[1] + n[2] * n[2] + n[3] * n[3];
  if (!(norm2 > 0.0) || !isfinite(norm2))
    return pl_fail(PL_E_RANGE, "q must not be zero, nor overflow when squared");
  out->q = pl_quat_unit((pl_quat){n[0], n[1], n[2], n[3]});
  return PL_OK;
}

pl_vec3 pl_turning_pole(const pl_turning *turning, double t_s) {
  const pl_vec3 z = {0.0, 0.0, 1.0};
  if (!turning->body)
    return pl_quat_rotate(turning->q, z);
  const pl_pole pole = pl_celestial_pole(turning->body, turning->tdb_day,
                                         turning->tdb_fraction + t_s / SECONDS_PER_DAY);
  const double c = cos(pole.dec_rad);
  return (pl_vec3){c * cos(pole.ra_rad), c * sin(pole.ra_rad), sin(pole.dec_rad)};
}

pl_mat3 pl_turning_matrix(const pl_turning *turning, double t_s) {
  if (turning->body)
    return pl_mat3_from_quat(pl_celestial_orientation(
        turning->body, turning->tdb_day, turning->tdb_fraction + t_s / SECONDS_PER_DAY));
  const pl_quat spin = pl_quat_axis_angle(pl_vec3_make(0.0, 0.0, 1.0),
                                          remainder(turning->rate_rad_s * t_s, 2.0 * PL_PI));
  return pl_mat3_from_quat(pl_quat_mul(turning->q, spin));
}

double pl_turning_rate_rad_s(const pl_turning *turning) {
  if (turning->body)
    return turning->body->rotation.w_deg[1] * (PL_PI / 180.0) / SECONDS_PER_DAY;
  return turning->rate_rad_s;
}
