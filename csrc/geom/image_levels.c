/* Implemented with lookup tables over the 256 codes. */
#include "geom/image_levels.h"

#include <math.h>

#include "base/memory.h"
#include "math/color.h"

static uint8_t code_of(float encoded) {
  return (uint8_t)(255.0f * pl_minf(pl_maxf(encoded, 0.0f), 1.0f) + 0.5f);
}

/* Fraction of the body's area that may be brighter than the black level. */
static const double LIT = 0.05;

/* Measures the fraction of the body's area that has each code in a channel. */
static void measure_codes(const pl_image *image, int channel, double area[256]) {
  double sum = 0.0;
  for (int c = 0; c < 256; c++)
    area[c] = 0.0;
  for (int y = 0; y < image->height; y++) {
    /* relative area of a texel of the row */
    const double wide = sin(PL_PI * (y + 0.5) / image->height);
    const uint8_t *row = &image->texels[(size_t)y * (size_t)image->width * (size_t)image->channels];
    for (int x = 0; x < image->width; x++)
      area[row[x * image->channels + channel]] += wide;
    sum += wide * image->width;
  }
  for (int c = 0; c < 256; c++)
    area[c] /= sum;
}

static int color_count(const pl_image *image) { return image->channels < 3 ? 1 : 3; }

void pl_image_find_black(const pl_image *image, float black[3]) {
  double area[256];
  for (int k = 0; k < color_count(image); k++) {
    int code = 255;
    measure_codes(image, k, area);
    for (double brighter = 0.0; code > 0 && brighter + area[code] <= LIT; code--)
      brighter += area[code];
    black[k] = pl_minf(pl_srgb_decode((float)code / 255.0f), PL_BLACK_MOST);
  }
}

void pl_image_raise_black(pl_image *image, const float black[3]) {
  uint8_t table[3][256];
  const int channels = image->channels, colors = color_count(image);
  for (int k = 0; k < colors; k++)
    for (int c = 0; c < 256; c++) {
      const float over = pl_srgb_decode((float)c / 255.0f) - black[k];
      table[k][c] = over > 0.0f ? code_of(pl_srgb_encode(over / (1.0f - black[k]))) : 0;
    }
  const size_t texels = (size_t)image->width * (size_t)image->height;
  for (size_t i = 0; i < texels; i++)
    for (int k = 0; k < colors; k++) {
      uint8_t *texel = &image->texels[i * (size_t)channels + (size_t)k];
      *texel = table[k][*texel];
    }
}

pl_status pl_image_to_water(pl_image *image) {
  float linear[256];
  pl_image mask;
  if (image->channels < 3)
    return pl_fail(PL_E_RANGE, "a grey map does not tell water by its colour");
  PL_TRY(pl_image_init(image->width, image->height, 1, &mask));
  for (int c = 0; c < 256; c++)
    linear[c] = pl_srgb_decode((float)c / 255.0f);
  const size_t texels = (size_t)image->width * (size_t)image->height;
  for (size_t i = 0; i < texels; i++) {
    const uint8_t *texel = &image->texels[i * (size_t)image->channels];
    const float red = linear[texel[0]], blue = linear[texel[2]];
    mask.texels[i] = blue > 0.0f ? code_of((blue - 1.5f * red) / pl_maxf(red, 1e-6f)) : 0;
  }
  pl_image_clear(image);
  *image = mask;
  return PL_OK;
}
