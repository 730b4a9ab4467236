/* Spectra: the sun's, reflectances by their colour, and what a band gathers of both. */
#ifndef PL_LIGHT_SPECTRUM_H
#define PL_LIGHT_SPECTRUM_H

#include <stddef.h>

#include "base/status.h"

/* A function of the wavelength: straight between its points, 0 outside of them. */
typedef struct pl_curve {
  const double (*points)[2]; /* borrowed: wavelength in um, value; wavelengths rise */
  size_t count;              /* >= 2 */
} pl_curve;

/* PL_E_RANGE naming the point (from 0) that is not finite, out of order, or not within 0.01 to 1000
 * um; or when there are fewer than two. */
pl_status pl_curve_check(const pl_curve *curve);

/* How much of the reflectance at a wavelength (um) is the red, green and blue of a colour (linear
 * sRGB): rho = sum colour[c] * shares[c]. Not negative, and 1 together, so that white is white and
 * colours within 0..1 reflect no more than they get. Constant beyond 0.38 to 0.73 um. */
void pl_reflectance_shares(double um, double shares[3]);

/* What a band gathers of sunlight that a colour reflects. */
typedef struct pl_band_light {
  double part[3]; /* of the sun's irradiance, by red, green and blue of the reflectance */
  double mean_um; /* wavelength of what it gathers of white, weighted by energy; 0 if nothing */
  /* sum of parts times wavelength, um: photons are energy times wavelength over h c */
  double moment_um[3];
} pl_band_light;

/* Integrates a band's response, the product of `count` curves, over sunlight: exact to 1e-12 for
 * steps of 0.01 um (Gauss-Legendre with four points between all bends of the curves).
 *
 * sun: W m-2 um-1 in any scale; NULL: a black body of 5850 K with 0.7 of its light below 0.4 um,
 * where the sun's lines crowd. These two numbers are fitted to Wehrli (1985): within 6 % in every
 * 50 nm from 0.3 to 1.1 um, within 3 % in every 100 nm from 0.4 to 0.7 um, 10 % too faint
 * beyond 1.1.
 *
 * step_um: the longest piece, 1e-5 or more. PL_E_RANGE for
 * curves that fail pl_curve_check, a sun of no light, or a first response that reaches beyond it.
 */
pl_status pl_band_gather(const pl_curve *sun, const pl_curve *responses, size_t count,
                         double step_um, pl_band_light *out);

#endif
