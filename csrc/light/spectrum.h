/* Spectra: the sun's spectrum, reflectances from colours, and their integrals over a band. */
#ifndef PL_LIGHT_SPECTRUM_H
#define PL_LIGHT_SPECTRUM_H

#include <stddef.h>

#include "base/status.h"

/* A function of wavelength: linear between its points, 0 outside them. */
typedef struct pl_curve {
  const double (*points)[2]; /* borrowed: wavelength in um (increasing), value */
  size_t count;              /* >= 2 */
} pl_curve;

/* Weights of the red, green and blue components of a colour (linear sRGB) in the reflectance at a
 * wavelength (um): rho = sum colour[c] * weights[c]. The weights are not negative and sum to 1, so
 * that white is spectrally flat and colours within 0..1 reflect no more light than they receive.
 * Constant outside 0.38 to 0.73 um. */
void pl_reflectance_weights(double um, double weights[3]);

/* Light of a band from sunlight reflected by a colour. */
typedef struct pl_band_light {
  double part[3]; /* fraction of the solar irradiance, by red, green, blue of the reflectance */
  double mean_um; /* energy-weighted mean wavelength for a white reflector; 0 if no light */
  /* integral of light times wavelength, um: photon number is energy times wavelength over h c */
  double moment_um[3];
} pl_band_light;

/* Integrates a band's response, the product of `count` curves, over sunlight. The result is exact
 * to 1e-12 for steps of 0.01 um (Gauss-Legendre quadrature with four points between all nodes of
 * the curves).
 *
 * sun: W m-2 um-1 in any scale. NULL: a black body of 5850 K with a factor of 0.7 below 0.4 um,
 * where absorption lines are dense. These two numbers are fitted to Wehrli (1985): within 6 % in
 * every 50 nm from 0.3 to 1.1 um, within 3 % in every 100 nm from 0.4 to 0.7 um, 10 % too faint
 * beyond 1.1 um.
 *
 * step_um: the longest piece, 1e-5 or more. Fails with PL_E_RANGE for a curve with
 * fewer than two points or with a point (named, from 0) that is not finite, out of order or outside
 * 0.01 to 1000 um, a sun without light, or a first response that extends beyond the sun's spectrum.
 */
pl_status pl_band_gather(const pl_curve *sun, const pl_curve *responses, size_t count,
                         double step_um, pl_band_light *out);

#endif
