/* Gradient noise in space, filtered by the width of the footprint.
 *
 * Perlin, "Improving Noise", SIGGRAPH 2002: smooth random values of wavelengths around two cells,
 * twice differentiable. Gradients are the 12 vertices of an icosahedron, a spherical 5-design: up
 * to the fifth moment they have no preferred direction, where Perlin's 12 edges of a cube do.
 *
 * Range [-1, 1]; over positions and seeds the mean is 0 and the variance PL_NOISE_VARIANCE, both
 * exact. Lattice points are zeros. */
#ifndef PL_MATH_NOISE_H
#define PL_MATH_NOISE_H

#include <stdint.h>

#include "math/vec.h"

/* 8 A^2 B of the fade f = 6t^5 - 15t^4 + 10t^3, A = int (1-f)^2 = 181/462,
 * B = int t^2 (1-f)^2 = 535/18018, times 4/3, the square of what scales the range to 1. */
#define PL_NOISE_VARIANCE (70108540.0 / 1442187747.0)

typedef struct pl_noise_value {
  float value;
  pl_vec3f gradient; /* of the value by the coordinates of the point, per cell */
} pl_noise_value;

/* The noise at a point, in cells; `seed` chooses one of 2^32 patterns. */
float pl_noise(pl_vec3 point, uint32_t seed);
pl_noise_value pl_noise_gradient(pl_vec3 point, uint32_t seed);

/* What is left of the noise in its mean over a footprint, a disc `width` cells across: the factor
 * whose product with the noise is nearest to that mean (least squares; its error is at noise.c). 1
 * at 0, falling, exactly 0 from PL_NOISE_WIDEST on and for infinite widths; not a number counts as
 * infinite. */
float pl_noise_fade(float width);
/* What the faded noise misses of the mean over a footprint: rms, over the noise's deviation. */
float pl_noise_missed(float width);
#define PL_NOISE_WIDEST 3.0f

#endif
