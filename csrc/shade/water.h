/* Open water that wind roughens, over a part of a Lambert ground. */
#ifndef PL_SHADE_WATER_H
#define PL_SHADE_WATER_H

#include <math.h>

#include "shade/reflectance.h"

/* Width of the distribution of slopes: sqrt of twice the mean square slope along one axis, for a
 * wind of 0..14 m/s 12.5 m above the sea, clean surface (Cox and Munk 1954, J. Opt. Soc. Am. 44,
 * 838: mean square slope of both axes 0.003 + 0.00512 W). Stronger winds count as such, too. */
static inline float pl_water_alpha(float wind_m_s) {
  const float variance = 0.003f + 0.00512f * wind_m_s;
  return sqrtf(variance < 1.0f ? variance : 1.0f);
}

/* The alpha of GGX for which pl_view_transfer and the like bound the lobe of waves: they come up to
 * 1.6 times 1/(2 alpha^3) (tests/c/test_water.c). */
static inline float pl_water_bound_alpha(float wind_m_s) {
  return 0.84f * pl_water_alpha(wind_m_s);
}

/* Not in the table: a surface has it where a map of water says so. Reads color, alpha (of slopes,
 * as above), water, the part of the ground that is open water, and below, the part of the colour
 * that is that water's. Gaussian slopes (Beckmann) with
 * Smith's shadowing, Fresnel's law for an index of 1.34 (sea water in the visible; Quan and Fry
 * 1995: 1.33..1.35); light that comes out of the water is Lambert's, less what the surface mirrors
 * on the way in and out. */
extern const pl_reflectance pl_reflectance_water;

#endif
