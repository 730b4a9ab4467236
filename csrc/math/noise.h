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

/* Factor on the noise that approximates its mean over a footprint, a disc with a diameter of
 * `width` cells, best in least squares (errors: see noise.c). 1 at 0, decreasing, exactly 0 from
 * PL_NOISE_WIDEST on and for infinite widths; NaN is treated as infinite. */
float pl_noise_fade(float width);
/* Rms difference between the faded noise and its mean over a footprint, over the noise's standard
 * deviation. */
float pl_noise_missed(float width);
#define PL_NOISE_WIDEST 3.0f

#endif
