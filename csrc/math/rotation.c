/* Conversions between quaternions and matrices, and interpolation. */
#include "math/rotation.h"

pl_quat pl_quat_from_mat3(pl_mat3 m) {
  const double a = m.row[0].x, b = m.row[1].y, c = m.row[2].z;
  const double trace = a + b + c;
  pl_quat q;
  if (trace >= a && trace >= b && trace >= c) {
    q = (pl_quat){1.0 + trace, m.row[2].y - m.row[1].z, m.row[0].z - m.row[2].x,
                  m.row[1].x - m.row[0].y};
  } else if (a >= b && a >= c) {
    q = (pl_quat){m.row[2].y - m.row[1].z, 1.0 + a - b - c, m.row[0].y + m.row[1].x,
                  m.row[0].z + m.row[2].x};
  } else if (b >= c) {
    q = (pl_quat){m.row[0].z - m.row[2].x, m.row[0].y + m.row[1].x, 1.0 - a + b - c,
                  m.row[1].z + m.row[2].y};
  } else {
    q = (pl_quat){m.row[1].x - m.row[0].y, m.row[0].z + m.row[2].x, m.row[1].z + m.row[2].y,
                  1.0 - a - b + c};
  }
  return pl_quat_unit(q);
}

pl_quat pl_quat_slerp(pl_quat a, pl_quat b, double u) {
  double cosine = a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z;
  if (cosine < 0.0) { /* -b is the same rotation and nearer to a */
    b = (pl_quat){-b.w, -b.x, -b.y, -b.z};
    cosine = -cosine;
  }
  double wa = 1.0 - u, wb = u;
  if (cosine < 1.0 - 1e-9) { /* otherwise linear weights are exact up to rounding */
    const double angle = atan2(sqrt(fmax(0.0, 1.0 - cosine * cosine)), cosine);
    wa = sin((1.0 - u) * angle) / sin(angle);
    wb = sin(u * angle) / sin(angle);
  }
  return pl_quat_unit((pl_quat){wa * a.w + wb * b.w, wa * a.x + wb * b.x, wa * a.y + wb * b.y,
                                wa * a.z + wb * b.z});
}
