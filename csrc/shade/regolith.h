/* Parameters of the photometric models of dark bodies. */
#ifndef PL_SHADE_REGOLITH_H
#define PL_SHADE_REGOLITH_H

#include <stdbool.h>

#include "math/vec.h"

/* Parameters of one band, as in shade/hapke.h. The single-scattering albedo, or the normal albedo
 * of lunar_lambert and minnaert, is the surface's colour. */
typedef struct pl_regolith_band {
  float b, c, b_c0, h_c, b_s0, h_s, roughness_rad, filling;
} pl_regolith_band;
enum { PL_REGOLITH_VALUES = sizeof(pl_regolith_band) / sizeof(float) };

/* All zero: isotropic, without surges and roughness; minnaert is then Lambert. */
typedef struct pl_regolith {
  pl_regolith_band band[3]; /* red, green, blue */
  float limb;               /* Minnaert's exponent k, less 1 */
  bool simple_h, narrow_surge;
  /* Relative correction of the reflectance, where the model replaces another one as a reflectance
   * level of detail. */
  float excess[3];
} pl_regolith;

/* True if each value is within its range, in which the models are finite. `partly`: NAN (unset) is
 * allowed. */
bool pl_regolith_band_valid(const pl_regolith_band *band, bool partly);

/* Copies the values of `given` that are not NAN. */
void pl_regolith_band_take(const pl_regolith_band *given, pl_regolith_band *out);

/* Albedo and parameters of one texel of a published map, in the order of Sato et al. 2014 (LROC WAC
 * Hapke parameter maps). */
typedef struct pl_regolith_texel {
  float w;
  pl_regolith_band band;
} pl_regolith_texel;

#endif
