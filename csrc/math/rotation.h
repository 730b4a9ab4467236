/* Rotations in double precision: quaternions (Hamilton, scalar first), 3x3 matrices, rigid poses.
 */
#ifndef PL_MATH_ROTATION_H
#define PL_MATH_ROTATION_H

#include "math/vec.h"

/* (w, x, y, z); a unit quaternion represents a rotation: v_a = q v_b q*. */
typedef struct pl_quat {
  double w, x, y, z;
} pl_quat;

/* Rows; M v = (row0.v, row1.v, row2.v). */
typedef struct pl_mat3 {
  pl_vec3 row[3];
} pl_mat3;

/* Maps child coordinates to parent coordinates: p_parent = rotate(q, p_child) + t. Metres. */
typedef struct pl_pose {
  pl_vec3 t;
  pl_quat q;
} pl_pose;

#define PL_QUAT_IDENTITY ((pl_quat){1.0, 0.0, 0.0, 0.0})

static inline pl_quat pl_quat_mul(pl_quat a, pl_quat b) {
  return (pl_quat){
      a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z, a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
      a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x, a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w};
}
static inline pl_quat pl_quat_conjugate(pl_quat q) { return (pl_quat){q.w, -q.x, -q.y, -q.z}; }
/* Zero or non-finite input gives the identity. */
static inline pl_quat pl_quat_unit(pl_quat q) {
  const double n = sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
  if (!(n > 0.0) || !isfinite(n))
    return PL_QUAT_IDENTITY;
  return (pl_quat){q.w / n, q.x / n, q.y / n, q.z / n};
}
/* Rotation by angle_rad about a unit axis (right-handed). */
static inline pl_quat pl_quat_axis_angle(pl_vec3 axis, double angle_rad) {
  const double s = sin(0.5 * angle_rad);
  return (pl_quat){cos(0.5 * angle_rad), axis.x * s, axis.y * s, axis.z * s};
}
static inline pl_mat3 pl_mat3_from_quat(pl_quat q) {
  const double w = q.w, x = q.x, y = q.y, z = q.z;
  return (pl_mat3){{{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
                    {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
                    {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}}};
}
static inline pl_vec3 pl_mat3_mul_vec(pl_mat3 m, pl_vec3 v) {
  return (pl_vec3){pl_vec3_dot(m.row[0], v), pl_vec3_dot(m.row[1], v), pl_vec3_dot(m.row[2], v)};
}
static inline pl_mat3 pl_mat3_transpose(pl_mat3 m) {
  return (pl_mat3){{{m.row[0].x, m.row[1].x, m.row[2].x},
                    {m.row[0].y, m.row[1].y, m.row[2].y},
                    {m.row[0].z, m.row[1].z, m.row[2].z}}};
}
/* M^T v without forming the transpose. */
static inline pl_vec3 pl_mat3_mul_vec_t(pl_mat3 m, pl_vec3 v) {
  return (pl_vec3){m.row[0].x * v.x + m.row[1].x * v.y + m.row[2].x * v.z,
                   m.row[0].y * v.x + m.row[1].y * v.y + m.row[2].y * v.z,
                   m.row[0].z * v.x + m.row[1].z * v.y + m.row[2].z * v.z};
}
static inline pl_mat3 pl_mat3_mul(pl_mat3 a, pl_mat3 b) {
  pl_mat3 out;
  for (int i = 0; i < 3; i++)
    out.row[i] = pl_mat3_mul_vec_t(b, a.row[i]);
  return out;
}
static inline pl_vec3 pl_quat_rotate(pl_quat q, pl_vec3 v) {
  const pl_vec3 u = {q.x, q.y, q.z};
  const pl_vec3 t = pl_vec3_scale(pl_vec3_cross(u, v), 2.0);
  return pl_vec3_add(pl_vec3_madd(v, q.w, t), pl_vec3_cross(u, t));
}
static inline pl_vec3 pl_quat_rotate_inverse(pl_quat q, pl_vec3 v) {
  return pl_quat_rotate(pl_quat_conjugate(q), v);
}
/* Shepperd (1978): uses the largest of the four components as the pivot, which avoids the square
 * root of a small number. */
pl_quat pl_quat_from_mat3(pl_mat3 m);
/* Shortest-arc interpolation, u in [0, 1]; takes into account that q and -q are the same rotation.
 */
pl_quat pl_quat_slerp(pl_quat a, pl_quat b, double u);

/* Sets unit axes along the ground, for a unit vector up: east and north about z; at a pole x and y,
 * or x and -y. */
static inline void pl_ground_axes(pl_vec3 up, pl_vec3 *east, pl_vec3 *north) {
  const double across = hypot(up.x, up.y);
  *east = across > 0.0 ? (pl_vec3){-up.y / across, up.x / across, 0.0} : (pl_vec3){1.0, 0.0, 0.0};
  *north = pl_vec3_cross(up, *east);
}

#endif
