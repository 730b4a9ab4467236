/* Fractal noise, filtered by the width of the footprint.
 *
 * Musgrave, in Ebert et al., "Texturing and Modeling", 3rd ed. 2003, chapters 14 and 16. Octave i
 * has the frequency lacunarity^i, the amplitude roughness^i, and its own pattern and offset:
 * octaves are independent, and they have no common zero.
 *
 * An octave that the footprint does not resolve is replaced by its mean (pl_noise_fade), so that
 * each kind tends to its mean as the footprint grows, and equals it, without evaluating noise, once
 * the first octave is hidden. fbm, multifractal and hetero_terrain preserve their mean exactly,
 * since octaves enter linearly and are independent. ridged and hybrid clamp, and preserve it within
 * 0.03 of the texture's standard deviation (measured at offsets 0.3..1, gains 1.6..4). Compared
 * with the true mean over the footprint, a disc of diameter `width`, the error is at most 0.35
 * standard deviations, near half a cell; 0.07 at a tenth and 0.15 at 6 cells. */
#ifndef PL_MATH_FRACTAL_H
#define PL_MATH_FRACTAL_H

#include <stdint.h>

#include "math/noise.h"

#define PL_FRACTAL_OCTAVES 16

typedef struct pl_fractal {
  float octaves;   /* clamped to [1, PL_FRACTAL_OCTAVES]; a fractional part adds a partial octave */
  float roughness; /* ratio of the amplitudes of successive octaves: lacunarity^-H */
  float lacunarity; /* ratio of the frequencies of successive octaves */
  float offset;     /* added to the noise: all kinds but fbm and multifractal */
  float gain;       /* weight of an octave on the next one: ridged and hybrid */
  uint32_t seed;
} pl_fractal;

typedef enum pl_fractal_kind {
  PL_FRACTAL_FBM,          /* sum of octaves over the sum of amplitudes: [-1, 1], mean 0 */
  PL_FRACTAL_MULTIFRACTAL, /* product of (1 + octave): mean 1 */
  /* Octaves times the height of coarser ones; mean offset * product of (1 + amplitude offset). */
  PL_FRACTAL_HETERO_TERRAIN,
  PL_FRACTAL_RIDGED, /* octaves (offset - |noise|)^2, weighted by the one before */
  PL_FRACTAL_HYBRID, /* octaves weighted by the product of those before */
  PL_FRACTAL_KINDS
} pl_fractal_kind;

/* Point and footprint width in cells of the first octave; of all lanes, with the same bits.
 * gradient: per cell of the first octave, for a width that is the same nearby. */
typedef float (*pl_fractal_fn)(const pl_fractal *fractal, pl_vec3 point, float width);
typedef void (*pl_fractal_lanes_fn)(const pl_fractal *fractal, const pl_point_lanes *points,
                                    const float width[PL_LANES], float out[PL_LANES]);
typedef void (*pl_fractal_gradient_fn)(const pl_fractal *fractal, const pl_point_lanes *points,
                                       const float width[PL_LANES], float out[PL_LANES],
                                       float gradient[3][PL_LANES]);
typedef struct pl_fractal_row {
  const char *name, *doc;
  pl_fractal_fn evaluate;
  pl_fractal_lanes_fn evaluate_lanes;
  pl_fractal_gradient_fn gradient_lanes;
} pl_fractal_row;
extern const pl_fractal_row pl_fractal_rows[PL_FRACTAL_KINDS];

/* fbm, its gradient per cell of the first octave, and the variance hidden by the footprint. */
typedef struct pl_fractal_value {
  float value;
  pl_vec3f gradient;
  float lost_variance;
} pl_fractal_value;
pl_fractal_value pl_fractal_gradient(const pl_fractal *fractal, pl_vec3 point, float width);

#endif
