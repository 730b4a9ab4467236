/* Maps from the unit square to discs, hemispheres and cones, with their densities. */
#ifndef PL_MATH_SAMPLING_H
#define PL_MATH_SAMPLING_H

#include <stdbool.h>

#include "math/vec.h"

/* Right-handed orthonormal axes (t, b, n) around the unit vector n; continuous except at n.z = 0.
 * Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 6(1), 2017. */
typedef struct pl_basis {
  pl_vec3f t, b, n;
} pl_basis;

static inline pl_basis pl_basis_make(pl_vec3f n) {
  const float sign = copysignf(1.0f, n.z);
  const float a = -1.0f / (sign + n.z);
  const float b = n.x * n.y * a;
  return (pl_basis){
      {1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x}, {b, sign + n.y * n.y * a, -n.y}, n};
}
static inline pl_vec3f pl_basis_to_world(const pl_basis *basis, pl_vec3f v) {
  return pl_vec3f_madd(pl_vec3f_madd(pl_vec3f_scale(basis->t, v.x), v.y, basis->b), v.z, basis->n);
}
static inline pl_vec3f pl_basis_to_local(const pl_basis *basis, pl_vec3f v) {
  return pl_vec3f_make(pl_vec3f_dot(v, basis->t), pl_vec3f_dot(v, basis->b),
                       pl_vec3f_dot(v, basis->n));
}

/* Lets one random number choose a strategy and then draw a direction: the chosen part of its range
 * is stretched to [0, 1). Evenly distributed samples remain so within each choice; with a second
 * number for the choice they would not. Returns whether u is below `chance`. */
static inline bool pl_sample_choose(float chance, float *u) {
  const bool below = *u < chance;
  const float from = below ? 0.0f : chance, wide = below ? chance : 1.0f - chance;
  *u = pl_minf((*u - from) / wide, 0x1.fffffep-1f);
  return below;
}

/* Uniform point of the unit disc, z = 0; density 1/pi. Concentric map, which keeps strata compact:
 * Shirley and Chiu, "A low distortion map between disk and square", JGT 2(3), 1997. */
static inline pl_vec3f pl_sample_disc(float u, float v) {
  const float a = 2.0f * u - 1.0f, b = 2.0f * v - 1.0f;
  if (fabsf(a) > fabsf(b)) {
    const float angle = 0.25f * PL_PI_F * (b / a);
    return pl_vec3f_make(a * cosf(angle), a * sinf(angle), 0.0f);
  }
  if (b == 0.0f) /* then a is 0 too: the centre */
    return pl_vec3f_make(0.0f, 0.0f, 0.0f);
  const float angle = 0.25f * PL_PI_F * (a / b);
  return pl_vec3f_make(b * sinf(angle), b * cosf(angle), 0.0f);
}

/* Direction about +z with density cos(theta)/pi; z > 0 except on the rim (Malley's method). */
static inline pl_vec3f pl_sample_cosine_hemisphere(float u, float v) {
  pl_vec3f d = pl_sample_disc(u, v);
  d.z = sqrtf(pl_maxf(1.0f - (d.x * d.x + d.y * d.y), 0.0f));
  return d;
}
static inline float pl_cosine_hemisphere_pdf(float cosine) {
  return pl_maxf(cosine, 0.0f) * (1.0f / PL_PI_F);
}

/* Maps the unit disc to the cone about +z; equal areas become equal solid angles. */
static inline pl_vec3f pl_disc_to_cone(pl_vec3f d, float one_minus_cos) {
  const float h = one_minus_cos * pl_minf(d.x * d.x + d.y * d.y, 1.0f); /* 1 - cos of the sample */
  const float scale = sqrtf(one_minus_cos * (2.0f - h));
  return pl_vec3f_make(d.x * scale, d.y * scale, 1.0f - h);
}
/* Uniform direction in the cone about +z; `one_minus_cos` of its half angle, in (0, 2],
 * without cancellation. Lambert's equal-area map of the concentric disc: x and y have full relative
 * precision for any width of the cone (half angles down to 1e-15 rad). */
static inline pl_vec3f pl_sample_cone(float u, float v, float one_minus_cos) {
  return pl_disc_to_cone(pl_sample_disc(u, v), one_minus_cos);
}
/* Density inside the cone, 1/sr. */
static inline float pl_cone_pdf(float one_minus_cos) {
  return 1.0f / (2.0f * PL_PI_F * one_minus_cos);
}

/* Power heuristic: weight of a sample from a distribution with density `a` that could also come
 * from one with density `b`, a^2/(a^2 + b^2) (Veach 1997, 9.2.4), computed from the ratio so that
 * large densities do not overflow. a = 0 gives 0; an infinite `a` (a delta) gives 1. */
static inline float pl_power_heuristic(float a, float b) {
  if (!(a > 0.0f))
    return 0.0f;
  if (isinf(a))
    return 1.0f;
  const float ratio = b / a;
  return 1.0f / (1.0f + ratio * ratio);
}

#endif
