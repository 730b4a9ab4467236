/* By tables of the 256 codes. */
#include "geom/image_levels.h"

#include <math.h>

#include "base/memory.h"
#include "math/color.h"

static uint8_t code_of(float encoded) {
  return (uint8_t)(255.0f * pl_minf(pl_maxf(encoded, 0.0f), 1.0f) + 0.5f);
}

void pl_image_raise_black(pl_image *image, float black) {
  uint8_t table[256];
  for (int c = 0; c < 256; c++) {
    const float over = pl_srgb_decode((float)c / 255.0f) - black;
    table[c] = over > 0.0f ? code_of(pl_srgb_encode(over / (1.0f - black))) : 0;
  }
  const int channels = image->channels, colors = channels < 3 ? 1 : 3;
  const size_t texels = (size_t)image->width * (size_t)image->height;
  for (size_t i = 0; i < texels; i++)
    for (int k = 0; k < colors; k++) {
      uint8_t *texel = &image->texels[i * (size_t)channels + (size_t)k];
      *texel = table[*texel];
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
