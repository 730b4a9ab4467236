/* Luminance, and the sRGB transfer functions (IEC 61966-2-1). */
#ifndef PL_MATH_COLOR_H
#define PL_MATH_COLOR_H

#include <math.h>

#include "math/vec.h"

/* Luminance of linear RGB with Rec. 709 primaries. */
static inline float pl_luminance(pl_vec3f c) {
  return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z;
}

/* Linear light to display value; both nominally [0, 1]. The linear segment extends to negative
 * input. */
static inline float pl_srgb_encode(float linear) {
  return linear <= 0.0031308f ? 12.92f * linear : 1.055f * powf(linear, 1.0f / 2.4f) - 0.055f;
}
/* Display value to linear light. */
static inline float pl_srgb_decode(float encoded) {
  return encoded <= 0.04045f ? encoded * (1.0f / 12.92f)
                             : powf((encoded + 0.055f) * (1.0f / 1.055f), 2.4f);
}

#endif
