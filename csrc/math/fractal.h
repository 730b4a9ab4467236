/* Fractals of gradient noise, filtered by the width of the footprint.
 *
 * Musgrave, in Ebert et al., "Texturing and Modeling", 3rd ed. 2003, chapters 14 and 16. Octave i
 * has the frequency lacunarity^i, the amplitude roughness^i, a pattern and an offset of its own:
 * octaves are independent of each other, and no point is a zero of all of them.
 *
 * An octave that the footprint does not resolve is replaced by its mean (pl_noise_fade), so that
 * every kind tends to its own mean as the footprint grows and is that mean, without a call of the
 * noise, once the first octave is gone. fbm, multifractal and hetero_terrain keep their mean
 * exactly under this, since octaves enter them linearly and are independent; ridged and hybrid
 * clamp, and keep it within 0.03 of the texture's standard deviation (measured at offsets 0.3..1,
 * gains 1.6..4). Against the mean over the footprint itself, a disc `width` across, the value errs
 * by at most 0.35 standard deviations, near half a cell; 0.07 at a tenth and 0.15 at 6 cells. */
#ifndef PL_MATH_FRACTAL_H
#define PL_MATH_FRACTAL_H

#include <stdint.h>

#include "math/noise.h"

#define PL_FRACTAL_OCTAVES 16

typedef struct pl_fractal {
  float octaves;    /* clamped to [1, PL_FRACTAL_OCTAVES]; a fraction adds a part of one more */
  float roughness;  /* ratio of the amplitudes of an octave and the one before: lacunarity^-H */
  float lacunarity; /* ratio of their frequencies */
  float offset;     /* added to the noise: all but fbm and multifractal */
  float gain;       /* how much an octave lets the next one through: ridged and hybrid */
  uint32_t seed;
} pl_fractal;

typedef enum pl_fractal_kind {
  PL_FRACTAL_FBM,            /* sum of octaves over the sum of amplitudes: [-1, 1], mean 0 */
  PL_FRACTAL_MULTIFRACTAL,   /* product of (1 + octave): mean 1 */
  PL_FRACTAL_HETERO_TERRAIN, /* octaves in proportion to the height below them;
                                mean offset * product of (1 + amplitude offset) */
  PL_FRACTAL_RIDGED,         /* octaves (offset - |noise|)^2, let through by the one before */
  PL_FRACTAL_HYBRID,         /* octaves let through by the product of those before */
  PL_FRACTAL_KINDS
} pl_fractal_kind;

typedef float (*pl_fractal_fn)(const pl_fractal *fractal, pl_vec3 point, float width);
typedef struct pl_fractal_row {
  const char *name, *doc;
  pl_fractal_fn evaluate; /* point and footprint width in cells of the first octave */
} pl_fractal_row;
extern const pl_fractal_row pl_fractal_rows[PL_FRACTAL_KINDS];

/* fbm with its gradient per cell of the first octave, and the variance that the footprint took. */
typedef struct pl_fractal_value {
  float value;
  pl_vec3f gradient;
  float lost_variance;
} pl_fractal_value;
pl_fractal_value pl_fractal_gradient(const pl_fractal *fractal, pl_vec3 point, float width);

#endif
