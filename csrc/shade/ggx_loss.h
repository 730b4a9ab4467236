/* Multiple scattering of isotropic GGX lobes: compensates the energy that single scattering loses
 * to shadowing and masking. Reciprocal and energy conserving.
 *
 * Of the loss 1 - E(w), where E is the directional albedo of a white surface, a part b(w) is
 * reflected as a broad lobe, b(wo) b(wi) cos(wi) / (pi mean of b) (Kulla and Conty, "Revisiting
 * Physically Based Shading at Imageworks", 2017). The rest stays near the mirror direction: the
 * single-scattering lobe is multiplied by g(wo) g(wi), so that its albedo is 1 - b(w). b is fitted
 * to random walks between microfacets (Heitz et al., "Multiple-Scattering Microfacet BSDFs with the
 * Smith Model", 2016; tests/c/test_microfacets.c): it is the whole loss for rough surfaces or
 * near-normal directions, and a small part of it for smooth surfaces at grazing angles. */
#ifndef PL_SHADE_GGX_LOSS_H
#define PL_SHADE_GGX_LOSS_H

#include <stdint.h>

#include "math/vec.h"

/* Energy loss of a lobe, and its cosine-weighted means over the hemisphere. */
typedef struct pl_ggx_loss {
  const uint16_t (*low)[3], (*high)[3]; /* rows of the table that bracket the roughness */
  float way;                            /* interpolation weight of `high`, 0..1 */
  float mean, broad_mean;
} pl_ggx_loss;

/* Multiple scattering for one direction. */
typedef struct pl_ggx_lost {
  float broad; /* b, albedo of the broad lobe, 0..1 */
  float gain;  /* g, factor on the single-scattering lobe */
} pl_ggx_lost;

/* `roughness`: square root of GGX's alpha, clamped to 0..1. Errors of the losses are at most 0.002
 * for roughness from 0.05 and cosines from 0.08. */
pl_ggx_loss pl_ggx_loss_of(float roughness);
pl_ggx_lost pl_ggx_lost_at(const pl_ggx_loss *l, float cosine);
/* The loss 1 - E for one direction. */
float pl_ggx_loss_at(const pl_ggx_loss *l, float cosine);

/* Absorption by multiple reflections. Each hit reflects the hemispherical mean of Schlick's
 * reflectance, f0 + (1 - f0)/21, and the light escapes with probability 1 - loss: a geometric
 * series, whose sum is 1 for f0 = 1. */
static inline float pl_ggx_reflectance_mean(float f0) { return f0 + (1.0f - f0) * (1.0f / 21.0f); }
/* Part of the light that remains after all hits beyond the first. */
static inline float pl_ggx_further(float f0, float loss_mean) {
  const float f = pl_ggx_reflectance_mean(f0);
  return f * (1.0f - loss_mean) / (1.0f - f * loss_mean);
}
/* Part of the light that remains after all hits. */
static inline float pl_ggx_returned(float f0, float loss_mean) {
  return pl_ggx_reflectance_mean(f0) * pl_ggx_further(f0, loss_mean);
}
static inline pl_vec3f pl_ggx_further_of(pl_vec3f f0, float loss_mean) {
  return pl_vec3f_make(pl_ggx_further(f0.x, loss_mean), pl_ggx_further(f0.y, loss_mean),
                       pl_ggx_further(f0.z, loss_mean));
}

#endif
