/* Radiance to display-encoded 8 bit (sRGB). */
#ifndef PL_SENSOR_ENCODE_H
#define PL_SENSOR_ENCODE_H

#include <stddef.h>
#include <stdint.h>

#include "math/vec.h"

enum { PL_ENCODER_BINS = 4096 };

/* Exact rounding of 255 * sRGB(x) without a power function a pixel: a guess from a table, settled
 * by the true thresholds between neighbouring codes. */
typedef struct pl_encoder {
  float threshold[256];           /* smallest linear value of each code */
  uint8_t guess[PL_ENCODER_BINS]; /* code at the start of each bin of [0, 1) */
} pl_encoder;

void pl_encoder_init(pl_encoder *encoder);
/* Code of linear light `x` (1 is white); NaN and below give 0, above gives 255. */
uint8_t pl_encode(const pl_encoder *encoder, float x);
/* `count` pixels at once. */
void pl_encode_rgb(const pl_encoder *encoder, const pl_vec3f *radiance, size_t count,
                   float white_radiance, uint8_t *rgb);

#endif
