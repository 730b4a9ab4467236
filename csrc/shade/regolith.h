/* What the photometric laws of dark worlds read, and what they share. */
#ifndef PL_SHADE_REGOLITH_H
#define PL_SHADE_REGOLITH_H

#include <stdbool.h>

#include "math/vec.h"

/* Of one band; as in shade/hapke.h. The single-scattering albedo, or the normal albedo of
 * lunar_lambert and minnaert, is the surface's colour. */
typedef struct pl_regolith_band {
  float b, c, b_c0, h_c, b_s0, h_s, roughness_rad, filling;
} pl_regolith_band;
enum { PL_REGOLITH_VALUES = sizeof(pl_regolith_band) / sizeof(float) };

/* All zero: isotropic, without surges and relief; minnaert is Lambert's law. */
typedef struct pl_regolith {
  pl_regolith_band band[3]; /* red, green, blue */
  float limb;               /* Minnaert's exponent k, less 1 */
  bool simple_h, narrow_surge;
  float excess[3]; /* what is sent on beside the law's light, as a part of it: where it stands for
                    * another law */
} pl_regolith;

/* Whether every value is within the range of its kind: what the laws are finite for. NAN counts as
 * such where `partly`. */
bool pl_regolith_band_valid(const pl_regolith_band *band, bool partly);

/* Takes over what is a number in `given`. */
void pl_regolith_band_take(const pl_regolith_band *given, pl_regolith_band *out);

/* A pl_regolith's band with its albedo: one texel of a published map, in the order of Sato et al.
 * 2014 (LROC WAC Hapke parameter maps). */
typedef struct pl_regolith_texel {
  float w;
  pl_regolith_band band;
} pl_regolith_texel;

#endif
