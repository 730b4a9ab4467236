/* Gradient noise in 3-D, filtered by the width of the footprint.
 *
 * Perlin, "Improving Noise", SIGGRAPH 2002: smooth random values with wavelengths of about two
 * cells, twice differentiable. Gradients are the 12 vertices of an icosahedron, a spherical
 * 5-design: isotropic up to the fifth moment, unlike Perlin's 12 edges of a cube.
 *
 * Range [-1, 1]; over positions and seeds the mean is 0 and the variance PL_NOISE_VARIANCE, both
 * exact. Lattice points are zeros. */
#ifndef PL_MATH_NOISE_H
#define PL_MATH_NOISE_H

#include <stdint.h>

#include "math/lattice.h"
#include "math/vec.h"

/* 8 A^2 B for the fade f = 6t^5 - 15t^4 + 10t^3, A = int (1-f)^2 = 181/462,
 * B = int t^2 (1-f)^2 = 535/18018, times 4/3, the square of the factor that scales the range to 1.
 */
#define PL_NOISE_VARIANCE (70108540.0 / 1442187747.0)

typedef struct pl_noise_value {
  float value;
  pl_vec3f gradient; /* derivative by the coordinates of the point, per cell */
} pl_noise_value;

/* Noise at a point, in cells; `seed` selects one of 2^32 patterns. */
float pl_noise(pl_vec3 point, uint32_t seed);
pl_noise_value pl_noise_gradient(pl_vec3 point, uint32_t seed);
/* pl_noise of all lanes, and pl_noise_gradient. */
void pl_noise_lanes(const pl_point_lanes *points, uint32_t seed, float out[PL_LANES]);
void pl_noise_gradient_lanes(const pl_point_lanes *points, uint32_t seed, float value[PL_LANES],
                             float gradient[3][PL_LANES]);
/* The same with a seed of its own in each lane. */
void pl_noise_seeds_lanes(const pl_point_lanes *points, const uint32_t seeds[PL_LANES],
                          float out[PL_LANES]);
void pl_noise_gradient_seeds_lanes(const pl_point_lanes *points, const uint32_t seeds[PL_LANES],
                                   float value[PL_LANES], float gradient[3][PL_LANES]);

/* Factor on the noise that approximates its mean over a footprint, a disc with a diameter of
 * `width` cells, best in least squares. 1 at 0, decreasing, exactly 0 from PL_NOISE_WIDEST on and
 * for infinite widths; NaN is treated as infinite.
 *
 * The factor is the mean of the noise's autocorrelation over the footprint. Measured over discs of
 * diameter `width` in random planes it is 0.96 at 0.3, 0.64 at 1, 0.35 at 1.64, 0.20 at 2.2, 0.08
 * at 2.9; the curve is within 0.1 of it everywhere and within 0.05 up to widths of 1.8. The
 * remaining rms difference between the faded noise and the true mean, for the best factor, is at
 * most 0.36 standard deviations of the noise, near widths of 2. */
#define PL_NOISE_WIDEST 3.0f
PL_WIDE_PART float pl_noise_fade(float width) {
  const float u = width * (1.0f / PL_NOISE_WIDEST);
  const float rest = 1.0f - u * u;
  return u < 1.0f ? rest * rest * rest : 0.0f;
}
/* Rms difference between the faded noise and its mean over a footprint, over the noise's standard
 * deviation. Fitted to measurements over squares, within 0.02; over discs it is within 0.05. */
PL_WIDE_PART float pl_noise_missed(float width) {
  const float w = pl_minf(width, 1e3f);
  return 0.46f * w * w / (1.0f + 0.66f * w * w * w);
}

#endif
