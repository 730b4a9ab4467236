/* Vectors: double precision for the world, float for the camera-relative view. */
#ifndef PL_MATH_VEC_H
#define PL_MATH_VEC_H

#include <math.h>
#include <stdbool.h>

#define PL_PI 3.14159265358979323846
#define PL_PI_F 3.14159265f

typedef struct pl_vec3 {
  double x, y, z;
} pl_vec3;

typedef struct pl_vec3f {
  float x, y, z;
} pl_vec3f;

/* Maximum and minimum of two numbers; `b` if `a` is NaN. One instruction each, whereas fmaxf and
 * fminf are library calls. */
static inline float pl_maxf(float a, float b) { return a > b ? a : b; }
static inline float pl_minf(float a, float b) { return a < b ? a : b; }

static inline pl_vec3 pl_vec3_make(double x, double y, double z) { return (pl_vec3){x, y, z}; }
static inline pl_vec3 pl_vec3_add(pl_vec3 a, pl_vec3 b) {
  return (pl_vec3){a.x + b.x, a.y + b.y, a.z + b.z};
}
static inline pl_vec3 pl_vec3_sub(pl_vec3 a, pl_vec3 b) {
  return (pl_vec3){a.x - b.x, a.y - b.y, a.z - b.z};
}
static inline pl_vec3 pl_vec3_scale(pl_vec3 a, double s) {
  return (pl_vec3){a.x * s, a.y * s, a.z * s};
}
static inline pl_vec3 pl_vec3_madd(pl_vec3 a, double s, pl_vec3 b) { /* a + s b */
  return (pl_vec3){a.x + s * b.x, a.y + s * b.y, a.z + s * b.z};
}
static inline double pl_vec3_dot(pl_vec3 a, pl_vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static inline pl_vec3 pl_vec3_cross(pl_vec3 a, pl_vec3 b) {
  return (pl_vec3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
static inline double pl_vec3_norm(pl_vec3 a) { return sqrt(pl_vec3_dot(a, a)); }
/* Unit vector; the zero vector stays zero. */
static inline pl_vec3 pl_vec3_unit(pl_vec3 a) {
  const double n = pl_vec3_norm(a);
  return n > 0.0 ? pl_vec3_scale(a, 1.0 / n) : a;
}
static inline bool pl_vec3_finite(pl_vec3 a) {
  return isfinite(a.x) && isfinite(a.y) && isfinite(a.z);
}

static inline pl_vec3f pl_vec3f_make(float x, float y, float z) { return (pl_vec3f){x, y, z}; }
static inline pl_vec3f pl_vec3f_add(pl_vec3f a, pl_vec3f b) {
  return (pl_vec3f){a.x + b.x, a.y + b.y, a.z + b.z};
}
static inline pl_vec3f pl_vec3f_sub(pl_vec3f a, pl_vec3f b) {
  return (pl_vec3f){a.x - b.x, a.y - b.y, a.z - b.z};
}
static inline pl_vec3f pl_vec3f_mul(pl_vec3f a, pl_vec3f b) {
  return (pl_vec3f){a.x * b.x, a.y * b.y, a.z * b.z};
}
static inline pl_vec3f pl_vec3f_scale(pl_vec3f a, float s) {
  return (pl_vec3f){a.x * s, a.y * s, a.z * s};
}
static inline pl_vec3f pl_vec3f_madd(pl_vec3f a, float s, pl_vec3f b) { /* a + s b */
  return (pl_vec3f){a.x + s * b.x, a.y + s * b.y, a.z + s * b.z};
}
static inline float pl_vec3f_dot(pl_vec3f a, pl_vec3f b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
static inline pl_vec3f pl_vec3f_cross(pl_vec3f a, pl_vec3f b) {
  return (pl_vec3f){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
static inline float pl_vec3f_norm(pl_vec3f a) { return sqrtf(pl_vec3f_dot(a, a)); }
static inline pl_vec3f pl_vec3f_unit(pl_vec3f a) {
  const float n = pl_vec3f_norm(a);
  return n > 0.0f ? pl_vec3f_scale(a, 1.0f / n) : a;
}
/* Unit vector perpendicular to two vectors of any length; zero if they are parallel. */
static inline pl_vec3f pl_vec3f_across(pl_vec3f a, pl_vec3f b) {
  const float m = pl_maxf(pl_maxf(fabsf(a.x), pl_maxf(fabsf(a.y), fabsf(a.z))),
                          pl_maxf(fabsf(b.x), pl_maxf(fabsf(b.y), fabsf(b.z))));
  const float by = m > 0.0f ? 1.0f / m : 0.0f;
  return pl_vec3f_unit(pl_vec3f_cross(pl_vec3f_scale(a, by), pl_vec3f_scale(b, by)));
}
static inline float pl_vec3f_max(pl_vec3f a) { return pl_maxf(a.x, pl_maxf(a.y, a.z)); }

static inline pl_vec3f pl_vec3_to_float(pl_vec3 a) {
  return (pl_vec3f){(float)a.x, (float)a.y, (float)a.z};
}
static inline pl_vec3 pl_vec3f_to_double(pl_vec3f a) { return (pl_vec3){a.x, a.y, a.z}; }

#endif
