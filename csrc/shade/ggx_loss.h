/* Light that single-scattering GGX loses to shadowing, given back as multiple scattering:
 * reciprocal, and with all light.
 *
 * Of the loss 1 - E(w), where E is the directional albedo of a white surface, a part b(w) comes
 * back as a broad lobe, b(wo) b(wi) cos(wi) / (pi mean of b) (Kulla and Conty, "Revisiting
 * Physically Based Shading at Imageworks", 2017); the rest stays about the mirror's direction: the
 * lobe itself is multiplied by g(wo) g(wi), so that it has 1 - b(w) of an even sky's light. b
 * follows random walks between microfacets (Heitz et al., "Multiple-Scattering Microfacet BSDFs
 * with the Smith Model", 2016; tests/c/test_microfacets.c): all of the loss where surfaces are
 * rough or seen from above, little of it where smooth ones are seen at grazing angles. */
#ifndef PL_SHADE_GGX_LOSS_H
#define PL_SHADE_GGX_LOSS_H

#include <stdint.h>

#include "math/vec.h"

/* A lobe's loss and its means over the hemisphere, by the cosine. */
typedef struct pl_ggx_loss {
  const uint16_t (*low)[3], (*high)[3]; /* rows of the table about the roughness */
  float way;                            /* from the one to the other */
  float mean, broad_mean;
} pl_ggx_loss;

/* Towards one direction. */
typedef struct pl_ggx_lost {
  float broad; /* b, 0..1 */
  float gain;  /* g */
} pl_ggx_lost;

/* `roughness`: square root of GGX's alpha, 0..1; values beyond count as the limit. Losses are off
 * by at most 0.002 for roughness from 0.05 and cosines from 0.08. */
pl_ggx_loss pl_ggx_loss_of(float roughness);
pl_ggx_lost pl_ggx_lost_at(const pl_ggx_loss *l, float cosine);
/* 1 - E alone, and the mean of it. */
float pl_ggx_loss_at(const pl_ggx_loss *l, float cosine);
float pl_ggx_loss_mean(float roughness);

/* Several reflections take their parts of the light: what they leave, by the mean over the
 * hemisphere of Schlick's reflectance, f0 + (1 - f0)/21: the geometric series over further hits,
 * each of which escapes with the chance 1 - loss. All of it for f0 = 1. */
static inline float pl_ggx_reflectance_mean(float f0) { return f0 + (1.0f - f0) * (1.0f / 21.0f); }
/* What hits beyond the first leave. */
static inline float pl_ggx_further(float f0, float loss_mean) {
  const float f = pl_ggx_reflectance_mean(f0);
  return f * (1.0f - loss_mean) / (1.0f - f * loss_mean);
}
/* What all of them leave. */
static inline float pl_ggx_returned(float f0, float loss_mean) {
  return pl_ggx_reflectance_mean(f0) * pl_ggx_further(f0, loss_mean);
}
static inline pl_vec3f pl_ggx_further_of(pl_vec3f f0, float loss_mean) {
  return pl_vec3f_make(pl_ggx_further(f0.x, loss_mean), pl_ggx_further(f0.y, loss_mean),
                       pl_ggx_further(f0.z, loss_mean));
}

#endif
