/* The GGX (Trowbridge-Reitz) microfacet lobe and Schlick's reflectance, shared by several
 * reflectance models. Directions are in the local frame, z = normal; ax, ay: alpha along x and y,
 * both in PL_GGX_ALPHA_MIN..1. */
#ifndef PL_SHADE_GGX_H
#define PL_SHADE_GGX_H

#include "math/sampling.h"

/* Below this alpha the peak of the distribution overflows float; 1e-3 blurs by 0.06 deg, a quarter
 * of the sun's radius. */
#define PL_GGX_ALPHA_MIN 1e-3f
/* Cosines are clamped to at least this value, a ten-thousandth of the sun's radius. */
#define PL_GGX_COSINE_MIN 1e-6f

/* Default index of refraction of dielectrics and its reflectance at normal incidence (glTF 2.0,
 * B.2.3). */
#define PL_DIELECTRIC_INDEX 1.5f
#define PL_DIELECTRIC_F0 0.04f

static inline float pl_ggx_alpha(float alpha) {
  return pl_minf(pl_maxf(alpha, PL_GGX_ALPHA_MIN), 1.0f);
}

/* Schlick (1994): reflectance f0 at normal incidence, f90 at grazing incidence. */
static inline pl_vec3f pl_schlick(pl_vec3f f0, float f90, float cosine) {
  const float c = pl_minf(pl_maxf(1.0f - cosine, 0.0f), 1.0f);
  const float c5 = c * c * c * c * c;
  return pl_vec3f_make(f0.x + (f90 - f0.x) * c5, f0.y + (f90 - f0.y) * c5,
                       f0.z + (f90 - f0.z) * c5);
}

/* Normal distribution at half vector h, written without 1 - cos^2 to keep precision in the tail.
 * For alphas <= 1, k is at least 1, except that two opposite grazing directions have no half vector
 * and give k = 0. */
static inline float pl_ggx_density(float ax, float ay, pl_vec3f h) {
  const float x = h.x / ax, y = h.y / ay;
  const float k = pl_maxf(x * x + y * y + h.z * h.z, 1.0f);
  return 1.0f / (PL_PI_F * ax * ay * k * k);
}

/* Smith's Lambda as a function of (alpha tan theta)^2 (Heitz 2014, eq. 72). */
static inline float pl_ggx_lambda_of(float tan2) { return 0.5f * (sqrtf(1.0f + tan2) - 1.0f); }
static inline float pl_ggx_lambda(float alpha, pl_vec3f w) {
  return pl_ggx_lambda_of(alpha * alpha * (w.x * w.x + w.y * w.y) /
                          pl_maxf(w.z * w.z, PL_GGX_COSINE_MIN * PL_GGX_COSINE_MIN));
}
/* Anisotropic Lambda (Heitz 2014, eq. 80). */
static inline float pl_ggx_lambda_xy(float ax, float ay, pl_vec3f w) {
  const float x = ax * w.x, y = ay * w.y;
  return pl_ggx_lambda_of((x * x + y * y) /
                          pl_maxf(w.z * w.z, PL_GGX_COSINE_MIN * PL_GGX_COSINE_MIN));
}

/* Upper bound of the pdf of reflection about visible normals, D(n) G1(wo) / (4 cos(wo)): D is at
 * most 1/(pi alpha^2), and G1 / cos(wo) at most 2/alpha by Smith's Lambda. */
static inline float pl_ggx_pdf_most(float alpha) {
  return 1.0f / (2.0f * PL_PI_F * alpha * alpha * alpha);
}

/* Samples a visible microfacet normal: Heitz, "Sampling the GGX distribution of visible normals",
 * JCGT 7(4), 2018. */
static inline pl_vec3f pl_ggx_visible_normal(float ax, float ay, pl_vec3f wo, const float u[2]) {
  const pl_vec3f v = pl_vec3f_unit(pl_vec3f_make(ax * wo.x, ay * wo.y, wo.z));
  const float length2 = v.x * v.x + v.y * v.y;
  const pl_vec3f t1 = length2 > 0.0f
                          ? pl_vec3f_scale(pl_vec3f_make(-v.y, v.x, 0.0f), 1.0f / sqrtf(length2))
                          : pl_vec3f_make(1.0f, 0.0f, 0.0f);
  const pl_vec3f t2 = pl_vec3f_cross(v, t1);
  const pl_vec3f d = pl_sample_disc(u[0], u[1]);
  const float s = 0.5f * (1.0f + v.z);
  const float y = (1.0f - s) * sqrtf(pl_maxf(1.0f - d.x * d.x, 0.0f)) + s * d.y;
  const float z = sqrtf(pl_maxf(1.0f - d.x * d.x - y * y, 0.0f));
  const pl_vec3f n = pl_vec3f_madd(pl_vec3f_madd(pl_vec3f_scale(t1, d.x), y, t2), z, v);
  return pl_vec3f_unit(pl_vec3f_make(ax * n.x, ay * n.y, pl_maxf(n.z, 1e-6f)));
}

#endif
