/* Limb darkening: the sun's disc is brighter at its centre than at its edge. */
#ifndef PL_LIGHT_LIMB_H
#define PL_LIGHT_LIMB_H

#include "light/sun.h"

enum { PL_LIMB_TERMS = 6, PL_LIMB_RINGS = 64 };

/* Radiance relative to the mean over the disc, by band: the sum of c[band][k] mu^k, where mu is the
 * cosine of the emission angle at the sun's surface. */
typedef struct pl_limb {
  float c[3][PL_LIMB_TERMS];
  /* Squared radius of a ring divided by s, where s is the fraction of the second band's light
   * inside the ring, tabulated at equal steps of s. With linear interpolation the sampling density
   * is accurate to 1e-3. */
  float spread[PL_LIMB_RINGS + 1];
} pl_limb;

/* Neckel (2005), Solar Physics 229, 13: fitted to 0.4226-1.1 um; wavelengths are clamped to this
 * range. The irradiance of the whole disc is unchanged. */
pl_limb pl_limb_make(const double wavelengths_um[3]);
/* Coefficients of the polynomial at one wavelength, in double precision. */
void pl_limb_polynomial(double wavelength_um, double c[PL_LIMB_TERMS]);
/* Relative radiance in a unit direction towards the disc; beyond the edge, the value at the edge.
 * The ratio of the second band is also the density of pl_limb_sample relative to that of
 * pl_sun_sample. */
pl_vec3f pl_limb_ratio(const pl_limb *limb, const pl_sun_view *view, pl_vec3f direction);
/* Samples a direction on the disc in proportion to the radiance of the second band. Direct sunlight
 * on a smooth surface then has no noise in that band and little in the others. ratio: as
 * pl_limb_ratio. */
pl_vec3f pl_limb_sample(const pl_limb *limb, const pl_sun_view *view, const float u[2],
                        pl_vec3f *ratio);

#endif
