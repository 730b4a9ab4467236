/* Equiangular cube around a body. */
#include "terrain/cube.h"

/* The axes of a face: outward, s and t, as indices of x, y, z with signs; s x t is outward. */
typedef struct face_axes {
  int axis[3];
  double sign[3];
} face_axes;

static const face_axes FACES[PL_CUBE_FACES] = {
    {{0, 1, 2}, {1.0, 1.0, 1.0}},  {{0, 1, 2}, {-1.0, -1.0, 1.0}}, {{1, 0, 2}, {1.0, -1.0, 1.0}},
    {{1, 0, 2}, {-1.0, 1.0, 1.0}}, {{2, 1, 0}, {1.0, 1.0, -1.0}},  {{2, 1, 0}, {-1.0, 1.0, 1.0}},
};

double pl_cube_tangent(double s) {
  const double a = fabs(s);
  return copysign(a == 1.0 ? 1.0 : tan(a * (0.25 * PL_PI)), s);
}

/* The sum of squares has the same bits for all faces that share the point, as only terms of a
 * commutative sum are exchanged: the outward one is 1, as is one of the others on an edge. */
pl_vec3 pl_cube_tangent_direction(int face, double tangent_s, double tangent_t) {
  const face_axes *axes = &FACES[face];
  const double norm = sqrt(1.0 + (tangent_s * tangent_s + tangent_t * tangent_t));
  const double along[3] = {1.0, tangent_s, tangent_t};
  double v[3];
  for (int k = 0; k < 3; k++)
    v[axes->axis[k]] = axes->sign[k] * along[k] / norm + 0.0; /* no negative zeros */
  return (pl_vec3){v[0], v[1], v[2]};
}

pl_vec3 pl_cube_direction(int face, double s, double t) {
  return pl_cube_tangent_direction(face, pl_cube_tangent(s), pl_cube_tangent(t));
}

static double angle_of(double across, double outward) {
  const double s = atan(across / outward) * (4.0 / PL_PI);
  return s > 1.0 ? 1.0 : s < -1.0 ? -1.0 : s;
}

void pl_cube_locate(pl_vec3 direction, int *face, double *s, double *t) {
  const double v[3] = {direction.x, direction.y, direction.z};
  int main = 0;
  for (int k = 1; k < 3; k++)
    if (fabs(v[k]) > fabs(v[main]))
      main = k;
  *face = 2 * main + (v[main] < 0.0);
  const face_axes *axes = &FACES[*face];
  *s = angle_of(axes->sign[1] * v[axes->axis[1]], fabs(v[main]));
  *t = angle_of(axes->sign[2] * v[axes->axis[2]], fabs(v[main]));
}

double pl_cube_outward(int face, pl_vec3 direction) {
  const double v[3] = {direction.x, direction.y, direction.z};
  return FACES[face].sign[0] * v[FACES[face].axis[0]];
}

bool pl_cube_beside(int face, pl_vec3 direction, double *s, double *t) {
  const double v[3] = {direction.x, direction.y, direction.z};
  const face_axes *axes = &FACES[face];
  const double outward = pl_cube_outward(face, direction);
  if (!(outward > 0.5))
    return false;
  *s = atan(axes->sign[1] * v[axes->axis[1]] / outward) * (4.0 / PL_PI);
  *t = atan(axes->sign[2] * v[axes->axis[2]] / outward) * (4.0 / PL_PI);
  return true;
}

/* An angle in a plane through the centre changes across the direction's part in that plane. */
static pl_vec3 gradient_of(const double v[3], int outward, double sign_outward, int across,
                           double sign_across) {
  double out[3] = {0.0, 0.0, 0.0};
  const double scale = 4.0 / PL_PI / (v[outward] * v[outward] + v[across] * v[across]);
  out[across] = sign_across * sign_outward * v[outward] * scale;
  out[outward] = -sign_across * sign_outward * v[across] * scale;
  return (pl_vec3){out[0], out[1], out[2]};
}

void pl_cube_gradients(int face, pl_vec3 direction, pl_vec3 *s, pl_vec3 *t) {
  const double v[3] = {direction.x, direction.y, direction.z};
  const face_axes *axes = &FACES[face];
  *s = gradient_of(v, axes->axis[0], axes->sign[0], axes->axis[1], axes->sign[1]);
  *t = gradient_of(v, axes->axis[0], axes->sign[0], axes->axis[2], axes->sign[2]);
}

double pl_cube_cell_m(int level, double radius_m) { return ldexp(0.5 * PL_PI * radius_m, -level); }

int pl_cube_level(double cell_m, double radius_m) {
  int level = 0;
  while (level < PL_CUBE_LEVELS - 1 && pl_cube_cell_m(level, radius_m) > cell_m)
    level++;
  return level;
}
