/* Smooth boundaries of dielectrics: Fresnel's and Snell's laws. `eta`: index behind the boundary
 * over that before it, >= 0; cosines and directions are those on the front side. */
#ifndef PL_SHADE_REFRACTION_H
#define PL_SHADE_REFRACTION_H

#include <stdbool.h>

#include "math/vec.h"

/* Squared cosine of the refracted direction; not positive in total reflection. */
static inline float pl_refracted_cosine2(float cosine, float eta) {
  return 1.0f - (1.0f - cosine * cosine) / (eta * eta);
}

/* Reflectance of unpolarised light, 0..1 (Born and Wolf, Principles of Optics, 7th ed., 1.5.2,
 * eq. 21); 1 in total reflection, 0 for eta = 1. */
static inline float pl_fresnel(float cosine, float eta) {
  const float c = pl_minf(fabsf(cosine), 1.0f), inner2 = pl_refracted_cosine2(c, eta);
  if (eta == 1.0f)
    return 0.0f;
  if (!(inner2 > 0.0f) || isinf(eta))
    return 1.0f;
  const float inner = sqrtf(inner2);
  const float across = (c - eta * inner) / (c + eta * inner);
  const float along = (eta * c - inner) / (eta * c + inner);
  return 0.5f * (across * across + along * along);
}

/* Refracts `w`: w and the result are unit and point away from the boundary, w on the front side,
 * the result behind it; n is the normal on the side of w. False in total reflection. */
static inline bool pl_refract(pl_vec3f w, pl_vec3f n, float eta, pl_vec3f *out) {
  const float c = pl_vec3f_dot(w, n), inner2 = pl_refracted_cosine2(c, eta);
  if (!(inner2 > 0.0f))
    return false;
  *out = pl_vec3f_madd(pl_vec3f_scale(n, c / eta - sqrtf(inner2)), -1.0f / eta, w);
  return true;
}

#endif
