/* Directional albedo of rough dielectric surfaces, and how they share light with what lies below.
 */
#ifndef PL_SHADE_GGX_FRESNEL_H
#define PL_SHADE_GGX_FRESNEL_H

#include <stdint.h>

#include "shade/ggx_loss.h"
#include "shade/refraction.h"

/* Fresnel's reflectance F of the relative index n is F0 + (1 - F0) rise, by this function: 0 at
 * normal incidence, 1 at grazing; a little below 0 between them for n over 2.4. Tinted and weighted
 * surfaces have f0 + (f90 - f0) rise (as the "generalized Schlick" of Cycles and OpenPBR).
 * Indices beyond the table count as its limits. */
#define PL_RISE_INDEX_LEAST (1.05f / 0.95f)
#define PL_RISE_INDEX_MOST 4.0f
float pl_fresnel_rise(float cosine, float index);

/* What single reflection by GGX makes of an even sky: directional albedos of a surface that
 * reflects all light, and of one that reflects `rise` of it. */
typedef struct pl_ggx_albedo {
  float all, rise;
} pl_ggx_albedo;

/* Rough boundary of a dielectric. */
typedef struct pl_ggx_dielectric {
  const int16_t *row[4]; /* of the table of `rise`, about roughness and index */
  float weight[4];
  pl_ggx_loss lost;
  pl_ggx_albedo mean; /* over the hemisphere, by the cosine */
  float deviation;    /* standard deviation of `rise`, likewise */
} pl_ggx_dielectric;

/* `roughness`: square root of GGX's alpha, 0..1. Albedos are off by at most 0.004 for cosines from
 * 0.08. */
pl_ggx_dielectric pl_ggx_dielectric_of(float roughness, float index);
/* The same without what concerns `all`: for stretched lobes, which have a table of their own. */
pl_ggx_dielectric pl_ggx_dielectric_rise(float roughness, float index);
float pl_ggx_rise(const pl_ggx_dielectric *d, float cosine);
pl_ggx_albedo pl_ggx_albedo_of(const pl_ggx_dielectric *d, float cosine);

/* The same for an index of 1.5, at half the cost: its albedo is that of Fresnel's reflectance. */
typedef struct pl_ggx_glass {
  const uint16_t *low, *high; /* rows of its table about the roughness */
  float way;                  /* from the one to the other */
  float mean, deviation;
} pl_ggx_glass;
pl_ggx_glass pl_ggx_glass_of(float roughness);
float pl_ggx_glass_albedo(const pl_ggx_glass *g, float cosine);

/* Light of an even sky that the boundary does not reflect: it enters. */
static inline float pl_ggx_entering(pl_ggx_albedo a, float f0, float f90) {
  return pl_maxf(1.0f - f0 * a.all - (f90 - f0) * a.rise, 0.0f);
}

/* A Lambert base below a boundary sends back color * share / pi: reciprocal, and all light if the
 * base is white, by `entering` towards both directions and its mean (Kelemen and Szirmay-Kalos,
 * "A Microfacet Based Coupled Specular-Matte BRDF Model", 2001). */
static inline float pl_ggx_base_share(float out, float in, float mean) {
  return mean > 1e-6f ? out * in / mean : 0.0f;
}

#endif
