/* Conversion of radiance to display-encoded 8-bit values (sRGB). */
#ifndef PL_SENSOR_ENCODE_H
#define PL_SENSOR_ENCODE_H

#include <stddef.h>
#include <stdint.h>

#include "math/vec.h"

enum { PL_ENCODER_BINS = 4096 };

/* Rounds 255 * sRGB(x) exactly without a power function per pixel: a table gives an initial code,
 * and the exact thresholds between adjacent codes correct it. */
typedef struct pl_encoder {
  float threshold[256];           /* smallest linear value of each code */
  uint8_t guess[PL_ENCODER_BINS]; /* code at the start of each bin of [0, 1) */
} pl_encoder;

void pl_encoder_init(pl_encoder *encoder);
/* Code of linear light `x` (1 is white). NaN and negative values give 0, values above 1 give 255.
 */
uint8_t pl_encode(const pl_encoder *encoder, float x);
/* Encodes `count` pixels. */
void pl_encode_rgb(const pl_encoder *encoder, const pl_vec3f *radiance, size_t count,
                   float white_radiance, uint8_t *rgb);

#endif
