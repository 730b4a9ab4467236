/* Affine maps in double precision: p' = m p + t. */
#ifndef PL_MATH_AFFINE_H
#define PL_MATH_AFFINE_H

#include <stdbool.h>

#include "math/rotation.h"

typedef struct pl_affine {
  pl_mat3 m;
  pl_vec3 t;
} pl_affine;

#define PL_AFFINE_IDENTITY                                                                         \
  ((pl_affine){{{{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}}}, {0.0, 0.0, 0.0}})

static inline pl_vec3 pl_affine_apply(const pl_affine *a, pl_vec3 p) {
  return pl_vec3_add(pl_mat3_mul_vec(a->m, p), a->t);
}
/* The map that applies first b, then a. */
static inline pl_affine pl_affine_compose(const pl_affine *a, const pl_affine *b) {
  return (pl_affine){pl_mat3_mul(a->m, b->m), pl_affine_apply(a, b->t)};
}
static inline double pl_mat3_determinant(pl_mat3 m) {
  return pl_vec3_dot(m.row[0], pl_vec3_cross(m.row[1], m.row[2]));
}
/* Cofactor matrix: transpose of the inverse times the determinant; defined for every matrix. Its
 * rows are cross products of rows (Cramer). It transforms normals, up to their length. */
static inline pl_mat3 pl_mat3_cofactor(pl_mat3 m) {
  return (pl_mat3){{pl_vec3_cross(m.row[1], m.row[2]), pl_vec3_cross(m.row[2], m.row[0]),
                    pl_vec3_cross(m.row[0], m.row[1])}};
}
/* True if the matrix is numerically invertible: the volume of the image of the unit cube, relative
 * to the product of its edges, exceeds rounding errors. */
static inline bool pl_mat3_is_regular(pl_mat3 m) {
  const pl_mat3 columns = pl_mat3_transpose(m);
  const double edges =
      pl_vec3_norm(columns.row[0]) * pl_vec3_norm(columns.row[1]) * pl_vec3_norm(columns.row[2]);
  return isfinite(edges) && fabs(pl_mat3_determinant(m)) > 1e-12 * edges && edges > 1e-200;
}
/* Inverse of an affine map whose matrix is regular. */
static inline pl_affine pl_affine_inverse(const pl_affine *a) {
  const double scale = 1.0 / pl_mat3_determinant(a->m);
  pl_affine out = {pl_mat3_transpose(pl_mat3_cofactor(a->m)), {0.0, 0.0, 0.0}};
  for (int i = 0; i < 3; i++)
    out.m.row[i] = pl_vec3_scale(out.m.row[i], scale);
  out.t = pl_vec3_scale(pl_mat3_mul_vec(out.m, a->t), -1.0);
  return out;
}

#endif
