/* Limb darkening: the sun's disc is brighter in its middle than at its edge. */
#ifndef PL_LIGHT_LIMB_H
#define PL_LIGHT_LIMB_H

#include "light/sun.h"

enum { PL_LIMB_TERMS = 6, PL_LIMB_RINGS = 64 };

/* Radiance over the disc's mean, by band: the sum of c[band][k] mu^k, where mu is the cosine of the
 * angle at which the sun's surface is seen. */
typedef struct pl_limb {
  float c[3][PL_LIMB_TERMS];
  /* By the part s of the second band's light inside a ring, in equal steps: the ring's square
   * radius over s. Straight between them, draws are as dense as they should be to 1e-3. */
  float spread[PL_LIMB_RINGS + 1];
} pl_limb;

/* Neckel (2005), Solar Physics 229, 13: fitted to 0.4226-1.1 um, to which wavelengths are cut off.
 * The irradiance of the whole disc stays what it is. */
pl_limb pl_limb_make(const double wavelengths_um[3]);
/* The polynomial of one wavelength, in double. */
void pl_limb_polynomial(double wavelength_um, double c[PL_LIMB_TERMS]);
/* For a unit direction at the disc; that of the edge beyond it. The second band's ratio is also the
 * density of pl_limb_sample over that of pl_sun_sample. */
pl_vec3f pl_limb_ratio(const pl_limb *limb, const pl_sun_view *view, pl_vec3f direction);
/* A direction on the disc, as often as the second band is bright there: what the disc gives to a
 * plain surface has no noise in that band, and little in the others. ratio: as pl_limb_ratio. */
pl_vec3f pl_limb_sample(const pl_limb *limb, const pl_sun_view *view, const float u[2],
                        pl_vec3f *ratio);

#endif
