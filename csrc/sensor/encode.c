/* Tables of the display encoder, and the encoding. */
#include "sensor/encode.h"

#include <math.h>

/* The smallest float whose display value reaches (code - 1/2)/255. Computed in double, since the
 * curve in float misplaces it by an ulp. Inverse of IEC 61966-2-1. */
static float threshold_of(int code) {
  const double encoded = (code - 0.5) / 255.0;
  const double linear = encoded <= 0.04045 ? encoded / 12.92 : pow((encoded + 0.055) / 1.055, 2.4);
  const float nearest = (float)linear;
  return nearest < linear ? nextafterf(nearest, 2.0f) : nearest;
}

void pl_encoder_init(pl_encoder *encoder) {
  encoder->threshold[0] = 0.0f;
  for (int code = 1; code < 256; code++)
    encoder->threshold[code] = threshold_of(code);
  int code = 0;
  for (int bin = 0; bin < PL_ENCODER_BINS; bin++) {
    const float x = (float)bin / PL_ENCODER_BINS;
    while (code < 255 && encoder->threshold[code + 1] <= x)
      code++;
    encoder->guess[bin] = (uint8_t)code;
  }
}

uint8_t pl_encode(const pl_encoder *encoder, float x) {
  if (!(x > 0.0f))
    return 0;
  if (x >= 1.0f)
    return 255;
  int code = encoder->guess[(int)(x * PL_ENCODER_BINS)];
  while (code < 255 && encoder->threshold[code + 1] <= x)
    code++;
  return (uint8_t)code;
}

void pl_encode_rgb(const pl_encoder *encoder, const pl_vec3f *radiance, size_t count,
                   float white_radiance, uint8_t *rgb) {
  const float scale = 1.0f / white_radiance;
  for (size_t i = 0; i < count; i++) {
    rgb[3 * i] = pl_encode(encoder, radiance[i].x * scale);
    rgb[3 * i + 1] = pl_encode(encoder, radiance[i].y * scale);
    rgb[3 * i + 2] = pl_encode(encoder, radiance[i].z * scale);
  }
}
