/* The encoder's tables and their use. */
#include "sensor/encode.h"

#include "math/color.h"

void pl_encoder_init(pl_encoder *encoder) {
  encoder->threshold[0] = 0.0f;
  for (int code = 1; code < 256; code++)
    encoder->threshold[code] = pl_srgb_decode(((float)code - 0.5f) / 255.0f);
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
