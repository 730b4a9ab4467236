/* Mip pyramid of a texture: its levels, in 8 bits with the code tables to linear light, or as
 * floats. Internal to geom. */
#ifndef PL_GEOM_MIPMAP_H
#define PL_GEOM_MIPMAP_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/status.h"
#include "geom/image.h"

/* A side of 65536 texels can be halved 16 times. */
enum { PL_MIP_MAX_LEVELS = 17 };

typedef struct pl_mip_level {
  int width, height;     /* texels */
  const uint8_t *texels; /* interleaved, tightly packed; in pl_mip_pyramid.base or .smaller */
  const float *numbers;  /* levels of a pyramid of floats, instead of texels; in .numbers */
} pl_mip_level;

typedef struct pl_mip_pyramid {
  int channels;
  int level_count;
  pl_mip_level levels[PL_MIP_MAX_LEVELS]; /* 0 is the image, the last is 1 x 1 */
  uint8_t *base;                          /* owned: texels of level 0 */
  uint8_t *smaller;                       /* owned: texels of all other levels */
  float *numbers;                         /* owned, or NULL: all levels of a pyramid of floats */
  size_t bytes;                           /* size of all levels */
  float color_table[256];                 /* 8-bit code to linear, colour channels */
  float alpha_table[256];                 /* the same for alpha: code / 255 */
} pl_mip_pyramid;

/* Returns true when channel `channel` of a texel with `channels` channels is alpha. */
static inline bool pl_mip_is_alpha(int channel, int channels) {
  return channels % 2 == 0 && channel == channels - 1;
}

/* Takes ownership of the texels of `image` (which is cleared, also on failure). */
pl_status pl_mip_build(pl_image *image, bool srgb, pl_mip_pyramid *out);
/* Builds a pyramid of one channel of floats, copied, top row first: nothing is rounded to 8
 * bits. */
pl_status pl_mip_build_numbers(const float *numbers, int width, int height, pl_mip_pyramid *out);
void pl_mip_clear(pl_mip_pyramid *pyramid);

#endif
