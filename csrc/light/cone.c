/* Cone of an ellipsoid. Lines from p touch the unit sphere at the points n with n . p = 1. */
#include "light/cone.h"

/* Unit vector perpendicular to u: the perpendicular component of `towards`, or any if `towards` is
 * parallel to u. */
static pl_vec3 across(pl_vec3 u, pl_vec3 towards) {
  const pl_vec3 axis = fabs(u.x) < 0.6 ? (pl_vec3){1, 0, 0} : (pl_vec3){0, 1, 0};
  const pl_vec3 other = pl_vec3_cross(u, axis);
  const pl_vec3 side = pl_vec3_cross(pl_vec3_cross(u, towards), u);
  return pl_vec3_unit(pl_vec3_norm(side) > 1e-14 * pl_vec3_norm(towards) ? side : other);
}

bool pl_cone_make(pl_pose pose, pl_vec3 radii_m, pl_vec3 point, pl_vec3 reference, pl_cone *out) {
  const pl_mat3 turned = pl_mat3_from_quat(pl_quat_unit(pose.q));
  const double radii[3] = {radii_m.x, radii_m.y, radii_m.z};
  const pl_mat3 axes = pl_mat3_transpose(turned);
  for (int i = 0; i < 3; i++)
    out->scaled.row[i] = pl_vec3_scale(axes.row[i], 1.0 / radii[i]);
  out->p = pl_mat3_mul_vec(out->scaled, pl_vec3_sub(point, pose.t));
  const double size = pl_vec3_norm(out->p);
  if (!(size > 1.0))
    return false;
  out->h = sqrt((size - 1.0) * (size + 1.0));
  const pl_vec3 down = pl_vec3_scale(out->p, -1.0 / size);
  out->e[0] = across(down, pl_mat3_mul_vec(out->scaled, reference));
  out->e[1] = pl_vec3_cross(down, out->e[0]);
  const pl_vec3 parts[3] = {pl_vec3_scale(down, out->h), out->e[0], out->e[1]};
  for (int i = 0; i < 3; i++)
    out->limb[i] = pl_mat3_mul_vec(
        turned, (pl_vec3){parts[i].x * radii_m.x, parts[i].y * radii_m.y, parts[i].z * radii_m.z});
  return true;
}

double pl_cone_depth(const pl_cone *cone, pl_vec3 direction) {
  const pl_vec3 q = pl_mat3_mul_vec(cone->scaled, direction);
  const double length = pl_vec3_norm(q), towards = -pl_vec3_dot(cone->p, q);
  const double reach = cone->h * length;
  /* (cos(angle) - cos(radius)) |p|. Computed by the sines at large distances, where the cosines are
   * too close to 1. */
  if (!(cone->h > 1.0 && towards > 0.0))
    return (towards - reach) / length;
  const double offset = pl_vec3_norm(pl_vec3_cross(cone->p, q));
  return (length - offset) * (length + offset) / ((towards + reach) * length);
}

pl_vec3 pl_cone_limb(const pl_cone *cone, double turn_rad) {
  return pl_vec3_madd(pl_vec3_madd(cone->limb[0], cos(turn_rad), cone->limb[1]), sin(turn_rad),
                      cone->limb[2]);
}

double pl_cone_turn(const pl_cone *cone, pl_vec3 direction) {
  const pl_vec3 q = pl_mat3_mul_vec(cone->scaled, direction);
  return atan2(pl_vec3_dot(q, cone->e[1]), pl_vec3_dot(q, cone->e[0]));
}
