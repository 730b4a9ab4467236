/* Open water roughened by wind, over a part of a Lambertian ground. */
#ifndef PL_SHADE_WATER_H
#define PL_SHADE_WATER_H

#include <math.h>

#include "shade/reflectance.h"

/* Width of the distribution of slopes: sqrt of twice the mean square slope along one axis, for a
 * wind of 0..14 m/s 12.5 m above the sea, clean surface (Cox and Munk 1954, J. Opt. Soc. Am. 44,
 * 838: mean square slope of both axes 0.003 + 0.00512 W). Extrapolated to stronger winds. */
static inline float pl_water_alpha(float wind_m_s) {
  const float variance = 0.003f + 0.00512f * wind_m_s;
  return sqrtf(variance < 1.0f ? variance : 1.0f);
}

/* GGX alpha with which pl_view_transfer and similar functions bound the lobe of waves: its peak is
 * up to 1.6 times 1/(2 alpha^3) (tests/c/test_water.c). */
static inline float pl_water_bound_alpha(float wind_m_s) {
  return 0.84f * pl_water_alpha(wind_m_s);
}

/* Not in the table: set where a map of water applies. Reads color, alpha (of slopes, as above),
 * water (the fraction of the ground under open water) and below (the fraction of the colour that
 * the water itself sends). Gaussian slopes (Beckmann) with Smith's shadowing, Fresnel's law for an
 * index of 1.34 (sea water in the visible; Quan and Fry 1995: 1.33..1.35); light from below the
 * surface is Lambertian, less what the surface reflects on the way in and out. */
extern const pl_reflectance pl_reflectance_water;

#endif
