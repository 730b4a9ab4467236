/* Directional albedo of rough dielectric surfaces, and the coupling to the layer below. */
#ifndef PL_SHADE_GGX_FRESNEL_H
#define PL_SHADE_GGX_FRESNEL_H

#include <stdint.h>

#include "shade/ggx_loss.h"
#include "shade/refraction.h"

/* Normalised Fresnel curve `rise`: the reflectance for the relative index n is F0 + (1 - F0) rise,
 * where rise is 0 at normal incidence, 1 at grazing incidence and slightly below 0 in between for n
 * over 2.4. Tinted and weighted surfaces have f0 + (f90 - f0) rise (the "generalized Schlick" of
 * Cycles and OpenPBR). Indices outside the table are clamped to its limits. */
#define PL_RISE_INDEX_LEAST (1.05f / 0.95f)
#define PL_RISE_INDEX_MOST 4.0f
float pl_fresnel_rise(float cosine, float index);

/* Directional albedos of the single-scattering GGX lobe: with a reflectance of 1 (`all`), and with
 * a reflectance of `rise`. */
typedef struct pl_ggx_albedo {
  float all, rise;
} pl_ggx_albedo;

/* Rough boundary of a dielectric. */
typedef struct pl_ggx_dielectric {
  /* The 4 rows of the table of `rise` to interpolate, over roughness and index. */
  const int16_t *row[4];
  float weight[4];
  pl_ggx_loss lost;
  pl_ggx_albedo mean; /* cosine-weighted mean over the hemisphere */
  float deviation;    /* standard deviation of `rise`, cosine-weighted */
} pl_ggx_dielectric;

/* `roughness`: square root of GGX's alpha, 0..1. Errors of the albedos are at most 0.004 for
 * cosines from 0.08. */
pl_ggx_dielectric pl_ggx_dielectric_of(float roughness, float index);
/* As above without `lost` and `mean.all`: for anisotropic lobes, which have their own table. */
pl_ggx_dielectric pl_ggx_dielectric_rise(float roughness, float index);
float pl_ggx_rise(const pl_ggx_dielectric *d, float cosine);
pl_ggx_albedo pl_ggx_albedo_of(const pl_ggx_dielectric *d, float cosine);

/* Albedo for an index of 1.5 with the exact Fresnel reflectance, at half the cost of the general
 * table. */
typedef struct pl_ggx_glass {
  const uint16_t *low, *high; /* rows of the table that bracket the roughness */
  float way;                  /* interpolation weight of `high`, 0..1 */
  float mean, deviation;
} pl_ggx_glass;
pl_ggx_glass pl_ggx_glass_of(float roughness);
float pl_ggx_glass_albedo(const pl_ggx_glass *g, float cosine);

/* Part of uniform incident light that the boundary transmits to the layer below. */
static inline float pl_ggx_entering(pl_ggx_albedo a, float f0, float f90) {
  return pl_maxf(1.0f - f0 * a.all - (f90 - f0) * a.rise, 0.0f);
}

/* BRDF factor of a Lambertian base below a boundary: the base reflects color * factor / pi.
 * Reciprocal, and conserves energy if the base is white. Arguments: the transmitted part
 * (pl_ggx_entering) towards both directions, and its mean (Kelemen and Szirmay-Kalos, "A Microfacet
 * Based Coupled Specular-Matte BRDF Model", 2001). */
static inline float pl_ggx_base_share(float out, float in, float mean) {
  return mean > 1e-6f ? out * in / mean : 0.0f;
}

#endif
