/* Samples of ground for its textures (terrain/ground_texture.h), made instead of photographed:
 * clods on soil, and mottling of the albedo. Squares of pixels, row by row; pure functions of their
 * arguments. */
#ifndef PL_TERRAIN_GROUND_SAMPLE_H
#define PL_TERRAIN_GROUND_SAMPLE_H

#include <stdint.h>

#include "base/status.h"

enum { PL_GROUND_SAMPLE_LEAST = 16, PL_GROUND_SAMPLE_MOST = 4096 };
/* Most clods of a sample, and the greatest fraction of it under their outlines. */
#define PL_CLODS_MOST 1e6
#define PL_CLODS_COVER_MOST 0.5

/* Fragments of soil and rock that lie on the ground, of diameters from min_m to max_m: `density` of
 * 1 cm or more per m^2, of D or more as D^-exponent. */
typedef struct pl_clods {
  uint64_t seed;
  int pixels;    /* along a side */
  double size_m; /* of the square */
  double min_m, max_m, density, exponent;
} pl_clods;

/* Writes heights over the soil between clods, m: means over pixels. PL_E_RANGE with a text that
 * names what is wrong. */
pl_status pl_clods_make(const pl_clods *given, float *heights_m);
/* Fraction of the ground that outlines of clods sum to. */
double pl_clods_cover(const pl_clods *given);

/* Two kinds of ground, as dust and bedrock, by a fractal of an exponent `hurst`: `cover` is the
 * fraction of the bright one, `border` the width of their transition in deviations of the fractal.
 */
typedef struct pl_mottling {
  uint64_t seed;
  int pixels;
  double cover, border, hurst;
} pl_mottling;

/* Writes the fraction of the bright kind, 0 to 1, less its mean over the sample. */
pl_status pl_mottling_make(const pl_mottling *given, float *out);

#endif
